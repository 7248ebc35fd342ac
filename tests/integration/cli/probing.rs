//! `probe`.

use serde_json::{Value, json};

use super::with_ball;
use crate::support::{self, pinhole, point_light, put, run_json, sphere, with};

/// A ball on a mirror, of some size; one light is behind them.
pub(super) fn scene(size: f64, intensity: f64) -> String {
    let at = |p: [f64; 3]| p.map(|x| x * size);
    let light = |position| {
        let light = point_light(intensity, at(position), [1.0; 3]);
        with(light, "falloff", "inverse-square")
    };
    let material = |color, kr: f64| json!({"ks": 0.2, "kd": 0.8, "specularexponent": 20, "diffusecolor": color, "kr": kr});
    let floor = [[-4.0, -1.0, 4.0], [-4.0, -1.0, -4.0], [4.0, -1.0, -4.0], [4.0, -1.0, 4.0]];
    let floor =
        json!({"type": "plane", "points": floor.map(at), "material": material([1, 1, 1], 0.5)});
    let camera = with(pinhole([32, 24], 60.0, 5.0), "location", json!(at([0.0, 1.0, 5.0])));
    let lights = [[2.0, 3.0, 5.0], [6.0, 3.0, 0.0], [-2.0, -4.0, -5.0]].map(light);
    let shapes = [sphere([0.0; 3], size, material([1, 0, 0], 0.0)), floor];
    support::scene(3, &with(camera, "antialias", 2), &lights, &shapes).to_string()
}

#[test]
fn both_tracers_tell_the_story_of_every_kind_of_pixel() {
    let folder = with_ball();
    put(folder.path(), "mirror.json", scene(1.0, 100.0));
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
