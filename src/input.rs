//! Input options of a file: image size, camera, lights.

use std::path::Path;

use crate::choice::choice;
use crate::common::whole;
use crate::lighting::LightingOptions;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_scene::load::framing::{Fit, Fov, Framing, Sheet, Side, Up};
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
    /// Camera of a mesh or a glTF file
    #[command(flatten)]
    pub(crate) framing: FramingOptions,
    /// Lights of a file without any
    #[command(flatten)]
    pub(crate) lighting: LightingOptions,
}

impl InputOptions {
    /// The options for the loader.
    pub(crate) fn load_options(&self) -> LoadOptions {
        LoadOptions {
            strict: false,
            width: self.width,
            height: self.height,
            camera: self.camera.clone(),
            allow_outside: self.allow_outside,
            framing: (&self.framing).into(),
            lighting: self.lighting.options(),
        }
    }

    /// Refuses options that have no effect on `file`.
    ///
    /// # Errors
    /// If there is one, or the file has an unknown format.
    pub(crate) fn check(&self, file: &Path) -> Result<()> {
        let LightingOptions { lights, crease, .. } = self.lighting;
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

/// Options on the camera of a mesh or a glTF file.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct FramingOptions {
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
}

impl From<&FramingOptions> for Framing {
    fn from(options: &FramingOptions) -> Self {
        let FramingOptions { view: side, up, fov, fit, turntable, .. } = *options;
        Self { side, up, fov, fit, turntable, sheet: options.sheet.clone().unwrap_or_default() }
    }
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
