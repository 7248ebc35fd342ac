//! Bounds on the rays of a tile: an interval for each number in the box test.

use std::array::from_fn;

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f32x16, mask32x8, mask32x16};

use super::columns::{GROUPS, Spans, TileColumn, WIDTH, load};
use crate::accel::rays::RayLanes;
use crate::accel::{Node, widened};
use crate::kernels::Aabb;
use crate::kernels::slab::{WIDENING, slack};
use crate::math::float::{max, min};
use crate::math::{LANES, Lanes};

/// Bounds on the rays seen so far.
pub(super) struct Extents<S: Lanes> {
    components: Spans<S, 8>,
    valid: mask32x16<S>,
}

impl<S: Lanes> Extents<S> {
    #[inline(always)]
    pub(super) fn new(simd: S) -> Self {
        let all = |v: f32| f32x16::splat(simd, v);
        Self { components: Spans::none(simd), valid: all(0.0).simd_eq(all(0.0)) }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, rays: &RayLanes<S>) {
        let &[ox, oy, oz, t_min, dx, dy, dz, t_max] = rays;
        self.components.add(rays);
        // A sum is finite only if all its terms are. Rays for which it overflows count as unfit,
        // which costs only time.
        let sum = ((ox + oy) + (oz + dx)) + (dy + dz);
        self.valid &= sum.abs().simd_le(f32::MAX) & t_min.simd_le(t_max);
    }

    /// Bounds on the rays, if they are valid and have one sign along each axis.
    #[inline(always)]
    pub(super) fn beam(&self) -> Option<Beam> {
        let low = fold::<S, false>(&self.components.0);
        let high = fold::<S, true>(&self.components.1);
        let [ox, oy, oz, x, y, z, t_min, t_max] = from_fn(|k| [low[k], high[k]]);
        let (origins, directions) = ([ox, oy, oz], [x, y, z]);
        if !(self.valid.all_true() && directions.into_iter().all(is_one_sign)) {
            return None;
        }
        let largest = |ends: [[f32; 2]; 3]| ends.into_iter().map(greatest).fold(0.0, max);
        let (farthest, longest) = (largest(origins), largest(directions));
        // Beyond these the filter of triangles has no bounds.
        if farthest > LARGEST || !(1.0 / LARGEST..=LARGEST).contains(&longest) {
            return None;
        }
        let negative = directions.map(|[_, high]| high < 0.0);
        let by_entry = |k: usize| {
            let [low, high] = origins[k];
            if negative[k] { [low, high] } else { [high, low] }
        };
        Some(Beam {
            negative,
            has_one_origin: origins.iter().all(|[low, high]| low == high),
            reciprocal: directions.map(|[low, high]| [1.0 / high, 1.0 / low]),
            origin: [0, 1, 2].map(by_entry),
            slack: slack(t_min[0]),
            t_min,
            reach: t_max,
        })
    }
}

/// The largest coordinate of an origin, and the largest component of a direction; the reciprocal is
/// the smallest: 2^60.
const LARGEST: f32 = (1_u64 << 60) as f32;

/// The smallest or largest of each component of origins, directions and ranges.
#[inline(always)]
fn fold<S: Lanes, const GREATEST: bool>(rays: &RayLanes<S>) -> [f32; 8] {
    let &[ox, oy, oz, t_min, dx, dy, dz, t_max] = rays;
    // Each step merges two into one, interleaved.
    let (a, b) = (both::<S, GREATEST>(ox, dy), both::<S, GREATEST>(oz, t_min));
    let (c, d) = (both::<S, GREATEST>(oy, dz), both::<S, GREATEST>(dx, t_max));
    let (even, odd) = (both::<S, GREATEST>(a, b), both::<S, GREATEST>(c, d));
    let (left, right) = both::<S, GREATEST>(even, odd).split();
    if GREATEST { left.max(right).into() } else { left.min(right).into() }
}

/// Alternately the smaller or larger of a pair of numbers from `a` and of a pair from `b`.
#[inline(always)]
fn both<S: Lanes, const GREATEST: bool>(a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
    let (low, high) = (a.zip_low(b), a.zip_high(b));
    if GREATEST { low.max(high) } else { low.min(high) }
}

/// The larger magnitude of both ends.
#[inline(always)]
pub(super) fn greatest([low, high]: [f32; 2]) -> f32 {
    max(low.abs(), high.abs())
}

/// Bounds on all rays of a tile.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Beam {
    pub(super) negative: [bool; 3],
    /// Whether all rays start at one point: planes are then equally far from each.
    pub(super) has_one_origin: bool,
    /// Smallest and largest.
    pub(super) reciprocal: [[f32; 2]; 3],
    /// The origins with the earliest and the latest entry, and exit.
    pub(super) origin: [[f32; 2]; 3],
    /// See [`SlabRay::slack`](crate::kernels::slab::SlabRay::slack).
    pub(super) slack: f32,
    /// Smallest and largest.
    pub(super) t_min: [f32; 2],
    /// Smallest and largest.
    pub(super) reach: [f32; 2],
}

/// Whether a component within these bounds has one sign and a finite reciprocal.
#[inline(always)]
fn is_one_sign([low, high]: [f32; 2]) -> bool {
    low > f32::MIN_POSITIVE || high < -f32::MIN_POSITIVE
}

/// The children of a node that a beam meets.
pub(super) struct MetChildren<S: Lanes> {
    /// The least t at which a ray can enter each child's box.
    pub(super) near: f32x8<S>,
    /// The children that some ray may meet.
    pub(super) some: mask32x8<S>,
    /// The children that every ray certainly meets, by its box and its range.
    pub(super) all: mask32x8<S>,
}

impl Beam {
    /// The children that it meets.
    #[inline(always)]
    pub(super) fn children<S: Lanes>(&self, simd: S, node: &Node) -> MetChildren<S> {
        if self.has_one_origin {
            self.children_of::<S, true>(simd, node)
        } else {
            self.children_of::<S, false>(simd, node)
        }
    }

    #[inline(always)]
    fn children_of<S: Lanes, const ONE: bool>(&self, simd: S, node: &Node) -> MetChildren<S> {
        let [x_near, x_far] = self.axis::<S, ONE>(simd, &node.planes[0], 0);
        let [y_near, y_far] = self.axis::<S, ONE>(simd, &node.planes[1], 1);
        let [z_near, z_far] = self.axis::<S, ONE>(simd, &node.planes[2], 2);
        let near = x_near[0].max(y_near[0]).max(z_near[0].max(f32x8::splat(simd, self.t_min[0])));
        let far = x_far[0].min(y_far[0]).min(z_far[0].min(f32x8::splat(simd, self.reach[1])));
        let last = x_near[1].max(y_near[1]).max(z_near[1].max(f32x8::splat(simd, self.t_min[1])));
        let first = x_far[1].min(y_far[1]).min(z_far[1].min(f32x8::splat(simd, self.reach[0])));
        let some = near.simd_le(widened(simd, far, self.slack));
        MetChildren { near, some, all: last.simd_le(first) & some }
    }

    /// Whether some ray may meet the box.
    #[inline(always)]
    pub(super) fn meets(&self, bounds: &Aabb) -> bool {
        let (mut near, mut far) = (self.t_min[0], self.reach[1]);
        for k in 0..3 {
            let planes = [bounds.low[k], bounds.high[k]];
            let first = planes[usize::from(self.negative[k])] - self.origin[k][0];
            let last = planes[usize::from(!self.negative[k])] - self.origin[k][1];
            let [low, high] = self.reciprocal[k];
            near = max(near, min(first * low, first * high));
            far = min(far, max(last * low, last * high));
        }
        near <= far * WIDENING + self.slack
    }

    /// The distance beyond which boxes hold no hit that comes first.
    #[inline(always)]
    pub(super) fn farthest(&self) -> f32 {
        self.reach[1] * WIDENING + self.slack
    }

    /// The least and greatest t of the rays at the children's entry planes on an axis, and the greatest
    /// and least at their exit planes.
    #[inline(always)]
    fn axis<S: Lanes, const ONE: bool>(
        &self,
        simd: S,
        planes: &[[f32; LANES]; 2],
        k: usize,
    ) -> [[f32x8<S>; 2]; 2] {
        let first: f32x8<S> = planes[usize::from(self.negative[k])].simd_into(simd);
        let last: f32x8<S> = planes[usize::from(!self.negative[k])].simd_into(simd);
        let [low, high] = self.reciprocal[k];
        let (a, z) = (first - self.origin[k][0], last - self.origin[k][1]);
        let (a_low, a_high, z_low, z_high) = (a * low, a * high, z * low, z * high);
        // Which of the two is earlier depends on the side of the plane on which rays start.
        let (near, far) = (a_low.min(a_high), z_low.max(z_high));
        if ONE {
            return [[near, a_low.max(a_high)], [far, z_low.min(z_high)]];
        }
        let (b, y) = (first - self.origin[k][1], last - self.origin[k][0]);
        [[near, (b * low).max(b * high)], [far, (y * low).min(y * high)]]
    }
}

/// The smallest and largest, of the `rays` of a tile.
#[inline(always)]
pub(super) fn extent<S: Lanes>(simd: S, column: &TileColumn, rays: u64) -> [f32; 2] {
    let mut low = f32x16::splat(simd, f32::INFINITY);
    let mut high = f32x16::splat(simd, f32::NEG_INFINITY);
    for g in 0..GROUPS {
        let own = mask32x16::from_bitmask(simd, rays >> (g * WIDTH) & 0xFFFF);
        let values = load(simd, column, g);
        (low, high) = (own.select(low.min(values), low), own.select(high.max(values), high));
    }
    [low.reduce_min(), high.reduce_max()]
}
