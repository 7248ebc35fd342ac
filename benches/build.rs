//! Building the tree with each preset: time per triangle.
//!
//! Run with `cargo bench --bench build`. The meshes, a scan and a room, have 100 thousand
//! triangles, or the number in the variable `WAVECREST_BENCH_TRIANGLES`.

use divan::Bencher;
use divan::counter::ItemsCount;

use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_scene::generate::{Model, Recipe, mesh};

fn geometry(model: Model) -> Geometry {
    let triangles = std::env::var("WAVECREST_BENCH_TRIANGLES");
    let triangles = triangles.ok().and_then(|n| n.parse().ok()).unwrap_or(100_000);
    // If this fails, the check below reports it.
    let mesh = mesh(&Recipe::new(model, triangles)).unwrap_or_default();
    let (positions, triangles) = (mesh.positions, mesh.triangles);
    let geometry = Geometry { positions, triangles, ..Geometry::default() };
    assert!(!geometry.triangles.is_empty(), "the {model} could not be made");
    geometry
}

fn main() {
    divan::main();
}

/// The presets that build a tree.
fn presets() -> impl Iterator<Item = Preset> {
    Preset::ALL.into_iter().filter(|&preset| preset != Preset::Brute)
}

fn build(bencher: Bencher<'_, '_>, model: Model, preset: Preset) {
    let geometry = geometry(model);
    bencher
        .counter(ItemsCount::new(geometry.triangles.len()))
        .with_inputs(|| geometry.clone())
        .bench_local_values(|geometry| Accel::new(geometry, preset));
}

#[divan::bench(args = presets(), sample_count = 5, sample_size = 1)]
fn scan(bencher: Bencher<'_, '_>, preset: Preset) {
    build(bencher, Model::Sphere, preset);
}

#[divan::bench(args = presets(), sample_count = 5, sample_size = 1)]
fn room(bencher: Bencher<'_, '_>, preset: Preset) {
    build(bencher, Model::Room, preset);
}
