//! Every kernel at every instruction level, and the tests of single primitives.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use super::case::{Effort, Outcome};
use wavecrest_core::accel::{Accel, Hit, KernelChoice};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::kernels::sphere;
use wavecrest_core::kernels::surface::{self, Surface};
use wavecrest_core::kernels::triangle::{self, exact, filter};
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::Level;
use wavecrest_core::math::vector::{Line, Vector};
use wavecrest_core::with_precision;

/// Rays for each task: several packets.
pub(super) const RAYS_OF_A_TASK: usize = 1 << 8;

/// Checks `accel` with every kernel and at all instruction levels. The reference is asked once, as
/// exact arithmetic is the same at every level; in fast precision it is the single kernel.
pub(super) fn with_every_kernel(accel: &mut Accel, check: impl Fn(&Accel) -> Outcome) -> Outcome {
    let mut outcome = Outcome::default();
    if accel.geometry().precision == Precision::Exact {
        accel.kernel = KernelChoice::Reference;
        let context = || KernelChoice::Reference.name().to_owned();
        outcome.add(check(accel).with_context(context));
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

/// The hits of all rays.
pub(super) fn hits_of(accel: &Accel, rays: &[Ray]) -> Vec<Hit> {
    let of = |rays: &[Ray]| {
        let mut hits = vec![Hit::MISS; rays.len()];
        accel.closest_of(rays, &mut hits, &mut accel.traversal());
        hits
    };
    rays.par_chunks(RAYS_OF_A_TASK).flat_map_iter(of).collect()
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

/// The tests of one primitive, and their surface points, in a precision. In exact precision hits
/// are those of exact arithmetic: if the tests in use find others, t is a NaN, which keeps no
/// bound.
#[derive(Clone, Copy)]
pub(super) struct Tests(Precision);

impl From<&Effort> for Tests {
    fn from(effort: &Effort) -> Self {
        Self(effort.precision)
    }
}

impl From<&Accel> for Tests {
    fn from(accel: &Accel) -> Self {
        Self(accel.geometry().precision)
    }
}

impl Tests {
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
        (center, radius): (Vec3, f32),
    ) -> Surface<f32> {
        let line = Line::from(ray);
        with_precision!(self.0, P => surface::sphere_at::<f32, P>(&line, t, center.into(), radius))
    }
}

/// What both say, or a NaN.
fn agreed(t: Option<f32>, exactly: Option<f32>) -> Option<f32> {
    if t == exactly { t } else { Some(f32::NAN) }
}
