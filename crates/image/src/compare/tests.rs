use super::*;
use crate::approved;
use crate::error_map::{MapKind, error_map};

fn film(pixels: &[[f32; 3]]) -> Film {
    Film::from_pixels(2, pixels.len() as u32 / 2, pixels.to_vec()).unwrap()
}

#[test]
fn the_numbers_are_those_found_by_hand() {
    let picture = |line: &str| {
        let values: Vec<f32> = line.split_whitespace().map(|v| v.parse().unwrap()).collect();
        film(values.as_chunks().0)
    };
    approved::compare("src/compare/by_hand.txt", |pictures| {
        let (a, b) = pictures.split_once('\n').unwrap();
        format!("{:?}", compare(&picture(a), &picture(b)).unwrap())
    });
}

#[test]
fn numbers_of_different_bits_that_are_none_differ_by_infinity() {
    let quiet = |payload| f32::from_bits(0x7fc0_0000u32 | payload);
    let found = compare(&film(&[[quiet(1); 3]; 2]), &film(&[[quiet(2); 3]; 2])).unwrap();
    assert_eq!((found.equal, found.largest), (false, f64::INFINITY));
}

#[test]
fn relative_errors_count_by_their_ratio_where_it_is_bright_and_by_their_size_where_dark() {
    let relative =
        |a: f32, b: f32| compare(&film(&[[a; 3]; 2]), &film(&[[b; 3]; 2])).unwrap().relative_mse;
    assert!((relative(1100.0, 1000.0) - 0.01).abs() < 1e-9);
    assert!((relative(1.1e6, 1e6) - 0.01).abs() < 1e-9);
    assert_eq!(relative(0.25, 0.0), 6.25);
    assert!((relative(2e-3, 1e-3) - 1e-4).abs() < 1e-7);
}

#[test]
fn pixels_beyond_a_tolerance_are_counted_once_each() {
    let a = film(&[[0.0; 3]; 4]);
    let b = film(&[[0.5, 0.5, 0.0], [0.25, 0.0, 0.0], [-0.0; 3], [0.0, f32::NAN, 0.0]]);
    let count = |tolerance| pixels_beyond(&a, &b, tolerance).unwrap();
    assert_eq!([0.0, 0.25, 0.5].map(count), [3, 2, 1]);
    assert!(pixels_beyond(&a, &Film::new(1, 1).unwrap(), 0.0).is_err());
}

#[test]
fn json_has_null_for_infinity_and_for_an_undefined_bias() {
    let a = film(&[[0.0; 3]; 2]);
    let text = serde_json::to_string(&compare(&a, &a).unwrap()).unwrap();
    assert_eq!(
        text,
        r#"{"width":2,"height":1,"mse":0.0,"rmse":0.0,"psnr":null,"relative_mse":0.0,"bias":0.0,"channel_bias":[0.0,0.0,0.0],"largest":0.0,"largest_at":null,"largest_channel":null,"different_pixels":0,"nonfinite":0,"equal":true}"#
    );
    let b = film(&[[0.0, f32::NAN, 0.0]; 2]);
    let json = serde_json::to_value(compare(&a, &b).unwrap()).unwrap();
    assert_eq!(json["bias"], serde_json::Value::Null);
    assert_eq!(json["channel_bias"], serde_json::json!([0.0, null, 0.0]));
}

#[test]
fn a_difference_image_shows_how_far_apart() {
    let a = film(&[[0.5, 0.25, f32::NAN], [0.0; 3]]);
    let b = film(&[[0.25, 0.5, f32::NAN], [0.0, f32::NAN, 1.0]]);
    let found = error_map(&a, &b, MapKind::Absolute, 2.0).unwrap();
    assert_eq!(found.pixels(), [[0.5, 0.5, 0.0], [0.0, f32::INFINITY, 2.0]]);
}
