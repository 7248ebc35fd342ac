//! What cannot be seen costs nothing, and what can be seen costs what it should. Counters are exact, so that
//! "nothing" is 0: the scene with what nobody sees has the image, the counts, the bytes and the passes of the
//! scene without, and its files are not opened.

use std::path::Path;

use image::{Rgba, RgbaImage};
use serde_json::{Value, json};
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::LANES;
use wavecrest_core::plan::Effect;
use wavecrest_core::plan::schedule::UNPLANNED;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, render};
use wavecrest_core::wavefront::batch::Batch;
use wavecrest_scene::load::{LoadOptions, load_str};
use wavecrest_scene::systems::{SceneOptions, extract};

use crate::parity::work;
use crate::planning::effect;
use crate::support::{
    ODD, TRACERS, alternatives, both_alone, bytes, edited, folder, json_in, matte, options,
    pinhole, point_light, prepare_in, put, put_texture, reason, run, scene, sphere, thin_lens,
    try_prepare, wall, with,
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

/// A folder with files that are neither images nor meshes, and with an opaque image.
fn files() -> tempfile::TempDir {
    let folder = folder();
    for name in ["broken.png", "broken.ply"] {
        put(folder.path(), name, "nothing");
    }
    let texel = |x, y| Rgba([50 * x as u8, 50 * y as u8, 99, 255]);
    RgbaImage::from_fn(4, 4, texel).save(folder.path().join("opaque.png")).expect("an image");
    let holes = |x, y| Rgba([9, 9, 9, if (x + y) % 2 == 0 { 255 } else { 0 }]);
    RgbaImage::from_fn(4, 4, holes).save(folder.path().join("holes.png")).expect("an image");
    let white = RgbaImage::from_pixel(4, 4, Rgba([255; 4]));
    white.save(folder.path().join("white.png")).expect("an image");
    folder
}

/// The scene as it is prepared if nothing is left out.
fn complete(json: &Value, folder: &Path) -> PreparedScene {
    prepare_in(folder, json, SceneOptions { passes: &UNPLANNED, ..SceneOptions::default() })
}

/// In what the cost and the image of a scene differ from those of another.
pub(crate) fn differences(found: &PreparedScene, expected: &PreparedScene) -> Vec<&'static str> {
    let of = |scene: &PreparedScene| (scene.accel.geometry().held(), scene.bytes());
    let [(held, bytes), (usual_held, usual_bytes)] = [found, expected].map(of);
    let appearance = |scene: &PreparedScene| scene.appearance.bytes();
    let by_path = Batch::bytes_per_path(found) == Batch::bytes_per_path(expected);
    let mut all = vec![
        ("passes", found.plan.schedule() == expected.plan.schedule()),
        ("columns", by_path),
        ("images held", appearance(found) == appearance(expected)),
        ("attributes held", bytes == usual_bytes),
        ("primitives held", held == usual_held),
    ];
    for (found, expected) in both_alone(found).iter().zip(&both_alone(expected)) {
        all.push(("the image", found.film.same_bits(&expected.film)));
        // Whatever is counted, tests of boxes too.
        all.push(("counts", found.counters == expected.counters));
        all.push(("bytes of columns", found.columns == expected.columns));
    }
    all.into_iter().filter(|(_, is_same)| !is_same).map(|(what, _)| what).collect()
}

/// What short names stand for in the scenes of transcripts.
fn written_out(text: &str) -> String {
    let mesh = json!({
        "type": "trimesh", "name": "m", "indices": [[0, 1, 2], [0, 2, 3]], "shading": "smooth",
        "points": [[-2, 0, 9], [-2, 4, 9], [2, 4, 9], [2, 0, 9]], "filter": "trilinear",
        "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]], "texture": "broken.png",
        "normals": [[0, 0, -1], [0, 0, -1], [0, 0, -1], [0, 0.1, -1]],
        "material": with(matte(0.8, [0.5; 3]), "kr", 0.5)});
    let panel = json!({
        "type": "trimesh", "indices": [[0, 1, 2], [0, 2, 3]], "material": matte(0.8, [0.5; 3]),
        "points": [[-2, 0, -2], [-2, 2, -2], [2, 2, -2], [2, 0, -2]]});
    text.replace("$mesh", &mesh.to_string())
        .replace("$panel", &panel.to_string())
        .replace("$matte", &matte(0.8, [0.5; 3]).to_string())
        .replace("$shiny", &with(matte(0.8, [0.5; 3]), "kr", 0.5).to_string())
}

/// A floor, a ball and a lamp are edited as the lines say: those that begin with `+` are what nobody sees, and with `-` what
/// is there instead. An input is the effects that are looked at, and the answer is why the plan has none; entries without `+`
/// show when it has. Where the files can be read, leaving nothing out gives the same images, but `nearly` the same where what
/// is left out is too small to be seen.
#[test]
fn what_nobody_sees_costs_nothing() {
    let (folder, readable) = (files(), files());
    let image = readable.path().join("opaque.png");
    std::fs::copy(image, readable.path().join("broken.png")).expect("a copy");
    let ball = sphere([0.0; 3], 0.8, with(matte(0.8, [0.5; 3]), "ks", 0.5));
    let usual = scene(2, &camera(), &[lamp(3.0)], &[floor(), ball]);
    transcript::check("unseen", |names, changes| {
        let (names, is_same) = match names.strip_suffix(", nearly") {
            Some(names) => (names, false),
            None => (names, true),
        };
        let (names, precision) = match names.strip_suffix(" in fast precision") {
            Some(names) => (names, Precision::Fast),
            None => (names, Precision::Exact),
        };
        let changes = written_out(changes);
        let [with, without] = alternatives(&usual, &changes);
        let prepared = |json: &Value, folder: &Path| -> Result<PreparedScene> {
            let file = folder.join("s.json");
            let loaded = load_str(&json.to_string(), &file, &LoadOptions::default())?;
            let options = SceneOptions { precision, ..SceneOptions::default() };
            Ok(extract(loaded.world, options)?.build(Preset::Fast))
        };
        let [found, expected] = [&with, &without].map(|json| prepared(json, folder.path()));
        let found = match found {
            Ok(found) => found,
            Err(error) => return format!("refused: {error}"),
        };
        let mut answer = String::new();
        if precision == Precision::Exact {
            let differing = differences(&found, &expected.expect("a scene"));
            if !differing.is_empty() {
                answer += &format!("other {}\n", differing.join(", "));
            }
            let planned = both_alone(&prepared(&with, readable.path()).expect("a scene"));
            for rendered in planned.iter().chain(&both_alone(&complete(&with, readable.path()))) {
                assert!(!is_same || rendered.film.same_bits(&planned[0].film), "{changes}");
            }
        }
        for name in names.split(", ") {
            let (is_present, why) = reason(&found, effect(name));
            answer += &format!("{}{why}\n", if is_present { "present: " } else { "" });
        }
        answer
    });
}

/// Bytes of the columns of a batch, without rays that wait.
fn column_bytes(scene: &PreparedScene) -> u64 {
    let each: usize = Batch::bytes_per_path(scene).iter().map(|(_, bytes)| bytes).sum();
    (each * (ODD + LANES)) as u64
}

/// What a scene of `pixels` pixels costs: counts of each by the pixel, kinds of shapes that rays were tested with, columns
/// that have storage, and images.
fn cost(scene: &PreparedScene, pixels: u64) -> String {
    let [wavefront, recursive] = both_alone(scene);
    let counts = wavefront.counters;
    assert_eq!(work(&counts), work(&recursive.counters), "the tracers do not do the same work");
    assert!(wavefront.film.same_bits(&recursive.film));
    let full = column_bytes(scene);
    // Rays that wait take more, and not every path has one.
    let [least, most] =
        if scene.plan.has(Effect::Transparency) { [full / 2, u64::MAX] } else { [full; 2] };
    let is_stored = counts.rays.primary > 0 && !scene.plan.has(Effect::TintedHighlights);
    let columns = if is_stored { least..=most } else { 0..=most };
    assert!(columns.contains(&wavefront.columns) && recursive.columns == 0, "{wavefront:?}");
    let by_pixel = [
        ("camera rays", counts.rays.primary),
        ("secondary rays", counts.rays.secondary),
        ("shadow rays", counts.rays.shadow),
        ("points on lenses", counts.samples.lens),
        ("points on lights", counts.samples.light),
        ("vertex colours", counts.samples.colors),
        ("texels", counts.samples.texels),
        ("footprints", counts.samples.footprints),
    ];
    let by_pixel = by_pixel.iter().filter(|(_, count)| *count > 0);
    let by_pixel =
        by_pixel.map(|&(name, count)| format!("{name} {}", count as f64 / pixels as f64));
    let tests = [counts.tests, recursive.counters.tests];
    let kinds = [
        ("triangles", tests.map(|tests| tests.primitives.triangles)),
        ("quads", tests.map(|tests| tests.primitives.quads)),
        ("spheres", tests.map(|tests| tests.primitives.spheres)),
        ("disks", tests.map(|tests| tests.primitives.disks)),
        ("cut-outs", tests.map(|tests| tests.cutouts)),
    ];
    let kinds =
        kinds.iter().filter(|(_, tests)| *tests != [0; 2]).map(|(kind, _)| (*kind).to_owned());
    let columns = Batch::bytes_per_path(scene).into_iter().map(|(name, _)| name.to_owned());
    let list = |name: &str, all: Vec<String>| {
        if all.is_empty() { String::new() } else { format!("{name}: {}\n", all.join(", ")) }
    };
    let images = scene.appearance.images.iter().map(|image| image.name().to_owned());
    [
        list("by the pixel", by_pixel.collect()),
        list("tests of", kinds.collect()),
        list("columns", columns.collect()),
        list("images", images.collect()),
    ]
    .concat()
}

/// A wall that fills the picture, of half a mirror, a wall behind the eye that it shows, and a lamp, edited as the lines say.
#[test]
fn what_is_seen_costs_what_it_should() {
    let folder = folder();
    put_texture(folder.path());
    let mirror = wall(50.0, 0.0, with(matte(0.8, [0.5; 3]), "kr", 0.5));
    let behind = with(wall(50.0, 9.0, matte(0.8, [0.5; 3])), "normal", json!([0, 0, -1]));
    let lamp = point_light(30.0, [1.0, 2.0, 4.0], [1.0; 3]);
    let usual = scene(0, &pinhole([16, 12], 40.0, 5.0), &[lamp], &[mirror, behind]);
    transcript::check("costs", |_, changes| {
        let json = edited(usual.clone(), &written_out(changes));
        cost(&prepare_in(folder.path(), &json, SceneOptions::default()), 16 * 12)
    });
}

/// A lens and antialiasing cast no ray where no shape can be: the image is that of a render that casts every ray.
#[test]
fn pixels_without_shapes_cost_nothing() {
    let small = |x: f64| sphere([x, 0.0, 0.0], 0.3, matte(0.8, [0.5; 3]));
    let camera = pinhole([64, 48], 40.0, 6.0);
    let lens = thin_lens(camera.clone(), 0.2, 6.0, [4, 4]);
    for camera in [lens, with(camera, "antialias", 4)] {
        let json = scene(0, &camera, &[lamp(3.0)], &[small(-1.2), small(0.7)]);
        let [scene, mut every] =
            [(); 2].map(|()| prepare_in(Path::new(""), &json, SceneOptions::default()));
        every.accel.rebuild(Preset::Brute);
        for (found, every) in both_alone(&scene).iter().zip(&both_alone(&every)) {
            assert!(found.film.same_bits(&every.film));
            let [cast, all] = [found, every].map(|rendered| rendered.counters.rays.primary);
            assert_eq!(all, 64 * 48 * 16);
            assert!(cast > 0 && cast < all / 4, "{cast} of {all}");
            let drawn = if scene.camera.has_lens() { cast } else { 0 };
            assert_eq!(found.counters.samples.lens, drawn);
            let mut others = work(&every.counters);
            (others.rays.primary, others.samples.lens) = (cast, drawn);
            assert_eq!(work(&found.counters), others);
        }
    }
}

/// A texture that others hide, or too small for any ray, is looked at no further than its head.
#[test]
fn a_texture_that_no_ray_meets_is_not_decoded() {
    let folder = files();
    // Its head is right, and its body is not.
    let whole = bytes(folder.path(), "opaque.png");
    put(folder.path(), "t.png", &whole[..whole.len() / 2]);
    let of = |shape: Value| {
        let shape = with(shape, "texture", "t.png");
        scene(2, &camera(), &[lamp(3.0)], &[shape, floor()])
    };
    let shiny = with(matte(0.8, [0.5; 3]), "kr", 0.5);
    let under = of(sphere([0.0, -3.0, 0.0], 1.0, shiny.clone()));
    let tiny = of(sphere([0.011, 0.3, 0.0], 1e-6, shiny.clone()));
    let seen = of(sphere([0.0; 3], 1.0, shiny));
    let file = folder.path().join("s.json");
    for (json, code) in [(under, 0), (tiny, 0), (seen.clone(), 2)] {
        let scene = try_prepare(&json, &file).expect("its head is right");
        assert!(scene.plan.has(Effect::Textures) && scene.plan.has(Effect::Mirrors));
        if code == 0 {
            // Rays that are never cast have no columns.
            assert!(both_alone(&scene)[0].columns < column_bytes(&scene));
        }
        for tracer in TRACERS {
            match render(&scene, &RenderOptions { tracer, ..options() }, &()) {
                Ok(rendered) => assert_eq!((rendered.counters.rays.secondary, code), (0, 0)),
                Err(error) => {
                    assert!(error.to_string().contains("scene.shapes[0].texture: cannot"))
                }
            }
        }
        put(folder.path(), "s.json", json.to_string());
        for image in ["o.ppm", "o.png", "o.exr"] {
            let found = run(folder.path(), &["-q", "s.json", image, "--stats", "stats.json"]);
            assert_eq!(found.status.code(), Some(code), "{image}");
            assert_eq!(folder.path().join(image).exists(), code == 0, "{image}");
            if code == 0 {
                let textures = json_in(folder.path(), "stats.json")["textures"].take();
                assert_eq!([&textures["decoded"], &textures["bytes"]], [&json!(0); 2], "{image}");
                std::fs::remove_file(folder.path().join(image)).expect("an image");
            }
        }
        let check = run(folder.path(), &["check", "s.json"]);
        assert_eq!(check.status.code(), Some(2), "what is checked is read to its end");
    }
    // A head that is wrong is an error at the start.
    put(folder.path(), "t.png", &whole[..20]);
    let told = try_prepare(&seen, &file).map(drop).expect_err("its head is wrong").to_string();
    assert!(told.contains("scene.shapes[0].texture"), "{told}");
}
