//! Rays in the memory layouts that kernels read.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{f32x4, f32x16};
use glam::Vec3;

use super::arena::prefetch;
use crate::math::{Lanes, Ray};

/// Rays in rows or columns. Kernels are compiled once for both: a check for every sixteen rays
/// costs little.
#[derive(Clone, Copy, Debug)]
pub enum Rays<'a> {
    /// An array of rays.
    Rows(&'a [Ray]),
    /// A column for each component.
    Columns(RayColumns<'a>),
}

/// Rays in columns, with t to the same `t_max`.
#[derive(Clone, Copy, Debug)]
pub struct RayColumns<'a> {
    /// Number of rays: columns may be longer.
    pub count: usize,
    /// The origins, an axis each.
    pub origin: [&'a [f32]; 3],
    /// The directions, an axis each.
    pub direction: [&'a [f32]; 3],
    /// Hits at or before this t do not count: 0 if there is no column.
    pub t_min: Option<&'a [f32]>,
    /// Hits at or after this t do not count.
    pub t_max: f32,
}

/// Most and fewest rays for a thread to trace at once, and how often it should come for more: so
/// that kernels have enough, and threads end together.
const MOST_AT_ONCE: usize = 4096;
const LEAST_AT_ONCE: usize = 1024;
const TURNS: usize = 32;

/// Out of this `count` of rays, how many a thread of the current rayon pool should trace at once.
pub fn rays_at_once(count: usize) -> usize {
    (count / (TURNS * rayon::current_num_threads())).clamp(LEAST_AT_ONCE, MOST_AT_ONCE)
}

impl<'a> From<&'a [Ray]> for Rays<'a> {
    fn from(rays: &'a [Ray]) -> Self {
        Self::Rows(rays)
    }
}

impl<'a> Rays<'a> {
    /// The number of rays.
    #[inline(always)]
    pub fn count(&self) -> usize {
        match self {
            Self::Rows(rays) => rays.len(),
            Self::Columns(columns) => columns.count,
        }
    }

    /// The first ones.
    pub(super) fn first(self, count: usize) -> Self {
        match self {
            Self::Rows(rays) => Self::Rows(&rays[..count]),
            Self::Columns(columns) => Self::Columns(RayColumns { count, ..columns }),
        }
    }

    /// All but the first ones.
    pub(crate) fn without(self, first: usize) -> Self {
        match self {
            Self::Rows(rays) => Self::Rows(&rays[first..]),
            Self::Columns(RayColumns { count, origin, direction, t_min, t_max }) => {
                let [origin, direction] =
                    [origin, direction].map(|of| of.map(|axis| &axis[first..]));
                let t_min = t_min.map(|t_min| &t_min[first..]);
                Self::Columns(RayColumns { count: count - first, origin, direction, t_min, t_max })
            }
        }
    }

    /// The `i`th ray.
    #[inline(always)]
    pub fn ray(&self, i: usize) -> Ray {
        match self {
            Self::Rows(rays) => rays[i],
            Self::Columns(RayColumns { origin, direction, t_min, t_max, .. }) => {
                let at = |[x, y, z]: &[&[f32]; 3]| Vec3::new(x[i], y[i], z[i]);
                let t_min = t_min.map_or(0.0, |t_min| t_min[i]);
                Ray { t_min, t_max: *t_max, ..Ray::new(at(origin), at(direction)) }
            }
        }
    }

    /// Sixteen existing rays: four from the `i`th on, and four each from one, two and three times
    /// `stride` behind it.
    #[inline(always)]
    pub(super) fn block<S: Lanes>(&self, simd: S, i: usize, stride: usize) -> RayLanes<S> {
        match self {
            Self::Rows(rays) => of_rows(simd, rays, i, stride),
            Self::Columns(columns) => of_columns(simd, columns, i, stride),
        }
    }

    /// Prefetches the rays of `range` if they may not be in a cache: columns are those of a batch,
    /// which is.
    #[inline(always)]
    pub(super) fn prefetch(&self, range: Range<usize>) {
        if let Self::Rows(rays) = self {
            for two in rays.get(range).unwrap_or_default().chunks(2) {
                prefetch(two.as_ptr().cast());
            }
        }
    }
}

/// Rays in a row of a block.
pub(super) const BLOCK_EDGE: usize = 4;

/// The components of sixteen rays, in the order of [`Ray`]: origin, `t_min`, direction, `t_max`.
pub(super) type RayLanes<S> = [f32x16<S>; 8];

#[inline(always)]
fn of_columns<S: Lanes>(
    simd: S,
    RayColumns { origin, direction, t_min, t_max, .. }: &RayColumns<'_>,
    i: usize,
    stride: usize,
) -> RayLanes<S> {
    let (o, d) = (origin, direction);
    let (ox, dx) = (four_rows(simd, o[0], i, stride), four_rows(simd, d[0], i, stride));
    let (oy, dy) = (four_rows(simd, o[1], i, stride), four_rows(simd, d[1], i, stride));
    let (oz, dz) = (four_rows(simd, o[2], i, stride), four_rows(simd, d[2], i, stride));
    let t_min = match t_min {
        Some(t_min) => four_rows(simd, t_min, i, stride),
        None => f32x16::splat(simd, 0.0),
    };
    [ox, oy, oz, t_min, dx, dy, dz, f32x16::splat(simd, *t_max)]
}

/// Four numbers from the `i`th on, and from each of three rows behind.
#[inline(always)]
fn four_rows<S: Lanes>(simd: S, column: &[f32], i: usize, stride: usize) -> f32x16<S> {
    let a = f32x4::from_slice(simd, &column[i..i + BLOCK_EDGE]);
    let b = f32x4::from_slice(simd, &column[i + stride..i + stride + BLOCK_EDGE]);
    let c = f32x4::from_slice(simd, &column[i + 2 * stride..i + 2 * stride + BLOCK_EDGE]);
    let d = f32x4::from_slice(simd, &column[i + 3 * stride..i + 3 * stride + BLOCK_EDGE]);
    a.combine(b).combine(c.combine(d))
}

#[inline(always)]
fn of_rows<S: Lanes>(simd: S, rays: &[Ray], i: usize, stride: usize) -> RayLanes<S> {
    let (a, b) = row(simd, &rays[i..i + BLOCK_EDGE]);
    let (c, d) = row(simd, &rays[i + stride..i + stride + BLOCK_EDGE]);
    let (e, f) = row(simd, &rays[i + 2 * stride..i + 2 * stride + BLOCK_EDGE]);
    let (g, h) = row(simd, &rays[i + 3 * stride..i + 3 * stride + BLOCK_EDGE]);
    // In a vector, the index bits of the ray are above those of the component. Each round moves
    // the lowest bit to the front; after three rounds the component bits are above.
    part(part(part([a, b, c, d, e, f, g, h])))
}

/// Four rays in memory order.
#[inline(always)]
fn row<S: Lanes>(simd: S, rays: &[Ray]) -> (f32x16<S>, f32x16<S>) {
    let numbers: &[f32] = bytemuck::cast_slice(rays);
    (f32x16::from_slice(simd, &numbers[..16]), f32x16::from_slice(simd, &numbers[16..32]))
}

/// The numbers at even positions of all vectors, then those at odd positions.
#[inline(always)]
#[allow(clippy::many_single_char_names, reason = "a vector each")]
fn part<S: Lanes>([a, b, c, d, e, f, g, h]: [f32x16<S>; 8]) -> [f32x16<S>; 8] {
    [
        a.unzip_low(b),
        c.unzip_low(d),
        e.unzip_low(f),
        g.unzip_low(h),
        a.unzip_high(b),
        c.unzip_high(d),
        e.unzip_high(f),
        g.unzip_high(h),
    ]
}
