//! Input options of a file: image size, camera, lights.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use bytesize::ByteSize;
use glam::DVec3;

use crate::allocator;
use crate::common::{
    FILES, FRAMES, IMAGE, SPEED, SearchOptions, Threads, VIEW, choice, number, numbers, tell_all,
    whole, with_names,
};
use crate::progress::{Display, Style};
use wavecrest_api::{self as api, session::Session};
use wavecrest_base::choice::Choice as _;
use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::float::MAX_COORDINATE;
use wavecrest_scene::components::Sampling;
use wavecrest_scene::load::framing::{Fit, Fov, Framing, LookAt, Side, Up};
use wavecrest_scene::load::lighting::{Background, Lighting, Rig, screen_color};
use wavecrest_scene::load::{
    FileFormat, LONGEST_SIDE, LoadOptions, LoadedScene, MOST_SAMPLES, antialias, load,
};

/// Options of every command that reads a scene, a glTF file or a mesh.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct InputOptions {
    /// Size of the image in pixels, such as 1280x720 [default: that of the scene; 1024x768 for a mesh]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size,
          conflicts_with_all = ["width", "height"])]
    pub(crate) size: Option<[u32; 2]>,
    /// Rays per pixel, in a square grid: 1, 4, 9, ..., 4096; other numbers are rounded up. 4 is "antialias": 2 in a
    /// scene; a lens multiplies them by its own. With a target error or a time, the most [default: those of the scene; 4 for a mesh]
    #[arg(long, value_name = "N", value_parser = whole(1..=MOST_SAMPLES))]
    pub(crate) samples: Option<u32>,
    /// Distribution of the rays in each pixel: random, jittered or sobol; each then has one point on a lens
    /// [default: that of the scene; jittered for a mesh]
    #[arg(long, help_heading = IMAGE, value_name = "NAME", hide_possible_values = true, value_parser = choice::<Sampling>())]
    pub(crate) sampler: Option<Sampling>,
    /// Width of the image in pixels; the height follows in proportion
    #[arg(long, help_heading = IMAGE, value_name = "PIXELS", value_parser = side)]
    pub(crate) width: Option<u32>,
    /// Height of the image in pixels; the width follows in proportion
    #[arg(long, help_heading = IMAGE, value_name = "PIXELS", value_parser = side)]
    pub(crate) height: Option<u32>,
    /// Camera of a glTF file, by name or number [default: the first]
    #[arg(long, help_heading = VIEW, value_name = "NAME")]
    pub(crate) camera: Option<String>,
    /// Also read files outside the folder of the glTF or OBJ file that names them
    #[arg(long, help_heading = FILES)]
    pub(crate) allow_outside: bool,
    /// View of a mesh or a glTF file, instead of its own camera: front, back, left, right, top, bottom, iso,
    /// inside, or two angles in degrees (from the front to the right, and up)
    #[arg(
        long, help_heading = VIEW,
        value_name = "SIDE|AZIMUTH,ELEVATION",
        allow_hyphen_values = true,
        hide_possible_values = true,
        value_parser = with_names(&SIDES, <Side as FromStr>::from_str),
        conflicts_with = "camera"
    )]
    pub(crate) view: Option<Side>,
    /// Another place for the camera, in the coordinates of the file
    #[arg(long, help_heading = IMAGE, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true,
          conflicts_with = "turntable")]
    pub(crate) from: Option<DVec3>,
    /// Point that it looks at from there [default: what it looks at without]
    #[arg(long, help_heading = IMAGE, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true,
          requires = "from")]
    pub(crate) at: Option<DVec3>,
    /// Up axis of a mesh or a glTF file [default: y; z for STL, and for others that stand only along z]. Three numbers are
    /// up in the image alone, with --from; both may be given
    #[arg(long, help_heading = VIEW, value_name = "AXIS|X,Y,Z", value_parser = with_names(&AXES, upward),
          hide_possible_values = true, allow_hyphen_values = true)]
    pub(crate) up: Vec<Upward>,
    /// Angle of view of a mesh or a glTF file, across the shorter side of the image [default: 40; 60 in rooms]
    #[arg(long, help_heading = VIEW, value_name = "DEGREES", conflicts_with = "camera")]
    pub(crate) fov: Option<Fov>,
    /// Share of the image that a mesh or a glTF file fills, 0 to 1 [default: 0.92]
    #[arg(long, help_heading = VIEW, value_name = "SHARE", conflicts_with = "camera")]
    pub(crate) fit: Option<Fit>,
    /// Turn once around a mesh or a glTF file in this many frames, numbered from 1
    #[arg(long, help_heading = FRAMES, value_name = "FRAMES", value_parser = whole(2..=3600_u32), conflicts_with = "camera")]
    pub(crate) turntable: Option<u32>,
    /// Lights of a mesh, or of a glTF file in place of its own [default: studio where it has none]
    #[arg(long, help_heading = VIEW, value_name = "RIG", value_parser = choice::<Rig>())]
    pub(crate) lights: Option<Rig>,
    /// Keep the added lights where they are for the usual view, instead of moving them with the camera
    #[arg(long, help_heading = VIEW)]
    pub(crate) lights_stay: bool,
    /// Colour of a mesh alone where it has no material: three numbers from 0 to 1, or #rrggbb; in sRGB
    #[arg(long, help_heading = VIEW, value_name = "R,G,B", value_parser = screen_color)]
    pub(crate) color: Option<DVec3>,
    /// Image around a mesh alone, by longitude and latitude, which lights it in place of other lights
    #[arg(long, help_heading = VIEW, value_name = "FILE", conflicts_with = "lights")]
    pub(crate) environment: Option<PathBuf>,
    /// Background: a colour in sRGB, such as 1,1,1 or #ffffff, or transparent
    #[arg(long, help_heading = IMAGE, value_name = "COLOR", hide_possible_values = true,
          value_parser = with_names(&["transparent"], <Background as FromStr>::from_str))]
    pub(crate) background: Option<Background>,
    /// Smooth the edges of a mesh without normals up to this angle between faces; 0 for flat faces [default: 30]
    #[arg(long, help_heading = VIEW, value_name = "DEGREES", value_parser = degrees)]
    pub(crate) crease: Option<f64>,
    /// The number of faces to read of a mesh file, for the first image of a page. Its warnings are left to the reading of all.
    #[arg(skip)]
    pub(crate) first: Option<u64>,
}

impl InputOptions {
    /// Whether the image has an alpha channel.
    pub(crate) fn is_transparent(&self) -> bool {
        self.background == Some(Background::Transparent)
    }

    /// The axis of the file that is up, and the direction in the image, as far as they are given.
    pub(crate) fn axis(&self) -> Option<Up> {
        self.up.iter().find_map(|up| if let Upward::Axis(axis) = up { Some(*axis) } else { None })
    }

    pub(crate) fn direction(&self) -> Option<DVec3> {
        self.up.iter().find_map(|up| if let Upward::Direction(up) = up { Some(*up) } else { None })
    }

    /// The options for the loader.
    pub(crate) fn load_options(&self) -> LoadOptions {
        let Self { allow_outside, view: side, fov, fit, turntable, sampler: sampling, .. } = *self;
        let [width, height] = self.size.map_or([self.width, self.height], |size| size.map(Some));
        let usual = Lighting::default();
        let lighting = Lighting {
            rig: self.lights.unwrap_or(usual.rig),
            replaces: self.lights.is_some(),
            stays: self.lights_stay,
            background: self.background,
            crease_degrees: self.crease.unwrap_or(usual.crease_degrees),
        };
        LoadOptions {
            strict: false,
            width,
            height,
            antialias: self.samples.map(antialias),
            sampling,
            camera: self.camera.clone(),
            allow_outside,
            framing: Framing { side, up: self.axis(), fov, fit, turntable },
            look_at: self.from.map(|eye| LookAt { eye, target: self.at, up: self.direction() }),
            lighting,
            color: self.color,
            environment: self.environment.clone(),
            like_meshes: false,
            first: self.first,
        }
    }

    /// Refuses options that have no effect on `file`.
    ///
    /// # Errors
    /// If there is one, or the file has an unknown format.
    pub(crate) fn check(&self, file: &Path) -> Result<()> {
        let Self { lights, crease, color, environment, .. } = self;
        let usage = |message: &str| Error::new(ErrorKind::Usage, message).in_file(file);
        if self.direction().is_some() && self.from.is_none() {
            let error = usage("three numbers are up in the image of a camera from --from");
            return Err(error.remedy("add --from, or use an axis, such as --up z"));
        }
        if self.axis().is_some() && self.camera.is_some() {
            let error = usage("--up with an axis has no effect on --camera");
            return Err(error.remedy("leave out one of them"));
        }
        let known = usize::from(self.axis().is_some()) + usize::from(self.direction().is_some());
        if self.up.len() > known {
            return Err(usage("--up is given twice").remedy("use one axis, and one direction"));
        }
        let (option, remedy) = match FileFormat::of(file)? {
            FileFormat::Scene | FileFormat::Gltf if color.is_some() => {
                ("--color", "leave it out, and change the colours of its materials")
            }
            FileFormat::Scene if environment.is_some() => {
                ("--environment", "leave it out, and set \"environment\" in the scene")
            }
            FileFormat::Gltf if environment.is_some() => {
                ("--environment", "convert the file, and set \"environment\" in the scene")
            }
            FileFormat::Mesh
                if environment.is_some()
                    && matches!(self.background, Some(Background::Color(_))) =>
            {
                ("--background", "leave it out: the environment is seen")
            }
            FileFormat::Scene if self.lights_stay => {
                ("--lights-stay", "leave it out: the lights of a scene stay")
            }
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
        Err(usage(&format!("{option} has no effect on this file")).remedy(remedy))
    }
}

/// Named views.
const SIDES: [&str; 8] = ["front", "back", "left", "right", "top", "bottom", "iso", "inside"];

/// Named up axes.
const AXES: [&str; 6] = ["x", "y", "z", "-x", "-y", "-z"];

/// What is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Upward {
    /// The axis of the file.
    Axis(Up),
    /// The direction in the image, and nothing else.
    Direction(DVec3),
}

fn upward(text: &str) -> std::result::Result<Upward, String> {
    let direction = || point(text).map(Upward::Direction).ok();
    let wrong = || format!("use {}, or three numbers, such as 0,1,0", AXES.join(", "));
    Up::by_name(text).map(Upward::Axis).or_else(direction).ok_or_else(wrong)
}

/// The size of an image in pixels.
fn size(text: &str) -> std::result::Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']).map(|(width, height)| [width, height].map(side));
    match sides {
        Some([Ok(width), Ok(height)]) => Ok([width, height]),
        Some([Err(wrong), _] | [_, Err(wrong)]) => Err(wrong),
        None => Err("write width and height in pixels, such as 1280x720".to_owned()),
    }
}

/// A point whose coordinates scene files can hold.
fn point(text: &str) -> std::result::Result<DVec3, String> {
    let greatest = f64::from(MAX_COORDINATE);
    numbers(text)
        .map(DVec3::from_array)
        .filter(|point| point.is_finite() && point.abs().max_element() <= greatest)
        .ok_or_else(|| format!("write three numbers, such as 0,1.5,4; at most {greatest:e}"))
}

/// A side of an image in pixels.
fn side(text: &str) -> std::result::Result<u32, String> {
    if text.contains(['x', 'X']) && size(text).is_ok() {
        return Err(format!("use --size {text}"));
    }
    let wrong = format!("use a whole number from 1 to {LONGEST_SIDE}");
    number(text, |side| (1..=LONGEST_SIDE).contains(side), &wrong)
}

fn degrees(text: &str) -> std::result::Result<f64, String> {
    number(text, |degrees| (0.0..=180.0).contains(degrees), "use a number from 0 to 180")
}

/// Options on what scene is read and how.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SceneOptions {
    /// What is shown of the file
    #[command(flatten)]
    pub(crate) input: InputOptions,
    /// Treat unknown keys in a scene file as errors
    #[arg(long, help_heading = FILES)]
    pub(crate) strict: bool,
    /// Quality of the BVH [default: chosen from the numbers of triangles and rays]
    #[arg(long, help_heading = SPEED, value_name = "PRESET", value_parser = choice::<Preset>())]
    pub(crate) bvh: Option<Preset>,
    /// Precision of intersections: fast can leak at edges
    #[arg(long, help_heading = SPEED, value_name = "PRECISION", value_parser = choice::<Precision>(), default_value_t)]
    pub(crate) precision: Precision,
    /// Copy instanced meshes into world space instead of keeping them once
    #[arg(long, help_heading = SPEED)]
    pub(crate) flatten: bool,
    /// Take at most this much memory, such as 8GiB: what needs more ends with an error
    #[arg(long, help_heading = SPEED, value_name = "SIZE", value_parser = bytes)]
    pub(crate) memory_limit: Option<ByteSize>,
    /// Threads
    #[command(flatten)]
    pub(crate) threads: Threads,
    /// Print no notes, no progress and no summary; warnings and errors stay
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

impl SceneOptions {
    /// How the scene is prepared, and searched.
    pub(crate) fn preparing(&self, search: Option<&SearchOptions>) -> api::SceneOptions {
        let usual = api::SceneOptions::default();
        let (kernel, level) =
            search.map_or((usual.kernel, usual.level), |search| (search.kernel, search.simd));
        let Self { precision, bvh, flatten: flat, .. } = *self;
        api::SceneOptions { precision, bvh, flat, kernel, level, ..usual }
    }

    /// Reads and prepares `scene`, after a `change`, and prints its warnings.
    pub(crate) fn session(
        &self,
        scene: &Path,
        options: &api::SceneOptions,
        change: impl FnOnce(&mut LoadedScene) -> Result<()>,
    ) -> Result<Session> {
        let mut loaded = self.load(scene)?;
        change(&mut loaded)?;
        let mut session = Session::of(loaded, options, |_| Ok(()))?;
        tell_all(&mut session.warnings, &mut session.notes, self.quiet);
        Ok(session)
    }

    /// Reads `scene` with a bar, and prints its warnings.
    pub(crate) fn load(&self, scene: &Path) -> Result<LoadedScene> {
        let mut loaded = {
            let _reading = Display::new(Style::Auto, self.quiet || self.input.first.is_some());
            self.read(scene)?
        };
        self.tell(&mut loaded.warnings, &mut loaded.notes);
        Ok(loaded)
    }

    /// Prints what is to be told of a file, and nothing of a part of one.
    pub(crate) fn tell(&self, warnings: &mut Vec<Warning>, notes: &mut Vec<Warning>) {
        if self.input.first.is_none() {
            tell_all(warnings, notes, self.quiet);
        }
    }

    /// Reads `scene`, within the limit of memory.
    pub(crate) fn read(&self, scene: &Path) -> Result<LoadedScene> {
        self.input.check(scene)?;
        allocator::begin(scene, self.memory_limit);
        load(scene, &LoadOptions { strict: self.strict, ..self.input.load_options() })
    }
}

/// A number of bytes, with or without a unit.
fn bytes(text: &str) -> std::result::Result<ByteSize, String> {
    let size: std::result::Result<ByteSize, _> = text.parse();
    size.ok().filter(|size| size.as_u64() > 0).ok_or_else(|| {
        "write a number of bytes above 0, such as 8GiB, 500MB or 1000000000".to_owned()
    })
}
