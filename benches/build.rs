//! Building the tree with each preset: time is told for one triangle.
//!
//! Run with `cargo bench --bench build`. The mesh has 100 thousand triangles, or as many as the
//! variable `WAVECREST_BENCH_TRIANGLES` says.

use std::sync::LazyLock;

use divan::Bencher;
use divan::counter::ItemsCount;

use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::geometry::Geometry;
use wavecrest_scene::generate::{Model, Recipe, mesh};

static GEOMETRY: LazyLock<Geometry> = LazyLock::new(|| {
    let triangles = std::env::var("WAVECREST_BENCH_TRIANGLES");
    let triangles = triangles.ok().and_then(|n| n.parse().ok()).unwrap_or(100_000);
    // Where it cannot be made, the check below says so.
    let mesh = mesh(&Recipe::new(Model::Sphere, triangles)).unwrap_or_default();
    let (positions, triangles) = (mesh.positions, mesh.triangles);
    let geometry = Geometry { positions, triangles, ..Geometry::default() };
    assert!(!geometry.triangles.is_empty(), "the mesh could not be made");
    geometry
});

fn main() {
    divan::main();
}

/// Of all presets, those that build a tree.
fn presets() -> impl Iterator<Item = Preset> {
    Preset::ALL.into_iter().filter(|&preset| preset != Preset::Brute)
}

#[divan::bench(args = presets(), sample_count = 5, sample_size = 1)]
fn build(bencher: Bencher<'_, '_>, preset: Preset) {
    bencher
        .counter(ItemsCount::new(GEOMETRY.triangles.len()))
        .with_inputs(|| GEOMETRY.clone())
        .bench_local_values(|geometry| Accel::new(geometry, preset));
}
