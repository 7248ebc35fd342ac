//! `probe`, and what becomes of samples that are not finite.

use serde_json::{Value, json};

use super::with_ball;
use crate::support::{
    self, bytes, edited, json_in, pinhole, point_light, put, run, run_json, sphere, with,
};

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

#[test]
fn the_story_in_words_has_the_radiance_that_is_rendered() {
    let folder = with_ball();
    let output = run(folder.path(), &["probe", "ball.json", "--pixel", "8,6", "--sample", "0"]);
    assert!(output.status.success());
    let words = String::from_utf8(output.stdout).unwrap();
    for part in [
        "camera ray",
        "hits sphere 1 of scene.shapes[0]",
        "colour 0.9 0.3 0.1",
        "light 0",
        "Both tracers",
    ] {
        assert!(words.contains(part), "{part} in {words}");
    }
}

/// Ambient light for which rays look is none of the numbered lights.
#[test]
fn ambient_light_is_told_from_other_lights() {
    let folder = with_ball();
    let ball = json_in(folder.path(), "ball.json");
    let sky = edited(ball, "/scene/ambient {\"sky\": [1, 1, 1], \"samples\": 2}");
    put(folder.path(), "sky.json", sky.to_string());
    for (file, lights) in [("ball.json", "  1\n"), ("sky.json", "  1 and ambient light\n")] {
        let output = run(folder.path(), &["check", file]);
        let words = support::text(&output.stdout);
        let line = words.lines().find(|line| line.starts_with("  lights")).unwrap();
        assert!(format!("{line}\n").ends_with(lights), "{words}");
        let output = run(folder.path(), &["probe", file, "--pixel", "8,6", "--sample", "0"]);
        let words = support::text(&output.stdout);
        assert!(words.contains("    light 0, point 0, "), "{words}");
        assert_eq!(words.contains("    ambient light, point 1, "), file == "sky.json", "{words}");
        assert!(!words.contains("light 1"), "{words}");
    }
}

#[test]
fn samples_that_are_not_finite_are_counted_named_and_trapped() {
    let folder = with_ball();
    put(folder.path(), "strong.json", scene(1e-15, 1e12));
    let mut named = Vec::new();
    for tracer in ["wavefront", "recursive"] {
        let stats = format!("{tracer}.json");
        let arguments =
            ["-q", "strong.json", "out.pfm", "--tracer", tracer, "--stats", stats.as_str()];
        let output = run(folder.path(), &arguments);
        let warning = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && warning.starts_with("warning: "), "{warning}");
        let found = json_in(folder.path(), &stats);
        assert!(found["invalid"].as_u64().unwrap() > 100);
        assert!(found["first_invalid"]["primitive"].is_number(), "{found}");
        named.push((found["invalid"].clone(), found["first_invalid"].clone()));
        let image = bytes(folder.path(), "out.pfm");
        let pixels = &image[image.len() - 32 * 24 * 12..];
        assert!(pixels.chunks(4).all(|c| f32::from_le_bytes(c.try_into().unwrap()).is_finite()));
    }
    assert_eq!(named[0], named[1]);
    let output = run(folder.path(), &["strong.json", "trapped.png", "--trap-invalid"]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(error.contains("not finite") && error.contains("wavecrest probe"), "{error}");
    assert!(!folder.path().join("trapped.png").exists());
}
