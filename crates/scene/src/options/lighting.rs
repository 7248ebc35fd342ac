//! Lighting options and backgrounds of files without lights.

use std::str::FromStr;

use glam::{DVec3, Vec3};

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

    /// A colour as of [`screen_color`], or `transparent`.
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "transparent" {
            return Ok(Self::Transparent);
        }
        screen_color(text).map(Self::Color).map_err(|_| format!("use transparent, {COLORS}"))
    }
}

/// What colours in sRGB look like.
const COLORS: &str =
    "three numbers from 0 to 1, such as 1,0.5,0, or six hexadecimal digits, such as #ff8000";

/// The linear colour of one in sRGB: three numbers from 0 to 1, or `#` and six hexadecimal digits.
///
/// # Errors
/// In words, if it is neither.
pub fn screen_color(text: &str) -> Result<DVec3, String> {
    let byte = |digits: &[u8]| u8::from_str_radix(str::from_utf8(digits).ok()?, 16).ok();
    let number = |word: &str| word.trim().parse().ok().filter(|x| (0.0..=1.0_f32).contains(x));
    let levels: Option<Vec<f32>> = match text.strip_prefix('#').map(str::as_bytes) {
        Some(digits) if digits.len() == 6 && digits.iter().all(u8::is_ascii_hexdigit) => {
            digits.chunks(2).map(|two| Some(f32::from(byte(two)?) / 255.0)).collect()
        }
        Some(_) => None,
        None => text.split(',').map(number).collect(),
    };
    match levels.as_deref() {
        Some(&[r, g, b]) => Ok(Vec3::new(r, g, b).map(srgb_decode).as_dvec3()),
        _ => Err(format!("use {COLORS}")),
    }
}

/// Lighting of files without lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lighting {
    /// What lights it.
    pub rig: Rig,
    /// Whether that also replaces the lights of a glTF file, other than its emission.
    pub replaces: bool,
    /// Whether the added lights are those of the usual view, wherever [`LookAt`](super::framing::LookAt) takes the camera.
    pub stays: bool,
    /// The background, overriding the file's or the default light grey.
    pub background: Option<Background>,
    /// Crease angle of a standalone mesh without normals, in degrees: edges with a smaller angle
    /// between their faces are smooth; at 0 none is.
    pub crease_degrees: f64,
}

impl Default for Lighting {
    /// A studio; edges of more than 30 degrees are sharp, as in modelling programs.
    fn default() -> Self {
        Self {
            rig: Rig::Studio,
            replaces: false,
            stays: false,
            background: None,
            crease_degrees: 30.0,
        }
    }
}
