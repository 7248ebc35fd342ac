//! Rays, as kernels read them.

use std::ops::Range;

use fearless_simd::f32x8;
use fearless_simd::prelude::*;

use super::arena::prefetch;
use crate::math::ray::Ray;
use crate::math::simd::{LANES, Lanes};

/// Rays in a row.
pub trait Rays {
    /// How many.
    fn count(&self) -> usize;

    /// The `i`th.
    fn ray(&self, i: usize) -> Ray;

    /// Eight rays from the `i`th on, all of which there are.
    fn eight<S: Lanes>(&self, simd: S, i: usize) -> RayLanes<S>;

    /// Asks for the memory of the rays of `range`, if they may not be in a cache.
    #[inline(always)]
    fn prefetch(&self, _: Range<usize>) {}
}

/// Eight rays, a component each.
#[derive(Clone, Copy)]
pub struct RayLanes<S: Lanes> {
    /// Where they start.
    pub origin: [f32x8<S>; 3],
    /// Where they go.
    pub direction: [f32x8<S>; 3],
    /// The ranges of t.
    pub t_min: f32x8<S>,
    /// The ranges of t.
    pub t_max: f32x8<S>,
}

impl Rays for [Ray] {
    fn count(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn ray(&self, i: usize) -> Ray {
        self[i]
    }

    #[inline(always)]
    fn eight<S: Lanes>(&self, simd: S, i: usize) -> RayLanes<S> {
        let rows: &[[f32; LANES]] = bytemuck::cast_slice(&self[i..i + LANES]);
        let [a, b, c, d, e, f, g, h] = *rows.first_chunk().unwrap_or(&[[0.0; LANES]; LANES]);
        let (a, b): (f32x8<S>, f32x8<S>) = (a.simd_into(simd), b.simd_into(simd));
        let (c, d): (f32x8<S>, f32x8<S>) = (c.simd_into(simd), d.simd_into(simd));
        let (e, f): (f32x8<S>, f32x8<S>) = (e.simd_into(simd), f.simd_into(simd));
        let (g, h): (f32x8<S>, f32x8<S>) = (g.simd_into(simd), h.simd_into(simd));
        // Three perfect shuffles turn rows into columns.
        let (a, b, c, d, e, f, g, h) = shuffle(a, b, c, d, e, f, g, h);
        let (a, b, c, d, e, f, g, h) = shuffle(a, b, c, d, e, f, g, h);
        let (ox, oy, oz, t_min, dx, dy, dz, t_max) = shuffle(a, b, c, d, e, f, g, h);
        RayLanes { origin: [ox, oy, oz], direction: [dx, dy, dz], t_min, t_max }
    }

    #[inline(always)]
    fn prefetch(&self, range: Range<usize>) {
        for two in self.get(range).unwrap_or_default().chunks(2) {
            prefetch(two.as_ptr().cast());
        }
    }
}

/// Eight vectors.
type Eight<S> = (f32x8<S>, f32x8<S>, f32x8<S>, f32x8<S>, f32x8<S>, f32x8<S>, f32x8<S>, f32x8<S>);

/// Interleaves the first four with the last four.
#[inline(always)]
#[allow(clippy::too_many_arguments, clippy::many_single_char_names, reason = "a vector each")]
fn shuffle<S: Lanes>(
    a: f32x8<S>,
    b: f32x8<S>,
    c: f32x8<S>,
    d: f32x8<S>,
    e: f32x8<S>,
    f: f32x8<S>,
    g: f32x8<S>,
    h: f32x8<S>,
) -> Eight<S> {
    (
        a.zip_low(e),
        a.zip_high(e),
        b.zip_low(f),
        b.zip_high(f),
        c.zip_low(g),
        c.zip_high(g),
        d.zip_low(h),
        d.zip_high(h),
    )
}
