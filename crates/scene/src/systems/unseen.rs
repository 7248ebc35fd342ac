//! A camera that sees nothing: the image is empty, which is rarely meant.

use glam::Vec3;

use super::backs::test_rays;
use wavecrest_base::error::{Error, ErrorKind};
use wavecrest_core::prepared::PreparedScene;

/// One in this many triangles may be an outlier.
const MOST_OUTLIERS: usize = 20;
/// Distance of outliers from the middle, in distances that all but these reach.
const FAR: f32 = 10.0;

/// The warning that none of its test rays meets the scene, whose ground does not count. A camera
/// that moves may see something in another frame.
pub(super) fn warning(scene: &PreparedScene) -> Option<Error> {
    if scene.path.is_some() || sees_some(scene) {
        return None;
    }
    let (message, remedy) = match outliers(scene) {
        0 => (
            "the image looks empty: the camera sees nothing of the scene".to_owned(),
            "turn the camera; --view front replaces that of a glTF file",
        ),
        n => (
            format!("the image looks empty: triangles far from the rest make it small, found {n}"),
            "remove them from the file",
        ),
    };
    Some(Error::new(ErrorKind::Scene, message).remedy(remedy))
}

/// Whether a test ray meets anything but the ground, or there is nothing else.
fn sees_some(scene: &PreparedScene) -> bool {
    let is_own = |shape: usize| Some(shape) != scene.appearance.ground;
    !(0..scene.appearance.shapes.len()).any(is_own) || test_rays(scene).any(is_own)
}

/// The number of triangles much farther from the middle than nearly all.
fn outliers(scene: &PreparedScene) -> usize {
    let geometry = scene.accel.geometry();
    let corner = |triangle: &[u32; 3]| geometry.positions[triangle[0] as usize];
    let shapes = scene.appearance.shapes.iter().enumerate();
    let mut corners: Vec<Vec3> = shapes
        .filter(|(number, _)| Some(*number) != scene.appearance.ground)
        .flat_map(|(_, shape)| shape.primitives.clone())
        .filter_map(|number| geometry.triangles.get(number as usize))
        .map(corner)
        .collect();
    if corners.is_empty() {
        return 0;
    }
    let half = corners.len() / 2;
    let mut median = Vec3::ZERO;
    for axis in 0..3 {
        let middle = corners.select_nth_unstable_by(half, |a, b| a[axis].total_cmp(&b[axis])).1;
        median[axis] = middle[axis];
    }
    let mut distances: Vec<f32> = corners.iter().map(|point| point.distance(median)).collect();
    let nearly_all = distances.len() - 1 - distances.len().div_ceil(MOST_OUTLIERS).min(half);
    let reach = *distances.select_nth_unstable_by(nearly_all, f32::total_cmp).1;
    distances.iter().filter(|&&distance| distance > FAR * reach).count()
}
