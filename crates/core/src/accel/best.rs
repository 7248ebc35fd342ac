//! The closest hit of a ray so far.
//!
//! While a ray is traced, its best hit is an entry of a leaf with an interval for t: the number and
//! the exact t are found once, when the ray is done ([`Best::finished`]). Intervals of two hits
//! that do not overlap tell which comes first; for others see [`order`](super::order).

use glam::Vec3;

use super::{ArenaView, Hit, NO_PRIMITIVE, Ref, Searched};
use crate::counters::TestCounts;
use crate::kernels::Arithmetic;
use crate::kernels::triangle::{exact, settle};
use crate::math::exact::Comparable;
use crate::math::{Line, Ray, Vector};

/// The closest hit of a ray so far, or none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Best {
    /// Bounds on t. If they are equal, t is known.
    pub(super) low: f32,
    /// See `low`. Boxes that the ray enters beyond it hold no closer hit: slabs are conservative,
    /// and no number of single precision lies between this one and a t that rounds to it. Without a
    /// hit, the end of the ray's range.
    pub(super) high: f32,
    /// The leaf, as the bits of a [`Ref`], or [`Best::NUMBERED`].
    pub(super) leaf: u32,
    /// The entry of the leaf, or the number of the primitive.
    pub(super) entry: u32,
}

impl Best {
    /// In place of a leaf: the hit is known by the number of its primitive. No leaf is there.
    pub(super) const NUMBERED: u32 = u32::MAX;

    /// No hit yet, of a ray that ends at `t_max`.
    #[inline(always)]
    pub(super) fn none(t_max: f32) -> Self {
        Self { low: t_max, high: t_max, leaf: Self::NUMBERED, entry: NO_PRIMITIVE }
    }

    /// A finished hit.
    #[inline(always)]
    pub(super) fn of(hit: Hit) -> Self {
        Self { low: hit.t, high: hit.t, leaf: Self::NUMBERED, entry: hit.primitive }
    }

    /// A hit on an entry of a leaf, with bounds on its t.
    #[inline(always)]
    pub(super) fn in_leaf(leaf: Ref, entry: usize, [low, high]: [f32; 2]) -> Self {
        Self { low, high, leaf: leaf.bits(), entry: entry as u32 }
    }

    #[inline(always)]
    pub(super) fn is_none(&self) -> bool {
        self.leaf == Self::NUMBERED && self.entry == NO_PRIMITIVE
    }

    /// Whether only its number is missing, or nothing.
    #[inline(always)]
    pub(super) fn has_t(&self) -> bool {
        self.low == self.high
    }

    /// Replaces the hit by `new`, of the same ray, or what is behind the hole in which it is, if that
    /// comes first. Returns whether this one changes.
    #[inline(always)]
    pub(super) fn offer<P: Arithmetic>(
        &mut self,
        searched: &Searched<'_>,
        ray: &Ray,
        new: Self,
        tests: &mut TestCounts,
    ) -> bool {
        if new.low > self.high {
            return false;
        }
        let Some(new) = searched.behind_holes::<P>(ray, new, tests) else { return false };
        if new.high < self.low {
            *self = new;
            return true;
        }
        new.low <= self.high && self.contest(searched, ray, new)
    }

    /// As [`Self::offer`], for hits whose intervals overlap.
    #[cold]
    #[inline(never)]
    fn contest(&mut self, searched: &Searched<'_>, ray: &Ray, new: Self) -> bool {
        let before = *self;
        if self.is_none() {
            *self = new;
            return true;
        }
        let arena = searched.arena;
        let [old, new] = [&*self, &new].map(|hit| hit.finished(arena, ray));
        // Whichever it is, its t is known from now on.
        let comes_first = searched.geometry.order(ray, new, old).is_lt();
        *self = Self::of(if comes_first { new } else { old });
        *self != before
    }

    /// The number of the primitive.
    #[inline(always)]
    pub(super) fn number(&self, arena: ArenaView<'_>) -> u32 {
        if self.leaf == Self::NUMBERED {
            return self.entry;
        }
        arena.number_of(Ref::from_bits(self.leaf), self.entry as usize)
    }

    /// The hit with its exact t, or if the search is without, an upper bound.
    // Always inlined, for the instructions of the caller's level.
    #[inline(always)]
    pub(super) fn answer(
        &self,
        &Searched { arena, without_t, .. }: &Searched<'_>,
        ray: &Ray,
        tests: &mut TestCounts,
    ) -> Hit {
        if without_t && !self.is_none() {
            return Hit { t: self.high, primitive: self.number(arena) };
        }
        tests.finished += u64::from(!self.has_t());
        self.finished(arena, ray)
    }

    /// The hit with its exact t.
    #[inline(always)]
    pub(super) fn finished(&self, arena: ArenaView<'_>, ray: &Ray) -> Hit {
        if self.is_none() {
            return Hit::MISS;
        }
        let primitive = self.number(arena);
        if self.has_t() {
            return Hit { t: self.low, primitive };
        }
        let corners = arena.triangle(Ref::from_bits(self.leaf), self.entry as usize);
        let (t, is_known) = settle::t_of(&Line::from(ray), &corners.map(Vector::from));
        let t = if is_known { t } else { exact_t(ray, &corners) };
        Hit { t, primitive }
    }
}

#[cold]
#[inline(never)]
pub(super) fn exact_t(ray: &Ray, corners: &[Vec3; 3]) -> f32 {
    exact::plane(ray, corners).map_or(f32::INFINITY, |t| t.rounded())
}
