//! Input options of a file: image size, camera, lights.

use std::path::Path;

use glam::DVec3;

use crate::common::{choice, number, whole};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::math::srgb::srgb_decode;
use wavecrest_scene::load::framing::{Fit, Fov, Framing, Sheet, Side, Up};
use wavecrest_scene::load::lighting::{Background, Lighting, Rig};
use wavecrest_scene::load::{FileFormat, LONGEST_SIDE, LoadOptions};

/// Options of every command that reads a scene, a glTF file or a mesh.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct InputOptions {
    /// Width of the image in pixels [default: in proportion to --height, or that of the scene; 1024 for a mesh]
    #[arg(long, value_name = "PIXELS", value_parser = side)]
    pub(crate) width: Option<u32>,
    /// Height of the image in pixels [default: in proportion to --width, or that of the scene; 768 for a mesh]
    #[arg(long, value_name = "PIXELS", value_parser = side)]
    pub(crate) height: Option<u32>,
    /// Camera of a glTF file, by name or number [default: the first]
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: Option<String>,
    /// Also read files outside the folder of the glTF or OBJ file that names them
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// View of a mesh or a glTF file, instead of its own camera: front, back, left, right, top, bottom, iso,
    /// inside, or two angles in degrees (from the front to the right, and up)
    #[arg(
        long,
        value_name = "SIDE|AZIMUTH,ELEVATION",
        allow_hyphen_values = true,
        conflicts_with = "camera"
    )]
    pub(crate) view: Option<Side>,
    /// Up axis of a mesh or a glTF file [default: y; z for STL, and for PLY that stands only along z]
    #[arg(long, value_name = "AXIS", value_parser = choice::<Up>(), allow_hyphen_values = true,
          conflicts_with = "camera")]
    pub(crate) up: Option<Up>,
    /// Angle of view of a mesh or a glTF file, across the shorter side of the image [default: 40; 60 in rooms]
    #[arg(long, value_name = "DEGREES", conflicts_with = "camera")]
    pub(crate) fov: Option<Fov>,
    /// Share of the image that a mesh or a glTF file fills, 0 to 1 [default: 0.92]
    #[arg(long, value_name = "SHARE", conflicts_with = "camera")]
    pub(crate) fit: Option<Fit>,
    /// Turn once around a mesh or a glTF file in this many frames, numbered from 1
    #[arg(long, value_name = "FRAMES", value_parser = whole(2..=3600_u32), conflicts_with = "camera")]
    pub(crate) turntable: Option<u32>,
    /// Show a mesh or a glTF file from several sides in one image, with a name under each
    #[arg(long, value_name = "SIDE,SIDE,...", allow_hyphen_values = true,
          conflicts_with_all = ["camera", "view", "turntable"])]
    pub(crate) sheet: Option<Sheet>,
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

impl InputOptions {
    /// Whether the image has an alpha channel.
    pub(crate) fn is_transparent(&self) -> bool {
        self.background == Some(Background::Transparent)
    }

    /// The options for the loader.
    pub(crate) fn load_options(&self) -> LoadOptions {
        let Self { width, height, allow_outside, up, fov, fit, turntable, .. } = *self;
        let sheet = self.sheet.clone().unwrap_or_default();
        let usual = Lighting::default();
        let lighting = Lighting {
            rig: match self.lights.unwrap_or(usual.rig) {
                Rig::Studio if self.without_ground => Rig::Headlight,
                rig => rig,
            },
            replaces: self.lights.is_some(),
            background: self.background,
            crease_degrees: self.crease.unwrap_or(usual.crease_degrees),
        };
        LoadOptions {
            strict: false,
            width,
            height,
            camera: self.camera.clone(),
            allow_outside,
            framing: Framing { side: self.view, up, fov, fit, turntable, sheet },
            lighting,
        }
    }

    /// Refuses options that have no effect on `file`.
    ///
    /// # Errors
    /// If there is one, or the file has an unknown format.
    pub(crate) fn check(&self, file: &Path) -> Result<()> {
        let Self { lights, crease, .. } = self;
        let (option, remedy) = match FileFormat::of(file)? {
            FileFormat::Scene if lights.is_some() => {
                ("--lights", "leave it out, and change \"lightsources\" in the scene")
            }
            FileFormat::Scene if crease.is_some() => {
                ("--crease", "leave it out, and set \"shading\" in the scene")
            }
            FileFormat::Gltf if crease.is_some() => {
                ("--crease", "leave it out, and export the normals that you want")
            }
            _ => return Ok(()),
        };
        let error = Error::new(ErrorKind::Usage, format!("{option} has no effect on this file"));
        Err(error.in_file(file).remedy(remedy))
    }
}

/// A side of an image in pixels.
fn side(text: &str) -> std::result::Result<u32, String> {
    let pixels = |text: &str| text.parse().ok().filter(|side| (1..=LONGEST_SIDE).contains(side));
    if let Some((Some(width), Some(height))) =
        text.split_once(['x', 'X']).map(|(width, height)| (pixels(width), pixels(height)))
    {
        return Err(format!("use --width {width} --height {height}"));
    }
    pixels(text).ok_or_else(|| format!("use a whole number from 1 to {LONGEST_SIDE}"))
}

/// A colour such as #ff8000, or none.
fn background(text: &str) -> std::result::Result<Background, String> {
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

fn degrees(text: &str) -> std::result::Result<f64, String> {
    number(text, |degrees| (0.0..=180.0).contains(degrees), "use a number from 0 to 180")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_side_says_what_to_write() {
        assert_eq!(side("300"), Ok(300));
        assert_eq!(side("300x200").unwrap_err(), "use --width 300 --height 200");
        for wrong in ["0", "-5", "1.5", "65537", "300x0", "wide"] {
            assert_eq!(side(wrong).unwrap_err(), "use a whole number from 1 to 65536", "{wrong}");
        }
    }
}
