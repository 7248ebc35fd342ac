//! From which side shapes are visible, in any frame of the camera, directly or in mirrors.
//!
//! A shape is out of view if no camera ray can meet it ([`super::met`]) and no mirror in view could show
//! it. In doubt a shape is in view, from both sides.

use super::geometry::{Output, ShapeOutput};
use super::reach::{Extent, Faces, is_faced};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::camera::Camera;
use wavecrest_core::prepared::Shape;

/// Number of primitives of small shapes. Large ones that both sides are lit of mostly show both.
const FEW: usize = 64;

/// For each shape in view of `cameras` its visible sides that lights can reach; `None` for others.
/// There is a camera for each frame, or none if nothing is certain. A shape `shows_others` if these sides
/// mirror them, or let them through.
pub(crate) fn run(
    cameras: &[Camera],
    output: &Output,
    shows_others: impl Fn(usize, Faces) -> bool,
) -> Vec<Option<Faces>> {
    let Output { geometry, shapes, .. } = output;
    let all = || shapes.iter().map(|output| Some(Faces::lit(&output.shape))).collect();
    if cameras.is_empty() {
        return all();
    }
    let pupils: Vec<Extent> = cameras.iter().map(Extent::of_pupil).collect();
    let mut tests = 0;
    let mut of = |output: &ShapeOutput| {
        let is_seen = output.is_seen && !output.shape.primitives.is_empty();
        is_seen.then(|| visible_faces(&output.shape, &pupils, geometry, &mut tests))
    };
    let in_view: Vec<Option<Faces>> = shapes.iter().map(&mut of).collect();
    let shows = |shape: usize| in_view[shape].is_some_and(|faces| shows_others(shape, faces));
    if (0..shapes.len()).any(shows) { all() } else { in_view }
}

/// The sides of the shape that lights can reach and that face a pupil.
pub(super) fn visible_faces(
    shape: &Shape,
    pupils: &[Extent],
    geometry: &Geometry,
    tests: &mut u64,
) -> Faces {
    let lit = Faces::lit(shape);
    if shape.two_sided && shape.primitives.len() > FEW {
        return lit;
    }
    let mut sees =
        |faces| pupils.iter().any(|pupil| is_faced(shape, faces, pupil, geometry, tests));
    Faces { front: sees(Faces::FRONT), back: lit.back && sees(Faces::BACK) }
}
