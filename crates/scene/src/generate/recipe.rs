//! The recipe of a generated mesh.

use super::surface::Surface;
use super::{knot, sphere, terrain};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// Largest number of triangles: the range of signed indices in a PLY file. Every model has fewer
/// vertices.
pub const MOST_TRIANGLES: u64 = (1 << 31) - 1;

wavecrest_base::choices! {
    /// The subject of the mesh.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Model {
        /// A sphere of radius about 1, displaced by fractal noise: closed.
        Sphere = "sphere",
        /// A ridged height field over [-1, 1] in x and z, y up: open.
        Terrain = "terrain",
        /// A finely displaced tube along a torus knot: closed, without self-intersections.
        Knot = "knot",
    }
}

impl Model {
    /// The default displacement, and the largest: beyond it the surface would tear or intersect
    /// itself.
    fn displacements(self) -> [f64; 2] {
        match self {
            Self::Sphere => [0.25, 0.9],
            Self::Terrain => [0.4, 10.0],
            Self::Knot => [0.3, knot::MOST_DISPLACEMENT],
        }
    }

    /// The number of triangles with one step of the grid (`n` steps have `n * n` times as many),
    /// and the smallest number of steps that still resembles the model.
    pub(super) fn grid(self) -> (u64, u64) {
        match self {
            Self::Sphere => (12, 2),
            Self::Terrain => (2, 4),
            Self::Knot => (2 * knot::RINGS_PER_SIDE, 8),
        }
    }

    /// The smallest number of triangles that may be requested.
    pub fn fewest_triangles(self) -> u64 {
        let (one, steps) = self.grid();
        one * steps.pow(2)
    }

    /// The largest number of triangles that may be requested: that of the finest grid within
    /// [`MOST_TRIANGLES`].
    pub fn most_triangles(self) -> u64 {
        let (one, _) = self.grid();
        one * (MOST_TRIANGLES / one).isqrt().pow(2)
    }
}

/// Everything that a mesh depends on.
///
/// ```
/// use wavecrest_scene::generate::{Model, Recipe, mesh};
/// let mesh = mesh(&Recipe::new(Model::Sphere, 1000))?;
/// assert_eq!(mesh.triangles.len(), 1200); // 12 x 10 x 10, the next that the grid allows
/// # Ok::<(), wavecrest_base::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// The subject of the mesh.
    pub model: Model,
    /// The requested number of triangles. The mesh has the next number that its grid allows.
    pub triangles: u64,
    /// Seed of the noise.
    pub seed: u64,
    /// The displacement of the surface: for the sphere and the knot as a share of their radius (for
    /// the knot, of the tube), in both directions; for the terrain the height of the highest
    /// crests.
    pub displacement: f64,
    /// Whether vertices have normals.
    pub normals: bool,
}

impl Recipe {
    /// The default mesh of `model` with at least this number of triangles: seed 1, no normals.
    pub fn new(model: Model, triangles: u64) -> Self {
        let [displacement, _] = model.displacements();
        Self { model, triangles, seed: 1, displacement, normals: false }
    }

    /// The triangles of the grid, at most [`MOST_TRIANGLES`].
    pub(super) fn grid_triangles(&self) -> u64 {
        self.model.grid().0 * self.steps().pow(2)
    }

    /// The surface of the recipe, which is checked.
    pub(super) fn surface(&self) -> Result<Box<dyn Surface>> {
        self.check_triangles()?;
        self.check_displacement()?;
        let Self { seed, displacement, .. } = *self;
        let steps = self.steps();
        Ok(match self.model {
            Model::Sphere => Box::new(sphere::SphereGrid::new(steps, displacement, seed)),
            Model::Terrain => Box::new(terrain::Terrain::new(steps, displacement, seed)),
            Model::Knot => Box::new(knot::Knot::new(steps, displacement, seed)),
        })
    }

    /// The steps of the coarsest grid with at least the requested triangles.
    fn steps(&self) -> u64 {
        let (one, _) = self.model.grid();
        // Of at least one square.
        (self.triangles.div_ceil(one) - 1).isqrt() + 1
    }

    fn check_triangles(&self) -> Result<()> {
        let (model, fewest) = (self.model, self.model.fewest_triangles());
        let most = model.most_triangles();
        if (fewest..=most).contains(&self.triangles) {
            return Ok(());
        }
        let (kind, what) = if self.triangles < fewest {
            (ErrorKind::Usage, "needs more triangles")
        } else {
            (ErrorKind::Limit, "cannot have so many triangles")
        };
        Err(Error::new(kind, format!("a {model} {what}"))
            .at("triangles")
            .value(self.triangles)
            .remedy(format!("use {fewest} to {most}")))
    }

    fn check_displacement(&self) -> Result<()> {
        let (model, [_, most]) = (self.model, self.model.displacements());
        if (0.0..=most).contains(&self.displacement) {
            return Ok(());
        }
        Err(Error::new(ErrorKind::Usage, format!("a {model} cannot be displaced so far"))
            .at("displacement")
            .value(self.displacement)
            .remedy(format!("use a number from 0 to {most}")))
    }
}
