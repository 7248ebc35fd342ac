//! From which side shapes are visible, in any frame of the camera, directly or in mirrors.
//!
//! A shape is out of view if no camera ray can meet it ([`super::met`]) and no mirror in view could show
//! it. In doubt a shape is in view, from both sides.

use hecs::World;

use super::frame::Frame;
use super::reach::{Extent, is_faced};
use super::visibility::{Faces, MaterialBound, Visibility};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::prepared::Shape;

/// Number of primitives of small shapes. Large ones that both sides are lit of mostly show both.
const FEW: usize = 64;

/// Finds out what cameras see of each shape: all of every shape, if one in view shows others.
pub(crate) fn run(world: &World, frame: &Frame, geometry: &Geometry) {
    let mut shapes = world.query::<(&Shape, &MaterialBound, &mut Visibility)>();
    let pupils: Vec<Extent> = frame.cameras.iter().map(Extent::of_pupil).collect();
    let mut tests = 0;
    let mut shows_others =
        |(shape, bound, visibility): (&Shape, &MaterialBound, &mut Visibility)| {
            let is_seen = visibility.is_seen && !shape.primitives.is_empty();
            visibility.faces = is_seen.then(|| visible_faces(shape, &pupils, geometry, &mut tests));
            let mirrors =
                |faces: Faces| faces.any() && frame.settings.bounces > 0 && bound.0.kr > 0.0;
            visibility.faces.is_some_and(|faces| visibility.is_transparent || mirrors(faces))
        };
    if frame.cameras.is_empty() || shapes.iter().any(&mut shows_others) {
        for (shape, _, visibility) in shapes.iter() {
            visibility.faces = Some(Faces::lit(shape));
        }
    }
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
