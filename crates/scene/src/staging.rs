//! Completes files that are not whole scenes: adds a camera that sees everything, lights, and
//! settings.
//!
//! A standalone mesh has none of these, a glTF file may have some. The choices are reported, and
//! `wavecrest convert` writes them to a scene file, in which they can be changed.

mod camera;
mod fit;
mod follow;
mod grid;
mod ground;
mod light;
mod pose;
mod room;
mod strays;
mod upward;

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DAffine3, DVec3, Vec3};

use crate::components::{CutOut, Maps, Material, View};
use crate::mesh::MeshData;
use crate::mtl::GREY;
use crate::systems::bounds::{self, EMPTY, Ends, around, joined, wide};
use crate::systems::cutouts::{Masks, left};
use wavecrest_base::parallel;

pub(crate) use camera::{Framed, framed, view};
pub use follow::LightFrame;
pub(crate) use follow::Staged;
use grid::Grid;
pub(crate) use light::{MOST_LAMPS, allow_for_surfaces, light, settings, surround};
pub(crate) use upward::Upward;

/// The material of meshes without one: a light grey with a faint highlight.
pub(crate) const MATERIAL: Material = Material {
    ks: 0.15,
    kd: 0.85,
    specular_exponent: 40.0,
    diffuse_color: DVec3::splat(GREY),
    ..Material::MATTE
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoundingSphere {
    pub(crate) center: DVec3,
    /// Above 0.
    pub(crate) radius: f64,
}

/// Largest number of points to check for one mesh, in all its places.
const MOST_POINTS: usize = 1 << 24;

/// Half of the lowest alpha above 0, of 255 levels.
const LEAST_ALPHA: f64 = 0.5 / 255.0;

/// The parts of a mesh that are not cut away.
pub(crate) struct VisibleMesh<'a> {
    points: Cow<'a, [Vec3]>,
    triangles: Cow<'a, [[u32; 3]]>,
}

impl<'a> VisibleMesh<'a> {
    fn new(mesh: &'a MeshData, cutout: Option<&CutOut>, images: &mut Masks<'_>) -> Self {
        let left = cutout.and_then(|cutout| left(mesh, cutout, images));
        let is_gone = left.as_ref().is_some_and(Vec::is_empty);
        Self {
            points: if is_gone { &[][..] } else { &mesh.positions }.into(),
            triangles: left.map_or(Cow::Borrowed(&mesh.triangles), Cow::Owned),
        }
    }

    /// What is visible of a mesh with these holes and maps; of one that is shown so often that checking every point would
    /// take too long, its box.
    pub(crate) fn of_uses(
        mesh: &'a MeshData,
        (cutout, maps): (Option<&CutOut>, &Maps),
        uses: usize,
        images: &mut Masks<'_>,
    ) -> Self {
        if uses > 1 && (3 * mesh.triangles.len()).saturating_mul(uses) > MOST_POINTS {
            return Self::boxed(mesh);
        }
        let fading = maps.opacity.as_ref().and_then(|map| {
            let look_up = map.texture.as_ref()?.look_up.clone();
            Some(CutOut { look_up: Some(look_up), is_mask: false, threshold: LEAST_ALPHA })
        });
        Self::new(mesh, cutout.or(fading.as_ref()), images)
    }

    /// The corners of the box around a mesh, which has some points.
    fn boxed(mesh: &MeshData) -> Self {
        let corners = bounds::corners(wide(around(&mesh.positions)));
        let points: Vec<Vec3> = corners.iter().map(|corner| corner.as_vec3()).collect();
        Self { points: points.into(), triangles: (&[]).into() }
    }

    /// An instance with each of these transforms.
    pub(crate) fn instances(
        &self,
        transforms: impl IntoIterator<Item = &'a DAffine3>,
    ) -> impl Iterator<Item = MeshInstance<'_>> {
        let own = MeshInstance::new(&self.points, &self.triangles, DAffine3::IDENTITY);
        transforms.into_iter().map(move |world| MeshInstance { world: *world, ..own.clone() })
    }
}

/// Visible geometry and its transform.
#[derive(Clone, Debug)]
pub(crate) struct MeshInstance<'a> {
    pub(crate) points: &'a [Vec3],
    pub(crate) triangles: &'a [[u32; 3]],
    pub(crate) world: DAffine3,
    /// Whether each point is visible, unless all are: those that no triangle with an area uses are
    /// not, nor those of stray parts. Without triangles all count.
    seen: Option<Arc<Vec<AtomicBool>>>,
}

impl<'a> MeshInstance<'a> {
    pub(crate) fn new(points: &'a [Vec3], triangles: &'a [[u32; 3]], world: DAffine3) -> Self {
        Self { points, triangles, world, seen: shown(points, triangles, |_| true) }
    }

    /// A point in the file.
    fn point(&self, i: usize) -> DVec3 {
        self.world.transform_point3(self.points[i].as_dvec3())
    }

    /// The corners of a triangle in the file.
    fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|i| self.point(i as usize))
    }
}

/// An instance, and the first of some of its points.
type Block<'a> = (&'a MeshInstance<'a>, usize);

/// The visible ones of every so many points of a block, in the file.
fn visible((instance, first): Block<'_>, step: usize) -> impl Iterator<Item = DVec3> {
    let seen = instance.seen.as_ref();
    let is_seen = move |i: &usize| seen.is_none_or(|seen| seen[*i].load(Ordering::Relaxed));
    let numbers = first..instance.points.len().min(first + BLOCK);
    numbers.step_by(step).filter(is_seen).map(|i| instance.point(i))
}

/// Points or triangles that a thread takes at once.
const BLOCK: usize = 1 << 10;
/// One of so many points is enough to tell about where the outermost are.
const SAMPLED: usize = 1 << 8;
/// Width that is added to boxes, as a share of the largest coordinate: far above the rounding errors of
/// what is computed for their corners.
const MARGIN: f64 = 1e-6;

/// Which of the `points` are corners of a triangle with an area that `is` holds for; `None` if all are,
/// or there are no triangles.
fn shown(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    is: impl Fn([u32; 3]) -> bool + Sync,
) -> Option<Arc<Vec<AtomicBool>>> {
    let seen: Vec<AtomicBool> = points.iter().map(|_| AtomicBool::new(false)).collect();
    let add = |triangle: &[u32; 3]| {
        // Reads are cheaper, and most triangles have no corner that is the first at its point.
        let corners = triangle.map(|i| i as usize);
        if corners.iter().all(|&i| seen[i].load(Ordering::Relaxed)) {
            return;
        }
        let [a, b, c] = corners.map(|i| points[i].as_dvec3());
        if (b - a).cross(c - a) != DVec3::ZERO && is(*triangle) {
            corners.into_iter().for_each(|i| seen[i].store(true, Ordering::Relaxed));
        }
    };
    parallel::each(triangles.chunks(BLOCK), |triangles| triangles.iter().for_each(add));
    let is_every_one = || seen.iter().all(|one| one.load(Ordering::Relaxed));
    (!triangles.is_empty() && !is_every_one()).then(|| Arc::new(seen))
}

/// Everything visible in a file.
pub(crate) struct Scenery<'a> {
    pub(crate) all: Vec<MeshInstance<'a>>,
    /// The ends of the boxes around the visible points of each block.
    boxes: Vec<Ends>,
    /// The ends of the box around all points; infinite without points.
    ends: Ends,
    /// The sphere around the centre of that box; without points of radius 1 around the origin.
    pub(crate) sphere: BoundingSphere,
    /// The number of triangles of stray parts, which are not in the box.
    strays: usize,
}

impl<'a> Scenery<'a> {
    pub(crate) fn new(all: Vec<MeshInstance<'a>>) -> Self {
        let sphere = BoundingSphere { center: DVec3::ZERO, radius: 1.0 };
        let mut contents = Self { all, boxes: vec![], ends: EMPTY, sphere, strays: 0 };
        contents.measure();
        contents.strays = strays::hide(&mut contents);
        if contents.strays > 0 {
            contents.measure();
        }
        contents
    }

    /// Finds the box and the sphere.
    fn measure(&mut self) {
        let add = |ends, point| joined(ends, [point; 2]);
        self.boxes = parallel::map(self.blocks(), |block| visible(block, 1).fold(EMPTY, add));
        let [low, high] = self.boxes.iter().copied().fold(EMPTY, joined);
        if !(high - low).is_finite() {
            return;
        }
        self.ends = [low, high];
        let center = (low + high) / 2.0;
        let radius = self.outermost(0.0, |point| point.distance(center), f64::max);
        // A single point has no extent; it is seen from one unit away.
        self.sphere = BoundingSphere { center, radius: if radius > 0.0 { radius } else { 1.0 } };
    }

    /// Points all over an image, with normals of any length; none if it takes too long.
    pub(crate) fn seen(&self, view: &View) -> Vec<[DVec3; 2]> {
        Grid::seen(self, view).unwrap_or_default()
    }

    /// Reduces the results of `of` for each visible point by `merge`, in any order. `of` is nowhere in a
    /// box greater than at one of its corners: most blocks are far inside, where no corner changes anything.
    fn outermost<T: Copy + Send + Sync + PartialEq>(
        &self,
        none: T,
        of: impl Fn(DVec3) -> T + Sync,
        merge: impl Fn(T, T) -> T + Sync,
    ) -> T {
        let add = |own: T, point| merge(own, of(point));
        let some = self.blocks().flat_map(|block| visible(block, SAMPLED)).fold(none, add);
        let margin = MARGIN * self.ends[0].abs().max(self.ends[1].abs()).max_element();
        let look = |own: &mut T, (block, [low, high]): (Block<'_>, &Ends)| {
            let corners = bounds::corners([low - margin, high + margin]);
            if corners.into_iter().any(|corner| add(*own, corner) != *own) {
                *own = visible(block, 1).fold(*own, add);
            }
        };
        let found = parallel::with_state(self.blocks().zip(&self.boxes), || some, look);
        found.into_iter().fold(some, merge)
    }

    /// The blocks of points, in the order of the boxes around them.
    fn blocks(&self) -> impl Iterator<Item = Block<'_>> {
        self.all.iter().flat_map(|instance| {
            (0..instance.points.len()).step_by(BLOCK).map(move |first| (instance, first))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of a box's sides, low and high x, y, z, counter-clockwise from outside.
    pub(super) const QUADS: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

    /// A mesh in a test.
    pub(super) type Solid = (Vec<Vec3>, Vec<[u32; 3]>);

    /// The sides of boxes from a low to a high corner.
    pub(super) fn boxes(all: &[([f32; 3], [f32; 3])]) -> Solid {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for (first, (low, high)) in (0..).step_by(8).zip(all) {
            let ends = [*low, *high].map(|end| Vec3::from_array(end).as_dvec3());
            points.extend(bounds::corners(ends).map(|corner| corner.as_vec3()));
            let sides = QUADS.map(|quad| quad.map(|i| i + first));
            triangles.extend(sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]));
        }
        (points, triangles)
    }

    /// What such a mesh is staged as.
    pub(super) fn contents((points, triangles): &Solid) -> Scenery<'_> {
        Scenery::new(vec![MeshInstance::new(points, triangles, DAffine3::IDENTITY)])
    }

    #[test]
    fn the_sphere_is_about_all_points_where_they_are() {
        let points = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y, Vec3::Z];
        let instance = |world| MeshInstance::new(&points, &[], world);
        let moved = instance(DAffine3::from_translation(DVec3::X * 10.0));
        let sphere = Scenery::new(vec![instance(DAffine3::IDENTITY), moved]).sphere;
        assert_eq!(sphere.center, DVec3::new(6.0, 0.5, 0.5));
        assert!((sphere.radius - 36.5_f64.sqrt()).abs() < 1e-12, "{}", sphere.radius);
        assert_eq!(
            Scenery::new(vec![]).sphere,
            BoundingSphere { center: DVec3::ZERO, radius: 1.0 }
        );
        // A point that no triangle uses is invisible.
        let seen = MeshInstance::new(&points, &[[0, 2, 3]], DAffine3::IDENTITY);
        assert_eq!(Scenery::new(vec![seen]).sphere.center, DVec3::new(0.0, 0.5, 0.5));
    }
}
