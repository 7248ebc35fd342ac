//! What transforms do to points.

use glam::{DAffine3, DVec3, dvec3};
use serde_json::json;

use super::{accepted, at};
use crate::components::Transform;

fn transform(value: serde_json::Value) -> DAffine3 {
    let scene = accepted("scene.shapes[1].transform", value);
    at::<Transform>(&scene, "scene.shapes[1]").unwrap().0
}

#[test]
fn transforms() {
    assert_eq!(transform(json!({})), DAffine3::IDENTITY);
    let matrix = transform(json!([[1, 2, 0, 10], [0, 1, 0, 20], [0, 0, 3, 30], [0, 0, 0, 1]]));
    assert_eq!(matrix.transform_point3(DVec3::ONE), dvec3(13.0, 21.0, 33.0));
    // Scale, then rotate, then translate; quarters of a turn are exact.
    let all = transform(json!({"translate": [10, 0, 0], "rotate": [0, 90, 0], "scale": [2, 1, 1]}));
    assert_eq!(all.transform_point3(DVec3::X), dvec3(10.0, 0.0, -2.0));
    // About x first: y goes to z, which about z then stays.
    let turned = transform(json!({"rotate": [90, 0, 90]}));
    assert_eq!(turned.transform_point3(DVec3::Y), DVec3::Z);
    assert_eq!(turned.transform_point3(DVec3::X), DVec3::Y);
    let about_x_and_y = transform(json!({"rotate": [90, 90, 0]}));
    assert_eq!(about_x_and_y.transform_point3(DVec3::Y), DVec3::X);
    assert_eq!(transform(json!({"scale": -2})).matrix3.determinant(), -8.0);
    for (degrees, sine) in [(-30.0, -0.5), (30.0, 0.5), (150.0, 0.5), (210.0, -0.5), (750.0, 0.5)] {
        let turned = transform(json!({"rotate": [0, 0, degrees]}));
        assert!((turned.transform_point3(DVec3::X).y - sine).abs() < 1e-15, "{degrees}");
    }
}
