//! Coordinates outside 0 to 1, and the texels around a point.
//!
//! Numbers of texels are whole numbers in single precision, which sides of images never exceed.

use crate::math::{Real, Single};

wavecrest_base::choices! {
    /// How a coordinate outside 0 to 1 is taken.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Wrap {
        /// The image repeats.
        #[default]
        Repeat = "repeat",
        /// The edge of the image goes on.
        Clamp = "clamp",
        /// The image repeats, each second time turned about: its edges meet themselves.
        Mirror = "mirror",
    }
}

/// The position of each `coordinate` along `count` texels: in \[0, count\].
#[inline(always)]
pub(super) fn position<F: Single>(coordinate: F, count: F, wrap: Wrap) -> F {
    let (zero, one) = (count.zero(), count.same(1.0));
    let is_finite = coordinate.abs().lt(count.same(f32::INFINITY));
    let coordinate = F::select(is_finite, coordinate, zero);
    let fraction = match wrap {
        // The far edge is the end of the image, not the start of the next one.
        Wrap::Repeat => F::select(coordinate.eq(one), one, coordinate - Real::floor(coordinate)),
        Wrap::Clamp => coordinate.max(zero).min(one),
        Wrap::Mirror => {
            // Forward and back. The remainder is exact, and so is the rest of the way.
            let way = coordinate.abs();
            let way = way - Real::floor(way.times(0.5)).times(2.0);
            way.min(way.same(2.0) - way)
        }
    };
    fraction * count
}

/// The texel at or below each `x`, clamped to the image.
#[inline(always)]
pub(super) fn below<F: Single>(x: F, count: F) -> F {
    Real::floor(x).min(count - count.same(1.0))
}

/// The two texels whose centres surround each `x`, and the fraction from the first to the second.
#[inline(always)]
pub(super) fn neighbours<F: Single>(x: F, count: F, wrap: Wrap) -> [F; 3] {
    let (zero, one) = (count.zero(), count.same(1.0));
    let from_centre = x - x.same(0.5);
    let first = Real::floor(from_centre);
    let (next, last) = (first + one, count - one);
    let [low, high] = match wrap {
        Wrap::Repeat => [last, zero],
        // The texel beyond a mirrored edge is the edge texel again.
        Wrap::Clamp | Wrap::Mirror => [zero, last],
    };
    let before = F::select(first.lt(zero), low, first);
    let after = F::select(next.gt(last), high, next);
    [before, after, from_centre - first]
}
