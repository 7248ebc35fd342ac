//! Textures of materials: metal and roughness, ambient light, normals, light of the material itself.

use glam::DVec3;
use serde_json::{Value, json};
use wavecrest_core::film::Film;
use wavecrest_scene::components::{AreaLight, Sky};
use wavecrest_scene::load::lighting::{Background, Lighting, Rig};
use wavecrest_scene::load::{LoadOptions, load_gltf as load_bytes};

use super::converted::converted;
use super::{File, SQUARE_UVS, image, loaded, mapped, rendered, small, square};
use crate::support::{assert_near, difference, folder, merged, pixel, put};

/// The square's own material, with more.
fn own(more: Value) -> Value {
    merged(square().json["materials"][0].take(), &more)
}

fn middle(film: &Film) -> [f64; 3] {
    pixel(film, 12, 9)
}

/// Metal tints what it mirrors, here the background's nothing, and its highlight.
#[test]
fn a_metal_has_a_highlight_of_its_colour() {
    let mut file = square();
    file.json["materials"][0]["pbrMetallicRoughness"] = json!({
        "baseColorFactor": [0.8, 0.4, 0.2, 1], "metallicFactor": 1, "roughnessFactor": 0.3
    });
    // Between the camera and the light is the normal.
    file.json["nodes"][2]["translation"] = json!([0, 0, 5]);
    let [r, g, b] = middle(&image(&file));
    assert!((g / r - 0.5).abs() < 1e-3 && (b / r - 0.25).abs() < 1e-3 && r > 0.5, "{r} {g} {b}");
}

#[test]
fn occlusion_takes_away_ambient_light_alone() {
    let plain = middle(&image(&square()));
    for (texel, strength, lost) in [(0, 1.0, 1.0), (0, 0.5, 0.5), (255, 1.0, 0.0), (51, 0.5, 0.4)] {
        let info = json!({"index": 0, "strength": strength});
        let file = mapped([[texel, 200, 100]; 4], own(json!({"occlusionTexture": info})));
        let found = middle(&image(&file));
        let expected: [f64; 3] =
            std::array::from_fn(|i| plain[i] - lost * 0.08 * [0.8, 0.2, 0.1][i]);
        assert_near(found, expected, 1e-5, "less of the ambient part");
    }
}

/// In the studio rays look for what is near, unless a map tells of more than the mesh has.
#[test]
fn a_map_of_occlusion_takes_the_place_of_rays() {
    let samples = |file: File| {
        let dark = file.with("/extensions/KHR_lights_punctual/lights/0/intensity", 0);
        let world = &mut loaded(&dark).expect("it is right").world;
        world.query_mut::<&Sky>().into_iter().map(|sky| sky.samples).collect::<Vec<_>>()
    };
    assert_eq!(samples(square()), [2]);
    let info = json!({"index": 0});
    assert_eq!(samples(mapped([[0; 3]; 4], own(json!({"occlusionTexture": info})))), [0]);
}

/// The square lit with a normal map all of one texel, with these coordinates.
fn bumpy(texel: [u8; 3], uvs: &[[f32; 2]; 4], scale: f64) -> File {
    let info = json!({"index": 0, "scale": scale});
    let mut file = mapped([texel; 4], own(json!({"normalTexture": info})));
    let uvs = file.floats(uvs);
    file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uvs.into();
    file
}

/// The square lit with this normal.
fn tilted(normal: [f32; 3]) -> Film {
    let mut file = square();
    let normals = file.floats(&[normal; 4]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals.into();
    image(&file)
}

#[test]
fn a_normal_map_turns_normals_along_u_and_v() {
    let texel = |x: f32, y: f32| {
        let z = (1.0 - x * x - y * y).sqrt();
        [x, y, z].map(|c| ((c * 0.5 + 0.5) * 255.0).round() as u8)
    };
    let number = |texel: u8| f32::from(texel) / 255.0 * 2.0 - 1.0;
    let mirrored = SQUARE_UVS.map(|[u, v]| [1.0 - u, v]);
    let turned = SQUARE_UVS.map(|[u, v]| [1.0 - v, u]);
    for (x, y) in [(0.0, 0.0), (0.5, 0.0), (0.0, -0.6), (-0.3, 0.4)] {
        let texel = texel(x, y);
        let [x, y, z] = texel.map(number);
        // The file's v runs down, and green runs up.
        for (uvs, normal) in [
            (SQUARE_UVS, [x, y, z]),
            (mirrored, [-x, y, z]),
            (turned, [-y, x, z]),
            (SQUARE_UVS.map(|[u, v]| [3.0 * u, 0.1 * v]), [x, y, z]),
        ] {
            let found = image(&bumpy(texel, &uvs, 1.0));
            let far = difference(&found, &tilted(normal));
            assert!(far < 1e-5, "{texel:?} {uvs:?}: {far}");
        }
        let found = image(&bumpy(texel, &SQUARE_UVS, 0.5));
        assert!(difference(&found, &tilted([0.5 * x, 0.5 * y, z])) < 1e-5, "half as strong");
    }
}

#[test]
fn a_texture_of_light_is_seen_and_lights_nothing() {
    let glow = json!({
        "emissiveFactor": [1, 0.5, 1], "emissiveTexture": {"index": 0},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}
    });
    let file = mapped([[188, 188, 0]; 4], own(glow));
    let mut world = loaded(&file).expect("it is right").world;
    assert_eq!(world.query_mut::<&AreaLight>().into_iter().count(), 0);
    let plain = middle(&image(&square()));
    let linear = ((188.0_f64 / 255.0 + 0.055) / 1.055).powf(2.4);
    let expected = [plain[0] + 2.0 * linear, plain[1] + linear, plain[2]];
    assert_near(middle(&image(&file)), expected, 1e-5, "sRGB, times factor and strength");
}

/// The square before a wall, in a material whose base colour is red in each of these ways: as the
/// factor, as a texture, as colours of the vertices, and as the product of all.
fn reds(material: &Value) -> [File; 4] {
    let white = [1.0; 3];
    let red = [1.0, 0.0, 0.0];
    [
        (red, None, None),
        (white, Some([255, 0, 0]), None),
        (white, None, Some(red)),
        ([1.0, 1.0, 0.5], Some([255, 0, 255]), Some([1.0, 1.0, 0.0])),
    ]
    .map(|([r, g, b], texel, colors)| {
        let mut file = mapped([texel.unwrap_or_default(); 4], material.clone());
        let mut wall = file.json["meshes"][0].clone();
        let matte = json!({"pbrMetallicRoughness": {"metallicFactor": 0}});
        wall["primitives"][0]["material"] = file.push("materials", matte).into();
        let wall = file.push("meshes", wall);
        file.node(json!({"mesh": wall, "translation": [0, 0, -1], "scale": [4, 4, 1]}));
        let model = &mut file.json["materials"][0]["pbrMetallicRoughness"];
        model["baseColorFactor"] = json!([r, g, b, 1]);
        if texel.is_some() {
            model["baseColorTexture"] = json!({"index": 0});
        }
        if let Some(colors) = colors {
            let colors = file.floats(&[colors.map(|x| x as f32); 4]);
            file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors.into();
        }
        file
    })
}

/// In diffuse light, mirrors, refraction, shadows of glass and what is unlit. In white surroundings
/// nothing returns more than its colour, but for what glass mirrors on both of its sides.
#[test]
fn a_base_colour_is_factor_times_texture_times_vertex_colours() {
    let of = |metallic: f64, roughness: f64, extensions: Value| {
        json!({"pbrMetallicRoughness": {"metallicFactor": metallic, "roughnessFactor": roughness},
               "extensions": extensions})
    };
    let glass = json!({"KHR_materials_transmission": {"transmissionFactor": 1}});
    let dielectric = 0.04;
    let of_glass = 2.0 * dielectric / (1.0 + dielectric);
    let mirrored = 0.7 * 0.6 * 0.6;
    let rest = mirrored * 0.3 * dielectric;
    for (material, expected) in [
        (of(0.0, 1.0, json!({})), [1.0, 0.0]),
        (of(1.0, 0.0, json!({})), [1.0, 0.0]),
        (of(0.7, 0.4, json!({})), [1.0 - mirrored + mirrored * 0.7 + rest, rest]),
        (of(0.0, 0.0, glass), [1.0, of_glass]),
        (of(1.0, 0.0, json!({"KHR_materials_unlit": {}})), [1.0, 0.0]),
    ] {
        let files = reds(&material);
        let lit = files.each_ref().map(image);
        for (file, other) in files.iter().zip(&lit) {
            let [red, rest] = expected;
            let found = middle(&surrounded(file));
            assert_near(found, [red, rest, rest], 1e-5, &material.to_string());
            assert!(difference(&lit[0], other) < 1e-5, "{material}");
        }
    }
}

/// White, with alphas of the vertices from 0 on the left to 1 on the right, times that of the factor. The
/// picture is converted to the same one.
#[test]
fn alphas_of_vertices_blend_and_are_cut_out() {
    let size = 2.0 * 5.0 * 0.3_f64.tan() / 18.0;
    for (mode, factor, is_textured) in
        [("BLEND", 1.0, false), ("BLEND", 0.5, true), ("MASK", 1.0, false), ("MASK", 0.8, true)]
    {
        let mut model = json!({"baseColorFactor": [1, 1, 1, factor]});
        if is_textured {
            model["baseColorTexture"] = json!({"index": 0});
        }
        let mut file = mapped(
            [[255; 3]; 4],
            json!({"pbrMetallicRoughness": model, "alphaMode": mode, "alphaCutoff": 0.5 * factor,
                   "extensions": {"KHR_materials_unlit": {}}}),
        );
        let colors = file.floats(&SQUARE_UVS.map(|[u, _]| [1.0, 1.0, 1.0, u]));
        file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors.into();
        let film = surrounded(&file);
        for column in 7..17 {
            let alpha = 0.5 + (f64::from(column) + 0.5 - 12.0) * size / 2.0;
            let expected = match mode {
                "BLEND" => factor * alpha,
                _ => f64::from(column / 12),
            };
            let what = format!("{mode} {factor} {column}");
            // Its rays are in the quarters of the pixel, at random: on average up to a quarter off.
            assert_near(pixel(&film, column, 9), [expected; 3], size / 8.0, &what);
        }
        let folder = folder();
        put(folder.path(), "a.glb", file.glb());
        let (film, _) = converted(&folder.path().join("a.glb"));
        assert!(film.same_bits(&rendered(loaded(&file))), "{mode} {factor}");
    }
}

/// The image in white surroundings, before black.
fn surrounded(file: &File) -> Film {
    let background = Some(Background::Color(DVec3::ZERO));
    let lighting = Lighting { rig: Rig::None, replaces: true, background, ..Lighting::default() };
    let options = LoadOptions { lighting, ..small() };
    rendered(load_bytes(file.glb(), "a.glb".as_ref(), &options))
}
