//! What is out of view: effects that nobody sees are not simulated, their files not read, their columns not stored;
//! and the image keeps its bits.

use std::path::Path;

use rayon::prelude::*;
use serde_json::{Value, json};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::random::Stream;
use wavecrest_core::plan::Effect;
use wavecrest_core::plan::schedule::{PASSES, unplanned};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, render};
use wavecrest_core::wavefront::batch::Batch;
use wavecrest_scene::systems::Options;

use crate::support::{
    TRACERS, both, both_alone, bytes, edited, folder, matte, options, pinhole, point_light,
    prepare_in, put, put_texture, reason, refusal, render_on, run, scene, sphere, thin_lens,
    try_prepare, wall, with,
};

fn prepare(json: &Value, folder: &Path, planned: bool, precision: Precision) -> PreparedScene {
    let everything = unplanned(&PASSES);
    let passes = if planned { &PASSES[..] } else { &everything };
    prepare_in(folder, json, Options { passes, precision, flat: false })
}

/// A floor seen from above, and a point light over it.
fn floor() -> (Value, Value, Value) {
    let camera = with(pinhole([32, 24], 40.0, 5.0), "location", json!([0, 2, 5]));
    let floor = json!({"type": "plane", "material": matte(0.8, [0.5; 3]), "normal": [0, 1, 0],
                       "points": [[-9, -1, 9], [-9, -1, -9], [9, -1, -9], [9, -1, 9]]});
    (camera, point_light(50.0, [1.0, 3.0, 1.0], [1.0; 3]), floor)
}

/// Mirrors that wear a texture, and an area light that shines on them alone: all behind the eye.
fn behind(texture: &str) -> (Value, Vec<Value>) {
    let light = json!({"type": "arealight", "intensity": 50, "color": [1, 1, 1], "sampling": "random",
                       "samples": 4, "shape": {"type": "sphere", "center": [0, -4, 12], "radius": 1}});
    let shiny = with(with(matte(0.8, [0.5; 3]), "kr", 0.5), "ks", 0.5);
    let worn = |shape: Value| with(with(shape, "texture", texture), "filter", "trilinear");
    let ball = worn(sphere([0.0, 2.0, 10.0], 1.0, shiny.clone()));
    let mesh = worn(json!({
        "type": "trimesh", "indices": [[0, 1, 2], [0, 2, 3]], "shading": "smooth", "material": shiny,
        "points": [[-2, 0, 9], [-2, 4, 9], [2, 4, 9], [2, 0, 9]],
        "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]],
        "normals": [[0, 0, -1], [0, 0, -1], [0, 0, -1], [0, 0.1, -1]],
    }));
    (light, vec![ball, mesh])
}

/// The scene with what is behind the eye, and the scene without.
fn with_and_without(texture: &str) -> [Value; 2] {
    let (camera, lamp, floor) = floor();
    let (light, mut shapes) = behind(texture);
    let without = scene(3, &camera, std::slice::from_ref(&lamp), std::slice::from_ref(&floor));
    shapes.push(floor);
    [scene(3, &camera, &[light, lamp], &shapes), without]
        .map(|scene| edited(scene, "/scene/ambient 0"))
}

#[test]
fn what_lies_behind_the_camera_is_not_read_not_stored_and_not_simulated() {
    let folder = folder();
    // It is not so much as opened: it is no image.
    put(folder.path(), "broken.png", "no image");
    put_texture(folder.path());
    let [full, without] = with_and_without("broken.png");
    let [found, expected] =
        [full, without].map(|json| prepare(&json, folder.path(), true, Precision::Exact));
    assert_eq!(found.plan.schedule(), expected.plan.schedule());
    assert_eq!(Batch::bytes_per_path(&found), Batch::bytes_per_path(&expected));
    assert_eq!((found.appearance.images.len(), found.appearance.bytes()), (0, 0));
    assert_eq!((found.lights.len(), found.bounces), (1, 0));
    for (effect, why) in [
        (Effect::Textures, "2 textured shapes, not in view"),
        (Effect::RayDifferentials, "2 trilinear textures, not in view"),
        (Effect::SmoothShading, "1 smooth mesh, not in view"),
        (Effect::Mirrors, "2 mirrors, not in view"),
        (Effect::AreaLights, "no area light shines on anything in view"),
    ] {
        assert_eq!(reason(&found, effect), (false, why));
    }
    let all = prepare(&with_and_without("t.png")[0], folder.path(), false, Precision::Exact);
    assert_eq!((all.appearance.images.len(), all.lights.len(), all.bounces), (1, 2, 3));
    let [found, expected, complete] = [&found, &expected, &all].map(both_alone);
    for ((found, expected), complete) in found.iter().zip(&expected).zip(&complete) {
        let [a, b] = [&found.counters, &expected.counters];
        assert_eq!((a.secondary_rays, a.light_samples, a.texels, a.footprints), (0, 0, 0, 0));
        assert_eq!((a.primary_rays, a.shadow_rays), (b.primary_rays, b.shadow_rays));
        assert_eq!(found.columns, expected.columns);
        assert!(found.film.same_bits(&expected.film) && found.film.same_bits(&complete.film));
        assert!(complete.counters.light_samples > 0, "they cost where nothing is left out");
    }
}

#[test]
fn a_mirror_in_view_shows_what_is_behind_the_eye() {
    let folder = folder();
    put_texture(folder.path());
    let of = |kr: f64, bounces: u32| {
        let (camera, lamp, floor) = floor();
        let (light, mut shapes) = behind("t.png");
        shapes.push(with(floor, "material", with(matte(0.8, [0.5; 3]), "kr", kr)));
        let json = scene(bounces, &camera, &[light, lamp], &shapes);
        let prepared = prepare(&json, folder.path(), true, Precision::Exact);
        (reason(&prepared, Effect::Textures).0, prepared.lights.len())
    };
    assert_eq!(of(0.5, 1), (true, 2));
    assert_eq!(of(0.0, 1), (false, 1));
    assert_eq!(of(0.5, 0), (false, 1), "without a bounce it shows nothing");
}

/// Whether the texture of `shape` is found to be in view of `camera`.
fn is_seen(camera: &Value, shape: Value, others: &[Value], precision: Precision) -> bool {
    let folder = folder();
    put_texture(folder.path());
    let mut shapes = vec![with(shape, "texture", "t.png")];
    shapes.extend_from_slice(others);
    let json = scene(1, camera, &[point_light(9.0, [0.0, 9.0, 9.0], [1.0; 3])], &shapes);
    reason(&prepare(&json, folder.path(), true, precision), Effect::Textures).0
}

#[test]
fn spheres_hide_what_is_in_them_and_what_is_around_them_from_within() {
    let camera = pinhole([8, 6], 40.0, 5.0);
    let ball = |radius: f64, z: f64| sphere([0.0, 0.0, z], radius, matte(0.8, [0.5; 3]));
    let sees = |shape: Value, others: &[Value]| is_seen(&camera, shape, others, Precision::Exact);
    assert!(sees(ball(0.5, 0.0), &[]));
    assert!(!sees(ball(0.5, 0.0), &[ball(1.0, 0.0)]), "enclosed");
    assert!(sees(ball(0.5, 0.0), &[ball(0.5, 0.0)]), "in the same place");
    assert!(sees(ball(0.5, 0.0), &[ball(1.0, 0.7)]), "half of it");
    assert!(sees(ball(0.5, 0.0), &[ball(9.0, 0.0)]), "the eye is within, too");
    assert!(!sees(ball(0.5, -9.0), &[ball(9.0, 3.0)]), "around the eye");
    assert!(!sees(wall(3.0, -9.0, matte(0.8, [0.5; 3])), &[ball(1.0, 5.0)]), "around the eye");
    let light = |ball: Value| with(ball, "material", with(matte(0.8, [0.5; 3]), "kr", 0.9));
    assert!(sees(ball(0.5, 0.0), &[ball(1.0, 0.0), light(ball(1.0, -3.0))]), "a mirror is in view");
    let fast = is_seen(&camera, ball(0.5, 0.0), &[ball(1.0, 0.0)], Precision::Fast);
    assert!(fast, "nothing is certain in fast arithmetic");
}

#[test]
fn a_texture_is_in_view_if_any_frame_shows_it() {
    let behind = sphere([0.0, 0.0, 9.0], 1.0, matte(0.8, [0.5; 3]));
    let with_keys = |keys: Value| with(pinhole([8, 6], 40.0, 5.0), "path", json!({"keys": keys}));
    let still = json!([{"frame": 1}, {"frame": 30, "location": [1, 0, 5]}]);
    let turning = json!([{"frame": 1}, {"frame": 30, "look": [0.5, 0, 10]}]);
    let endless = json!([{"frame": 1}, {"frame": 4_000_000, "location": [1, 0, 5]}]);
    for (keys, expected) in [(still, false), (turning, true), (endless, true)] {
        let seen = is_seen(&with_keys(keys.clone()), behind.clone(), &[], Precision::Exact);
        assert_eq!(seen, expected, "{keys}");
    }
}

#[test]
fn what_others_hide_is_looked_at_no_further_than_its_head() {
    let folder = folder();
    put_texture(folder.path());
    let image = bytes(folder.path(), "t.png");
    let shiny = with(matte(0.8, [0.5; 3]), "kr", 0.5);
    let of = |front: f64| {
        let camera = pinhole([16, 12], 40.0, 5.0);
        let hidden = with(wall(1.0, -1.0, shiny.clone()), "texture", "t.png");
        let front = wall(front, 0.0, matte(0.8, [0.5; 3]));
        scene(2, &camera, &[point_light(9.0, [0.0, 2.0, 6.0], [1.0; 3])], &[hidden, front])
    };
    let file = folder.path().join("scene.json");
    for (front, seen) in [(9.0, 0), (0.1, 1)] {
        let prepared = try_prepare(&of(front), &file).expect("a scene");
        assert!(prepared.plan.has(Effect::Textures) && prepared.plan.has(Effect::Mirrors));
        let [wavefront, recursive] =
            TRACERS.map(|tracer| render_on(4, &prepared, &RenderOptions { tracer, ..options() }));
        assert!(wavefront.film.same_bits(&recursive.film));
        let images = &prepared.appearance.images;
        assert_eq!(images.iter().filter(|image| image.decoded().is_some()).count(), seen);
        assert_eq!(wavefront.counters.secondary_rays > 0, seen > 0);
        // Rays that are never cast have no columns: the next ones have as many as those of this bounce.
        let one = render_on(1, &prepared, &options()).columns;
        let next =
            Batch::bytes_per_path(&prepared).into_iter().find(|(name, _)| *name == "next rays");
        let missing = Batch::estimated_bytes(&prepared, 1024) - one;
        assert_eq!(missing > 0, seen == 0, "{missing} {next:?}");
    }
    // A file whose head is right and whose body is not: an error where it is looked up, and nowhere else.
    put(folder.path(), "t.png", &image[..image.len() / 2]);
    let broken = try_prepare(&of(0.1), &file).expect("its head is right");
    for tracer in TRACERS {
        let error = render(&broken, &RenderOptions { tracer, ..options() }, &()).err();
        let told = error.expect("it is broken").to_string();
        assert!(told.contains("scene.shapes[0].texture: cannot read the texture"), "{told}");
    }
    let hidden = try_prepare(&of(9.0), &file).expect("its head is right");
    assert!(both(&hidden).iter().all(|rendered| rendered.finished));
    for (front, code) in [(0.1, 2), (9.0, 0)] {
        std::fs::write(&file, of(front).to_string()).expect("a file");
        let found = run(folder.path(), &["-q", "scene.json", "o.pfm"]);
        assert_eq!(found.status.code(), Some(code));
        assert_eq!(folder.path().join("o.pfm").exists(), code == 0);
        let check = run(folder.path(), &["check", "scene.json"]);
        assert_eq!(check.status.code(), Some(2), "what is checked is read to its end");
    }
    // A head that is wrong is an error at the start.
    put(folder.path(), "t.png", &image[..20]);
    assert!(refusal(&of(9.0), &file).to_string().contains("scene.shapes[0].texture"));
}

/// Numbers from 0 to 1 that follow from a seed.
struct Numbers(Stream, u32);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.1 += 1;
        f64::from(self.0.uniform(self.1)[0])
    }

    fn below(&mut self, n: u32) -> u32 {
        (self.next() * f64::from(n)) as u32
    }

    fn point(&mut self, size: f64) -> [f64; 3] {
        [0; 3].map(|_| (self.next() * 2.0 - 1.0) * size)
    }
}

/// A scene of a few shapes and lights all around the eye.
fn around_the_eye(seed: u32) -> Value {
    let n = &mut Numbers(Stream { seed: 5, pixel: seed, sample: 0, bounce: 0 }, 0);
    let far = [0.0, 0.0, 5_000.0][n.below(3) as usize];
    let at = |p: [f64; 3]| p.map(|x| x + far);
    let mut camera = pinhole([8, 6], 20.0 + 120.0 * n.next(), 5.0);
    (camera["location"], camera["look"]) = (json!(at([0.0; 3])), json!(at(n.point(1.0))));
    if n.below(3) == 0 {
        camera = thin_lens(camera, n.next(), 1.0 + 4.0 * n.next(), [2, 1]);
    }
    if n.below(4) == 0 {
        let keys = json!([{"frame": 0}, {"frame": 3, "location": at(n.point(0.5))}]);
        camera["path"] = json!({"keys": keys});
    }
    let mut shapes = Vec::new();
    for _ in 0..1 + n.below(5) {
        let kr = if n.below(5) == 0 { 0.5 } else { 0.0 };
        let material = with(with(matte(0.7, [0.9, 0.6, 0.3]), "kr", kr), "ks", 0.3);
        let [a, b, c] = [n.point(4.0), n.point(4.0), n.point(4.0)];
        let d = [0, 1, 2].map(|k| a[k] + c[k] - b[k]);
        let size = [0.3, 1.0, 8.0][n.below(3) as usize];
        let mut shape = match n.below(4) {
            0 => sphere(at(a), size, material),
            1 => {
                json!({"type": "plane", "points": [at(a), at(b), at(c), at(d)], "material": material})
            }
            2 => json!({"type": "triangle", "points": [at(a), at(b), at(c)], "material": material}),
            _ => {
                json!({"type": "trimesh", "points": [at(a), at(b), at(c), at(d)], "material": material,
                        "indices": [[0, 1, 2], [0, 2, 3]], "shading": "smooth",
                        "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]],
                        "normals": [[0, 0, 1], [0, 1, 1], [1, 0, 1], [0, 0, 1]]})
            }
        };
        if n.below(2) == 0 {
            shape["texture"] = "t.png".into();
            shape["filter"] = ["bilinear", "trilinear"][n.below(2) as usize].into();
        }
        shapes.push(shape);
    }
    let mut lights = vec![point_light(30.0, at(n.point(5.0)), [1.0, 0.9, 0.8])];
    for _ in 0..n.below(3) {
        let center = at(n.point(5.0));
        lights.push(json!({"type": "arealight", "intensity": 20, "color": [0.8, 0.9, 1.0],
                           "sampling": "random", "samples": 2,
                           "shape": {"type": "sphere", "center": center, "radius": 0.1 + n.next()}}));
    }
    let mut scene = scene(n.below(3), &camera, &lights, &shapes);
    if n.below(3) == 0 {
        let instance =
            |shape: &str, by: [f64; 3]| json!({"shape": shape, "transform": {"translate": by}});
        let instances = [instance("one", n.point(6.0)), instance("one", n.point(6.0))];
        shapes[0]["name"] = "one".into();
        scene["scene"]["shapes"] = json!(shapes);
        scene["scene"]["instances"] = json!(instances);
    }
    scene
}

#[test]
fn what_is_out_of_view_changes_no_bit_of_any_scene() {
    let folder = folder();
    put_texture(folder.path());
    let left_out: usize = (0..600_u32)
        .into_par_iter()
        .map(|seed| {
            let json = around_the_eye(seed);
            let precision = Precision::ALL[seed as usize % Precision::ALL.len()];
            let [mut planned, mut all] =
                [true, false].map(|planned| prepare(&json, folder.path(), planned, precision));
            let frames = planned.path.as_ref().map_or(0..=0, |path| path.frames());
            for frame in frames {
                for scene in [&mut planned, &mut all] {
                    let moved = scene.path.as_ref().and_then(|path| path.at(frame));
                    scene.camera = moved.unwrap_or(scene.camera);
                }
                let [found, expected] = [both(&planned), both(&all)];
                for rendered in found.iter().chain(&expected) {
                    let same = rendered.film.same_bits(&found[0].film);
                    assert!(same, "{seed}, frame {frame}: {json}");
                }
            }
            usize::from(planned.plan.decisions().iter().any(|d| d.reason.contains("in view")))
        })
        .sum();
    assert!(left_out > 100, "{left_out}");
}
