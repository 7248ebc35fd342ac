//! Lighting options and backgrounds of files without lights.

use std::str::FromStr;

use glam::DVec3;

use wavecrest_core::math::srgb::srgb_decode;

wavecrest_base::choices! {
    /// The lights added to a file without any.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Rig {
        /// A soft key light from the left, a rim light from behind, a sky as fill light, and a ground that receives shadows.
        #[default]
        Studio = "studio",
        /// A light at the camera, and a sky.
        Headlight = "headlight",
        /// No lights: surfaces show their plain colours.
        None = "none",
    }
}

/// The colour of rays that hit nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// A linear colour.
    Color(DVec3),
    /// Transparent: the image has an alpha channel.
    Transparent,
}

impl Background {
    /// The colour rendered behind everything.
    pub(crate) fn color(self) -> DVec3 {
        match self {
            Self::Color(color) => color,
            Self::Transparent => DVec3::ZERO,
        }
    }
}

impl FromStr for Background {
    type Err = String;

    /// A colour in sRGB such as `#ff8000`, or `transparent`.
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "transparent" {
            return Ok(Self::Transparent);
        }
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii());
        let level = |i: usize| {
            let level = u8::from_str_radix(digits?.get(2 * i..2 * i + 2)?, 16).ok()?;
            Some(f64::from(srgb_decode(f32::from(level) / 255.0)))
        };
        match (level(0), level(1), level(2)) {
            (Some(r), Some(g), Some(b)) => Ok(Self::Color(DVec3::new(r, g, b))),
            _ => Err("use transparent, or six hexadecimal digits such as #ffffff".to_owned()),
        }
    }
}

/// Lighting of files without lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lighting {
    /// What lights it.
    pub rig: Rig,
    /// Whether that also replaces the lights of a glTF file, other than its emission.
    pub replaces: bool,
    /// The background, overriding the file's or the default light grey.
    pub background: Option<Background>,
    /// Crease angle of a standalone mesh without normals, in degrees: edges with a smaller angle
    /// between their faces are smooth; at 0 none is.
    pub crease_degrees: f64,
}

impl Default for Lighting {
    /// A studio; edges of more than 30 degrees are sharp, as in modelling programs.
    fn default() -> Self {
        Self { rig: Rig::Studio, replaces: false, background: None, crease_degrees: 30.0 }
    }
}
