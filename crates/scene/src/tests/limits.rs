//! Numbers at the ends of their ranges, and limits on what they ask for together.

use serde_json::{Value, json};

use super::{LoadOptions, accepted, complete, error, load, load_options, only, refused, set, with};
use crate::components::{Settings, View};
use wavecrest_base::error::ErrorKind;

/// The least and greatest of the range at `path`, and values just outside it.
fn ends(path: &str, inside: [Value; 2], outside: [Value; 2]) {
    for value in inside {
        load(&with(path, value.clone())).unwrap_or_else(|e| panic!("{path} = {value}: {e}"));
    }
    for value in outside {
        assert_eq!(error(&with(path, value)).place(), Some(path));
    }
}

#[test]
fn hc28_ranges() {
    ends("camera.fov", [json!(0.001), json!(179)], [json!(0.000999), json!(179.001)]);
    ends("camera.width", [json!(1), json!(65536)], [json!(0), json!(65537)]);
    ends("camera.height", [json!(1), json!(65536)], [json!(0), json!(65537)]);
    ends("camera.antialias", [json!(1), json!(64)], [json!(0), json!(65)]);
    ends("nbounces", [json!(0), json!(10000)], [json!(-1), json!(10001)]);
    refused("camera.fov", json!(180), "camera.fov: must be a number from 0.001 to 179, found 180");
}

#[test]
fn hc29_lens() {
    ends("camera.aperture", [json!(0), json!(1e12)], [json!(-0.5), json!(2e12)]);
    ends("camera.focal", [json!(1e-6), json!(1e12)], [json!(0), json!(-1)]);
    ends("camera.nsamplesx", [json!(1), json!(4096)], [json!(0), json!(4097)]);
    ends("camera.nsamplesy", [json!(1), json!(4096)], [json!(0), json!(4097)]);
}

#[test]
fn hc36_materials() {
    let path = "scene.shapes[0].material.specularexponent";
    ends(path, [json!(0), json!(1e6)], [json!(-1), json!(1.1e6)]);
    ends("scene.shapes[0].radius", [json!(1e-9), json!(1e12)], [json!(0), json!(2e12)]);
}

#[test]
fn integers_may_have_a_point() {
    let scene = accepted("nbounces", json!(8.0));
    assert_eq!(only::<Settings>(&scene).bounces, 8);
    let error = error(&with("nbounces", json!(20_000)));
    assert_eq!(error.kind(), ErrorKind::Limit);
}

#[test]
fn samples_of_a_light() {
    let path = "scene.lightsources[1]";
    let jittered = |n: u32| with(&format!("{path}.samples"), json!(n));
    assert!(load(&jittered(4096)).is_ok());
    assert_eq!(
        error(&jittered(4097)).to_string(),
        "s.json: scene.lightsources[1].samples: jittered sampling would take 4097 x 4097 = 16785409 \
         points, found 4097; at most 16777216 (2^24) are allowed"
    );
    assert_eq!(error(&jittered(4097)).kind(), ErrorKind::Limit);
    let random = set(jittered(65536), &format!("{path}.sampling"), json!("random"));
    assert!(load(&random).is_ok());
}

#[test]
fn pixels() {
    let square = set(with("camera.width", json!(65536)), "camera.height", json!(65536));
    let error = error(&square);
    assert_eq!(
        error.to_string(),
        "s.json: camera: the image would have 65536 x 65536 = 4294967296 pixels; \
         at most 268435456 (2^28) are allowed"
    );
    assert_eq!(error.kind(), ErrorKind::Limit);
}

#[test]
fn rays() {
    let scene = set(with("camera.nsamplesx", json!(4096)), "camera.nsamplesy", json!(4096));
    assert_eq!(
        error(&scene).to_string(),
        "s.json: camera: each pixel would have 2 x 2 (antialias) x 4096 x 4096 (nsamplesx, \
         nsamplesy) = 67108864 rays; at most 16777216 (2^24) are allowed"
    );
    assert!(load(&set(scene, "camera.antialias", json!(1))).is_ok());
}

fn sized(width: u32, height: u32) -> LoadOptions {
    LoadOptions { width: Some(width), height: Some(height), ..LoadOptions::default() }
}

#[test]
fn a_requested_size_replaces_the_files_and_one_side_keeps_the_proportions() {
    let view: View = only(&load_options(&complete(), sized(30, 20)).unwrap());
    assert_eq!((view.width, view.height), (30, 20));
    for (width, height, expected) in [
        (Some(32), None, (32, 24)),
        (None, Some(24), (32, 24)),
        (Some(50), None, (50, 38)),
        (Some(65536), Some(1), (65536, 1)),
        (None, None, (640, 480)),
    ] {
        let options = LoadOptions { width, height, ..LoadOptions::default() };
        let view: View = only(&load_options(&complete(), options).unwrap());
        assert_eq!((view.width, view.height), expected);
    }
}

#[test]
fn the_size_asked_for_has_the_same_limits() {
    let text = |w, h| load_options(&complete(), sized(w, h)).err().unwrap().to_string();
    assert_eq!(text(0, 1), "the width must be an integer from 1 to 65536, found 0");
    assert_eq!(text(1, 65537), "the height must be an integer from 1 to 65536, found 65537");
    assert_eq!(
        text(65536, 65536),
        "s.json: camera: the image would have 65536 x 65536 = 4294967296 pixels; \
         at most 268435456 (2^28) are allowed"
    );
}
