//! Surfaces that the camera sees from behind only: lights do not reach them there, which looks like
//! an error.

use super::camera::frames_of;
use super::reach::{Extent, is_faced};
use super::visibility::Faces;
use wavecrest_base::error::{Error, ErrorKind};
use wavecrest_core::math::random::Stream;
use wavecrest_core::prepared::{Class, PreparedScene};

/// Largest number of test rays along each side of the image.
const RAYS: u32 = 64;

/// The warning about them.
pub(super) fn warning(scene: &PreparedScene) -> Option<Error> {
    let appearance = &scene.appearance;
    let found = seen_from_behind(scene);
    let &first = found.first()?;
    let back = appearance.names[first].as_ref();
    let back = back.map_or("its back".to_owned(), |name| format!("the back of {name:?}"));
    let others = match found.len() - 1 {
        0 => String::new(),
        1 => " and that of 1 other shape".to_owned(),
        n => format!(" and those of {n} other shapes"),
    };
    let message = format!("the camera sees only {back}{others}, which no light reaches");
    let place = &appearance.paths[first];
    // Otherwise it is one of a glTF file's nodes: both sides of a mesh by itself are lit.
    let remedy = match place.starts_with("scene.") {
        true => "set \"sides\" to \"both\", or turn a plane or a triangle with \"normal\": -1",
        false => "set \"doubleSided\" of its material to true, or flip its faces",
    };
    Some(Error::new(ErrorKind::Scene, message).at(place).remedy(remedy))
}

/// The shapes that some camera rays hit first and that all cameras that see them are behind, in every frame, if
/// they would look different from the front.
fn seen_from_behind(scene: &PreparedScene) -> Vec<usize> {
    let cameras = frames_of(&scene.camera, scene.path.as_ref());
    let pupils: Vec<Extent> = cameras.iter().map(Extent::of_pupil).collect();
    let geometry = scene.accel.geometry();
    let shapes = &scene.appearance.shapes;
    let mut tests = 0;
    let mut is_candidate = |&shape: &usize| {
        let shape = &shapes[shape];
        let Class { material, .. } = scene.appearance.class(shape);
        let shows_light = material.kd > 0.0 || material.ks > 0.0 || material.kr > 0.0;
        let faces = |pupil| is_faced(shape, Faces::lit(shape), pupil, geometry, &mut tests);
        shape.light.is_none() && shows_light && !pupils.is_empty() && !pupils.iter().any(faces)
    };
    let candidates: Vec<usize> = (0..shapes.len()).filter(&mut is_candidate).collect();
    if candidates.is_empty() {
        return candidates;
    }
    let mut met = vec![false; shapes.len()];
    test_rays(scene).for_each(|shape| met[shape] = true);
    candidates.into_iter().filter(|&shape| met[shape]).collect()
}

/// The shapes that test rays hit first. The rays start in the middle of the image, where the first
/// one mostly hits something.
pub(super) fn test_rays(scene: &PreparedScene) -> impl Iterator<Item = usize> {
    let mut traversal = scene.accel.traversal();
    let [width, height] = scene.camera.size();
    let pixels = middle_first(height).flat_map(move |y| middle_first(width).map(move |x| (x, y)));
    pixels.filter_map(move |(x, y)| {
        let stream = Stream { seed: 0, pixel: y * width + x, sample: 0, bounce: 0 };
        let hit = scene.accel.closest(&scene.camera.ray(x, y, &stream), &mut traversal);
        (!hit.is_miss()).then(|| scene.appearance.shape_of(hit.primitive))
    })
}

/// Evenly spaced pixels along a side, from the middle to the end, then from there to the start.
fn middle_first(side: u32) -> impl Iterator<Item = u32> {
    let count = side.min(RAYS);
    let pixel = move |i| ((u64::from(i) * 2 + 1) * u64::from(side) / u64::from(count * 2)) as u32;
    (count / 2..count).chain((0..count / 2).rev()).map(pixel)
}
