//! Options on the lights of files without any.

use glam::DVec3;

use crate::choice::choice;
use wavecrest_core::math::srgb::srgb_decode;
use wavecrest_scene::load::lighting::{Background, Lighting, Rig};

/// Options on the lights, the background and the smoothness of files that have none.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LightingOptions {
    /// Lights of a mesh, or of a glTF file in place of its own [default: studio where it has none]
    #[arg(long, value_name = "RIG", value_parser = choice::<Rig>())]
    pub(crate) lights: Option<Rig>,
    /// Whether the lights put up no ground, which a look would show
    #[arg(skip)]
    pub(crate) without_ground: bool,
    /// Background: a colour in sRGB such as #ffffff, or transparent
    #[arg(long, value_name = "COLOR", value_parser = background)]
    pub(crate) background: Option<Background>,
    /// Smooth the edges of a mesh without normals up to this angle between faces; 0 for flat faces [default: 30]
    #[arg(long, value_name = "DEGREES", value_parser = degrees)]
    pub(crate) crease: Option<f64>,
}

impl LightingOptions {
    /// Whether the image has an alpha channel.
    pub(crate) fn is_transparent(&self) -> bool {
        self.background == Some(Background::Transparent)
    }

    /// The options for the loader.
    pub(crate) fn options(&self) -> Lighting {
        let usual = Lighting::default();
        let crease_degrees = self.crease.unwrap_or(usual.crease_degrees);
        let rig = match self.lights.unwrap_or(usual.rig) {
            Rig::Studio if self.without_ground => Rig::Headlight,
            rig => rig,
        };
        let replaces = self.lights.is_some();
        Lighting { rig, replaces, background: self.background, crease_degrees }
    }
}

/// A colour such as #ff8000, or none.
fn background(text: &str) -> Result<Background, String> {
    if text == "transparent" {
        return Ok(Background::Transparent);
    }
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii());
    let level = |i: usize| {
        let level = u8::from_str_radix(digits?.get(2 * i..2 * i + 2)?, 16).ok()?;
        Some(f64::from(srgb_decode(f32::from(level) / 255.0)))
    };
    match (level(0), level(1), level(2)) {
        (Some(r), Some(g), Some(b)) => Ok(Background::Color(DVec3::new(r, g, b))),
        _ => Err("use transparent, or six hexadecimal digits such as #ffffff".to_owned()),
    }
}

fn degrees(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|degrees| (0.0..=180.0).contains(degrees));
    number.ok_or_else(|| "use a number from 0 to 180".to_owned())
}
