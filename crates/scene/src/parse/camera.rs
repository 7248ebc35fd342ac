//! The camera.

use glam::DVec3;

use crate::components::{CameraKey, CameraPath, FovAxis, Interpolation, Sampling, ThinLens, View};
use crate::corners::direction;
use crate::load::LoadOptions;
use crate::reader::{Cursor, Object, Range, integer_words};
use crate::schema::Camera;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::kernels::camera::path::least_aligned_axis;

use super::light::SAMPLINGS;

pub(super) const KEYS: [&str; 14] = [
    "type",
    "width",
    "height",
    "fov",
    "location",
    "position",
    "look",
    "lookat",
    "lookAt",
    "up",
    "fovaxis",
    "antialias",
    "sampling",
    "path",
];
pub(super) const LENS_KEYS: [&str; 4] = ["aperture", "focal", "nsamplesx", "nsamplesy"];

/// Keys of the path of a camera.
pub(super) const PATH_KEYS: [&str; 2] = ["keys", "interpolation"];
pub(super) const INTERPOLATIONS: [(&str, Interpolation); 2] =
    [("smooth", Interpolation::Smooth), ("linear", Interpolation::Linear)];

/// Keys of where a camera is at a frame; of a pinhole, the first [`PINHOLE_FRAME_KEYS`].
pub(super) const FRAME_KEYS: [&str; 6] = ["frame", "location", "look", "up", "fov", "focal"];
pub(super) const PINHOLE_FRAME_KEYS: usize = 5;

/// Greatest number of a frame.
pub(super) const LAST_FRAME: u32 = 9_999_999;

/// Greatest width and height of the image.
pub(crate) const LONGEST_SIDE: u32 = 65_536;
/// Greatest number of pixels, 2^28: as floats, three gibibytes.
const MOST_PIXELS: u64 = 1 << 28;
/// Greatest number of rays through each pixel, 2^24.
const MOST_RAYS: u64 = 1 << 24;
/// Greatest side of the grid of rays in each pixel.
pub(super) const MOST_ANTIALIAS: u32 = 64;
/// Greatest number of angles or radii of points on the lens.
pub(super) const MOST_LENS_SAMPLES: u32 = 4_096;
/// Points on the lens along each side of the grid, where the file does not say.
pub(super) const LENS_SAMPLES: u32 = 4;
/// Angles of view, in degrees. At 180 the image plane would be at infinity.
pub(crate) const FOV: Range = Range::new(0.001, 179.0);
/// Sine of the angle between `up` and the view below which they are taken as parallel: what is
/// left of `up` across the view would then be mostly rounding, in single precision.
const PARALLEL: f64 = 1e-6;

pub(super) const FOV_AXES: [(&str, FovAxis); 4] = [
    ("x", FovAxis::X),
    ("y", FovAxis::Y),
    ("smaller", FovAxis::Smaller),
    ("larger", FovAxis::Larger),
];

/// The cameras, and whether each has a lens.
pub(super) const KINDS: [(&str, bool); 2] = [("pinhole", false), ("thinlens", true)];

/// Reads the camera. The size that the `options` ask for takes the place of the file's.
pub(super) fn camera(cursor: &Cursor<'_>, options: &LoadOptions) -> Result<Camera> {
    let has_lens = cursor.kind("the camera", &KINDS)?;
    let object = if has_lens {
        cursor.object("a thin-lens camera", [&KEYS[..], &LENS_KEYS].concat())?
    } else {
        cursor.object("a pinhole camera", KEYS.into())?
    };
    let mut view = view(&object, options)?;
    if has_lens && view.sampling == Sampling::Random {
        // The report's key is about the lens: a pixel's rays are jittered whatever it says of that.
        view.sampling = Sampling::Jittered;
    }
    let lens = has_lens.then(|| lens(&object)).transpose()?;
    check_rays(&object, &view, lens.as_ref())?;
    let path = object.get("path").map(|cursor| path(&cursor, &view, lens.as_ref())).transpose()?;
    Ok(Camera { view, lens, path })
}

/// Reads the path of the camera, which is at `view` with `lens` where a key does not say otherwise.
fn path(cursor: &Cursor<'_>, view: &View, lens: Option<&ThinLens>) -> Result<CameraPath> {
    let object = cursor.object("the path of a camera", PATH_KEYS.into())?;
    let interpolation =
        object.choice_or("interpolation", &INTERPOLATIONS, Interpolation::default())?;
    let what = "an array of keys, at least one";
    let list = object.need("keys", what)?;
    let mut keys: Vec<CameraKey> = Vec::new();
    for item in list.items(list.array(what)?) {
        let key = key(&item, view, lens)?;
        if keys.last().is_some_and(|last| last.frame >= key.frame) {
            let error = item.error("the frame must be greater than that of the key before");
            return Err(error.remedy("put the keys in the order of their frames"));
        }
        keys.push(key);
    }
    if keys.is_empty() {
        return Err(list.error(format!("must be {what}")));
    }
    Ok(CameraPath { keys, interpolation })
}

fn key(cursor: &Cursor<'_>, view: &View, lens: Option<&ThinLens>) -> Result<CameraKey> {
    let keys = if lens.is_some() { &FRAME_KEYS[..] } else { &FRAME_KEYS[..PINHOLE_FRAME_KEYS] };
    let object = cursor.object("a key of a camera's path", keys.to_vec())?;
    let location = object.point_or("location", view.location)?;
    let look = object.point_or("look", view.look)?;
    if look == location {
        let error = cursor.error("the camera looks at the point where it stands");
        return Err(error.remedy("move \"look\" away from \"location\""));
    }
    let focal = lens.map_or(1.0, |lens| lens.focal);
    Ok(CameraKey {
        frame: object.integer("frame", 0, LAST_FRAME)?,
        location,
        look,
        up: object.point_or("up", view.up)?,
        fov_degrees: object.number_or("fov", FOV, view.fov_degrees)?,
        focal: match lens {
            Some(_) => object.number_or("focal", Range::POSITIVE, focal)?,
            None => focal,
        },
    })
}

fn view(object: &Object<'_>, options: &LoadOptions) -> Result<View> {
    let (width, height) = size(object, options)?;
    let fov_degrees = object.number("fov", FOV)?;
    let fov_axis = object.choice_or("fovaxis", &FOV_AXES, FovAxis::default())?;
    let location = object.point(&["location", "position"])?;
    let look = look(object, location)?;
    let up = up(object, look - location)?;
    let antialias = object.count_or("antialias", MOST_ANTIALIAS, 1)?;
    let sampling = sampling(object)?;
    Ok(View { location, look, up, fov_degrees, fov_axis, width, height, antialias, sampling })
}

fn size(object: &Object<'_>, options: &LoadOptions) -> Result<(u32, u32)> {
    let width = side(object, "width", options.width)?;
    let height = side(object, "height", options.height)?;
    match too_many_pixels(width, height) {
        Some(message) => Err(limit(object, message, pixels_allowed())),
        None => Ok((width, height)),
    }
}

fn too_many_pixels(width: u32, height: u32) -> Option<String> {
    let pixels = u64::from(width) * u64::from(height);
    (pixels > MOST_PIXELS)
        .then(|| format!("the image would have {width} x {height} = {pixels} pixels"))
}

fn pixels_allowed() -> String {
    format!("at most {MOST_PIXELS} (2^28) are allowed")
}

/// Checks the size of an image that no scene file tells.
pub(crate) fn check_size(width: u32, height: u32) -> Result<()> {
    check_side("width", width)?;
    check_side("height", height)?;
    match too_many_pixels(width, height) {
        Some(message) => Err(Error::new(ErrorKind::Limit, message).remedy(pixels_allowed())),
        None => Ok(()),
    }
}

/// A side of the image: the one asked for, if one is, but the file must be right all the same.
fn side(object: &Object<'_>, key: &'static str, asked: Option<u32>) -> Result<u32> {
    let own = object.integer(key, 1, LONGEST_SIDE)?;
    let Some(asked) = asked else { return Ok(own) };
    check_side(key, asked)?;
    Ok(asked)
}

/// Checks a side that is asked for.
fn check_side(key: &str, asked: u32) -> Result<()> {
    if (1..=LONGEST_SIDE).contains(&asked) {
        return Ok(());
    }
    let words = integer_words(1, LONGEST_SIDE);
    let message = format!("the {key} asked for in place of the scene's must be {words}");
    let kind = if asked == 0 { ErrorKind::Usage } else { ErrorKind::Limit };
    Err(Error::new(kind, message).value(asked))
}

fn look(object: &Object<'_>, location: DVec3) -> Result<DVec3> {
    let names = ["look", "lookat", "lookAt"];
    let look = object.point(&names)?;
    match object.one_of(&names)? {
        Some(cursor) if look == location => {
            let error = cursor.error("the camera looks at the point where it stands");
            Err(error.remedy("move \"look\" away from \"location\""))
        }
        _ => Ok(look),
    }
}

/// The upward direction: the file's, unless it does not tell which way up the image is.
fn up(object: &Object<'_>, view: DVec3) -> Result<DVec3> {
    let up = object.point_or("up", DVec3::Y)?;
    let Some(unit) = direction(up) else {
        let cursor = object.need("up", "a direction")?;
        return Err(cursor
            .error("must have a direction")
            .remedy("give a vector such as [0, 1, 0]"));
    };
    let Some(view) = direction(view).filter(|v| v.cross(unit).length() < PARALLEL) else {
        return Ok(up);
    };
    let axis = least_aligned_axis(view);
    warn_of_up(object, up, axis);
    Ok(axis)
}

fn warn_of_up(object: &Object<'_>, up: DVec3, axis: DVec3) {
    let notes = object.cursor().notes();
    let place = format!("{}.up", object.cursor().path());
    let message = "is parallel to the view, so that it does not say which way up the image is";
    let error = notes.error(ErrorKind::Scene, &place, message.into()).value(up);
    notes.warn(&error.remedy(format!("{axis} is used instead")));
}

fn lens(object: &Object<'_>) -> Result<ThinLens> {
    Ok(ThinLens {
        aperture: object.number("aperture", Range::NOT_NEGATIVE)?,
        focal: object.number("focal", Range::POSITIVE)?,
        sampling: sampling(object)?,
        samples_x: object.count_or("nsamplesx", MOST_LENS_SAMPLES, LENS_SAMPLES)?,
        samples_y: object.count_or("nsamplesy", MOST_LENS_SAMPLES, LENS_SAMPLES)?,
    })
}

fn sampling(object: &Object<'_>) -> Result<Sampling> {
    object.choice_or("sampling", &SAMPLINGS, Sampling::Jittered)
}

fn check_rays(object: &Object<'_>, view: &View, lens: Option<&ThinLens>) -> Result<()> {
    let (x, y) = lens.map_or((1, 1), |lens| (lens.samples_x, lens.samples_y));
    let n = view.antialias;
    // At most 64 * 64 * 4096 * 4096 = 2^36.
    let rays = u64::from(n) * u64::from(n) * u64::from(x) * u64::from(y);
    if rays <= MOST_RAYS {
        return Ok(());
    }
    let message = format!(
        "each pixel would have {n} x {n} (antialias) x {x} x {y} (nsamplesx, nsamplesy) = {rays} rays"
    );
    Err(limit(object, message, format!("at most {MOST_RAYS} (2^24) are allowed")))
}

fn limit(object: &Object<'_>, message: String, allowed: String) -> Error {
    let cursor = object.cursor();
    cursor.notes().error(ErrorKind::Limit, &cursor.path(), message).remedy(allowed)
}
