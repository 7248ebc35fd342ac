//! What a mesh is to be made of.

use super::surface::Surface;
use super::{knot, room, sphere, terrain};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The most triangles a mesh may have: what the signed indices of a PLY file can count. Vertices
/// are fewer still in every model.
pub const MOST_TRIANGLES: u64 = (1 << 31) - 1;

wavecrest_base::choices! {
    /// What the mesh is of.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Model {
        /// A sphere of radius about 1, displaced by fractal noise: closed.
        Sphere = "sphere",
        /// A ridged height field over [-1, 1] in x and z, y up: open.
        Terrain = "terrain",
        /// A finely displaced tube along a torus knot: closed, without self-intersections.
        Knot = "knot",
        /// A furnished room, 6 by 5 metres and y up: triangles of all sizes, with a palette's coordinates.
        Room = "room",
    }
}

impl Model {
    /// The displacement used when none is asked for.
    pub fn usual_displacement(self) -> f64 {
        match self {
            Self::Sphere => 0.25,
            Self::Terrain => 0.4,
            Self::Knot => 0.3,
            Self::Room => 0.035,
        }
    }

    /// The greatest displacement: beyond it the surface would be torn or meet itself.
    pub(super) fn most_displacement(self) -> f64 {
        match self {
            Self::Sphere => 0.9,
            Self::Terrain => 10.0,
            Self::Knot => knot::MOST_DISPLACEMENT,
            Self::Room => room::MOST_FOLDS,
        }
    }

    /// Of what is a single grid, the triangles of one step (one of `n` steps has `n * n` times as
    /// many), and the fewest steps that still look like the model.
    pub(super) fn grid(self) -> Option<(u64, u64)> {
        match self {
            Self::Sphere => Some((12, 2)),
            Self::Terrain => Some((2, 4)),
            Self::Knot => Some((2 * knot::RINGS_PER_SIDE, 8)),
            Self::Room => None,
        }
    }

    /// The fewest triangles that may be asked for.
    pub fn fewest_triangles(self) -> u64 {
        self.grid().map_or_else(room::fewest_triangles, |(one, steps)| one * steps.pow(2))
    }

    /// The most triangles that may be asked for: within [`MOST_TRIANGLES`], those of the finest
    /// grid. A room has no more than half, as its leaves have three vertices to the triangle.
    pub fn most_triangles(self) -> u64 {
        self.grid()
            .map_or(MOST_TRIANGLES / 2, |(one, _)| one * (MOST_TRIANGLES / one).isqrt().pow(2))
    }
}

/// All that a mesh depends on.
///
/// ```
/// use wavecrest_scene::generate::{Model, Recipe, mesh};
/// let mesh = mesh(&Recipe::new(Model::Sphere, 1000))?;
/// assert_eq!(mesh.triangles.len(), 1200); // 12 x 10 x 10, the next that the grid allows
/// # Ok::<(), wavecrest_base::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// What the mesh is of.
    pub model: Model,
    /// The triangles asked for. The mesh has the nearest count at or above it that its grid
    /// allows, and a room as many: see [`Recipe::counts`].
    pub triangles: u64,
    /// Which of the noises is used.
    pub seed: u64,
    /// How far the surface is moved: for the sphere and the knot as a share of their radius (that
    /// of the tube), either way; for the terrain the height of the highest crests; for the room how
    /// deep cloth folds, in metres.
    pub displacement: f64,
    /// Whether vertices have normals.
    pub normals: bool,
}

impl Recipe {
    /// The usual mesh of `model` with at least so many triangles: seed 1, no normals.
    pub fn new(model: Model, triangles: u64) -> Self {
        let displacement = model.usual_displacement();
        Self { model, triangles, seed: 1, displacement, normals: false }
    }

    /// The numbers of vertices and of triangles that the mesh has.
    ///
    /// # Errors
    /// When the recipe asks for what cannot be made, as for [`mesh`](super::mesh).
    pub fn counts(&self) -> Result<(u64, u64)> {
        let surface = self.surface()?;
        Ok((surface.vertices(), surface.triangles()))
    }

    /// The surface, once the recipe has been checked.
    pub(super) fn surface(&self) -> Result<Box<dyn Surface>> {
        self.check_triangles()?;
        self.check_displacement()?;
        let Self { triangles, seed, displacement, .. } = *self;
        let steps = self.model.grid().map_or(0, |(one, _)| self.steps(one));
        Ok(match self.model {
            Model::Sphere => Box::new(sphere::Sphere::new(steps, displacement, seed)),
            Model::Terrain => Box::new(terrain::Terrain::new(steps, displacement, seed)),
            Model::Knot => Box::new(knot::Knot::new(steps, displacement, seed)),
            Model::Room => Box::new(room::Room::new(triangles, displacement, seed)),
        })
    }

    /// The steps of the coarsest grid with at least the triangles asked for, where one step has
    /// `one`.
    fn steps(&self, one: u64) -> u64 {
        let squares = self.triangles.div_ceil(one);
        let root = squares.isqrt();
        if root * root < squares { root + 1 } else { root }
    }

    fn check_triangles(&self) -> Result<()> {
        let (model, fewest) = (self.model, self.model.fewest_triangles());
        let most = model.most_triangles();
        if (fewest..=most).contains(&self.triangles) {
            return Ok(());
        }
        let (kind, than) = if self.triangles < fewest {
            (ErrorKind::Usage, "more triangles than were asked for")
        } else {
            (ErrorKind::Limit, "fewer triangles than were asked for")
        };
        Err(Error::new(kind, format!("a {model} must have {than}"))
            .at("triangles")
            .value(self.triangles)
            .remedy(format!("ask for {fewest} to {most}")))
    }

    fn check_displacement(&self) -> Result<()> {
        let (model, most) = (self.model, self.model.most_displacement());
        if (0.0..=most).contains(&self.displacement) {
            return Ok(());
        }
        Err(Error::new(ErrorKind::Usage, format!("a {model} cannot be displaced so far"))
            .at("displacement")
            .value(self.displacement)
            .remedy(format!("use a number from 0 to {most}")))
    }
}
