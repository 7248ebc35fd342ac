//! Columns: a number for each ray of a tile, in groups that are tested at a time.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f32x16};

use super::TILE;
use crate::math::{Lanes, Single, set_bits};

/// Rays tested at a time.
pub(super) const WIDTH: usize = 16;

/// Groups of [`WIDTH`] rays in a tile.
pub(super) const GROUPS: usize = TILE / WIDTH;

/// A number for each ray of a tile.
pub(super) type TileColumn = [[f32; WIDTH]; GROUPS];

/// The index in a tile's row of groups of ray number `number`, counted row by row: each group is a
/// block of 4 by 4, which meets less than one of 8 by 2.
#[inline(always)]
pub(super) fn index_of(number: usize) -> usize {
    number & 0b100011 | (number & 0b011000) >> 1 | (number & 0b000100) << 2
}

/// The inverse of [`index_of`].
#[inline(always)]
pub(super) fn number_of(index: usize) -> usize {
    index & 0b100011 | (index & 0b001100) << 1 | (index & 0b010000) >> 2
}

/// The first `count` rays of a block, or all, a bit each.
#[inline(always)]
pub(super) fn first(count: usize) -> u64 {
    (count..TILE).fold(u64::MAX, |rays, number| rays & !(1 << index_of(number)))
}

/// The numbers of `rays`, a bit each, of the block that starts at `block`.
#[inline(always)]
pub(super) fn numbers(block: usize, rays: u64) -> impl Iterator<Item = usize> {
    set_bits::<TILE>(rays).map(move |i| block + number_of(i))
}

/// A group's row of a column.
#[inline(always)]
pub(super) fn load<S: Lanes>(simd: S, column: &TileColumn, g: usize) -> f32x16<S> {
    column[g].simd_into(simd)
}

/// Half a group's row of a column, from `l` on.
#[inline(always)]
pub(super) fn half<S: Lanes>(simd: S, column: &TileColumn, g: usize, l: usize) -> f32x8<S> {
    <f32x8<S> as Single>::from_slice(simd, &column[g][l..])
}

/// The smallest and the largest so far of each of some numbers.
#[derive(Clone, Copy)]
pub(super) struct Spans<S: Lanes, const N: usize>(
    pub(super) [f32x16<S>; N],
    pub(super) [f32x16<S>; N],
);

impl<S: Lanes, const N: usize> Spans<S, N> {
    #[inline(always)]
    pub(super) fn none(simd: S) -> Self {
        let [high, low] = [f32::INFINITY, f32::NEG_INFINITY];
        Self([f32x16::splat(simd, high); N], [f32x16::splat(simd, low); N])
    }

    #[inline(always)]
    pub(super) fn add(&mut self, numbers: &[f32x16<S>; N]) {
        for ((low, high), &v) in self.0.iter_mut().zip(&mut self.1).zip(numbers) {
            (*low, *high) = (low.min(v), high.max(v));
        }
    }
}
