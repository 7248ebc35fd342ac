//! Traces rays with every kernel and every instruction level.

use std::ops::Range;
use std::time::Instant;

use glam::Vec3;
use rand::RngExt;
use rayon::prelude::*;

use super::case::{Effort, Outcome};
use wavecrest_core::accel::{Accel, Hit, KernelChoice};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::kernels::sphere;
use wavecrest_core::kernels::surface::{self, Surface};
use wavecrest_core::kernels::triangle::{self, exact, filter};
use wavecrest_core::math::random::{Generator, Stream};
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::Level;
use wavecrest_core::math::vector::{Line, Vector};
use wavecrest_core::with_precision;

/// Rays for each task.
const RAYS_OF_A_THREAD: usize = 1 << 13;

/// Checks the hits of all rays with every kernel and at all instruction levels. `judge` describes
/// the error of the hit of this ray, if any.
pub(super) fn every_way(
    mut accel: Accel,
    rays: &[Ray],
    judge: impl Fn(usize, &Ray, Hit) -> Option<String> + Sync,
) -> Outcome {
    with_every_kernel(&mut accel, |accel| ask(accel, rays, &judge))
}

/// Checks the hits of `accel` with every kernel and at all instruction levels. The reference is
/// asked once, as exact arithmetic is the same at every level, and is not timed; in fast precision it
/// is the single kernel.
pub(super) fn with_every_kernel(accel: &mut Accel, check: impl Fn(&Accel) -> Outcome) -> Outcome {
    let mut outcome = Outcome::default();
    if accel.geometry().precision == Precision::Exact {
        accel.kernel = KernelChoice::Reference;
        let context = || KernelChoice::Reference.name().to_owned();
        let of_reference = check(accel).with_context(context);
        outcome.add(Outcome { timed: 0, seconds: 0.0, ..of_reference });
    }
    for level in Level::available() {
        let Some(token) = level.token() else { continue };
        accel.level = token;
        for kernel in KernelChoice::FOR_RENDERS {
            accel.kernel = kernel;
            let context = || format!("{} {}", level.name(), kernel.name());
            outcome.add(check(accel).with_context(context));
        }
        if accel.tree().is_none() {
            // There is nothing left to vary.
            break;
        }
    }
    outcome
}

/// Checks the hits of all rays.
fn ask(
    accel: &Accel,
    rays: &[Ray],
    judge: impl Fn(usize, &Ray, Hit) -> Option<String> + Sync,
) -> Outcome {
    let blocks = rays.par_chunks(RAYS_OF_A_THREAD).enumerate().map(|(block, rays)| {
        let mut hits = vec![Hit::MISS; rays.len()];
        let mut traversal = accel.traversal();
        let start = Instant::now();
        accel.closest_of(rays, &mut hits, &mut traversal);
        let seconds = start.elapsed().as_secs_f64();
        let mut outcome = Outcome { timed: rays.len() as u64, seconds, ..Outcome::default() };
        for (i, (ray, &hit)) in rays.iter().zip(&hits).enumerate() {
            let number = block * RAYS_OF_A_THREAD + i;
            let context = |failure| format!("ray {number}, {ray}: {failure}");
            outcome.count(judge(number, ray, hit).map(context));
        }
        outcome
    });
    in_order(blocks)
}

/// Runs `count` tests on all threads, and adds up their outcomes in order.
pub(super) fn in_blocks(count: usize, ask: impl Fn(usize) -> Outcome + Sync) -> Outcome {
    let one = |n| ask(n).with_context(|| format!("input {n}"));
    in_order(blocks(count, RAYS_OF_A_THREAD).map(|block| block.map(one).sum()))
}

/// The numbers below `count`, up to `size` of them at a time.
pub(super) fn blocks(
    count: usize,
    size: usize,
) -> impl IndexedParallelIterator<Item = Range<usize>> {
    let block = move |b: usize| b * size..((b + 1) * size).min(count);
    (0..count.div_ceil(size)).into_par_iter().map(block)
}

/// The sum of all outcomes; the first failure is that of the first failed test.
pub(super) fn in_order(outcomes: impl ParallelIterator<Item = Outcome>) -> Outcome {
    outcomes.collect::<Vec<_>>().into_iter().sum()
}

/// The tests of one primitive, and their surface points, in a precision. In exact precision hits are
/// those of exact arithmetic: if the tests in use find others, t is a NaN, which keeps no bound.
#[derive(Clone, Copy)]
pub(super) struct Tests(Precision);

impl Tests {
    /// The tests that `effort` asks for.
    pub(super) fn of(effort: &Effort) -> Self {
        Self(effort.precision)
    }

    /// The tests that the hits of `accel` are made with.
    pub(super) fn in_accel(accel: &Accel) -> Self {
        Self(accel.geometry().precision)
    }

    /// The t at which the ray meets the triangle.
    pub(super) fn triangle(self, ray: &Ray, corners: &[Vec3; 3]) -> Option<f32> {
        match self.0 {
            Precision::Fast => filter::fast(ray, corners),
            Precision::Exact => agreed(triangle::meet(ray, corners), exact::meet(ray, corners)),
        }
    }

    /// The t at which the ray meets the sphere.
    pub(super) fn sphere(self, ray: &Ray, center: Vec3, radius: f32) -> Option<f32> {
        let range = [ray.t_min, ray.t_max];
        let (t, is_hit) = with_precision!(self.0, P =>
            sphere::meet::<f32, P>(&Line::from(ray), center, radius, range));
        let t = is_hit.then_some(t);
        match self.0 {
            Precision::Fast => t,
            Precision::Exact => agreed(t, sphere::intersect_exactly(ray, center, radius)),
        }
    }

    /// The surface point at which the ray meets the triangle.
    pub(super) fn surface(self, ray: &Ray, t: f32, corners: &[Vec3; 3]) -> Surface<f32> {
        let (line, corners) = (Line::from(ray), corners.map(Vector::from));
        with_precision!(self.0, P => surface::triangle_at::<f32, P>(&line, t, &corners))
    }

    /// The surface point at which the ray meets the sphere.
    pub(super) fn sphere_surface(
        self,
        ray: &Ray,
        t: f32,
        center: Vec3,
        radius: f32,
    ) -> Surface<f32> {
        let line = Line::from(ray);
        with_precision!(self.0, P => surface::sphere_at::<f32, P>(&line, t, center.into(), radius))
    }
}

/// What both say, or a NaN.
fn agreed(t: Option<f32>, exactly: Option<f32>) -> Option<f32> {
    if t == exactly { t } else { Some(f32::NAN) }
}

/// Random numbers for the `index`th input of a case.
#[derive(Clone, Debug)]
pub(super) struct Numbers(Generator);

/// Random numbers for each of these inputs of a case.
pub(super) fn inputs(
    effort: &Effort,
    case: u32,
    inputs: Range<usize>,
) -> impl Iterator<Item = Numbers> {
    inputs.map(move |index| Numbers::new(effort, case, index))
}

impl Numbers {
    pub(super) fn new(effort: &Effort, case: u32, index: usize) -> Self {
        let stream = Stream { seed: effort.seed, pixel: index as u32, sample: case, bounce: 0 };
        Self(stream.generator(0))
    }

    /// Uniform from 0 to 1.
    pub(super) fn one(&mut self) -> f64 {
        self.0.random()
    }

    /// From `low` to `high`, uniform in logarithm.
    pub(super) fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        libm::pow(10.0, libm::log10(low) + self.one() * libm::log10(high / low))
    }

    /// Less than `end`.
    pub(super) fn below(&mut self, end: usize) -> usize {
        self.0.random_range(0..end)
    }

    /// 1 or -1.
    pub(super) fn sign(&mut self) -> f64 {
        if self.0.random() { 1.0 } else { -1.0 }
    }

    /// Uniform in a triangle.
    pub(super) fn within(&mut self, [a, b, c]: [Vec3; 3]) -> glam::DVec3 {
        let [a, b, c] = [a, b, c].map(|v| v.as_dvec3());
        let (u, v) = (self.one(), self.one());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        a + (b - a) * u + (c - a) * v
    }

    /// Uniform on the unit sphere.
    pub(super) fn direction(&mut self) -> glam::DVec3 {
        let (z, turn) = (2.0 * self.one() - 1.0, std::f64::consts::TAU * self.one());
        let r = (1.0 - z * z).max(0.0).sqrt();
        glam::DVec3::new(r * libm::cos(turn), r * libm::sin(turn), z)
    }
}
