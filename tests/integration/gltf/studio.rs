//! Files whose lights do not light them get a studio, and so does any on request.

use serde_json::json;
use wavecrest_scene::components::{AreaLight, DirectionalLight, PointLight};
use wavecrest_scene::load::LoadOptions;
use wavecrest_scene::load::lighting::{Lighting, Rig};
use wavecrest_scene::load::load_gltf as load_bytes;
use wavecrest_scene::systems;

use super::{File, image, loaded, small, square};
use crate::support::ready;

/// The numbers of lamps of the studio, of point lights and of emissive meshes; and the note.
fn lights(file: &File, rig: Option<Rig>) -> ([usize; 3], String) {
    let usual = Lighting::USUAL;
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

#[test]
fn weak_lamps_and_dead_lights_leave_the_studio_on() {
    let (counts, note) = lights(&with_lamp(1.0), None);
    assert_eq!(counts, [2, 0, 1]);
    assert!(note.contains("no lights but weak emission: studio lights"), "{note}");
    let (counts, note) = lights(&with_lamp(200.0), None);
    assert_eq!(counts, [0, 0, 1]);
    assert!(note.contains("(exposure)"), "{note}");
    let dead = square().with("/extensions/KHR_lights_punctual/lights/0/intensity", 0);
    let (counts, note) = lights(&dead, None);
    assert_eq!(counts, [2, 0, 0]);
    assert!(note.contains("no lights with power: studio lights"), "{note}");
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

#[test]
fn lights_on_request_replace_those_of_the_file_but_not_its_emission() {
    let (counts, note) = lights(&square(), Some(Rig::Studio));
    assert_eq!(counts, [2, 0, 0]);
    assert!(note.contains("the lights of the file are replaced: studio lights"), "{note}");
    assert_eq!(lights(&square(), None).0, [0, 1, 0]);
    assert_eq!(lights(&with_lamp(200.0), Some(Rig::Studio)).0, [2, 0, 1]);
    assert_eq!(lights(&square(), Some(Rig::Headlight)).0, [0, 1, 0]);
    // Then a lamp shows its emission and lights nothing.
    assert_eq!(lights(&with_lamp(200.0), Some(Rig::None)).0, [0, 0, 0]);
}

#[test]
fn an_empty_image_is_told_with_the_reason() {
    let told = |file: &File| {
        let mut loaded = loaded(file).expect("it is right");
        let warnings = std::mem::take(&mut loaded.warnings);
        let found = systems::warnings(&ready(Ok(loaded)), "a.glb".as_ref());
        warnings.iter().chain(&found).map(|w| format!("{w}\n")).collect::<String>()
    };
    assert_eq!(told(&square()), "");
    let mut turned = square();
    turned.json["nodes"][0]["rotation"] = json!([0, 1, 0, 0]);
    let found = told(&turned);
    assert!(found.contains("set \"doubleSided\" of its material to true, or flip"), "{found}");
    let mut away = square();
    away.json["nodes"][1]["rotation"] = json!([0, 1, 0, 0]);
    let found = told(&away);
    assert!(
        found.contains("the image looks empty: the camera sees nothing of the scene"),
        "{found}"
    );
    for (mode, alpha) in [("MASK", 0.4), ("BLEND", 0.0)] {
        let mut faint = square();
        faint.json["materials"][0]["alphaMode"] = mode.into();
        faint.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][3] = json!(alpha);
        let found = told(&faint);
        assert!(
            found.contains("nothing is left of the scene: all its surfaces are left out"),
            "{found}"
        );
        assert!(!found.contains("no node of the scene"), "{found}");
    }
}
