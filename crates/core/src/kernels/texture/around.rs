//! The four texels around a point, and the mean of their colours.

use glam::Vec3;

use super::Wrap;
use super::wrap::{neighbours, position};
use crate::math::vector::set;
use crate::math::{Single, Vector};

/// The shares of 255.
pub(super) static SHARES: [f32; 256] = {
    let (mut shares, mut byte) = ([0.0; 256], 0);
    while byte < shares.len() {
        shares[byte] = byte as f32 / 255.0;
        byte += 1;
    }
    shares
};

/// The four texels around each point, and their weights.
pub(super) struct Around<F: Single> {
    /// The columns to the left and to the right, and the rows above and below.
    columns: [F::Integers; 2],
    rows: [F::Integers; 2],
    /// From the left to the right, and from above to below.
    fractions: [F; 2],
}

impl<F: Single> Around<F> {
    /// Around each `uv` in an image of this size.
    #[inline(always)]
    pub(super) fn new([width, height]: [F; 2], [u, v]: [F; 2], wrap: Wrap) -> Self {
        let [left, right, across] = neighbours(position(u, width, wrap), width, wrap);
        let [above, below, down] =
            neighbours(position(u.same(1.0) - v, height, wrap), height, wrap);
        Self {
            columns: [left.integers(), right.integers()],
            rows: [above.integers(), below.integers()],
            fractions: [across, down],
        }
    }

    /// The numbers of the texels of a lane in an image of this width, row by row.
    #[inline(always)]
    pub(super) fn indices(&self, lane: usize, width: u32) -> [usize; 4] {
        let [left, right] = &self.columns;
        let [above, below] = &self.rows;
        let (left, right) = (left.as_ref()[lane] as usize, right.as_ref()[lane] as usize);
        let above = above.as_ref()[lane] as usize * width as usize;
        let below = below.as_ref()[lane] as usize * width as usize;
        [above + left, above + right, below + left, below + right]
    }

    /// The weighted colours, from those of the texels of a lane.
    #[inline(always)]
    pub(super) fn color(&self, texels: impl Fn(usize) -> [Vec3; 4]) -> Vector<F> {
        let mut found = <[[F::Row; 3]; 4]>::default();
        for lane in 0..F::LANES {
            let ([a, b, c, d], [in_a, in_b, in_c, in_d]) = (texels(lane), &mut found);
            set::<F>(in_a, lane, a);
            set::<F>(in_b, lane, b);
            set::<F>(in_c, lane, c);
            set::<F>(in_d, lane, d);
        }
        let ([a, b, c, d], token) = (&found, self.fractions[0].token());
        self.mixed([
            Vector::load(token, a),
            Vector::load(token, b),
            Vector::load(token, c),
            Vector::load(token, d),
        ])
    }

    /// The weighted colours in an image of this width: lanes become numbers together.
    #[inline(always)]
    pub(super) fn color_of_bytes(&self, texels: &[[u8; 4]], width: u32) -> Vector<F> {
        let mut found = <[F::Integers; 4]>::default();
        for lane in 0..F::LANES {
            for (words, index) in found.iter_mut().zip(self.indices(lane, width)) {
                words.as_mut()[lane] = u32::from_le_bytes(texels[index]);
            }
        }
        let ([a, b, c, d], token) = (&found, self.fractions[0].token());
        self.mixed([shares(token, a), shares(token, b), shares(token, c), shares(token, d)])
    }

    /// The weighted colours, from those of the texels, row by row.
    #[inline(always)]
    fn mixed(&self, [a, b, c, d]: [Vector<F>; 4]) -> Vector<F> {
        let [across, down] = self.fractions;
        mix(mix(a, b, across), mix(c, d, across), down)
    }
}

/// The colours of texels of 8 bits a channel, as in [`SHARES`].
#[inline(always)]
pub(super) fn shares<F: Single>(token: F::Token, texels: &F::Integers) -> Vector<F> {
    let [red, green] = [F::byte(token, texels, 0), F::byte(token, texels, 8)];
    Vector::new(red, green, F::byte(token, texels, 16)).over(F::splat(token, 255.0))
}

/// `of` each of four numbers: see [`both`].
#[inline(always)]
pub(super) fn four<A>([a, b, c, d]: [usize; 4], of: impl Fn(usize) -> A) -> [A; 4] {
    [of(a), of(b), of(c), of(d)]
}

/// From `a` to `b` by `fraction`, below 1. Between equal colours the result is that colour,
/// although rounded weights need not add up to 1.
#[inline(always)]
pub(super) fn mix<F: Single>(a: Vector<F>, b: Vector<F>, fraction: F) -> Vector<F> {
    let between = a.scale(fraction.same(1.0) - fraction) + b.scale(fraction);
    let differs = a.x.ne(b.x) | a.y.ne(b.y) | a.z.ne(b.z);
    Vector::select(differs, between, a)
}
