//! Numbers at the ends of their ranges, and the size asked for.

use serde_json::json;

use super::{LoadOptions, complete, error, load, load_options, with};
use crate::components::View;

/// The least and greatest of each range, and values just outside it.
#[test]
fn hc28_hc29_hc36_ranges() {
    let exponent = "scene.shapes[0].material.specularexponent";
    let (fov, radius) = ("camera.fov", "scene.shapes[0].radius");
    for (path, inside, outside) in [
        (fov, [json!(0.001), json!(179)], [json!(0.000999), json!(179.001)]),
        ("camera.width", [json!(1), json!(65536)], [json!(0), json!(65537)]),
        ("camera.height", [json!(1), json!(65536)], [json!(0), json!(65537)]),
        ("camera.antialias", [json!(1), json!(64)], [json!(0), json!(65)]),
        ("nbounces", [json!(0), json!(10000)], [json!(-1), json!(10001)]),
        ("camera.aperture", [json!(0), json!(1e12)], [json!(-0.5), json!(2e12)]),
        ("camera.focal", [json!(1e-6), json!(1e12)], [json!(0), json!(-1)]),
        ("camera.nsamplesx", [json!(1), json!(4096)], [json!(0), json!(4097)]),
        ("camera.nsamplesy", [json!(1), json!(4096)], [json!(0), json!(4097)]),
        (exponent, [json!(0), json!(1e6)], [json!(-1), json!(1.1e6)]),
        (radius, [json!(1e-9), json!(1e12)], [json!(0), json!(2e12)]),
    ] {
        for value in inside {
            load(&with(path, value.clone())).unwrap_or_else(|e| panic!("{path} = {value}: {e}"));
        }
        for value in outside {
            assert_eq!(error(&with(path, value)).place(), Some(path));
        }
    }
}

#[test]
fn a_requested_size_replaces_the_files_and_one_side_keeps_the_proportions() {
    let too_many = "s.json: camera: the image would have 65536 x 65536 = 4294967296 pixels; \
                    at most 268435456 (2^28) are allowed";
    for (width, height, expected) in [
        (Some(30), Some(20), Ok((30, 20))),
        (Some(32), None, Ok((32, 24))),
        (None, Some(24), Ok((32, 24))),
        (Some(50), None, Ok((50, 38))),
        (Some(65536), Some(1), Ok((65536, 1))),
        (None, None, Ok((640, 480))),
        (Some(0), Some(1), Err("the width must be an integer from 1 to 65536, found 0")),
        (Some(1), Some(65537), Err("the height must be an integer from 1 to 65536, found 65537")),
        (Some(65536), Some(65536), Err(too_many)),
    ] {
        let options = LoadOptions { width, height, ..LoadOptions::default() };
        let found = load_options(&complete(), options).map(|scene| {
            let mut views = scene.world.query::<&View>();
            let view = views.iter().next().unwrap();
            (view.width, view.height)
        });
        let found = found.map_err(|error| error.to_string());
        assert_eq!(found, expected.map_err(str::to_owned));
    }
}
