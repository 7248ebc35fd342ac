//! The frame: where the origin lies of the coordinates that a render computes in.
//!
//! Single precision has 24 bits for a coordinate. Far from the origin few of them are left for what the
//! camera looks at, so that such scenes are moved to it (camera-relative coordinates: Pharr, Jakob and
//! Humphreys, *Physically Based Rendering*, 4th edition, section 5.1.1). They are moved by a multiple
//! of a power of two: where a vertex of single precision comes nearer by that, nothing is rounded.

use glam::DVec3;
use hecs::World;

use crate::query::view;
use wavecrest_base::error::Result;
use wavecrest_core::kernels::precision::Precision;

/// A camera this many times as far from the origin as from what it looks at has lost ten bits.
const FAR_CAMERA: f64 = 1024.0;

/// What is to be subtracted from all positions, in scene units: zero in most scenes.
pub fn run(world: &World, precision: Precision) -> Result<DVec3> {
    // Fast arithmetic takes coordinates as they are.
    if precision == Precision::Fast {
        return Ok(DVec3::ZERO);
    }
    let view = view(world)?;
    let distance = (view.look - view.location).abs().max_element();
    let far = view.location.abs().max_element() >= FAR_CAMERA * distance;
    Ok(if far { nearest(view.location, distance) } else { DVec3::ZERO })
}

/// The multiple of the next greater power of two that is nearest to `place`.
pub(super) fn nearest(place: DVec3, distance: f64) -> DVec3 {
    let (_, exponent) = libm::frexp(distance);
    let step = libm::ldexp(1.0, exponent);
    (place / step).round() * step
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
