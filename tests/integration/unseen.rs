//! What cannot be seen costs nothing: the scene with it has the image, the counts, the bytes and the passes
//! of the scene without, and its files are not opened.

use std::path::Path;

use image::{Rgba, RgbaImage};
use serde_json::{Value, json};
use wavecrest_core::counters::Counters;
use wavecrest_core::plan::Effect;
use wavecrest_core::plan::schedule::{PASSES, unplanned};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::wavefront::batch::Batch;
use wavecrest_scene::load::{LoadOptions, load};
use wavecrest_scene::systems::Options;

use wavecrest_core::accel::build::Preset;

use crate::support::{
    both_alone, bytes, edited, folder, json_in, matte, pinhole, point_light, prepare_in, put,
    ready, reason, run_well, scene, sphere, textured_square, thin_lens, wall, with,
};
use crate::transcript;

/// A camera above a floor, which looks down on it.
fn camera() -> Value {
    with(pinhole([32, 24], 40.0, 5.0), "location", json!([0, 2, 5]))
}

fn floor() -> Value {
    json!({"type": "plane", "material": matte(0.8, [0.5; 3]), "normal": [0, 1, 0],
           "points": [[-9, -1, 9], [-9, -1, -9], [9, -1, -9], [9, -1, 9]]})
}

fn lamp(y: f64) -> Value {
    point_light(50.0, [1.0, y, 1.0], [1.0; 3])
}

fn ball() -> Value {
    sphere([0.0, 0.0, 0.0], 0.8, with(matte(0.8, [0.5; 3]), "ks", 0.5))
}

/// `value` with the members of `more`.
fn extended(mut value: Value, more: &Value) -> Value {
    let members = more.as_object().cloned().expect("an object");
    value.as_object_mut().expect("an object").extend(members);
    value
}

/// A folder with files that are neither images nor meshes, and with an opaque image.
fn files() -> tempfile::TempDir {
    let folder = folder();
    for name in ["broken.png", "broken.ply"] {
        put(folder.path(), name, "nothing");
    }
    let texel = |x, y| Rgba([50 * x as u8, 50 * y as u8, 99, 255]);
    RgbaImage::from_fn(4, 4, texel).save(folder.path().join("opaque.png")).expect("an image");
    folder
}

fn prepared(json: &Value, folder: &Path) -> PreparedScene {
    prepare_in(folder, json, Options::default())
}

/// The scene as it is prepared if nothing is left out.
fn complete(json: &Value, folder: &Path) -> PreparedScene {
    prepare_in(folder, json, Options { passes: &unplanned(&PASSES), ..Options::default() })
}

/// A floor, a ball and a lamp are edited as the lines say: those that begin with `+` are what nobody sees, and with `-` what
/// is there instead. An input is the effect that is looked at, and the answer is why the plan has none. Where the files can
/// be read, leaving nothing out gives the same images.
#[test]
fn what_nobody_sees_costs_nothing() {
    let (folder, readable) = (files(), files());
    let image = readable.path().join("opaque.png");
    std::fs::copy(image, readable.path().join("broken.png")).expect("a copy");
    let usual = scene(2, &camera(), &[lamp(3.0)], &[floor(), ball()]);
    transcript::check("unseen", |name, changes| {
        let effect = Effect::ALL.into_iter().find(|effect| effect.name() == name).expect("one");
        let [with, without] = ["+ ", "- "].map(|mark| {
            let is_other = |line: &&str| !line.starts_with(['+', '-']);
            let lines = changes
                .lines()
                .filter_map(|line| line.strip_prefix(mark).or_else(|| Some(line).filter(is_other)));
            edited(usual.clone(), &lines.collect::<Vec<_>>().join("\n"))
        });
        let [found, expected] = [&with, &without].map(|json| prepared(json, folder.path()));
        assert_eq!(found.plan.schedule(), expected.plan.schedule(), "{changes}");
        assert_eq!(Batch::bytes_per_path(&found), Batch::bytes_per_path(&expected), "{changes}");
        assert_eq!(found.bytes(), expected.bytes(), "{changes}");
        for (found, expected) in both_alone(&found).iter().zip(&both_alone(&expected)) {
            assert!(found.film.same_bits(&expected.film), "{changes}");
            assert_eq!(found.counters, expected.counters, "{changes}");
            assert_eq!(found.columns, expected.columns, "{changes}");
        }
        let [planned, all] =
            [prepared, complete].map(|prepare| both_alone(&prepare(&with, readable.path())));
        for rendered in planned.iter().chain(&all) {
            assert!(rendered.film.same_bits(&planned[0].film), "{changes}");
        }
        let (is_present, why) = reason(&found, effect);
        format!("{}{why}", if is_present { "present: " } else { "" })
    });
}

/// A mesh behind the eye is read, for its place, and not kept where no ray goes there.
#[test]
fn shapes_that_no_ray_can_meet_are_not_kept() {
    let folder = files();
    let mesh = json!({
        "type": "trimesh", "name": "m", "indices": [[0, 1, 2], [0, 2, 3]], "shading": "smooth",
        "points": [[-2, 0, 9], [-2, 4, 9], [2, 4, 9], [2, 0, 9]], "texture": "opaque.png",
        "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]], "normals": [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1]],
        "material": matte(0.8, [0.5; 3])});
    let seen = json!({
        "type": "trimesh", "indices": [[0, 1, 2]], "uvs": [[0, 0], [0, 1], [1, 1]],
        "points": [[-1, 0, 0], [0, 1, 0], [1, 0, 0]], "texture": "opaque.png",
        "material": matte(0.8, [0.5; 3])});
    let quad = |z| wall(1.0, z, matte(0.8, [0.5; 3]));
    let around = |before: &[Value], after: &[Value], intensity: f64| {
        let shapes = [before, &[seen.clone(), quad(-1.0), ball(), floor()][..], after].concat();
        let lamp = with(lamp(3.0), "intensity", intensity);
        scene(0, &camera(), &[lamp], &shapes)
    };
    let unseen = [mesh.clone(), quad(9.0), sphere([0.0, 2.0, 10.0], 1.0, matte(0.8, [0.5; 3]))];
    let expected = prepared(&around(&[], &[], 0.0), folder.path());
    // Before images are decoded.
    let bytes = expected.bytes();
    let images = both_alone(&expected);
    for (before, after) in
        [(&unseen[..], &[][..]), (&[][..], &unseen[..]), (&unseen[..1], &unseen[1..])]
    {
        let json = around(before, after, 0.0);
        let found = prepared(&json, folder.path());
        assert_eq!(found.bytes(), bytes);
        assert_eq!(found.accel.geometry().len(), expected.accel.geometry().len());
        assert_eq!(found.appearance.shapes.len(), expected.appearance.shapes.len() + 3);
        for (found, expected) in both_alone(&found).iter().zip(&images) {
            assert!(found.film.same_bits(&expected.film));
            assert_eq!(found.counters, expected.counters);
        }
        // Shadow rays may meet them.
        let lit = prepared(&around(before, after, 50.0), folder.path());
        assert_eq!(lit.accel.geometry().len(), expected.accel.geometry().len() + 4);
    }
    // In instances, of which one or none is in view.
    let shown = |places: &[[f64; 3]]| {
        let mut json = around(&[with(mesh.clone(), "hidden", true)], &[], 0.0);
        let instance = |by: &[f64; 3]| json!({"shape": "m", "transform": {"translate": by}});
        json["scene"]["instances"] = places.iter().map(instance).collect::<Value>();
        prepared(&json, folder.path())
    };
    let [none, one] = [shown(&[[0.0; 3], [0.0, 1.0, 0.0]]), shown(&[[0.0; 3], [0.0, 0.0, -12.0]])];
    assert_eq!(none.accel.geometry().held(), expected.accel.geometry().held());
    assert_eq!(one.accel.geometry().instances.len(), 1);
    assert!(!one.accel.geometry().prototypes[0].triangles.is_empty());
    let alone = prepared(&around(&[], &[], 0.0), folder.path());
    assert!(both_alone(&none)[0].film.same_bits(&both_alone(&alone)[0].film));
    let only = json!({"nbounces": 0, "camera": camera(), "scene": {
        "backgroundcolor": [0, 0, 0], "lightsources": [], "shapes": [mesh]}});
    let only = prepared(&only, folder.path());
    assert_eq!(reason(&only, Effect::Triangles), (false, "2 triangles, not in view"));
    assert_eq!((only.accel.tree_bytes(), only.accel.geometry().len()), (0, 0));
}

/// A lens and antialiasing cast no ray where no shape can be.
#[test]
fn pixels_without_shapes_cost_nothing() {
    let folder = files();
    let size = [64, 48];
    let of = |more: &Value, shapes: &[Value]| {
        let camera = extended(pinhole(size, 40.0, 6.0), more);
        prepared(&scene(0, &camera, &[lamp(3.0)], shapes), folder.path())
    };
    let lens = thin_lens(json!({}), 0.2, 6.0, [4, 4]);
    let small = |x: f64| sphere([x, 0.0, 0.0], 0.3, matte(0.8, [0.5; 3]));
    for (more, effect) in
        [(&lens, Effect::DepthOfField), (&json!({"antialias": 4}), Effect::Antialiasing)]
    {
        let all = u64::from(size[0] * size[1] * 16);
        let empty = of(more, &[]);
        assert_eq!(reason(&empty, effect), (false, "no shape is in view"));
        for rendered in both_alone(&empty) {
            assert_eq!(rendered.counters, Counters::default());
            assert!(rendered.film.pixels().iter().all(|pixel| *pixel == [0.125, 0.25, 0.5]));
        }
        // Two balls: the image is that of a render that casts every ray.
        let scene = of(more, &[small(-1.2), small(0.7)]);
        let mut every = of(more, &[small(-1.2), small(0.7)]);
        every.accel.rebuild(Preset::Brute);
        for (found, every) in both_alone(&scene).iter().zip(&both_alone(&every)) {
            assert!(found.film.same_bits(&every.film));
            assert_eq!(every.counters.primary_rays, all);
            let cast = found.counters.primary_rays;
            assert!(cast > 0 && cast < all / 4, "{cast} of {all}");
            let drawn = if effect == Effect::DepthOfField { cast } else { 0 };
            assert_eq!(found.counters.lens_samples, drawn);
            assert_eq!(found.counters.shadow_rays, every.counters.shadow_rays);
        }
    }
}

/// The command decodes no texture that no ray looks up, whatever it writes, and does not read it for
/// files without metadata.
#[test]
fn a_texture_that_no_ray_meets_is_not_decoded() {
    let folder = files();
    // Its head is right, and its body is not.
    let whole = bytes(folder.path(), "opaque.png");
    put(folder.path(), "half.png", &whole[..whole.len() / 2]);
    for (name, place, radius) in [
        ("under the floor", [0.0, -3.0, 0.0], 1.0),
        ("smaller than a pixel", [0.011, 0.3, 0.0], 1e-6),
    ] {
        let hidden = sphere(place, radius, matte(0.8, [0.5; 3]));
        let json =
            scene(0, &camera(), &[lamp(3.0)], &[floor(), with(hidden, "texture", "half.png")]);
        put(folder.path(), "s.json", json.to_string());
        for image in ["o.ppm", "o.png", "o.exr"] {
            run_well(folder.path(), &["-q", "s.json", image, "--stats", "stats.json"]);
            let textures = json_in(folder.path(), "stats.json")["textures"].take();
            let found = [&textures["decoded"], &textures["bytes"]];
            assert_eq!(found, [&json!(0); 2], "{name}, {image}");
        }
    }
}

/// As they come from other programs: strengths of 0 in glTF, and opaque masks in glTF and MTL files.
#[test]
fn files_of_other_formats_pay_for_nothing_either() {
    let folder = files();
    let at = |name: &str| folder.path().join(name);
    let mut gltf = textured_square(folder.path(), &["opaque.png", "broken.png"]);
    gltf["materials"] = json!([{
        "alphaMode": "MASK", "doubleSided": true,
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0,
                                 "roughnessFactor": 0, "metallicRoughnessTexture": {"index": 1}},
        "normalTexture": {"index": 1, "scale": 0}, "occlusionTexture": {"index": 1, "strength": 0}
    }]);
    put(folder.path(), "m.gltf", gltf.to_string());
    for name in ["m.gltf", "m.obj"] {
        let options = LoadOptions { width: Some(20), height: Some(16), ..LoadOptions::default() };
        let scene = ready(load(&at(name), &options));
        let why = "no image of a cut-out has a transparent texel";
        assert_eq!(reason(&scene, Effect::CutOuts), (false, why), "{name}");
        assert!(scene.accel.geometry().cutouts.is_empty() && scene.appearance.cutouts.is_empty());
        for effect in [Effect::NormalMaps, Effect::MaterialTextures] {
            assert!(!scene.plan.has(effect), "{name}: {}", effect.name());
        }
        let used = scene.appearance.images.iter().map(|image| image.name());
        assert!(used.clone().all(|image| !image.contains("broken")), "{name}");
        assert_eq!(both_alone(&scene)[0].counters.tests.cutouts, 0, "{name}");
    }
}
