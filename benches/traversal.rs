//! Searching the tree over a mesh of 100 thousand triangles: time is told for one ray.
//!
//! Coherent rays are those of a camera, random ones are the worst that a tree can meet.
//! Run with `cargo bench --bench traversal`.

use std::sync::LazyLock;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use glam::Vec3;

use wavecrest::accel::Accel;
use wavecrest::accel::build::Preset;
use wavecrest::accel::geometry::Geometry;
use wavecrest::generate::{Model, Recipe, mesh};
use wavecrest::math::random::Stream;
use wavecrest::math::ray::Ray;

const TRIANGLES: u64 = 100_000;
/// Rays in a row and in a column of the coherent ones; there are as many random ones.
const SIDE: u32 = 128;

static GEOMETRY: LazyLock<Geometry> = LazyLock::new(|| {
    // The sphere is known to be possible; without it there would be nothing to time.
    let mesh = mesh(&Recipe::new(Model::Sphere, TRIANGLES)).unwrap_or_default();
    Geometry { positions: mesh.positions, triangles: mesh.triangles, ..Geometry::default() }
});

static ACCEL: LazyLock<Accel> = LazyLock::new(|| Accel::new(GEOMETRY.clone(), Preset::Fast));

fn main() {
    assert!(GEOMETRY.triangles.len() as u64 >= TRIANGLES, "the mesh could not be made");
    divan::main();
}

/// From one point through a grid, row by row; the mesh fills most of it.
fn coherent() -> Vec<Ray> {
    let at = |i: u32| (i as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0;
    let ray = |i: u32| {
        let target = Vec3::new(at(i % SIDE), at(i / SIDE), 0.0);
        let origin = Vec3::new(0.0, 0.0, 4.0);
        Ray::new(origin, target - origin)
    };
    (0..SIDE * SIDE).map(ray).collect()
}

/// Between two points anywhere about the mesh and within it.
fn random() -> Vec<Ray> {
    let ray = |pixel| {
        let stream = Stream { seed: 2, pixel, sample: 0, bounce: 0 };
        let point = |dimension| {
            let [x, y, z, _] = stream.uniform(dimension);
            Vec3::new(x, y, z) * 4.0 - 2.0
        };
        Ray { t_max: 1.0, ..Ray::new(point(0), point(1) - point(0)) }
    };
    (0..SIDE * SIDE).map(ray).collect()
}

fn rays(kind: &str) -> Vec<Ray> {
    if kind == "coherent" { coherent() } else { random() }
}

#[divan::bench(args = ["coherent", "random"], sample_count = 30, sample_size = 1)]
fn closest(bencher: Bencher<'_, '_>, kind: &str) {
    let (rays, mut traversal) = (rays(kind), ACCEL.traversal());
    bencher.counter(ItemsCount::new(rays.len())).bench_local(|| {
        for ray in &rays {
            black_box(ACCEL.closest(black_box(ray), &mut traversal));
        }
    });
}

#[divan::bench(args = ["coherent", "random"], sample_count = 30, sample_size = 1)]
fn occluded(bencher: Bencher<'_, '_>, kind: &str) {
    let (rays, mut traversal) = (rays(kind), ACCEL.traversal());
    bencher.counter(ItemsCount::new(rays.len())).bench_local(|| {
        for ray in &rays {
            black_box(ACCEL.occluded(black_box(ray), &mut traversal));
        }
    });
}

/// The tree itself: time is told for one triangle.
#[divan::bench(args = [Preset::Fastest, Preset::VeryFast, Preset::Fast, Preset::Medium],
               sample_count = 5, sample_size = 1)]
fn build(bencher: Bencher<'_, '_>, preset: Preset) {
    bencher
        .counter(ItemsCount::new(GEOMETRY.triangles.len()))
        .with_inputs(|| GEOMETRY.clone())
        .bench_local_values(|geometry| Accel::new(geometry, preset));
}
