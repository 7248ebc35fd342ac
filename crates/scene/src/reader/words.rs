//! The words of scene files, and what they mean.

use crate::components::{
    Encoding, Falloff, Filter, FovAxis, Interpolation, Sampling, Shading, Sides, Wrap,
};

/// What a scene file says by one of a few words.
pub(crate) trait Word: Copy + PartialEq + 'static {
    /// The words, and what each means.
    const WORDS: &'static [(&'static str, Self)];

    /// The word for this.
    fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, meaning)| *meaning == self).map_or("", |(word, _)| word)
    }

    /// What a word means.
    fn of(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(name, _)| *name == word).map(|(_, meaning)| *meaning)
    }
}

impl Word for Encoding {
    const WORDS: &[(&str, Self)] = &[("linear", Self::Linear), ("srgb", Self::Srgb)];
}

impl Word for Falloff {
    const WORDS: &[(&str, Self)] =
        &[("linear", Self::Linear), ("inverse-square", Self::InverseSquare), ("none", Self::None)];
}

impl Word for Filter {
    const WORDS: &[(&str, Self)] =
        &[("nearest", Self::Nearest), ("bilinear", Self::Bilinear), ("trilinear", Self::Trilinear)];
}

impl Word for FovAxis {
    const WORDS: &[(&str, Self)] =
        &[("x", Self::X), ("y", Self::Y), ("smaller", Self::Smaller), ("larger", Self::Larger)];
}

impl Word for Interpolation {
    const WORDS: &[(&str, Self)] = &[("smooth", Self::Smooth), ("linear", Self::Linear)];
}

impl Word for Sampling {
    const WORDS: &[(&str, Self)] =
        &[("random", Self::Random), ("jittered", Self::Jittered), ("sobol", Self::Sobol)];
}

impl Word for Shading {
    const WORDS: &[(&str, Self)] = &[("flat", Self::Flat), ("smooth", Self::Smooth)];
}

impl Word for Sides {
    const WORDS: &[(&str, Self)] = &[("front", Self::Front), ("both", Self::Both)];
}

impl Word for Wrap {
    const WORDS: &[(&str, Self)] = &[("repeat", Self::Repeat), ("clamp", Self::Clamp)];
}
