//! Building the tree with each preset, time per triangle; and searching it with each kernel and each instruction
//! level, time per ray.
//!
//! A scan has triangles of one size, a room triangles of all sizes: a kernel that is fast in one
//! may be slow in the other. Coherent rays are those of a camera, in blocks of 8 by 8; random ones
//! are the worst case of a tree. They are searched in batches, as in the wavefront. Run with `cargo
//! bench --bench trees`, and a word to select by name, such as `build`, `packet` or `room`. The meshes
//! have 100 thousand triangles, or the number in the variable `WAVECREST_BENCH_TRIANGLES`.

use std::fmt;
use std::sync::{LazyLock, Mutex, PoisonError};

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use glam::Vec3;

use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, Hit, KernelChoice, Traversal};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::Level;
use wavecrest_core::wavefront::DEFAULT_BATCH;
use wavecrest_scene::generate::{self, Model, Recipe};

// The room of the example.
#[path = "../examples/room/furniture.rs"]
mod furniture;
#[path = "../examples/room/solids.rs"]
mod solids;

/// Coherent rays in each row and column; there are as many random ones.
const SIDE: u32 = 128;

/// The mesh to search.
#[derive(Clone, Copy)]
enum Mesh {
    Scan,
    Room,
}

static MESHES: [LazyLock<Mutex<Accel>>; 2] = [
    LazyLock::new(|| Mutex::new(Accel::new(geometry(Mesh::Scan), Preset::Fast))),
    LazyLock::new(|| Mutex::new(Accel::new(geometry(Mesh::Room), Preset::Fast))),
];

fn geometry(mesh: Mesh) -> Geometry {
    let triangles = std::env::var("WAVECREST_BENCH_TRIANGLES");
    let triangles = triangles.ok().and_then(|n| n.parse().ok()).unwrap_or(100_000);
    let mesh = match mesh {
        Mesh::Scan => generate::mesh(&Recipe::new(Model::Sphere, triangles)),
        Mesh::Room => furniture::room(triangles as usize),
    };
    // If this failed, the check below reports it.
    let mesh = mesh.unwrap_or_default();
    let (positions, triangles) = (mesh.positions, mesh.triangles);
    let geometry = Geometry { positions, triangles, ..Geometry::default() };
    assert!(!geometry.triangles.is_empty(), "the mesh could not be made");
    geometry
}

fn main() {
    divan::main();
}

/// A timed case.
#[derive(Clone, Copy)]
struct Case {
    mesh: Mesh,
    coherent: bool,
    kernel: KernelChoice,
    level: Level,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mesh = match self.mesh {
            Mesh::Scan => "scan",
            Mesh::Room => "room",
        };
        let rays = if self.coherent { "coherent" } else { "random" };
        write!(f, "{mesh}, {rays}, {}, {}", self.kernel.name(), self.level.name())
    }
}

/// Every kernel at the best level, and the default kernel at every other level.
fn cases() -> Vec<Case> {
    let kernels = KernelChoice::FOR_RENDERS.map(|kernel| (kernel, Level::best()));
    let levels = Level::available().into_iter().map(|level| (KernelChoice::Auto, level));
    let others = levels.filter(|(_, level)| *level != Level::best());
    let both: Vec<_> = kernels.into_iter().chain(others).collect();
    let all = [Mesh::Scan, Mesh::Room].into_iter().flat_map(|mesh| [(mesh, true), (mesh, false)]);
    let with = |(mesh, coherent)| {
        both.iter().map(move |&(kernel, level)| Case { mesh, coherent, kernel, level })
    };
    all.flat_map(with).collect()
}

impl Mesh {
    /// The position of a camera, and the square that it sees, by its centre and half its sides: the
    /// scan fills it, or it lies across the room from the camera's corner.
    fn view(self) -> [Vec3; 4] {
        match self {
            Self::Scan => [Vec3::Z * 4.0, Vec3::ZERO, Vec3::X, Vec3::Y],
            Self::Room => {
                let (eye, middle) = (Vec3::new(2.35, 1.6, 2.2), Vec3::new(-0.45, 0.85, -0.6));
                let right = (middle - eye).cross(Vec3::Y).normalize();
                let up = right.cross(middle - eye).normalize();
                [eye, middle, right * 2.4, up * 2.4]
            }
        }
    }

    /// The box between whose points random rays go: around the scan and inside the room.
    fn bounds(self) -> [Vec3; 2] {
        match self {
            Self::Scan => [Vec3::splat(-2.0), Vec3::splat(2.0)],
            Self::Room => [Vec3::new(-3.0, 0.0, -2.5), Vec3::new(3.0, 2.7, 2.5)],
        }
    }
}

/// From one point through a grid, block by block.
fn coherent(mesh: Mesh) -> Vec<Ray> {
    let [eye, middle, right, up] = mesh.view();
    let at = |i: u32| (i as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0;
    let ray = |i: u32| {
        let (block, within) = (i / 64, i % 64);
        let (x, y) = (block % (SIDE / 8) * 8 + within % 8, block / (SIDE / 8) * 8 + within / 8);
        Ray::new(eye, middle + right * at(x) + up * at(y) - eye)
    };
    (0..SIDE * SIDE).map(ray).collect()
}

/// Between two random points in the bounds.
fn random(mesh: Mesh) -> Vec<Ray> {
    let [low, high] = mesh.bounds();
    let ray = |pixel| {
        let stream = Stream { seed: 2, pixel, sample: 0, bounce: 0 };
        let point = |dimension| {
            let [x, y, z, _] = stream.uniform(dimension);
            low + Vec3::new(x, y, z) * (high - low)
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
    let rays = if case.coherent { coherent(case.mesh) } else { random(case.mesh) };
    let mut accel = MESHES[case.mesh as usize].lock().unwrap_or_else(PoisonError::into_inner);
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

/// The presets that build a tree.
fn presets() -> impl Iterator<Item = Preset> {
    Preset::ALL.into_iter().filter(|&preset| preset != Preset::Brute)
}

fn build(bencher: Bencher<'_, '_>, mesh: Mesh, preset: Preset) {
    let geometry = geometry(mesh);
    bencher
        .counter(ItemsCount::new(geometry.triangles.len()))
        .with_inputs(|| geometry.clone())
        .bench_local_values(|geometry| Accel::new(geometry, preset));
}

#[divan::bench(args = presets(), sample_count = 5, sample_size = 1)]
fn build_scan(bencher: Bencher<'_, '_>, preset: Preset) {
    build(bencher, Mesh::Scan, preset);
}

#[divan::bench(args = presets(), sample_count = 5, sample_size = 1)]
fn build_room(bencher: Bencher<'_, '_>, preset: Preset) {
    build(bencher, Mesh::Room, preset);
}
