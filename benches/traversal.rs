//! Searching the tree with each kernel and each set of vector instructions: time is told for one
//! ray.
//!
//! Coherent rays are those of a camera, in blocks of 8 by 8; random ones are the worst that a tree
//! can meet. They are asked for in batches, as the wavefront does. Run with
//! `cargo bench --bench traversal`, and a word to choose by name, such as `packet`. The mesh has
//! 100 thousand triangles, or as many as the variable `WAVECREST_BENCH_TRIANGLES` says.

use std::fmt;
use std::sync::{LazyLock, Mutex, PoisonError};

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use glam::Vec3;

use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::geometry::Geometry;
use wavecrest_core::accel::{Accel, Hit, KernelChoice, Traversal};
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::Level;
use wavecrest_core::wavefront::DEFAULT_BATCH;
use wavecrest_scene::generate::{Model, Recipe, mesh};

/// Rays in a row and in a column of the coherent ones; there are as many random ones.
const SIDE: u32 = 128;

static ACCEL: LazyLock<Mutex<Accel>> = LazyLock::new(|| {
    let triangles = std::env::var("WAVECREST_BENCH_TRIANGLES");
    let triangles = triangles.ok().and_then(|n| n.parse().ok()).unwrap_or(100_000);
    // Where it cannot be made, the check below says so.
    let mesh = mesh(&Recipe::new(Model::Sphere, triangles)).unwrap_or_default();
    let (positions, triangles) = (mesh.positions, mesh.triangles);
    let geometry = Geometry { positions, triangles, ..Geometry::default() };
    assert!(!geometry.triangles.is_empty(), "the mesh could not be made");
    Mutex::new(Accel::new(geometry, Preset::Fast))
});

fn main() {
    divan::main();
}

/// What is timed.
#[derive(Clone, Copy)]
struct Case {
    coherent: bool,
    kernel: KernelChoice,
    level: Level,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rays = if self.coherent { "coherent" } else { "random" };
        write!(f, "{rays}, {}, {}", self.kernel.name(), self.level.name())
    }
}

/// Every kernel with the best level, and the usual kernel with every other level.
fn cases() -> Vec<Case> {
    let kernels = KernelChoice::ALL.map(|kernel| (kernel, Level::best()));
    let levels = Level::available().into_iter().map(|level| (KernelChoice::Auto, level));
    let others = levels.filter(|(_, level)| *level != Level::best());
    let both: Vec<_> = kernels.into_iter().chain(others).collect();
    let with = |coherent| both.iter().map(move |&(kernel, level)| Case { coherent, kernel, level });
    with(true).chain(with(false)).collect()
}

/// From one point through a grid, block by block; the mesh fills most of it.
fn coherent() -> Vec<Ray> {
    let at = |i: u32| (i as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0;
    let ray = |i: u32| {
        let (block, within) = (i / 64, i % 64);
        let (x, y) = (block % (SIDE / 8) * 8 + within % 8, block / (SIDE / 8) * 8 + within / 8);
        let origin = Vec3::new(0.0, 0.0, 4.0);
        Ray::new(origin, Vec3::new(at(x), at(y), 0.0) - origin)
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

/// Times `ask` over all batches of the case's rays.
fn time<A: Clone>(
    bencher: Bencher<'_, '_>,
    case: &Case,
    none: A,
    ask: impl Fn(&Accel, &[Ray], &mut [A], &mut Traversal),
) {
    let rays = if case.coherent { coherent() } else { random() };
    let mut accel = ACCEL.lock().unwrap_or_else(PoisonError::into_inner);
    accel.kernel = case.kernel;
    accel.level = case.level.token().unwrap_or(accel.level);
    let (accel, mut traversal) = (&*accel, accel.traversal());
    let mut answers = vec![none; DEFAULT_BATCH];
    bencher.counter(ItemsCount::new(rays.len())).bench_local(|| {
        for batch in rays.chunks(DEFAULT_BATCH) {
            ask(accel, black_box(batch), &mut answers[..batch.len()], &mut traversal);
            black_box(&answers);
        }
    });
}

#[divan::bench(args = cases(), sample_count = 30, sample_size = 1)]
fn closest(bencher: Bencher<'_, '_>, case: &Case) {
    time(bencher, case, Hit::MISS, |a, r, h, t| a.closest_of(r, h, t));
}

#[divan::bench(args = cases(), sample_count = 30, sample_size = 1)]
fn occluded(bencher: Bencher<'_, '_>, case: &Case) {
    time(bencher, case, false, |a, r, h, t| a.occluded_of(r, h, t));
}
