//! Textures of materials: metal and roughness, ambient light, normals, light of the material itself.

use glam::DVec3;
use serde_json::{Value, json};
use wavecrest_core::film::Film;
use wavecrest_scene::components::{AreaLight, Sky};
use wavecrest_scene::load::lighting::{Background, Lighting, Rig};
use wavecrest_scene::load::{LoadOptions, load_gltf as load_bytes};

use super::converted::converted;
use super::images::png;
use super::{File, SQUARE_UVS, image, loaded, rendered, small, square};
use crate::support::{assert_near, difference, folder, pixel, put};

/// The square in this material, with a texture all of one colour.
fn mapped(texel: [u8; 3], material: Value) -> File {
    mapped_with([texel; 4], material)
}

fn mapped_with(texels: [[u8; 3]; 4], material: Value) -> File {
    let mut file = square();
    let view = file.view(&png(texels));
    file.json["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    file.json["samplers"] = json!([{"magFilter": 9728}]);
    file.json["textures"] = json!([{"source": 0, "sampler": 0}]);
    file.json["materials"][0] = material;
    file
}

/// The square's own material, with more.
fn own(more: Value) -> Value {
    let mut material = square().json["materials"][0].clone();
    let more = more.as_object().cloned().expect("an object");
    material.as_object_mut().expect("an object").extend(more);
    material
}

fn middle(film: &Film) -> [f64; 3] {
    pixel(film, 12, 9)
}

/// Blue is metal and green is roughness, each times its factor; red is not looked at.
#[test]
fn a_texture_of_metal_and_roughness_is_as_good_as_factors() {
    let gold = |metallic: f64, roughness: f64| {
        json!({"baseColorFactor": [0.9, 0.6, 0.3, 1], "metallicFactor": metallic,
               "roughnessFactor": roughness})
    };
    let of = |mut model: Value, texel: Option<[u8; 3]>| {
        if texel.is_some() {
            model["metallicRoughnessTexture"] = json!({"index": 0});
        }
        image(&mapped(texel.unwrap_or_default(), json!({"pbrMetallicRoughness": model})))
    };
    let rough = |texel: u8| f64::from(texel) / 255.0;
    for (texel, [metallic, roughness]) in [
        ([7, 51, 255], [1.0, rough(51)]),
        ([90, 128, 102], [rough(102), rough(128)]),
        ([255, 255, 0], [0.0, 1.0]),
    ] {
        let (found, expected) =
            (of(gold(1.0, 1.0), Some(texel)), of(gold(metallic, roughness), None));
        assert!(difference(&found, &expected) < 1e-5, "{texel:?}");
    }
    let half = of(gold(0.5, 0.4), Some([0, 255, 255]));
    assert!(difference(&half, &of(gold(0.5, 0.4), None)) < 1e-5, "factors count");
    assert!(difference(&half, &of(gold(1.0, 0.4), None)) > 0.05);
}

/// Without metalness, colours of scattered and of mirrored light are a plain surface or a metal; a usual model counts first.
#[test]
fn specular_and_gloss_are_a_plain_surface_or_a_metal() {
    let usual = |color: [f64; 4], metallic: f64, roughness: f64| json!({"pbrMetallicRoughness": {"baseColorFactor": color, "metallicFactor": metallic, "roughnessFactor": roughness}});
    let gloss =
        |model: Value| json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": model}});
    let plastic = json!({"diffuseFactor": [0.8, 0.2, 0.1, 1], "specularFactor": [0.04, 0.04, 0.04], "glossinessFactor": 0.75});
    let gold = json!({"diffuseFactor": [0, 0, 0, 1], "specularFactor": [0.9, 0.6, 0.3], "glossinessFactor": 0.5});
    let of = |material: Value| image(&mapped([0, 128, 255], material));
    let plain = of(usual([0.8, 0.2, 0.1, 1.0], 0.0, 0.25));
    assert!(of(gloss(plastic.clone())).same_bits(&plain));
    assert!(of(gloss(gold)).same_bits(&of(usual([0.9, 0.6, 0.3, 1.0], 1.0, 0.5))));
    let [mut both, alone] = [(); 2].map(|()| usual([0.1, 0.2, 0.9, 1.0], 0.0, 0.5));
    both["extensions"] = gloss(plastic.clone())["extensions"].clone();
    assert!(of(both).same_bits(&of(alone)));
    let textured = |key: &str, model: &str, mut of: Value| {
        of[key] = json!({"index": 0});
        json!({"extensions": {model: of}})
    };
    let picture = textured("diffuseTexture", "KHR_materials_pbrSpecularGlossiness", plastic);
    let mut right = usual([0.8, 0.2, 0.1, 1.0], 0.0, 0.25);
    right["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    assert!(of(picture).same_bits(&of(right)));
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
        let file = mapped([texel, 200, 100], own(json!({"occlusionTexture": info})));
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
    assert_eq!(samples(mapped([0; 3], own(json!({"occlusionTexture": info})))), [0]);
}

/// The square lit with a normal map all of one texel, with these coordinates.
fn bumpy(texel: [u8; 3], uvs: &[[f32; 2]; 4], scale: f64) -> File {
    let info = json!({"index": 0, "scale": scale});
    let mut file = mapped(texel, own(json!({"normalTexture": info})));
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
fn coordinates_without_area_leave_normals_as_they_are() {
    let found = image(&bumpy([255, 128, 128], &[[0.5, 0.5]; 4], 1.0));
    assert!(found.same_bits(&image(&square())));
}

#[test]
fn a_texture_of_light_is_seen_and_lights_nothing() {
    let glow = json!({
        "emissiveFactor": [1, 0.5, 1], "emissiveTexture": {"index": 0},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}
    });
    let file = mapped([188, 188, 0], own(glow));
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
        let mut file = mapped(texel.unwrap_or_default(), material.clone());
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
            [255; 3],
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
    let lighting = Lighting { rig: Rig::None, replaces: true, background, ..Lighting::USUAL };
    let options = LoadOptions { lighting, ..small() };
    rendered(load_bytes(file.glb(), "a.glb".as_ref(), &options))
}

/// Beyond its edge a mirrored image runs back.
#[test]
fn a_mirrored_texture_runs_there_and_back() {
    let texels = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255; 3]];
    let of = |wrap: u64, uvs: [[f32; 2]; 4]| {
        let model = json!({"metallicFactor": 0, "baseColorTexture": {"index": 0}});
        let mut file = mapped_with(texels, json!({"pbrMetallicRoughness": model}));
        file.json["samplers"] = json!([{"magFilter": 9728, "wrapS": wrap, "wrapT": wrap}]);
        let uvs = file.floats(&uvs);
        file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uvs.into();
        image(&file)
    };
    let (repeat, mirror) = (10_497, 33_648);
    let beyond = SQUARE_UVS.map(|[u, v]| [u + 1.0, v]);
    let back = SQUARE_UVS.map(|[u, v]| [1.0 - u, v]);
    assert!(difference(&of(mirror, beyond), &of(repeat, back)) < 1e-6);
    assert!(difference(&of(mirror, beyond), &of(repeat, beyond)) > 0.1);
}

/// All maps at once, each placed by a transform of its own, survive the conversion to a scene file.
#[test]
fn a_converted_file_keeps_its_maps() {
    let texels = [[200, 90, 255], [30, 160, 140], [120, 128, 250], [255, 60, 200]];
    let place = |scale: f64, turn: f64| {
        let change = json!({"scale": [scale, 0.7], "rotation": turn, "offset": [0.1, scale]});
        json!({"index": 0, "extensions": {"KHR_texture_transform": change}})
    };
    let mut normal = place(0.5, 1.1);
    normal["scale"] = 0.7.into();
    let material = json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.9, 0.7, 0.5, 1], "metallicFactor": 0.8,
            "baseColorTexture": place(1.5, 0.0), "metallicRoughnessTexture": place(1.0, 0.4)
        },
        "normalTexture": normal, "occlusionTexture": place(2.0, -0.3),
        "emissiveFactor": [0.2, 0.1, 0.3], "emissiveTexture": place(0.3, 2.0)
    });
    let mut file = mapped_with(texels, material);
    let normals =
        file.floats(&[[0.1, 0.2, 0.9], [0.3, 0.0, 1.0], [0.0, -0.1, 0.7], [0.0, 0.0, 1.0]]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals.into();
    file.node(json!({"mesh": 0, "translation": [0.4, 0.3, -1], "scale": [-1, 1.2, 0.8]}));
    let folder = folder();
    let path = folder.path().join("a.glb");
    put(folder.path(), "a.glb", file.glb());
    let (film, json) = converted(&path);
    assert!(film.same_bits(&rendered(loaded(&file))));
    for key in ["emissionmap", "metalmap", "occlusionmap", "normalmap", "uvtransform"] {
        assert!(!json["scene"]["shapes"][0][key].is_null(), "{key}");
    }
}

#[test]
fn a_node_with_instances_is_as_many_nodes() {
    let mut many = square();
    let translations = many.floats(&[[-0.5, 0.2, 0.0], [0.6, -0.3, -1.0], [0.0, 0.0, -2.0]]);
    let scales = many.floats(&[[0.5, 0.5, 0.5], [-0.4, 0.3, 1.0], [1.0, 1.0, 1.0]]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let quarter = [0.0, 0.0, half, half].map(f32::to_le_bytes).as_flattened().to_vec();
    let still = [0.0_f32, 0.0, 0.0, 1.0].map(f32::to_le_bytes).as_flattened().to_vec();
    let rotations = many.accessor(&[still.clone(), quarter, still].concat(), 5126, 3, "VEC4");
    let attributes = json!({"TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales});
    many.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    many.json["nodes"][0]["scale"] = json!([1.1, 0.9, 1.0]);
    let mut each = square();
    each.json["nodes"][0] = json!({"scale": [1.1, 0.9, 1.0], "children": []});
    for node in [
        json!({"mesh": 0, "translation": [-0.5, 0.2, 0.0], "scale": [0.5, 0.5, 0.5]}),
        json!({"mesh": 0, "translation": [0.6, -0.3, -1.0], "scale": [-0.4, 0.3, 1.0],
               "rotation": [0.0, 0.0, half, half]}),
        json!({"mesh": 0, "translation": [0.0, 0.0, -2.0]}),
    ] {
        let number = each.push("nodes", node);
        each.json["nodes"][0]["children"].as_array_mut().expect("a list").push(number.into());
    }
    let mut named = many.clone();
    named.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
    // Numbers of 32 bits are a little off those of the text.
    assert!(difference(&image(&named), &image(&each)) < 1e-2);
    let worst = image(&many);
    assert!(difference(&worst, &image(&named)) > 0.05, "without them it is one");
    let mut odd = named.clone();
    odd.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
        json!(rotations);
    let error = loaded(&odd).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.contains("nodes[0].extensions.EXT_mesh_gpu_instancing"), "{error}");
}
