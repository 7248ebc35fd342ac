//! How a file is lit that has no lights of its own, and what is behind it: what a user may ask for.

use glam::DVec3;

wavecrest_base::choices! {
    /// The lights that are put where a file has none.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Rig {
        /// A soft key from the left, a rim from behind, a sky that fills, and a ground that takes shadows.
        #[default]
        Studio = "studio",
        /// A light at the camera, and a sky.
        Headlight = "headlight",
        /// No lights: surfaces show their unlit colours.
        None = "none",
    }
}

/// What rays that hit nothing show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// A linear colour.
    Color(DVec3),
    /// Nothing: the image has an opacity.
    Transparent,
}

impl Background {
    /// What is rendered behind all else.
    pub(crate) fn color(self) -> DVec3 {
        match self {
            Self::Color(color) => color,
            Self::Transparent => DVec3::ZERO,
        }
    }
}

/// How a file is to look that says nothing of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lighting {
    /// What lights it.
    pub rig: Rig,
    /// What is behind it, in place of what the file says or of a light grey.
    pub background: Option<Background>,
    /// Edges of a standalone mesh without normals are smooth where its faces meet at less than this angle, in
    /// degrees; at 0 none is.
    pub crease_degrees: f64,
}

impl Lighting {
    /// A studio; edges of more than 30 degrees are sharp, as modelling programs have it.
    pub const USUAL: Self = Self { rig: Rig::Studio, background: None, crease_degrees: 30.0 };
}

impl Default for Lighting {
    fn default() -> Self {
        Self::USUAL
    }
}
