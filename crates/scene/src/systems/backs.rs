//! Surfaces that the camera sees from behind only: lights do not reach them there, which looks like
//! an error.

use super::camera::frames_of;
use super::reach::{Extent, Faces, is_faced};
use wavecrest_base::error::{Error, ErrorKind};
use wavecrest_core::math::random::Stream;
use wavecrest_core::prepared::PreparedScene;

/// Largest number of test rays along each side of the image.
const RAYS: u32 = 64;

/// The warning about them.
pub(super) fn warning(scene: &PreparedScene) -> Option<Error> {
    let appearance = &scene.appearance;
    let found = seen(scene, &from_behind(scene));
    let &first = found.first()?;
    let back = appearance.names[first].as_ref();
    let back = back.map_or("its back".to_owned(), |name| format!("the back of {name:?}"));
    let others = match found.len() - 1 {
        0 => String::new(),
        1 => " and that of 1 other shape".to_owned(),
        n => format!(" and those of {n} other shapes"),
    };
    let message = format!("the camera sees only {back}{others}, which no light reaches");
    let remedy = "set \"sides\" to \"both\", or turn a plane or a triangle with \"normal\": -1";
    Some(Error::new(ErrorKind::Scene, message).at(&appearance.places[first]).remedy(remedy))
}

/// For each shape, whether the cameras that see it are behind all of it in every frame, and whether
/// it would look different from the front.
fn from_behind(scene: &PreparedScene) -> Vec<bool> {
    let cameras = frames_of(&scene.camera, scene.path.as_ref());
    let pupils: Vec<Extent> = cameras.iter().map(Extent::of_pupil).collect();
    let geometry = scene.accel.geometry();
    let mut tests = 0;
    let shapes = scene.appearance.shapes.iter().zip(&scene.appearance.materials);
    shapes
        .map(|(shape, material)| {
            let shows_light = material.kd > 0.0 || material.ks > 0.0 || material.kr > 0.0;
            let is_candidate = shape.light.is_none() && shows_light && !pupils.is_empty();
            let faces = |pupil| is_faced(shape, Faces::lit(shape), pupil, geometry, &mut tests);
            is_candidate && !pupils.iter().any(faces)
        })
        .collect()
}

/// Those of the shapes that some camera rays hit first.
fn seen(scene: &PreparedScene, those: &[bool]) -> Vec<usize> {
    if !those.contains(&true) {
        return Vec::new();
    }
    let mut met = vec![false; those.len()];
    let mut traversal = scene.accel.traversal();
    let [width, height] = scene.camera.size();
    for y in places(height) {
        for x in places(width) {
            let stream = Stream { seed: 0, pixel: y * width + x, sample: 0, bounce: 0 };
            let hit = scene.accel.closest(&scene.camera.ray(x, y, &stream), &mut traversal);
            if !hit.is_miss() {
                met[scene.appearance.shape_of(hit.primitive)] = true;
            }
        }
    }
    (0..those.len()).filter(|&shape| those[shape] && met[shape]).collect()
}

/// Evenly spaced pixels along a side.
pub(super) fn places(side: u32) -> impl DoubleEndedIterator<Item = u32> + ExactSizeIterator {
    let count = side.min(RAYS);
    (0..count)
        .map(move |i| ((u64::from(i) * 2 + 1) * u64::from(side) / u64::from(count * 2)) as u32)
}
