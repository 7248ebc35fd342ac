//! Boxes, and the ray-box test that never loses a hit.
//!
//! The test is the slab test of Kay and Kajiya (1986). Ize (*Robust BVH Ray Traversal*, 2013) makes
//! it conservative by widening the far t. Hits are exact, so they lie in the box of their primitive
//! as it is, and only the roundings of the test itself count.
//!
//! # The bound
//!
//! With u the unit roundoff, the t of a plane is rounded three times: a difference, a reciprocal and
//! a product. So it is off by at most 3.01 u |t|, and less than the least normal number where it
//! underflows; the same holds for the largest near t and the smallest far t. Of a ray that meets a
//! hit at t in the box, the near t is at most t + 3.01 u |t|, the far t at least t - 3.01 u |t|. So
//! a far t grows by [`WIDENING`], 8 u of itself, which covers its own rounding too, and by
//! [`SlabRay::slack`]: 16 u times the magnitude of the least t in the range, if that is negative,
//! and the least normal number.
//!
//! A ray that runs along a plane of the box meets it on both sides: where a component of the
//! direction is zero, the origin is moved by an ulp, forth for near planes and back for far ones.
//!
//! # Why culling by distance loses nothing
//!
//! A hit's t is the primitive's own; boxes do not change it. A box's t matters in one place only: a
//! box is skipped if the ray enters it after the closest hit so far, or after an upper bound of its
//! t. That bound is widened like a far t ([`SlabRay::reach`]), which covers the one rounding of the t of
//! hits, so no box with a closer or equally close hit is skipped. The same holds for any box around
//! that one, whatever the shape of the tree, and for the ends of a ray's range.

use glam::{Vec3, Vec3A, Vec4};

use crate::math::float::{UNIT_ROUNDOFF, max, min};
use crate::math::{Ray, Real};

/// The factor by which a far t grows: see the module documentation.
pub const WIDENING: f32 = 1.0 + 8.0 * UNIT_ROUNDOFF;

/// The error bound of computed points, as a factor of their coordinates: 16 roundings.
pub const PADDING: f32 = 16.0 * UNIT_ROUNDOFF;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The smallest coordinates.
    pub low: Vec3,
    /// The largest coordinates.
    pub high: Vec3,
}

impl Aabb {
    /// The empty box.
    pub const EMPTY: Self =
        Self { low: Vec3::splat(f32::INFINITY), high: Vec3::splat(f32::NEG_INFINITY) };

    /// The smallest box around `points`.
    #[inline]
    pub fn around<const N: usize>(points: [Vec3; N]) -> Self {
        let mut low = points[0];
        let mut high = points[0];
        for p in &points[1..] {
            low = Vec3::new(min(low.x, p.x), min(low.y, p.y), min(low.z, p.z));
            high = Vec3::new(max(high.x, p.x), max(high.y, p.y), max(high.z, p.z));
        }
        Self { low, high }
    }

    /// The smallest box around both boxes.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Half the surface of the box.
    pub fn half_area(&self) -> f64 {
        let d = (self.high - self.low).as_dvec3();
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}

/// A ray prepared for slab tests. Rows of four numbers, as whole rows are written at once: what is read of pieces
/// just written waits.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay {
    /// Reciprocal of the opposite direction: t is the distance from a plane to the origin, times this.
    /// Infinite, with the sign opposite to the zero's, for zero components; 1 or -1 for other components
    /// whose reciprocal is no normal number. The fourth number has the bits of [`Self::entry`].
    opposite: Vec4,
    /// The origin for entry planes: see the module documentation. The fourth number is [`Self::slack`].
    near_origin: Vec4,
    /// The origin for exit planes.
    far_origin: Vec4,
}

/// The reciprocal of the opposite direction, and the origins for entry and exit planes, for boxes that are off by
/// `factor` times [`PADDING`], or if a component of the direction is zero or its reciprocal no normal number.
#[inline(never)]
fn moved(ray: &Ray, factor: f32, opposite: Vec3A) -> [Vec3A; 3] {
    let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
    let negative = opposite.cmpgt(Vec3A::ZERO);
    let is_zero = direction.cmpeq(Vec3A::ZERO);
    let ulp = origin.abs() * f32::EPSILON + f32::MIN_POSITIVE;
    let pad = Vec3A::splat(factor * PADDING * origin.abs().max_element());
    let pad = Vec3A::select(is_zero, pad.max(ulp), pad);
    let shift = Vec3A::select(negative, -pad, pad);
    // If the reciprocal of a nonzero component is no normal number, the crossing of a plane is
    // unknown: all boxes count as met along that axis.
    let size = opposite.abs();
    let unknown =
        (size.cmpeq(Vec3A::INFINITY) & !is_zero) | size.cmplt(Vec3A::splat(f32::MIN_POSITIVE));
    let sign = Vec3A::select(negative, Vec3A::NEG_ONE, Vec3A::ONE);
    let before = sign * f32::MAX;
    [
        Vec3A::select(unknown, -sign, opposite),
        Vec3A::select(unknown, before, origin + shift),
        Vec3A::select(unknown, -before, origin - shift),
    ]
}

/// The places of entry planes by the signs of the direction, a bit for each negative component: see
/// [`SlabRay::entry`]. A byte for each axis.
#[rustfmt::skip]
const ENTRIES: [u32; 8] = [
    0x20_10_00, 0x20_10_08, 0x20_18_00, 0x20_18_08, 0x28_10_00, 0x28_10_08, 0x28_18_00, 0x28_18_08,
];

/// See [`SlabRay::slack`], for a ray whose range begins at `t_min`.
#[inline(always)]
pub fn slack(t_min: f32) -> f32 {
    16.0 * UNIT_ROUNDOFF * (-t_min).clamp(0.0, f32::MAX) + f32::MIN_POSITIVE
}

impl SlabRay {
    /// Prepares `ray`.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        Self::widened(ray, 0.0)
    }

    /// Prepares `ray` for boxes whose content may be off by `factor` times [`PADDING`] times the
    /// largest coordinate of the origin.
    #[inline(always)]
    pub fn widened(ray: &Ray, factor: f32) -> Self {
        let opposite = Vec3A::NEG_ONE / Vec3A::from(ray.direction);
        let size = opposite.abs();
        let usual =
            size.cmpge(Vec3A::splat(f32::MIN_POSITIVE)) & size.cmple(Vec3A::splat(f32::MAX));
        let entry = ENTRIES[opposite.cmpgt(Vec3A::ZERO).bitmask() as usize % ENTRIES.len()];
        let origin = Vec3A::from(ray.origin);
        let rows = if usual.all() && factor == 0.0 {
            [opposite, origin, origin]
        } else {
            moved(ray, factor, opposite)
        };
        let [opposite, near_origin, far_origin] = rows;
        Self {
            opposite: opposite.extend(f32::from_bits(entry)),
            near_origin: near_origin.extend(slack(ray.t_min)),
            far_origin: far_origin.extend(0.0),
        }
    }

    /// Where the row of the entry planes on axis `k` begins among those of the eight children of a node, the low and
    /// the high ones of each axis: the high ones if the ray runs towards smaller coordinates.
    #[inline(always)]
    pub fn entry(&self, k: usize) -> usize {
        (self.opposite.w.to_bits() >> (8 * k)) as usize & 0x38
    }

    /// By what a far t grows, besides [`WIDENING`].
    #[inline(always)]
    pub fn slack(&self) -> f32 {
        self.near_origin.w
    }

    /// The t at which the ray crosses its entry and exit planes on axis `k`, of one box or of several, rounded: a
    /// number for each.
    #[inline(always)]
    pub fn crossings<F: Real<Element = f32>>(&self, k: usize, first: F, last: F) -> [F; 2] {
        // In this order planes in memory are read by the subtraction itself.
        let near = first.same(self.near_origin[k]) - first;
        let far = last.same(self.far_origin[k]) - last;
        [near.times(self.opposite[k]), far.times(self.opposite[k])]
    }

    /// The distance beyond which boxes hold no hit at `t` or before.
    #[inline(always)]
    pub fn reach(&self, t: f32) -> f32 {
        t * WIDENING + self.slack()
    }

    /// The ends of a range of t that contains all t at which the ray is in `bounds`: it is empty if the
    /// first is larger.
    ///
    /// For a zero component, every nonzero difference becomes an infinite t of the right sign. A
    /// zero difference becomes a NaN with unspecified results: the ray then runs just outside the
    /// box.
    #[inline(always)]
    pub fn interval(&self, bounds: &Aabb) -> [f32; 2] {
        let axis = |k: usize| {
            let (low, high) = (bounds.low[k], bounds.high[k]);
            let [first, last] = if self.entry(k) & 8 != 0 { [high, low] } else { [low, high] };
            self.crossings(k, first, last)
        };
        let ([x0, x1], [y0, y1], [z0, z1]) = (axis(0), axis(1), axis(2));
        [max(x0, max(y0, z0)), self.reach(min(x1, min(y1, z1)))]
    }

    /// Whether `ray`, whose values these are, may meet anything in the box within its range.
    #[inline(always)]
    pub fn meets(&self, ray: &Ray, bounds: &Aabb) -> bool {
        let [near, far] = self.interval(bounds);
        max(near, ray.t_min) <= min(far, self.reach(ray.t_max))
    }
}
