//! Textures, transforms, sides of surfaces, and units of length.

use serde_json::{Value, json};
use wavecrest_scene::systems::SceneOptions;

use super::Eye;
use crate::support::{
    BACKGROUND, alternatives, edited, folder, image, image_of, likeness, pixel, plain, point_light,
    prepare_in, put_image, scene,
};
use crate::transcript;

const EYE: Eye = Eye { size: [21, 21], fov: 40.0, distance: 5.0 };

/// The texels of a picture, from its top left, with those of 8 bits where a transfer curve would make grey 0.21; and what
/// else may be seen: nothing, and white under its ambient light alone.
const NAMED: [(&str, [f64; 3]); 6] = [
    ("red", [1.0, 0.0, 0.0]),
    ("green", [0.0, 1.0, 0.0]),
    ("blue", [0.0, 0.0, 1.0]),
    ("grey", [128.0 / 255.0; 3]),
    ("nothing", BACKGROUND),
    ("unlit", [0.08; 3]),
];

/// What short names stand for in the scenes: the last members of what shows a picture, and of what is white.
fn written_out(text: &str) -> String {
    let material =
        |color| json!({"ks": 0, "kd": 0.75, "specularexponent": 1, "diffusecolor": color});
    let picture =
        json!({"texture": "four.png", "filter": "nearest", "material": material([0.3, 0.2, 0.1])});
    let white = json!({"material": material([1.0; 3])});
    let members = |object: Value| object.to_string().split_off(1);
    text.replace("$picture", &members(picture)).replace("$white", &members(white))
}

/// An input names pixels of a scene, edited as its lines say, in which shapes show their `picture` or are `lit`, and the
/// answer what is seen there; or it asks whether what lines of `+` show is `alike` what those of `-` do.
#[test]
fn surfaces_look_as_they_are_placed_turned_and_lit() {
    let folder = folder();
    let texel = |x, y| NAMED[(2 * y + x) as usize].1.map(|value| value as f32);
    put_image(folder.path(), "four.png", [2, 2], texel);
    let light = point_light(30.0, [1.0, 2.0, 6.0], [1.0, 0.5, 0.25]);
    transcript::check("surfaces", |input, changes| {
        let words: Vec<&str> = input.split(' ').collect();
        let usual = match words[0] {
            "picture" => plain(0, &EYE.json(), &[]),
            _ => scene(0, &EYE.json(), std::slice::from_ref(&light), &[]),
        };
        let [found, other] = alternatives(&usual, &written_out(changes))
            .map(|json| image_of(&prepare_in(folder.path(), &json, SceneOptions::default()), 0));
        if words[0] == "alike" {
            return likeness(&found, &other);
        }
        let seen = words[1..].iter().map(|place| {
            let (x, y) = place.split_once(',').expect("a place");
            let seen = pixel(&found, x.parse().expect("x"), y.parse().expect("y"));
            let is_near = |(a, b): (f64, f64)| (a - b).abs() <= 1e-6;
            let named = NAMED.iter().find(|(_, color)| seen.into_iter().zip(*color).all(is_near));
            named.map_or("lit", |(name, _)| name)
        });
        seen.collect::<Vec<_>>().join(", ")
    });
}

/// Keys of lengths.
const LENGTHS: [&str; 8] =
    ["aperture", "focal", "location", "look", "position", "points", "center", "radius"];

/// The value with lengths times `s`.
fn scaled(value: &Value, s: f64, is_length: bool) -> Value {
    match value {
        Value::Object(members) => {
            let of = |key: &String| LENGTHS.contains(&key.as_str());
            members.iter().map(|(key, value)| (key.clone(), scaled(value, s, of(key)))).collect()
        }
        Value::Array(items) => items.iter().map(|item| scaled(item, s, is_length)).collect(),
        Value::Number(number) if is_length => json!(number.as_f64().expect("a number") * s),
        other => other.clone(),
    }
}

#[test]
fn hc08_a_scene_in_units_up_to_2_to_the_16_times_as_long_or_as_short_gives_the_same_bits() {
    let everything = serde_json::from_str(include_str!("everything.json")).expect("JSON");
    for (falloff, power) in [("linear", 1), ("inverse-square", 2), ("none", 0)] {
        let of = |s: f64| {
            let light = |i: u32| {
                let intensity = 25.0 * s.powi(power);
                let place = format!("/scene/lightsources/{i}");
                format!("{place}/falloff \"{falloff}\"\n{place}/intensity {intensity:e}\n")
            };
            image(&edited(scaled(&everything, s, false), &[0, 1].map(light).concat()))
        };
        let unit = of(1.0);
        for s in [16, 8, -8, -16].map(|power| 2.0_f64.powi(power)) {
            assert!(of(s).same_bits(&unit), "{falloff}, times {s}");
        }
    }
}
