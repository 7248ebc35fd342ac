//! `probe`.

use serde_json::Value;

use wavecrest_core::probe;

use super::signals::endless;
use super::{ball, with_ball, with_scene};
use crate::support::{edited, prepare, put, run_json};

/// A ball on a mirror, under three lights of which one is behind them.
const MIRROR: &str = r#"/nbounces 3
/camera/location [0, 1, 5]
/camera/width 32
/camera/height 24
/camera/fov 60
/camera/antialias 2
/scene/lightsources/0/position [2, 3, 5]
/scene/lightsources/- {"type": "pointlight", "intensity": 40, "position": [6, 3, 0], "color": [1, 1, 1]}
/scene/lightsources/- {"type": "pointlight", "intensity": 40, "position": [-2, -4, -5], "color": [1, 1, 1]}
/scene/shapes/0/material/kr 0
/scene/shapes/1/material/kr 0.5
/scene/shapes/1/points [[-4, -1, 4], [-4, -1, -4], [4, -1, -4], [4, -1, 4]]"#;

#[test]
fn every_kind_of_pixel_tells_its_story() {
    let folder = with_ball();
    put(folder.path(), "mirror.json", edited(ball(), MIRROR).to_string());
    let (mut ends, mut verdicts) = (Vec::new(), Vec::new());
    for pixel in ["16,11", "16,20", "0,0", "2,20", "10,16", "22,18", "8,15"] {
        for precision in ["fast", "exact"] {
            let arguments =
                ["probe", "mirror.json", "--pixel", pixel, "--json", "--precision", precision];
            let record = run_json(folder.path(), &arguments);
            let paths = record["paths"].as_array().unwrap();
            assert_eq!(paths.len(), 4);
            for bounce in paths.iter().flat_map(|path| path["bounces"].as_array().unwrap()) {
                ends.push(bounce["end"].to_string());
                let lights = bounce["met"]["lights"].as_array().into_iter().flatten();
                verdicts.extend(lights.map(|light| light["verdict"].to_string()));
                let bound = &bounce["met"]["t_error"];
                assert_eq!(bound.is_number(), bounce["met"].is_object() && precision != "fast");
            }
        }
    }
    for end in ["null", "\"nothing\"", "\"no-mirror\""] {
        assert!(ends.iter().any(|found| found == end), "{end}");
    }
    for verdict in ["\"visible\"", "\"behind\"", "occluded"] {
        assert!(verdicts.iter().any(|found| found.contains(verdict)), "{verdict}");
    }
}

/// Of a pixel of 4096 samples, each with 20 000 points on a light.
#[test]
fn what_is_traced_is_what_is_shown_and_no_more_than_can_be_read() {
    let folder = with_scene(&endless().to_string());
    let of = |more: &[&str]| {
        let arguments = ["probe", "ball.json", "--pixel", "0,0", "--json"];
        let record = run_json(folder.path(), &[&arguments, more].concat());
        assert_eq!(record["samples"], 4096);
        let paths = record["paths"].as_array().expect("paths").iter();
        (paths.map(|path| path["sample"].clone()).collect(), record["cut_after"].as_u64())
    };
    let (samples, cut_after): (Vec<Value>, _) = of(&[]);
    assert_eq!(samples, [0, 1, 2, 3]);
    assert!(cut_after.is_some_and(|count| (65_536..67_000).contains(&count)), "{cut_after:?}");
    assert_eq!(of(&["--sample", "4000"]), (vec![4000.into()], None));
    let record = probe::pixel(&prepare(&endless()), [0, 0], None, 0, &|_| true);
    let lights = record.paths[0].bounces[0].met.as_ref().map(|met| met.lights.len());
    assert!(record.paths.len() == 1 && record.cut_after < Some(2048) && lights < Some(2048));
}
