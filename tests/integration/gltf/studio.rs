//! Files whose lights do not light them get a studio, and so does any on request.

use serde_json::json;
use wavecrest_scene::components::{AreaLight, DirectionalLight, PointLight};
use wavecrest_scene::load::LoadOptions;
use wavecrest_scene::load::lighting::{Lighting, Rig};
use wavecrest_scene::load::load_gltf as load_bytes;

use super::{File, image, small, square};

/// The numbers of lamps of the studio, of point lights and of emissive meshes; and the note.
fn lights(file: &File, rig: Option<Rig>) -> ([usize; 3], String) {
    let usual = Lighting::default();
    let lighting = Lighting { rig: rig.unwrap_or(usual.rig), replaces: rig.is_some(), ..usual };
    let options = LoadOptions { lighting, ..small() };
    let mut loaded = load_bytes(file.glb(), "a.glb".as_ref(), &options).expect("it is right");
    let world = &mut loaded.world;
    let counts = [
        world.query_mut::<&DirectionalLight>().into_iter().count(),
        world.query_mut::<&PointLight>().into_iter().count(),
        world.query_mut::<&AreaLight>().into_iter().count(),
    ];
    (counts, loaded.notes[0].to_string())
}

/// The square, and a small one beside it of this emission.
fn with_lamp(emission: f64) -> File {
    let mut file = square();
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    let material = file.push("materials", json!({"emissiveFactor": [emission, emission, 0]}));
    let mut primitive = file.json["meshes"][0]["primitives"][0].clone();
    primitive["material"] = material.into();
    let mesh = file.push("meshes", json!({"primitives": [primitive]}));
    file.node(json!({"mesh": mesh, "translation": [0, 1.2, 0.5], "scale": [0.1, 0.1, 0.1]}));
    file
}

/// Weak lamps and dead lights leave the studio on; lights on request replace those of the file but not its emission, and
/// without lights a lamp shows its emission and lights nothing.
#[test]
fn the_studio_is_on_where_nothing_else_lights_a_file_or_on_request() {
    let dead = || square().with("/extensions/KHR_lights_punctual/lights/0/intensity", 0);
    for (file, rig, counts, words) in [
        (with_lamp(1.0), None, [2, 0, 1], "no lights but weak emission: studio lights"),
        (with_lamp(200.0), None, [0, 0, 1], "(exposure)"),
        (dead(), None, [2, 0, 0], "no lights with power: studio lights"),
        (square(), None, [0, 1, 0], ""),
        (square(), Some(Rig::Studio), [2, 0, 0], "the lights of the file are replaced: studio"),
        (with_lamp(200.0), Some(Rig::Studio), [2, 0, 1], ""),
        (square(), Some(Rig::Headlight), [0, 1, 0], ""),
        (with_lamp(200.0), Some(Rig::None), [0, 0, 0], ""),
    ] {
        let (found, note) = lights(&file, rig);
        assert_eq!(found, counts, "{note}");
        assert!(note.contains(words), "{note}");
    }
}

/// A lamp near a corner of the square, as bright as it may be: only there is anything white, and the rest
/// is as bright as that allows.
#[test]
fn a_lamp_near_a_surface_leaves_it_its_shape() {
    for (height, intensity) in [(0.3, 9.0), (0.3, 5e6), (1.0, 0.002), (30.0, 100.0)] {
        let white = json!([1, 1, 1, 1]);
        let mut file = square().with("/materials/0/pbrMetallicRoughness/baseColorFactor", white);
        file.json["nodes"][2]["translation"] = json!([0.8, 0.8, height]);
        file.json["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = json!(intensity);
        let film = image(&file);
        let pixels = film.pixels().iter().map(|pixel| f64::from(pixel[0]));
        let mut seen: Vec<f64> = pixels.filter(|&value| value > 0.05).collect();
        seen.sort_by(f64::total_cmp);
        let (most, brightest) = (seen[seen.len() * 95 / 100], seen[seen.len() - 1]);
        assert!(most <= 1.0 && brightest > 0.9, "{height}: {most} {brightest}");
    }
}
