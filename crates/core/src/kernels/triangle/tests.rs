//! Hits and areas are tried against exact arithmetic: `tests/properties/triangle.rs`.

use glam::{DVec3, Vec3};

use super::*;
use crate::math::Ray;

#[test]
fn barycentric_coordinates_name_the_point() {
    let triangle = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 2.5, 2.0), Vec3::new(2.0, 5.0, 3.5)];
    let point = triangle[0] * 0.5 + triangle[1] * 0.25 + triangle[2] * 0.25;
    let ray = Ray::new(Vec3::new(0.0, 0.0, -9.0), point - Vec3::new(0.0, 0.0, -9.0));
    let b = exact::barycentric(&ray, &triangle).expect("it is not parallel");
    assert!((b - DVec3::new(0.5, 0.25, 0.25)).abs().max_element() < 1e-6, "{b}");
}
