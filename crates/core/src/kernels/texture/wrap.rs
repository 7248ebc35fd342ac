//! Coordinates outside 0 to 1, and the texels around a point.

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

/// The position of `coordinate` along `count` texels: in \[0, count\].
#[inline]
pub(super) fn position(coordinate: f32, count: u32, wrap: Wrap) -> f32 {
    let coordinate = if coordinate.is_finite() { coordinate } else { 0.0 };
    let fraction = match wrap {
        // The far edge is the end of the image, not the start of the next one.
        Wrap::Repeat if coordinate == 1.0 => 1.0,
        Wrap::Repeat => coordinate - coordinate.floor(),
        Wrap::Clamp => coordinate.clamp(0.0, 1.0),
        Wrap::Mirror => {
            // Forward and back. The remainder is exact, and so is the rest of the way.
            let way = coordinate.abs() % 2.0;
            if way > 1.0 { 2.0 - way } else { way }
        }
    };
    fraction * count as f32
}

/// The texel at or below `x`, clamped to the image.
#[inline]
pub(super) fn below(x: f32, count: u32) -> u32 {
    (x as u32).min(count - 1)
}

/// The two texels whose centres surround `x`, and the fraction from the first to the second.
#[inline]
pub(super) fn neighbours(x: f32, count: u32, wrap: Wrap) -> (u32, u32, f32) {
    let from_centre = x - 0.5;
    let floor = from_centre.floor();
    let fraction = from_centre - floor;
    let first = floor as i64;
    let bound = |i: i64| match wrap {
        Wrap::Repeat => i.rem_euclid(i64::from(count)) as u32,
        // The texel beyond a mirrored edge is the edge texel again.
        Wrap::Clamp | Wrap::Mirror => i.clamp(0, i64::from(count) - 1) as u32,
    };
    (bound(first), bound(first + 1), fraction)
}
