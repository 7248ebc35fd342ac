//! Both tracers on small scenes that need different effects, and the wavefront pass by pass over one batch of camera
//! rays: time per ray, and per path.
//!
//! For your own scenes, with checked images and the time of each pass, use `wavecrest bench`. Run
//! with `cargo bench --bench tracers`, and a word to select by name.

use std::path::Path;

use divan::Bencher;
use divan::counter::ItemsCount;
use serde_json::{Value, json};

use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::precision::Exact;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, TracerKind, render};
use wavecrest_core::tile::{Tile, TraceSettings, Tracer, Unit};
use wavecrest_core::wavefront::{DEFAULT_BATCH, Wavefront};
use wavecrest_scene::generate::{Model, Recipe, mesh};
use wavecrest_scene::load::load_str;
use wavecrest_scene::systems;

/// The tracer whose passes are timed.
type Passes = Wavefront<Exact>;

/// Everything but the shapes.
const SCENE: &str = r#"{
    "nbounces": 4,
    "camera": {"type": "pinhole", "width": 160, "height": 120, "fov": 50,
               "location": [0, 1, 4], "look": [0, 0, 0]},
    "scene": {
        "backgroundcolor": [0.1, 0.2, 0.3],
        "lightsources": [{"type": "pointlight", "intensity": 40, "position": [2, 3, 5],
                          "color": [1, 1, 1]}],
        "shapes": []
    }
}"#;

/// The shapes of the scenes.
const SCENES: [&str; 3] = ["spheres", "mesh", "mirrors"];

/// As many pixels as a batch has paths, in the centre of the image.
const TILE: Tile = Tile { x: 64, y: 44, width: 32, height: 32 };

fn main() {
    divan::main();
}

fn material(kr: f64) -> Value {
    json!({"ks": 0.2, "kd": 0.8, "specularexponent": 20, "diffusecolor": [0.8, 0.4, 0.2], "kr": kr})
}

/// Spheres in a row.
fn spheres(kr: f64) -> Result<Vec<Value>> {
    let sphere = |i: i32| {
        let center = [f64::from(i) * 0.8, 0.0, 0.0];
        json!({"type": "sphere", "center": center, "radius": 0.45, "material": material(kr)})
    };
    Ok((-2..=2).map(sphere).collect())
}

/// A displaced sphere of 20 thousand triangles, inline.
fn meshes() -> Result<Vec<Value>> {
    let mesh = mesh(&Recipe::new(Model::Sphere, 20_000))?;
    let points: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    // Fronts are clockwise in a scene file.
    let indices: Vec<[u32; 3]> = mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let material = material(0.0);
    Ok(vec![json!({"type": "trimesh", "points": points, "indices": indices, "material": material})])
}

fn prepare(name: &str) -> Result<PreparedScene> {
    let mut scene: Value = serde_json::from_str(SCENE).unwrap_or_default();
    scene["scene"]["shapes"] = match name {
        "spheres" => spheres(0.0)?,
        "mirrors" => spheres(0.6)?,
        _ => meshes()?,
    }
    .into();
    let loaded = load_str(&scene.to_string(), Path::new("bench.json"), &Default::default())?;
    Ok(systems::extract(loaded.world, Default::default())?.build(Preset::Fast))
}

fn trace(scene: &PreparedScene, tracer: TracerKind) -> Result<Rendered> {
    render(scene, &RenderOptions { tracer, ..RenderOptions::default() }, &())
}

/// Times a tracer after checking it against the other.
fn time(bencher: Bencher<'_, '_>, name: &str, tracer: TracerKind) -> Result<()> {
    let scene = prepare(name)?;
    let (a, b) = (trace(&scene, TracerKind::Wavefront)?, trace(&scene, TracerKind::Recursive)?);
    assert!(a.film.same_bits(&b.film), "{name}: the tracers disagree");
    let counters = a.counters;
    let rays = counters.primary_rays + counters.secondary_rays + counters.shadow_rays;
    bencher.counter(ItemsCount::new(rays)).bench_local(|| trace(&scene, tracer));
    Ok(())
}

/// Stops the program if a scene cannot be prepared.
fn time_or_stop(bencher: Bencher<'_, '_>, name: &str, tracer: TracerKind) {
    let timed = time(bencher, name, tracer);
    assert!(timed.is_ok(), "{name}: {timed:?}");
}

#[divan::bench(args = SCENES, sample_count = 30, sample_size = 1)]
fn wavefront(bencher: Bencher<'_, '_>, name: &str) {
    time_or_stop(bencher, name, TracerKind::Wavefront);
}

#[divan::bench(args = SCENES, sample_count = 30, sample_size = 1)]
fn recursive(bencher: Bencher<'_, '_>, name: &str) {
    time_or_stop(bencher, name, TracerKind::Recursive);
}

/// Times `pass` on a wavefront after the passes before it.
fn time_pass(
    bencher: Bencher<'_, '_>,
    name: &str,
    before: usize,
    mut pass: impl FnMut(&mut Passes, &PreparedScene),
) {
    let prepared = prepare(name);
    assert!(prepared.is_ok(), "{name}: {prepared:?}");
    let Ok(scene) = prepared else { return };
    let settings = TraceSettings { seed: 0, batch: DEFAULT_BATCH, time_passes: false };
    let mut wavefront = Passes::new(&scene, &settings);
    let passes = [generate_all, Passes::intersect, |w: &mut Passes, s: &PreparedScene| {
        w.shade(s, 0);
    }];
    for earlier in passes.iter().take(before) {
        earlier(&mut wavefront, &scene);
    }
    bencher.counter(ItemsCount::new(TILE.len())).bench_local(|| pass(&mut wavefront, &scene));
}

fn generate_all(wavefront: &mut Passes, scene: &PreparedScene) {
    wavefront.generate(scene, &Unit::whole(scene, TILE), 0..TILE.len() as u64);
}

#[divan::bench(args = SCENES)]
fn s1_generate(bencher: Bencher<'_, '_>, name: &str) {
    time_pass(bencher, name, 0, generate_all);
}

#[divan::bench(args = SCENES)]
fn s2_intersect(bencher: Bencher<'_, '_>, name: &str) {
    time_pass(bencher, name, 1, Passes::intersect);
}

#[divan::bench(args = SCENES)]
fn s3_shade(bencher: Bencher<'_, '_>, name: &str) {
    time_pass(bencher, name, 2, |wavefront, scene| wavefront.shade(scene, 0));
}

#[divan::bench(args = SCENES)]
fn s4_shadow(bencher: Bencher<'_, '_>, name: &str) {
    time_pass(bencher, name, 3, |wavefront, scene| {
        wavefront.shadow(scene, 0, &|| false);
    });
}

#[divan::bench(args = SCENES)]
fn s5_resolve(bencher: Bencher<'_, '_>, name: &str) {
    let mut sums = vec![[0.0; 3]; TILE.len()];
    time_pass(bencher, name, 1, |wavefront, _| wavefront.resolve(&mut sums));
}
