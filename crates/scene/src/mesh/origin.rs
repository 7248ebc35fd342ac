//! The origin of a mesh whose file has coordinates in double precision, far from zero: map
//! coordinates of a scan, for example. Single precision has 24 bits for a coordinate; beyond
//! [`FAR`], positions relative to a point of the mesh keep the bits that it needs.

use glam::{DVec3, Vec3};

use wavecrest_core::math::float::MAX_COORDINATE;

/// The coordinate beyond which single precision has steps above a ten-thousandth.
const FAR: f64 = 1024.0;

/// The origin of a mesh with this `first` vertex, in its own space: near the vertex if that is far
/// from zero, and otherwise zero. A whole number, so that positions with few digits stay exact.
pub fn origin(first: DVec3) -> DVec3 {
    let is_far = (FAR..f64::from(MAX_COORDINATE)).contains(&first.abs().max_element());
    if first.is_finite() && is_far { first.round() } else { DVec3::ZERO }
}

/// The position of a `point` relative to the `origin`.
pub fn relative(point: DVec3, origin: DVec3) -> Vec3 {
    (point - origin).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_far_vertices_move_the_origin() {
        assert_eq!(origin(DVec3::new(-1000.5, 3.0, 0.0)), DVec3::ZERO);
        assert_eq!(origin(DVec3::new(1.2, -2000.7, 0.0)), DVec3::new(1.0, -2001.0, 0.0));
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(origin(DVec3::new(bad, 5000.0, 0.0)), DVec3::ZERO);
        }
        let point = DVec3::new(450_000.125, 5_200_000.375, 12.5);
        assert_eq!(relative(point, origin(point)), Vec3::new(0.125, 0.375, -0.5));
    }
}
