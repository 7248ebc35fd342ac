//! What is told of scenes that can be rendered, but are probably not meant so.

use std::path::Path;

use serde_json::{Value, json};
use wavecrest_scene::load::{LoadOptions, load_str};
use wavecrest_scene::systems;

use crate::support::{matte, pinhole, point_light, scene, sphere, try_prepare, wall, with};

/// What is said of a scene of such walls.
fn told(walls: &[Value], bounces: u32) -> Vec<String> {
    let camera = pinhole([24, 18], 40.0, 5.0);
    let json = scene(bounces, &camera, &[point_light(9.0, [0.0, 2.0, 6.0], [1.0; 3])], walls);
    let file = Path::new("s.json");
    let prepared = try_prepare(&json, file).expect("a scene");
    let told = systems::warnings(&prepared, file).into_iter().map(|warning| warning.to_string());
    told.filter(|text| !text.contains("the image looks empty")).collect()
}

#[test]
fn a_shape_seen_only_from_behind_is_a_warning_with_name_and_remedy() {
    let front = || wall(1.0, 0.0, matte(0.8, [0.5; 3]));
    let back = || with(front(), "normal", -1);
    let at = |shape: Value, z: f64| with(shape, "transform", json!({"translate": [0, 0, z]}));
    assert_eq!(told(&[front()], 0), [""; 0]);
    assert_eq!(
        told(&[with(back(), "name", "the wall")], 0),
        [
            "s.json: scene.shapes[0]: the camera sees only the back of \"the wall\", which no light reaches; \
          set \"sides\" to \"both\", or turn a plane or a triangle with \"normal\": -1"
        ]
    );
    assert_eq!(told(&[with(back(), "sides", "both")], 0), [""; 0]);
    assert_eq!(told(&[back()], 0).len(), 1, "without a name");
    // What is not seen at all is not told, nor what would look the same from the front.
    assert_eq!(told(&[at(back(), 9.0)], 0), [""; 0], "behind the eye");
    assert_eq!(
        told(&[at(back(), -1.0), with(front(), "transform", json!({"scale": 3}))], 0),
        [""; 0]
    );
    let black = with(matte(0.0, [0.5; 3]), "kd", 0);
    assert_eq!(told(&[with(back(), "material", black)], 0), [""; 0]);
    // A mesh that turns one of its sides to the eye is not told, and one that turns none is.
    let mesh = |second: [u32; 3]| {
        json!({"type": "trimesh", "points": [[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [1, -1, 0]],
               "indices": [[0, 2, 1], second], "material": matte(0.8, [0.5; 3]), "sides": "front"})
    };
    assert_eq!(told(&[mesh([0, 3, 2])], 0).len(), 1);
    assert_eq!(told(&[mesh([0, 2, 3])], 0), [""; 0]);
    let ball = with(sphere([0.0, 0.0, 5.0], 9.0, matte(0.8, [0.5; 3])), "sides", "front");
    assert_eq!(told(&[ball], 0).len(), 1, "from within");
    let many: Vec<Value> = (0..9)
        .map(|i| {
            let place = json!({"translate": [i % 3 - 1, i / 3 - 1, 0], "scale": 0.3});
            with(back(), "transform", place)
        })
        .collect();
    let all = told(&many, 0);
    assert!(all.len() == 1 && all[0].contains("and those of 8 other shapes"), "{all:?}");
}

#[test]
fn a_camera_after_a_full_turn_sees_the_front() {
    let back = with(wall(1.0, 0.0, matte(0.8, [0.5; 3])), "normal", -1);
    let of = |location: Value| {
        let keys = json!([{"frame": 0}, {"frame": 9, "location": location}]);
        let camera = with(pinhole([24, 18], 40.0, 5.0), "path", json!({"keys": keys}));
        let light = point_light(9.0, [0.0, 2.0, 6.0], [1.0; 3]);
        let json = scene(0, &camera, &[light], std::slice::from_ref(&back));
        let prepared = try_prepare(&json, Path::new("s.json")).expect("a scene");
        systems::warnings(&prepared, Path::new("s.json")).len()
    };
    assert_eq!((of(json!([3, 0, 5])), of(json!([1, 0, -5]))), (1, 0));
}

#[test]
fn lights_without_power_no_lights_and_colours_above_1_are_warnings() {
    let told = |json: &Value| {
        let loaded = load_str(&json.to_string(), Path::new("s.json"), &LoadOptions::default());
        let loaded = loaded.unwrap_or_else(|error| panic!("{error}"));
        loaded.warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let camera = pinhole([24, 18], 40.0, 5.0);
    let light = || point_light(9.0, [0.0, 2.0, 6.0], [1.0; 3]);
    let of = |lights: &[Value]| {
        told(&scene(0, &camera, lights, &[wall(1.0, 0.0, matte(0.8, [0.5; 3]))]))
    };
    assert_eq!(of(&[light()]), [""; 0]);
    assert_eq!(
        of(&[]),
        ["s.json: scene.lightsources: there is no light, so every shape is black; add a light"]
    );
    assert_eq!(told(&scene(0, &camera, &[], &[])), [""; 0], "nor is there anything to light");
    for (key, value, expected) in [
        (
            "intensity",
            json!(0),
            "is 0, so the light has no effect, found 0; use a number above 0, or remove the light",
        ),
        (
            "color",
            json!([0, 0, 0]),
            "is 0, so the light has no effect, found [0,0,0]; use a colour other than black, or remove the light",
        ),
        (
            "color",
            json!([0, 2, 0]),
            "is above 1, found [0,2,0]; use a colour from 0 to 1 and a higher \"intensity\"",
        ),
    ] {
        let expected = format!("s.json: scene.lightsources[0].{key}: {expected}");
        assert_eq!(of(&[with(light(), key, value)]), [expected]);
    }
    let mut bright = scene(0, &camera, &[light()], &[]);
    bright["scene"]["backgroundcolor"] = json!([1, 1, 1.5]);
    assert_eq!(
        told(&bright),
        ["s.json: scene.backgroundcolor: is above 1, which images of 8 bits cannot show, \
          found [1,1,1.5]; use colours from 0 to 1"]
    );
}
