//! Which shapes are visible in any frame of the camera, directly or in mirrors, and from which
//! side.
//!
//! A shape is out of view if no camera ray can meet it and no mirror in view could show it: it is
//! outside the frustum of every frame, or a sphere lies around it or around the camera. Its box
//! counts, with all rounding errors. In doubt a shape is in view, from both sides.

use glam::Vec3;
use rayon::prelude::*;

use super::bounds::around;
use super::geometry::{Output, ShapeOutput};
use super::reach::{Extent, Faces, is_faced};
use wavecrest_core::geometry::{Geometry, Primitive, Quadric};
use wavecrest_core::kernels::camera::Camera;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::prepared::Shape;

/// Largest number of box tests, against cameras and spheres. Beyond them, shapes count as in view.
const MOST_TESTS: usize = 1 << 22;

/// Number of a shape's primitives that are tested before its box: they decide for most shapes.
const FIRST: usize = 64;

/// For each shape in view of `cameras` its visible sides that lights can reach; `None` for others.
/// There is a camera for each frame, or none if there are too many. A shape
/// `shows_others` if these sides mirror them, or let them through.
pub(crate) fn run(
    cameras: &[Camera],
    output: &Output,
    shows_others: impl Fn(usize, Faces) -> bool,
) -> Vec<Option<Faces>> {
    let Output { geometry, shapes, .. } = output;
    let all = || shapes.iter().map(|output| Some(Faces::lit(&output.shape))).collect();
    let tests = shapes.len().saturating_mul(cameras.len() + geometry.quadrics.len());
    // Fast precision has no error bounds, so nothing is certain.
    if cameras.is_empty() || tests > MOST_TESTS || geometry.precision == Precision::Fast {
        return all();
    }
    let pupils: Vec<Extent> = cameras.iter().map(Extent::of_pupil).collect();
    let walls = Walls::of(&pupils, geometry);
    let sees = |bounds: &Aabb, widening| {
        cameras.iter().any(|camera| camera.may_see(bounds, widening)) && !walls.hide(bounds)
    };
    let prototypes: Vec<Aabb> =
        geometry.prototypes.iter().map(|prototype| around(&prototype.positions)).collect();
    let mut tests = 0;
    let mut of = |output: &ShapeOutput| {
        let is_seen = is_in_view(&output.shape, geometry, &prototypes, sees);
        is_seen.then(|| visible_faces(&output.shape, &pupils, geometry, &mut tests))
    };
    let in_view: Vec<Option<Faces>> = shapes.iter().map(&mut of).collect();
    let shows = |shape: usize| in_view[shape].is_some_and(|faces| shows_others(shape, faces));
    if (0..shapes.len()).any(shows) { all() } else { in_view }
}

/// The sides of the shape that lights can reach and that face a pupil.
fn visible_faces(shape: &Shape, pupils: &[Extent], geometry: &Geometry, tests: &mut u64) -> Faces {
    let lit = Faces::lit(shape);
    // Large meshes that both sides are lit of mostly show both.
    if shape.two_sided && shape.primitives.len() > FIRST {
        return lit;
    }
    let mut sees =
        |faces| pupils.iter().any(|pupil| is_faced(shape, faces, pupil, geometry, tests));
    Faces { front: sees(Faces::FRONT), back: lit.back && sees(Faces::BACK) }
}

/// Whether any part of the shape is visible; `sees` tests a box.
fn is_in_view(
    shape: &Shape,
    geometry: &Geometry,
    prototypes: &[Aabb],
    sees: impl Fn(&Aabb, f32) -> bool,
) -> bool {
    let mut first = shape.primitives.clone().take(FIRST);
    if let Some(Primitive::Instanced(instanced)) =
        first.clone().next().map(|number| geometry.primitive(number))
    {
        let (instance, _) = geometry.instance(instanced);
        let bounds = instance.bounds(&[prototypes[instance.prototype()]]);
        return sees(&bounds, instance.widening());
    }
    let bounds = |number| geometry.bounds(number);
    first.any(|number| sees(&bounds(number), 1.0))
        || shape.primitives.len() > FIRST && {
            let primitives = shape.primitives.clone().into_par_iter();
            sees(&primitives.map(bounds).reduce(|| Aabb::EMPTY, Aabb::union), 1.0)
        }
}

/// Spheres, by centre and radius, that no ray of any camera passes.
struct Walls {
    /// With all cameras outside.
    outside: Vec<(Vec3, f32)>,
    /// With all cameras inside.
    within: Vec<(Vec3, f32)>,
}

impl Walls {
    fn of(pupils: &[Extent], geometry: &Geometry) -> Self {
        let those = |are: fn(&Extent, Vec3, f32) -> bool| {
            let all = |&(center, radius): &(Vec3, f32)| {
                pupils.iter().all(|pupil| are(pupil, center, radius))
            };
            geometry.quadrics.iter().filter_map(Quadric::sphere).filter(all).collect()
        };
        Self { outside: those(Extent::is_beyond), within: those(Extent::is_within) }
    }

    fn hide(&self, bounds: &Aabb) -> bool {
        let extent = Extent::of_box(bounds);
        self.outside.iter().any(|&(center, radius)| extent.is_within(center, radius))
            || self.within.iter().any(|&(center, radius)| extent.is_beyond(center, radius))
    }
}
