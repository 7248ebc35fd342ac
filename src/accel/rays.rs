//! Rays, as kernels read them.

use std::ops::Range;

use fearless_simd::f32x16;
use fearless_simd::prelude::*;

use super::arena::prefetch;
use crate::math::ray::Ray;
use crate::math::simd::Lanes;

/// Rays in a row.
pub trait Rays {
    /// How many.
    fn count(&self) -> usize;

    /// The `i`th.
    fn ray(&self, i: usize) -> Ray;

    /// Sixteen rays, all of which there are: four from the `i`th on, and four from each of the places
    /// that are once, twice and three times `stride` behind it.
    fn block<S: Lanes>(&self, simd: S, i: usize, stride: usize) -> RayLanes<S>;

    /// Asks for the memory of the rays of `range`, if they may not be in a cache.
    #[inline(always)]
    fn prefetch(&self, _: Range<usize>) {}
}

/// Rays of a row of a block.
pub const BLOCK_EDGE: usize = 4;

/// Sixteen rays, a component each.
#[derive(Clone, Copy)]
pub struct RayLanes<S: Lanes> {
    /// Where they start.
    pub origin: [f32x16<S>; 3],
    /// Where they go.
    pub direction: [f32x16<S>; 3],
    /// The ranges of t.
    pub t_min: f32x16<S>,
    /// The ranges of t.
    pub t_max: f32x16<S>,
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
    fn block<S: Lanes>(&self, simd: S, i: usize, stride: usize) -> RayLanes<S> {
        let (a, b) = row(simd, &self[i..i + BLOCK_EDGE]);
        let (c, d) = row(simd, &self[i + stride..i + stride + BLOCK_EDGE]);
        let (e, f) = row(simd, &self[i + 2 * stride..i + 2 * stride + BLOCK_EDGE]);
        let (g, h) = row(simd, &self[i + 3 * stride..i + 3 * stride + BLOCK_EDGE]);
        // Numbers of a vector have the bits of their ray above those of their component. Each round
        // turns the lowest bit to the front, and after three the components are above.
        let (a, b, c, d, e, f, g, h) = part(a, b, c, d, e, f, g, h);
        let (a, b, c, d, e, f, g, h) = part(a, b, c, d, e, f, g, h);
        let (ox, oy, oz, t_min, dx, dy, dz, t_max) = part(a, b, c, d, e, f, g, h);
        RayLanes { origin: [ox, oy, oz], direction: [dx, dy, dz], t_min, t_max }
    }

    #[inline(always)]
    fn prefetch(&self, range: Range<usize>) {
        for two in self.get(range).unwrap_or_default().chunks(2) {
            prefetch(two.as_ptr().cast());
        }
    }
}

/// Four rays, as they lie.
#[inline(always)]
fn row<S: Lanes>(simd: S, rays: &[Ray]) -> (f32x16<S>, f32x16<S>) {
    let numbers: &[f32] = bytemuck::cast_slice(rays);
    (f32x16::from_slice(simd, &numbers[..16]), f32x16::from_slice(simd, &numbers[16..32]))
}

/// Eight vectors.
type Eight<V> = (V, V, V, V, V, V, V, V);

/// The numbers at even places of all vectors, then those at odd places.
#[inline(always)]
#[allow(clippy::too_many_arguments, clippy::many_single_char_names, reason = "a vector each")]
fn part<S: Lanes>(
    a: f32x16<S>,
    b: f32x16<S>,
    c: f32x16<S>,
    d: f32x16<S>,
    e: f32x16<S>,
    f: f32x16<S>,
    g: f32x16<S>,
    h: f32x16<S>,
) -> Eight<f32x16<S>> {
    (
        a.unzip_low(b),
        c.unzip_low(d),
        e.unzip_low(f),
        g.unzip_low(h),
        a.unzip_high(b),
        c.unzip_high(d),
        e.unzip_high(f),
        g.unzip_high(h),
    )
}
