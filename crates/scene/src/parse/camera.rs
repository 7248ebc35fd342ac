//! The camera.

use glam::DVec3;

use crate::components::{CameraKey, CameraPath, FovAxis, Interpolation, Sampling, ThinLens, View};
use crate::corners::direction;
use crate::load::LoadOptions;
use crate::reader::{Cursor, Key, Kind, Object, POINT, Range, integer_words, keys};
use crate::schema::Camera;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::kernels::camera::path::least_aligned_axis;

/// Largest number of a frame.
const LAST_FRAME: u32 = 9_999_999;

/// Largest width and height of an image, in pixels.
pub const LONGEST_SIDE: u32 = 65_536;
/// Largest number of pixels, 2^28: as floats, three gibibytes.
const MOST_PIXELS: u64 = 1 << 28;
/// Largest number of rays through each pixel, 2^24.
const MOST_RAYS: u64 = 1 << 24;
/// Largest side of the grid of rays in each pixel.
const MOST_ANTIALIAS: u32 = 64;
/// Largest number of angles or radii of points on the lens.
const MOST_LENS_SAMPLES: u32 = 4_096;
/// Default number of points on the lens along each side of the grid.
const LENS_SAMPLES: f64 = 4.0;
/// Angles of view, in degrees. At 180 the image plane would be at infinity.
pub(crate) const FOV: Range = Range::new(0.001, 179.0);
/// Sine of the angle between `up` and the view below which they count as parallel: the component of
/// `up` across the view would then be mostly single-precision rounding.
const PARALLEL: f64 = 1e-6;

wavecrest_base::choices! {
    /// The cameras.
    #[derive(Clone, Copy, PartialEq)]
    pub(crate) enum CameraKind {
        /// Everything is in focus.
        Pinhole = "pinhole",
        /// One plane is in focus.
        ThinLens = "thinlens",
    }
}

const LOCATIONS: [&str; 2] = ["location", "position"];
const LOOKS: [&str; 3] = ["look", "lookat", "lookAt"];

pub(crate) const PINHOLE: Kind = Kind {
    one_of: &[&LOCATIONS, &LOOKS],
    ..Kind::new(
        "a pinhole camera",
        "A pinhole camera: everything is in focus.",
        &[KEYS, PINHOLE_KEYS],
    )
};

pub(crate) const THIN_LENS: Kind = Kind {
    one_of: &[&LOCATIONS, &LOOKS],
    ..Kind::new(
        "a thin-lens camera",
        "A camera with a lens: one plane is in focus.",
        &[KEYS, LENS_KEYS],
    )
};

const KEYS: &[Key] = keys! {
    /// The kind of camera.
    "type": word::<CameraKind>(), Required;
    /// Width of the image, in pixels.
    "width": Integer(1, LONGEST_SIDE), Required;
    /// Height of the image, in pixels.
    "height": Integer(1, LONGEST_SIDE), Required;
    /// Full angle of view across one side of the image, in degrees.
    "fov": Number(FOV), Required;
    /// Position of the camera.
    "location": Point;
    /// Synonym of location.
    "position": Point;
    /// The point at the centre of the image.
    "look": Point;
    /// Synonym of look.
    "lookat": Point;
    /// Synonym of look.
    "lookAt": Point;
    /// Up in the image.
    "up": Point, Are([0.0, 1.0, 0.0]);
    /// The side across which fov is measured.
    "fovaxis": word::<FovAxis>(), Says("smaller");
    /// Side of the grid of rays in each pixel; 1 is one ray through its centre.
    "antialias": Integer(1, MOST_ANTIALIAS), Is(1.0);
    /// Distribution of rays: over the pixel for a pinhole, over its lens for a thin lens.
    "sampling": word::<Sampling>(), Says("jittered");
};

const PINHOLE_KEYS: &[Key] = keys! {
    /// The motion of the camera, frame by frame.
    "path": Definition("pinholePath");
};

const LENS_KEYS: &[Key] = keys! {
    /// The motion of the camera, frame by frame.
    "path": Definition("cameraPath");
    /// Diameter of the lens; 0 is a pinhole.
    "aperture": Number(Range::NOT_NEGATIVE), Required;
    /// Distance of the plane in focus, along the view.
    "focal": Number(Range::POSITIVE), Required;
    /// Points on the lens: angles. Their product with nsamplesy is the number of rays for each
    /// pixel.
    "nsamplesx": Integer(1, MOST_LENS_SAMPLES), Is(LENS_SAMPLES);
    /// Points on the lens: radii. Their product with nsamplesx is the number of rays for each
    /// pixel.
    "nsamplesy": Integer(1, MOST_LENS_SAMPLES), Is(LENS_SAMPLES);
};

/// How a pinhole moves.
pub(crate) const PINHOLE_PATH: Kind = path_kind(&[PINHOLE_PATH_KEYS, PATH_KEYS]);

/// How a camera with a lens moves.
pub(crate) const LENS_PATH: Kind = path_kind(&[LENS_PATH_KEYS, PATH_KEYS]);

const fn path_kind(keys: &'static [&'static [Key]]) -> Kind {
    Kind::new("a camera path", "The motion of the camera, frame by frame.", keys)
}

const PINHOLE_PATH_KEYS: &[Key] = keys! {
    /// The camera at some frames, in their order.
    "keys": AtLeast(1, &Nested(&PINHOLE_FRAME)), Required;
};

const LENS_PATH_KEYS: &[Key] = keys! {
    /// The camera at some frames, in their order.
    "keys": AtLeast(1, &Nested(&LENS_FRAME)), Required;
};

const PATH_KEYS: &[Key] = keys! {
    /// Interpolation between the keys.
    "interpolation": word::<Interpolation>(), Says("smooth");
};

const PINHOLE_FRAME: Kind = frame_kind(&[FRAME_KEYS]);
const LENS_FRAME: Kind = frame_kind(&[FRAME_KEYS, FOCAL_KEYS]);

const fn frame_kind(keys: &'static [&'static [Key]]) -> Kind {
    let about = "The camera at a frame; keys left out keep the values of the camera.";
    Kind::new("a keyframe of a camera path", about, keys)
}

const FRAME_KEYS: &[Key] = keys! {
    /// The frame.
    "frame": Integer(0, LAST_FRAME), Required;
    /// Position of the camera.
    "location": Point;
    /// The point at the centre of the image.
    "look": Point;
    /// Up in the image.
    "up": Point;
    /// Full angle of view across one side of the image, in degrees.
    "fov": Number(FOV);
};

const FOCAL_KEYS: &[Key] = keys! {
    /// Distance of the plane in focus, along the view.
    "focal": Number(Range::POSITIVE);
};

/// Reads the camera. The size in the `options` overrides the file's.
pub(super) fn camera(cursor: &Cursor<'_>, options: &LoadOptions) -> Result<Camera> {
    let has_lens = cursor.kind::<CameraKind>("the camera")? == CameraKind::ThinLens;
    let object = cursor.object(if has_lens { THIN_LENS } else { PINHOLE })?;
    let mut view = view(&object, options)?;
    if has_lens && view.sampling == Sampling::Random {
        // The report's key is about the lens: a pixel's rays are jittered for any value.
        view.sampling = Sampling::Jittered;
    }
    let lens = has_lens.then(|| lens(&object)).transpose()?;
    check_rays(&object, &view, lens.as_ref())?;
    let path = object.get("path").map(|cursor| path(&cursor, &view, lens.as_ref())).transpose()?;
    Ok(Camera { view, lens, path })
}

/// Reads the path of the camera, with the defaults of `view` and `lens`.
fn path(cursor: &Cursor<'_>, view: &View, lens: Option<&ThinLens>) -> Result<CameraPath> {
    let object = cursor.object(if lens.is_some() { LENS_PATH } else { PINHOLE_PATH })?;
    let interpolation = object.word("interpolation");
    let what = "an array of keys, at least one";
    let list = object.need("keys", what)?;
    let mut keys: Vec<CameraKey> = Vec::new();
    for item in list.items(list.array(what)?) {
        let key = key(&item, view, lens)?;
        if keys.last().is_some_and(|last| last.frame >= key.frame) {
            let error = item.error("the frame must be greater than the one before");
            return Err(error.remedy("sort the keys by frame"));
        }
        keys.push(key);
    }
    if keys.is_empty() {
        return Err(list.error(format!("must be {what}")));
    }
    Ok(CameraPath { keys, interpolation })
}

fn key(cursor: &Cursor<'_>, view: &View, lens: Option<&ThinLens>) -> Result<CameraKey> {
    let object = cursor.object(if lens.is_some() { LENS_FRAME } else { PINHOLE_FRAME })?;
    let location = object.point_or("location", view.location);
    let look = object.point_or("look", view.look);
    if look == location {
        let error = cursor.error("the camera looks at its own location");
        return Err(error.remedy("move \"look\" away from \"location\""));
    }
    Ok(CameraKey {
        frame: object.integer("frame"),
        location,
        look,
        up: object.point_or("up", view.up),
        fov_degrees: object.number_or("fov", view.fov_degrees),
        focal: match lens {
            Some(lens) => object.number_or("focal", lens.focal),
            None => 1.0,
        },
    })
}

fn view(object: &Object<'_>, options: &LoadOptions) -> Result<View> {
    let (width, height) = size(object, options)?;
    let fov_degrees = object.number("fov");
    let fov_axis = object.word("fovaxis");
    let notes = object.cursor().notes();
    let location = notes.part(|| object.need_one_of(&LOCATIONS, POINT)?.point());
    let look = notes.part(|| object.need_one_of(&LOOKS, POINT)?.point());
    let (location, look) = (location?, look?);
    check_look(object, location, look)?;
    let up = up(object, look - location)?;
    let antialias = object.integer("antialias");
    let sampling = object.word("sampling");
    Ok(View { location, look, up, fov_degrees, fov_axis, width, height, antialias, sampling })
}

fn size(object: &Object<'_>, options: &LoadOptions) -> Result<(u32, u32)> {
    // The file's must be valid even if others are requested.
    let own = ["width", "height"].map(|key| f64::from(object.integer(key)));
    for (key, asked) in [("width", options.width), ("height", options.height)] {
        asked.map_or(Ok(()), |asked| check_side(key, asked))?;
    }
    let (width, height) = in_proportion(options, own);
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

/// Checks the size of an image without a scene file.
pub(crate) fn check_size(width: u32, height: u32) -> Result<()> {
    check_side("width", width)?;
    check_side("height", height)?;
    match too_many_pixels(width, height) {
        Some(message) => Err(Error::new(ErrorKind::Limit, message).remedy(pixels_allowed())),
        None => Ok(()),
    }
}

/// Width and height of an image as requested. If only one is, the other follows from the
/// proportions of the image's `own` width and height.
pub(crate) fn in_proportion(options: &LoadOptions, own: [f64; 2]) -> (u32, u32) {
    let [width, height] = own;
    // Within the limits of a side, so that the conversion is exact.
    let side = |length: f64| length.round().clamp(1.0, f64::from(LONGEST_SIDE)) as u32;
    match (options.width, options.height) {
        (Some(asked), None) => (asked, side(f64::from(asked) * height / width)),
        (None, Some(asked)) => (side(f64::from(asked) * width / height), asked),
        (Some(asked), Some(other)) => (asked, other),
        (None, None) => (side(width), side(height)),
    }
}

/// Checks a requested side.
fn check_side(key: &str, asked: u32) -> Result<()> {
    if (1..=LONGEST_SIDE).contains(&asked) {
        return Ok(());
    }
    let words = integer_words(1, LONGEST_SIDE);
    let message = format!("the {key} must be {words}");
    let kind = if asked == 0 { ErrorKind::Usage } else { ErrorKind::Limit };
    Err(Error::new(kind, message).value(asked))
}

fn check_look(object: &Object<'_>, location: DVec3, look: DVec3) -> Result<()> {
    if look != location {
        return Ok(());
    }
    let error = object.need_one_of(&LOOKS, POINT)?.error("the camera looks at its own location");
    Err(error.remedy("move \"look\" away from \"location\""))
}

/// The up direction: the file's, unless it is parallel to the view.
fn up(object: &Object<'_>, view: DVec3) -> Result<DVec3> {
    let up = object.point("up");
    let Some(unit) = direction(up) else {
        let cursor = object.need("up", "a direction")?;
        return Err(cursor.error("must not be zero").remedy("use a vector such as [0, 1, 0]"));
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
    let message = "is parallel to the view direction";
    let error = notes.error(ErrorKind::Scene, &place, message.into()).value(up);
    notes.warn(&error.remedy(format!("{axis} is used instead")));
}

fn lens(object: &Object<'_>) -> Result<ThinLens> {
    Ok(ThinLens {
        aperture: object.number("aperture"),
        focal: object.number("focal"),
        sampling: object.word("sampling"),
        samples_x: object.integer("nsamplesx"),
        samples_y: object.integer("nsamplesy"),
    })
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
