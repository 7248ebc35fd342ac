//! What each part of a file becomes, as its image shows it.

use serde_json::{Value, json};
use wavecrest_scene::components::{AreaLight, View};
use wavecrest_scene::load::{LoadOptions, load};

use super::{File, image, loaded, mapped, rendered, small, square, textured, textured_with};
use crate::support::{alternatives, assert_near, folder, likeness, pixel, put, repository};
use crate::transcript;

#[test]
fn all_forms_of_a_file_are_one_scene() {
    let file = square();
    let expected = image(&file);
    let folder = folder();
    put(folder.path(), "a b.bin", &file.bytes);
    for (name, content) in [
        ("outside.gltf", file.text("a%20b.bin").into_bytes()),
        ("inside.GLTF", file.embedded().into_bytes()),
        ("binary.glb", file.glb()),
        ("binary.scene", file.glb()),
    ] {
        put(folder.path(), name, content);
        let found = rendered(load(&folder.path().join(name), &small()));
        assert!(found.same_bits(&expected), "{name}");
    }
}

/// The light is scaled so that it and ambient light show 1 on white, but for the brightest 3 %.
#[test]
fn a_matte_surface_shows_what_the_rule_says() {
    let steps = || (0..100).map(|i| (f64::from(i) + 0.5) / 50.0 - 1.0);
    let falloff = |x: f64, y: f64| ((x - 1.0).powi(2) + (y - 2.0).powi(2) + 16.0).powf(-1.5);
    let mut all: Vec<f64> = steps().flat_map(|x| steps().map(move |y| falloff(x, y))).collect();
    all.sort_by(f64::total_cmp);
    let color = [0.8, 0.2, 0.1].map(|c| c * (0.92 * falloff(0.0, 0.0) / all[9700] + 0.08));
    let film = image(
        &square()
            .with("/materials/0/pbrMetallicRoughness/baseColorFactor", json!([0.8, 0.2, 0.1, 1])),
    );
    let middle = pixel(&film, 12, 9);
    assert_near(middle, color, 0.02, "the middle of the square");
    assert_near(pixel(&film, 0, 0), [0.05; 3], 1e-6, "beside it");
}

/// Adds an accessor: the type of its numbers, what they make up, and the numbers.
fn add_accessor(file: &mut File, line: &str) {
    let [component, of, numbers] = line.splitn(3, ' ').collect::<Vec<_>>()[..] else {
        panic!("{line}")
    };
    let numbers: Vec<f64> = serde_json::from_str(numbers).expect("numbers");
    let bytes = |number: &f64| match component {
        "5121" => vec![*number as u8],
        "5125" => (*number as u32).to_le_bytes().to_vec(),
        _ => (*number as f32).to_le_bytes().to_vec(),
    };
    let data: Vec<u8> = numbers.iter().flat_map(bytes).collect();
    let parts = ["SCALAR", "", "VEC2", "VEC3", "VEC4"].iter().position(|name| *name == of);
    let count = numbers.len() / parts.expect("a type").max(1);
    file.accessor(&data, component.parse().expect("a type"), count, of);
}

/// `square`, `picture` and `texel`, with a texture of one colour, are edited as the lines say, after accessors have been
/// added. The answer is how alike what lines of `+` and of `-` show is.
#[test]
fn what_is_said_in_other_ways_has_the_same_image() {
    transcript::check("gltf-images", |input, lines| {
        let mut file = match input.split(' ').collect::<Vec<_>>()[..] {
            ["square"] => square(),
            ["picture"] => textured(),
            ["texel", ref levels @ ..] => {
                let texel = [0, 1, 2].map(|k| levels[k].parse().expect("a level"));
                let material = square().json["materials"][0].take();
                mapped([texel; 4], material)
            }
            _ => panic!("{input}"),
        };
        let is_data = |line: &&str| line.starts_with("accessor ");
        let (data, changes): (Vec<&str>, Vec<&str>) = lines.lines().partition(is_data);
        data.iter().for_each(|line| add_accessor(&mut file, &line["accessor ".len()..]));
        let [one, other] = alternatives(&file.json, &changes.join("\n"))
            .map(|json| loaded(&File { json, bytes: file.bytes.clone() }));
        match one {
            Ok(_) => likeness(&rendered(one), &rendered(other)),
            Err(error) => error.to_string(),
        }
    });
}

/// Its levels are behind the sRGB curve, its first row is at the top, the factor tints it.
#[test]
fn a_texture_is_decoded_tinted_and_the_right_way_up() {
    let film = image(&textured());
    let at = |x, y| {
        let color = pixel(&film, x, y);
        color.map(|c| c / color.into_iter().fold(0.0, f64::max))
    };
    assert_near(at(9, 6), [1.0, 0.0, 0.0], 1e-6, "top left");
    assert_near(at(14, 6), [0.0, 1.0, 0.0], 1e-6, "top right");
    assert_near(at(9, 11), [0.0, 0.0, 1.0], 1e-6, "bottom left");
    assert_near(at(14, 11), [1.0; 3], 1e-6, "bottom right");
    let [grey, white] = [188, 255].map(|level| image(&textured_with([[level; 3]; 4])));
    let (grey, white) = (pixel(&grey, 12, 9)[0], pixel(&white, 12, 9)[0]);
    assert!((grey / white - 0.502_886).abs() < 1e-4, "half the light: {grey} and {white}");
    let mut tinted = textured();
    tinted.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] =
        json!([0.5, 1, 0.25, 1]);
    let tinted = image(&tinted);
    for (k, factor) in [0.5, 1.0, 0.25].into_iter().enumerate() {
        let (found, plain) = (pixel(&tinted, 14, 11)[k], pixel(&film, 14, 11)[k]);
        assert!((found - factor * plain).abs() < 1e-5, "{found} and {plain}");
    }
}

#[test]
fn a_surface_that_gives_off_light_is_a_light() {
    let mut file = square();
    file.json["materials"][0] = json!({
        "emissiveFactor": [1, 0.5, 0], "doubleSided": true,
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3}}
    });
    let mut world = loaded(&file).expect("it is right").world;
    let lights: Vec<AreaLight> = world.query_mut::<&AreaLight>().into_iter().copied().collect();
    assert_eq!(lights.len(), 1);
    assert!((lights[0].intensity - 4.0).abs() < 1e-12, "its area");
    let color = lights[0].color;
    assert!((color.y / color.x - 0.5).abs() < 1e-12 && color.z == 0.0);
    let film = image(&file);
    assert_near(pixel(&film, 12, 9), color.to_array(), 1e-5, "it shows its colour");
}

#[test]
fn a_surface_that_glows_weakly_or_is_unlit_shows_its_own_light() {
    let with = |material: Value| {
        let mut file = square();
        file.json["materials"][0] = material;
        file
    };
    let black = json!({"baseColorFactor": [0, 0, 0, 1], "roughnessFactor": 1});
    let glowing = |strength: f64| {
        with(json!({
            "pbrMetallicRoughness": black, "emissiveFactor": [0.5, 0.25, 0],
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
        }))
    };
    let unlit = with(json!({
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0, 1], "metallicFactor": 0},
        "emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_unlit": {}}
    }));
    for (file, factor) in [(glowing(1.0), 1.0), (glowing(1.9), 1.9), (unlit, 1.0)] {
        let mut world = loaded(&file).expect("it is right").world;
        assert_eq!(world.query_mut::<&AreaLight>().into_iter().count(), 0);
        let expected = [0.5 * factor, 0.25 * factor, 0.0];
        assert_near(pixel(&image(&file), 12, 9), expected, 1e-6, "its own light alone");
    }
}

/// Lamps show 4 I / (4 pi d^2), the sun E / pi, together 1 with ambient light: with a sun alone its intensity is of
/// no account.
#[test]
fn the_sun_shines_alike_however_bright_it_is() {
    let sun = |intensity: f64| {
        let mut file = square();
        file.json["extensions"] = json!({});
        file.json["nodes"].as_array_mut().expect("a list").truncate(2);
        file.json["scenes"][0]["nodes"] = json!([0, 1]);
        file.light(json!({"type": "directional", "intensity": intensity}), json!({}));
        image(&file)
    };
    let film = sun(100_000.0);
    assert_near(pixel(&film, 12, 9), [0.8, 0.2, 0.1], 1e-3, "straight from before");
    let other = sun(2.0);
    assert_near(pixel(&other, 12, 9), pixel(&film, 12, 9), 1e-5, "a weaker sun");
}

/// A spot at the camera, turned aside: what is within its cone shows, by the formula of the extension.
#[test]
fn a_spot_shines_within_its_cone_along_its_node() {
    let lit = |spot: Value, degrees: f64| {
        let mut file = square();
        file.json["extensions"] = json!({});
        file.json["nodes"].as_array_mut().expect("a list").truncate(2);
        file.json["scenes"][0]["nodes"] = json!([0, 1]);
        let (sin, cos) = (degrees / 2.0).to_radians().sin_cos();
        let node = json!({"translation": [0, 0, 5], "rotation": [0, sin, 0, cos]});
        file.light(json!({"type": "spot", "intensity": 9, "spot": spot}), node);
        pixel(&image(&file), 12, 9)[0]
    };
    let radians = |degrees: f64| degrees.to_radians();
    let cone =
        |inner, outer| json!({"innerConeAngle": radians(inner), "outerConeAngle": radians(outer)});
    let dark = lit(cone(10.0, 20.0), 25.0);
    assert_near([dark; 3], [0.8 * 0.08; 3], 1e-6, "ambient light alone");
    let full = lit(cone(10.0, 20.0), 5.0) - dark;
    assert_near([full; 3], [0.8 * 0.92; 3], 1e-2, "exposed to 1");
    let cos = |degrees: f64| radians(degrees).cos();
    for (spot, inner, outer) in [(cone(10.0, 20.0), 10.0, 20.0), (json!({}), 0.0, 45.0)] {
        let part = |degrees: f64| (cos(degrees) - cos(outer)) / (cos(inner) - cos(outer));
        let found = (lit(spot, 15.0) - dark) / full;
        // The middle of the pixel is less than a degree off the axis.
        let [least, most] = [16.0, 14.0].map(|degrees| part(degrees).powi(2));
        assert!(least < found && found < most, "{found}, not {least} to {most}");
    }
}

#[test]
fn a_camera_is_chosen_by_name_or_number() {
    let mut file = square();
    let camera = json!({"name": "far", "type": "perspective", "perspective": {"yfov": 0.6, "aspectRatio": 2}});
    let number = file.push("cameras", camera);
    file.node(json!({"camera": number, "translation": [0, 0, 9], "name": "tower"}));
    let flat = json!({"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 1, "zfar": 9, "znear": 0}});
    let number = file.push("cameras", flat);
    file.node(json!({"camera": number, "translation": [0, 0, 3]}));
    let view = |camera: Option<&str>| {
        let options = LoadOptions { camera: camera.map(str::to_owned), ..LoadOptions::default() };
        let loaded = super::load_bytes(file.glb(), std::path::Path::new("a.glb"), &options);
        loaded.map(|mut loaded| {
            *loaded.world.query_mut::<&View>().into_iter().next().expect("a view")
        })
    };
    let place = |camera| {
        let view: View = view(camera).expect("it is there");
        (view.location.z, view.width, view.height)
    };
    assert_eq!(place(None), (5.0, 1024, 768));
    for name in ["far", "tower", "1"] {
        assert_eq!(place(Some(name)), (9.0, 1024, 512), "{name}");
    }
    // Very far away: half its height is 1 in the middle of the scene.
    let flat = view(Some("2")).expect("it is there");
    let half = (flat.fov_degrees / 2.0).to_radians().tan() * flat.location.z;
    assert!((half - 1.0).abs() < 1e-9 && flat.location.z > 100.0, "{half}");
    let error = view(Some("near")).expect_err("there is none").to_string();
    assert!(error.contains("found near; the scene has the cameras 0, 1 (far), 2"), "{error}");
}

#[test]
fn without_camera_and_light_all_is_seen() {
    let mut file = square();
    file.json["scenes"][0]["nodes"] = json!([0]);
    let found = loaded(&file).expect("it is right");
    let notes: Vec<String> = found.notes.iter().map(ToString::to_string).collect();
    assert!(notes[0].contains("no camera") && notes[0].contains("no light"), "{notes:?}");
    // The square is less bright than what is behind it, and neither is black.
    let film = image(&file);
    let [square, background] = [pixel(&film, 12, 9)[0], pixel(&film, 0, 0)[0]];
    assert!(0.1 < square && square < background && background < 1.0, "{square}, {background}");
}

#[test]
fn the_scene_of_the_repository_loads_without_a_word() {
    let loaded = load(&repository("scenes/gltf/stones.gltf"), &small()).expect("it is right");
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    rendered(Ok(loaded));
}
