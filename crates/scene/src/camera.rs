//! The camera: its view, its lens and its path.

mod place;

use glam::DVec3;
use hecs::{EntityBuilder, EntityRef};

use crate::corners::direction;
use crate::format::{
    Cursor, Declaration, Declared, Key, Kind, Object, Range, Variants, Writer, component, declared,
    integer_words, keys, words,
};
use crate::options::framing::FOV;
use crate::options::{LoadOptions, MOST_ANTIALIAS};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::kernels::camera::Placement;
use wavecrest_core::kernels::camera::path::least_aligned_axis;

pub(crate) use place::change;

pub use wavecrest_core::kernels::camera::FovAxis;
pub use wavecrest_core::kernels::camera::path::Interpolation;
pub use wavecrest_core::kernels::light::Falloff;
pub use wavecrest_core::math::sampling::Sampling;

words!(FovAxis, Interpolation, Falloff, Sampling);

/// Largest number of a frame.
const LAST_FRAME: u32 = 9_999_999;

/// Largest width and height of an image, in pixels.
pub const LONGEST_SIDE: u32 = 65_536;
/// Largest number of pixels, 2^28: as floats, three gibibytes.
const MOST_PIXELS: u64 = 1 << 28;
/// Largest number of rays through each pixel, 2^24.
const MOST_CAMERA_RAYS: u64 = 1 << 24;
/// Largest number of angles or radii of points on the lens.
const MOST_LENS_SAMPLES: u32 = 4_096;
/// Default number of points on the lens along each side of the grid.
const LENS_SAMPLES: f64 = 4.0;
/// Sine of the angle between `up` and the view below which they count as parallel: the component of
/// `up` across the view would then be mostly single-precision rounding.
const PARALLEL: f64 = 1e-6;

/// The cameras.
pub(crate) const CAMERAS: Variants = Variants {
    name: "the camera",
    about: "The camera and the size of the image.",
    kinds: &[
        Kind::entity(
            "pinhole",
            "a pinhole camera",
            "A pinhole camera: everything is in focus.",
            &[Declaration::of::<View>(), Moving::<false>::PATH],
        ),
        Kind::entity(
            "thinlens",
            "a thin-lens camera",
            "A camera with a lens: one plane is in focus.",
            &[Declaration::of::<ThinLens>(), Declaration::of::<View>(), Moving::<true>::PATH],
        ),
    ],
};

component! {
    /// The lens of a camera, in focus in one plane. Without it all rays pass through the camera's location.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct ThinLens {
        /// Diameter of the lens; 0 is a pinhole.
        pub aperture: f64 = "aperture": Number(Range::NOT_NEGATIVE), Required;
        /// Distance of the plane in focus, along the view.
        pub focal: f64 = "focal": Number(Range::POSITIVE), Required;
        /// `jittered` divides the lens into `nsamplesx` angles by `nsamplesy` radii of equal area;
        /// `sobol` also draws the points in the pixel from its sequence, which are jittered
        /// otherwise.
        pub sampling: Sampling = "sampling": word::<Sampling>(), Says("jittered");
        /// Points on the lens: angles. Their product with `nsamplesy` is the number of rays for
        /// each pixel, or with `antialias` for each point in it.
        pub samples_x: u32 = "nsamplesx": Integer(1, MOST_LENS_SAMPLES), Is(LENS_SAMPLES);
        /// Points on the lens: radii.
        pub samples_y: u32 = "nsamplesy": Integer(1, MOST_LENS_SAMPLES), Is(LENS_SAMPLES);
    }
}

declared!(ThinLens);

component! {
    /// Position and direction of the camera, and the size of its image.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct View {
        /// Width of the image, in pixels; `--width` or `--height` alone keeps the proportions.
        pub width: u32 = "width": Integer(1, LONGEST_SIDE), Required;
        /// Height of the image, in pixels.
        pub height: u32 = "height": Integer(1, LONGEST_SIDE), Required;
        /// Full angle of view across the side that `fovaxis` names, in degrees.
        pub fov_degrees: f64 = "fov": Number(FOV), Required;
        /// The side of the image across which `fov` is measured.
        pub fov_axis: FovAxis = "fovaxis": word::<FovAxis>(), Says("smaller");
        /// Position of the camera.
        pub location: DVec3 = "location" | "position": Point, Required;
        /// The point at the centre of the image.
        pub look: DVec3 = "look" | "lookat" | "lookAt": Point, Required;
        /// Up in the image. If it is parallel to the view, the axis least aligned with the view
        /// replaces it, with a warning.
        pub up: DVec3 = "up": Direction("[0, 1, 0]"), Are([0.0, 1.0, 0.0]);
        /// Side of the grid of rays in each pixel; 1 is one ray through its centre. `--samples` sets its square.
        pub antialias: u32 = "antialias": Integer(1, MOST_ANTIALIAS), Is(1.0);
        /// Distribution of a pinhole's rays over the pixel.
        pub sampling: Sampling = "sampling": word::<Sampling>(), Says("jittered");
    }
}

impl View {
    /// The number of rays for each pixel, with or without a lens.
    pub(crate) fn rays(&self, lens: Option<&ThinLens>) -> u64 {
        let on_lens = lens.map_or(1, |lens| u64::from(lens.samples_x) * u64::from(lens.samples_y));
        u64::from(self.antialias).pow(2).saturating_mul(on_lens)
    }

    /// A pinhole with this view at a frame.
    pub(crate) fn key(&self, frame: u32) -> CameraKey {
        let &Self { location, look, up, fov_degrees, .. } = self;
        CameraKey { frame, location, look, up, fov_degrees, focal: 1.0 }
    }

    /// Where it is, for its angles.
    pub fn placement(&self) -> Placement {
        let &Self { location, look, up, fov_degrees, fov_axis, width, height, .. } = self;
        Placement { location, look, up, fov_degrees, fov_axis, size: [width, height] }
    }
}

impl Declared for View {
    const KEYS: &'static [Key] = Self::FIELDS;

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let mut view = Self::fields(object, None);
        if view.look == view.location {
            let error =
                object.need("look", "a point")?.error("the camera looks at its own location");
            return Err(error.remedy("move \"look\" away from \"location\""));
        }
        let axes = [view.look - view.location, view.up].map(direction);
        if let [Some(ahead), Some(up)] = axes
            && ahead.cross(up).length() < PARALLEL
        {
            let axis = least_aligned_axis(ahead);
            warn_of_up(object, view.up, axis);
            view.up = axis;
        }
        if object.word() == "thinlens" {
            view.sampling = beside_lens(view.sampling);
        }
        Ok(Some(view))
    }

    /// The sampling of a lens is in the same key, and counts.
    fn write(&self, to: &mut Writer<'_>) {
        let of_lens = to.get("sampling").cloned();
        self.write_fields(to);
        of_lens.into_iter().for_each(|sampling| to.set("sampling", sampling));
    }
}

/// That the camera goes where its user wants, later: a component of its entity. Nothing is left out for what it sees now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FreeCamera;

/// The path of a camera, a component of its entity.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    /// Its keys, at least one, in the order of their frames.
    pub keys: Vec<CameraKey>,
    /// Interpolation between keys.
    pub interpolation: Interpolation,
}

component! {
    /// The camera at a frame; omitted values are those of its [`View`].
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct CameraKey {
        /// The frame.
        pub frame: u32 = "frame": Integer(0, LAST_FRAME), Required;
        /// Position of the camera.
        pub location: DVec3 = "location": Point;
        /// The point at the centre of the image.
        pub look: DVec3 = "look": Point;
        /// Up in the image.
        pub up: DVec3 = "up": Point;
        /// Full angle of view across one side of the image, in degrees.
        pub fov_degrees: f64 = "fov": Number(FOV);
        /// Distance of the plane in focus, along the view; 1 for a pinhole.
        pub focal: f64 = "focal": Number(Range::POSITIVE);
    }
}

/// The path of a camera with a `LENS`, or without.
struct Moving<const LENS: bool>;

impl<const LENS: bool> Moving<LENS> {
    const FRAME: Kind = Kind {
        without: if LENS { "" } else { "focal" },
        ..Kind::new(
            "a keyframe of a camera path",
            "The camera at a frame; keys left out keep the values of the camera.",
            CameraKey::FIELDS,
        )
    };

    const MOTION: Kind = Kind::new(
        "a camera path",
        "The motion of the camera, frame by frame.",
        keys! {
            /// The camera at some frames, in their order.
            "keys": AtLeast(1, &Object(&Self::FRAME)), Required;
            /// Interpolation between the keys.
            "interpolation": word::<Interpolation>(), Says("smooth");
        },
    );

    const PATH: Declaration = Declaration {
        read: Self::read,
        write: Self::write,
        ..Declaration::of_keys(keys! {
            /// The motion of the camera, frame by frame.
            "path": Object(&Self::MOTION);
        })
    };

    /// Reads the path of a camera, whose other components it has already.
    fn read(object: &Object<'_>, entity: &mut EntityBuilder) -> Result<()> {
        let Some(cursor) = object.get("path") else { return Ok(()) };
        // Its errors are recorded already.
        let Some(view) = entity.get::<&View>().copied() else { return Ok(()) };
        let focal = entity.get::<&ThinLens>().map_or(1.0, |lens| lens.focal);
        let usual = CameraKey { focal, ..view.key(0) };
        let object = cursor.object(Self::MOTION)?;
        let what = "an array of keys, at least one";
        let mut last = None;
        let keys = object.need("keys", what)?.each_of(1.., what, |item| {
            let key = CameraKey::fields(&item.object(Self::FRAME)?, Some(&usual));
            if key.look == key.location {
                let error = item.error("the camera looks at its own location");
                return Err(error.remedy("move \"look\" away from \"location\""));
            }
            if last.replace(key.frame).is_some_and(|last| last >= key.frame) {
                let error = item.error("the frame must be greater than the one before");
                return Err(error.remedy("sort the keys by frame"));
            }
            Ok(key)
        })?;
        entity.add(CameraPath { keys, interpolation: object.read("interpolation") });
        Ok(())
    }

    fn write(entity: EntityRef<'_>, to: &mut Writer<'_>) {
        let Some(path) = entity.get::<&CameraPath>() else { return };
        to.object("path", |to| {
            to.put("interpolation", path.interpolation);
            let key = |key: &CameraKey| {
                let mut one = to.inner();
                key.write_fields(&mut one);
                if !LENS {
                    one.remove("focal");
                }
                one.end()
            };
            let keys: Vec<_> = path.keys.iter().map(key).collect();
            to.set("keys", keys);
        });
    }
}

/// Reads the camera as components of an `entity`. Size and antialias in the `options` override the file's.
pub(crate) fn camera(
    cursor: &Cursor<'_>,
    options: &LoadOptions,
    entity: &mut EntityBuilder,
) -> Result<()> {
    let object = cursor.variant(&CAMERAS)?;
    for (key, asked) in [("width", options.width), ("height", options.height)] {
        asked.map_or(Ok(()), |asked| check_side(key, asked))?;
    }
    object.components(entity)?;
    let lens = entity.get::<&ThinLens>().copied();
    let Some(view) = entity.get_mut::<&mut View>() else { return Ok(()) };
    // The file's must be valid even if others are requested.
    (view.width, view.height) = in_proportion(options, [view.width, view.height].map(f64::from));
    view.antialias = options.antialias_or(view.antialias);
    check_size(view.width, view.height)
        .and_then(|()| check_rays(view, lens.as_ref()))
        .map_err(|error| error.in_file(cursor.notes().file()).at(cursor.path()))
}

/// The distribution of points in a pixel beside that of points on a lens. The report's key is about the lens: a pixel's rays
/// are jittered for any value.
fn beside_lens(sampling: Sampling) -> Sampling {
    if sampling == Sampling::Random { Sampling::Jittered } else { sampling }
}

/// Checks the size of an image.
pub(crate) fn check_size(width: u32, height: u32) -> Result<()> {
    check_side("width", width)?;
    check_side("height", height)?;
    let pixels = u64::from(width) * u64::from(height);
    if pixels <= MOST_PIXELS {
        return Ok(());
    }
    let message = format!("the image would have {width} x {height} = {pixels} pixels");
    let error = Error::new(ErrorKind::Limit, message);
    Err(error.remedy(format!("at most {MOST_PIXELS} (2^28) are allowed")))
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

fn warn_of_up(object: &Object<'_>, up: DVec3, axis: DVec3) {
    let notes = object.cursor().notes();
    let place = format!("{}.up", object.cursor().path());
    let message = "is parallel to the view direction";
    let error = notes.error(ErrorKind::Scene, &place, message).value(up);
    notes.warn(&error.remedy(format!("{axis} is used instead")));
}

fn check_rays(view: &View, lens: Option<&ThinLens>) -> Result<()> {
    let (x, y) = lens.map_or((1, 1), |lens| (lens.samples_x, lens.samples_y));
    let n = view.antialias;
    // At most 64 * 64 * 4096 * 4096 = 2^36.
    let rays = view.rays(lens);
    if rays <= MOST_CAMERA_RAYS {
        return Ok(());
    }
    let message = format!(
        "each pixel would have {n} x {n} (antialias) x {x} x {y} (nsamplesx, nsamplesy) = {rays} rays"
    );
    let error = Error::new(ErrorKind::Limit, message);
    Err(error.remedy(format!("at most {MOST_CAMERA_RAYS} (2^24) are allowed")))
}
