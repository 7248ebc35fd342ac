//! `probe`.

use serde_json::Value;

use super::{ball, with_ball};
use crate::support::{edited, put, run_json};

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
fn both_tracers_tell_the_story_of_every_kind_of_pixel() {
    let folder = with_ball();
    put(folder.path(), "mirror.json", edited(ball(), MIRROR).to_string());
    let (mut ends, mut verdicts) = (Vec::new(), Vec::new());
    for pixel in ["16,11", "16,20", "0,0", "2,20", "10,16", "22,18", "8,15"] {
        for precision in ["fast", "exact"] {
            let arguments =
                ["probe", "mirror.json", "--pixel", pixel, "--json", "--precision", precision];
            let record = run_json(folder.path(), &arguments);
            let paths = record["paths"].as_array().unwrap();
            assert_eq!((paths.len(), &record["differs"]), (4, &Value::Null));
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
