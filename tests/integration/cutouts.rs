//! Cut-outs: what has little alpha is not there, for rays of any kind.

use std::path::Path;

use image::{Rgba, RgbaImage};
use serde_json::{Value, json};
use wavecrest_core::film::Film;
use wavecrest_core::plan::Effect;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::RenderOptions;
use wavecrest_scene::load::lighting::{Background, Lighting, Rig};
use wavecrest_scene::load::{LoadOptions, load, load_str};
use wavecrest_scene::systems::Options;
use wavecrest_scene::write::write;

use crate::support::{
    assert_near, both, folder, image_of, matte, options, pinhole, pixel, point_light, ready,
    ready_by, render_on, scene, sphere, textured_square, wall, with,
};

/// A folder with an image whose left half is there, green, and whose right half is not.
fn with_image() -> tempfile::TempDir {
    let folder = folder();
    let texel = |x, _| Rgba([0, 255, 0, if x < 2 { 255 } else { 0 }]);
    RgbaImage::from_fn(4, 4, texel).save(folder.path().join("half.png")).expect("an image");
    folder
}

fn prepared_as(json: &Value, folder: &Path, flat: bool) -> PreparedScene {
    let file = folder.join("scene.json");
    let options = LoadOptions { strict: true, ..LoadOptions::default() };
    let loaded = load_str(&json.to_string(), &file, &options);
    ready_by(loaded, Options { flat, ..Options::default() })
}

fn prepared(json: &Value, folder: &Path) -> PreparedScene {
    prepared_as(json, folder, false)
}

fn cut_out(shape: Value) -> Value {
    let shape = with(with(shape, "texture", "half.png"), "alphacutoff", 0.5);
    with(with(shape, "filter", "nearest"), "sides", "both")
}

/// A wall of which the left half is there, as shapes of each kind have it.
fn walls() -> [Value; 3] {
    let corners = [[-2, -2, 0], [-2, 2, 0], [2, 2, 0], [2, -2, 0]];
    let mesh = json!({"type": "trimesh", "points": corners, "indices": [[0, 1, 2], [0, 2, 3]],
                      "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]], "material": matte(1.0, [0.5; 3])});
    let triangle = json!({"type": "triangle", "points": [[-2, -2, 0], [-2, 6, 0], [2, -2, 0]],
                          "wrap": "clamp", "material": matte(1.0, [0.5; 3])});
    [wall(2.0, 0.0, matte(1.0, [0.5; 3])), mesh, triangle]
}

/// What is behind shows where nothing is, in a mirror too, and it casts no shadow there.
#[test]
fn camera_rays_shadow_rays_and_mirror_rays_pass_where_nothing_is() {
    let folder = with_image();
    for shape in walls() {
        // Straight before the camera; behind it a wall that the lamp is before, beside the camera's axis.
        let behind = wall(8.0, -2.0, matte(1.0, [1.0, 0.0, 0.0]));
        let lamp = point_light(50.0, [0.0, 0.0, 6.0], [1.0; 3]);
        let mut json = scene(1, &pinhole([16, 16], 40.0, 6.0), &[lamp], &[cut_out(shape), behind]);
        json["scene"]["ambient"] = 0.into();
        let scene = prepared(&json, folder.path());
        let film = image_of(&scene, 0);
        let is_green = |x| pixel(&film, x, 8)[1] > 0.0 && pixel(&film, x, 8)[0] == 0.0;
        let is_red = |x| pixel(&film, x, 8)[0] > 0.0 && pixel(&film, x, 8)[1] == 0.0;
        assert!(is_green(5) && is_red(10), "{json}");
        let counted = render_on(1, &scene, &RenderOptions { ..options() }).counters.tests.cutouts;
        assert!(counted > 0);
        // The lamp stands where the camera does: the wall's shadow is hidden behind it, and seen from its right side.
        let mut aside = json.clone();
        aside["camera"]["location"] = json!([6, 0, 6]);
        aside["camera"]["look"] = json!([1.3, 0, -2]);
        let shadowed = image_of(&prepared(&aside, folder.path()), 0);
        let whole = {
            let mut whole = aside.clone();
            whole["scene"]["shapes"][0]["alphacutoff"] = 0.into();
            image_of(&prepared(&whole, folder.path()), 0)
        };
        assert!(!shadowed.same_bits(&whole));
    }
}

/// A sphere, and masks by their brightness.
#[test]
fn a_sphere_is_cut_out_by_a_mask() {
    let folder = folder();
    let texel = |x, _| image::Luma([if x < 2 { 255_u8 } else { 0 }]);
    let mask = image::GrayImage::from_fn(4, 4, texel);
    mask.save(folder.path().join("mask.png")).expect("an image");
    let ball = sphere([0.0; 3], 1.0, matte(1.0, [0.0, 1.0, 0.0]));
    let ball = with(with(ball, "alpha", "mask.png"), "filter", "nearest");
    let lamp = point_light(50.0, [0.0, 0.0, 6.0], [1.0; 3]);
    let json = scene(0, &pinhole([16, 16], 30.0, 6.0), &[lamp], &[ball]);
    let scene = prepared(&json, folder.path());
    assert!(scene.plan.has(Effect::CutOuts) && !scene.plan.has(Effect::Textures));
    let film = image_of(&scene, 0);
    // u runs around +y from behind: to the left half of the image the left half of the ball belongs, and on the
    // right its inside is seen.
    assert!(pixel(&film, 5, 8)[1] > pixel(&film, 10, 8)[1]);
}

/// Through the hole of a shell its inside is met, by rays of any kind: opaque, it shades as much as a whole ball;
/// half transparent, light passes once where it passes a whole one twice.
#[test]
fn behind_a_hole_is_the_far_side() {
    let folder = with_image();
    let lamp = with(point_light(1.0, [0.0, 0.0, 6.0], [1.0; 3]), "falloff", "none");
    let camera = with(pinhole([64, 64], 60.0, 3.0), "location", json!([0, 0, -4]));
    let camera = with(camera, "look", json!([0, 0, -5]));
    let shadow = |ball: Option<Value>| {
        let floor = wall(9.0, -6.0, matte(1.0, [1.0; 3]));
        let shapes: Vec<Value> = [floor].into_iter().chain(ball).collect();
        let mut json = scene(0, &camera, std::slice::from_ref(&lamp), &shapes);
        json["scene"]["ambient"] = 0.into();
        let [wavefront, recursive] = both(&prepared(&json, folder.path()));
        assert!(wavefront.film.same_bits(&recursive.film));
        wavefront.film
    };
    let ball = |opacity: f64| sphere([0.0; 3], 1.0, with(matte(1.0, [1.0; 3]), "opacity", opacity));
    let [open, whole] = [None, Some(ball(0.5))].map(shadow);
    assert_eq!(pixel(&whole, 32, 32)[0], pixel(&open, 32, 32)[0] * 0.25);
    // The hole faces the lamp, or the floor, from which shadow rays come.
    for angle in [-90, 90] {
        let shell = |opacity: f64| {
            with(cut_out(ball(opacity)), "transform", json!({"rotate": [0, angle, 0]}))
        };
        assert!(shadow(Some(shell(1.0))).same_bits(&shadow(Some(ball(1.0)))), "{angle}");
        let once = shadow(Some(shell(0.5)));
        assert_eq!(pixel(&once, 32, 32)[0], pixel(&open, 32, 32)[0] * 0.5, "{angle}");
    }
}

/// Of glTF files, by their mode; of MTL files, by `map_d`. A converted file has the same image.
#[test]
fn files_of_other_formats_are_cut_out() {
    let folder = with_image();
    let at = |name: &str| folder.path().join(name);
    let gltf = textured_square(folder.path(), &["half.png"]);
    let model = |alpha: f64| json!({"baseColorTexture": {"index": 0}, "metallicFactor": 0, "baseColorFactor": [1, 1, 1, alpha]});
    for (name, mode, alpha) in [
        ("mask", "MASK", 1.0),
        ("blend", "BLEND", 0.6),
        ("opaque", "OPAQUE", 1.0),
        ("gone", "MASK", 0.4),
    ] {
        let material =
            json!({"alphaMode": mode, "pbrMetallicRoughness": model(alpha), "doubleSided": true});
        let gltf = with(gltf.clone(), "materials", json!([material]));
        std::fs::write(at(&format!("{name}.gltf")), gltf.to_string()).expect("a file");
    }
    let options = LoadOptions { width: Some(20), height: Some(16), ..LoadOptions::default() };
    let background = Some(Background::Color([0.0; 3].into()));
    let lighting = Lighting { rig: Rig::Headlight, background, ..Lighting::default() };
    let lit = LoadOptions { lighting, ..options.clone() };
    let film = |name: &str| -> Film {
        let options = if name.ends_with(".json") { &options } else { &lit };
        image_of(&ready(load(&at(name), options)), 0)
    };
    let covered = |film: &Film| film.pixels().iter().filter(|p| p[1] > 0.1).count();
    let whole = covered(&film("opaque.gltf"));
    for name in ["mask.gltf", "blend.gltf", "m.obj"] {
        let found = film(name);
        let share = covered(&found) as f64 / whole as f64;
        assert!((0.3..0.7).contains(&share), "{name}: {share}");
        let out = at(&format!("{name}.json"));
        write(&load(&at(name), &lit).expect("a scene"), &out, false).expect("a scene file");
        assert!(film(&format!("{name}.json")).same_bits(&found), "{name}");
    }
    let gone = load(&at("gone.gltf"), &options).expect("a scene");
    assert!(gone.notes.iter().any(|note| note.to_string().contains("an invisible surface")));
}

/// Between texels alpha is weighted, and what is there is what has as much as the threshold.
#[test]
fn the_threshold_moves_the_edge() {
    let folder = with_image();
    let share = |cutoff: f64| {
        let shape = with(cut_out(wall(1.0, 0.0, matte(1.0, [0.5; 3]))), "filter", "bilinear");
        let shape = with(with(shape, "wrap", "clamp"), "alphacutoff", cutoff);
        let lamp = point_light(50.0, [0.0, 0.0, 6.0], [1.0; 3]);
        let json = scene(0, &pinhole([64, 4], 20.0, 5.671_281_819_617_709), &[lamp], &[shape]);
        let json = with(
            json,
            "camera",
            with(pinhole([64, 4], 20.0, 5.671_281_819_617_709), "fovaxis", "x"),
        );
        let film = image_of(&prepared(&json, folder.path()), 0);
        (0..64).filter(|&x| pixel(&film, x, 2)[1] > 0.26).count() as f64 / 64.0
    };
    // Alpha falls from 1 to 0 between 3/8 and 5/8.
    for (cutoff, right) in [(0.25, 0.5625), (0.5, 0.5), (0.75, 0.4375), (1.0, 0.375)] {
        let found = share(cutoff);
        assert_near([found; 3], [right; 3], 0.02, &format!("{cutoff}"));
    }
}
