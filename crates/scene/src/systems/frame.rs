//! The frame: the origin of the coordinates of a render, and the positions of its camera.
//!
//! Single precision has 24 bits for a coordinate. Far from the origin few of them are left for the
//! visible part, so such scenes are moved to the camera (camera-relative coordinates: Pharr, Jakob
//! and Humphreys, *Physically Based Rendering*, 4th edition, section 5.1.1). The offset is a
//! multiple of a power of two: a single-precision vertex that moves closer to the origin is not
//! rounded.

use glam::DVec3;
use hecs::World;

use super::camera::{self, frames_of};
use super::textures::Images;
use super::{SceneOptions, brightness};
use crate::components::{FreeCamera, Settings, View};
use crate::query;
use wavecrest_base::error::Result;
use wavecrest_core::kernels::camera::Camera;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::kernels::shade::Visible;
use wavecrest_core::plan::schedule::Step;

/// A camera this many times as far from the origin as from its look-at point has lost ten bits.
const FAR_CAMERA: f64 = 1024.0;

/// What holds for the whole scene.
pub(crate) struct Frame {
    pub(crate) settings: Settings,
    pub(crate) precision: Precision,
    /// Everything is moved by `-origin`, in scene units: zero in most scenes.
    pub(crate) origin: DVec3,
    /// A camera for each frame, or none if nothing is certain.
    pub(crate) cameras: Vec<Camera>,
    /// Which rays can show anything.
    pub(crate) visible: Visible,
}

pub(super) fn run(world: &World, options: &SceneOptions, images: &mut Images) -> Result<Frame> {
    let &SceneOptions { precision, passes, exposure, .. } = options;
    let skips = passes.iter().any(|pass| pass.step == Step::Shadow && !pass.needs.is_empty());
    // Fast precision has no error bounds, so nothing is certain, and uses coordinates unchanged.
    let is_fast = precision == Precision::Fast;
    let settings = query::settings(world)?;
    let origin = if is_fast { DVec3::ZERO } else { origin(&query::view(world)?) };
    let (camera, path) = camera::run(world, origin, None)?;
    let is_free = world.query::<&FreeCamera>().iter().next().is_some();
    let is_certain = skips && !is_fast && !is_free;
    let cameras = if is_certain { frames_of(&camera, path.as_ref()) } else { Vec::new() };
    let visible = brightness::run(world, settings.background, exposure, images)?;
    Ok(Frame { settings, precision, origin, cameras, visible })
}

/// The offset to subtract from all positions, for this view.
pub fn origin(view: &View) -> DVec3 {
    let distance = (view.look - view.location).abs().max_element();
    let far = view.location.abs().max_element() >= FAR_CAMERA * distance;
    if far { nearest(view.location, distance) } else { DVec3::ZERO }
}

/// The multiple of the next greater power of two that is nearest to `point`.
pub(super) fn nearest(point: DVec3, distance: f64) -> DVec3 {
    let (_, exponent) = libm::frexp(distance);
    let step = libm::ldexp(1.0, exponent);
    (point / step).round() * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hc07_vertices_near_the_camera_are_moved_without_rounding() {
        let location = DVec3::new(131_072.3, -98_765.4, 40_000.7);
        let origin = nearest(location, 2.7);
        assert!((location - origin).abs().max_element() <= 2.0);
        for i in 0..1000 {
            let vertex = (location + DVec3::splat(f64::from(i) * 0.01)).as_vec3();
            let moved = vertex.as_dvec3() - origin;
            assert_eq!(moved.as_vec3().as_dvec3(), moved);
        }
    }
}
