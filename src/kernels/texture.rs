//! Texture look-up.

/// How a look-up between texels is answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// The texel that the point lies in.
    Nearest,
    /// The four texels around the point, weighted.
    #[default]
    Bilinear,
}

/// How a coordinate outside 0 to 1 is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The image repeats.
    #[default]
    Repeat,
    /// The edge of the image goes on.
    Clamp,
}
