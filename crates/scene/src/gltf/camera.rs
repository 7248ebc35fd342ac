//! Cameras, and the choice of one.

use glam::DAffine3;

use crate::components::{FovAxis, View};
use crate::corners::direction;
use crate::format::{Notes, Range};
use crate::options::LoadOptions;
use crate::options::framing::FOV;
use crate::staging::{self, BoundingSphere};
use wavecrest_base::error::{Error, ErrorKind, Result};

use super::fields::Fields;

/// Distance of a camera that replaces an orthographic one, in radii of the scene: far enough for
/// nearly parallel rays.
const PARALLEL_DISTANCE: f64 = 100.0;

/// An element of `cameras`.
#[derive(Clone, Debug)]
pub(super) struct Camera {
    pub(super) name: Option<String>,
    /// Its place in the file.
    path: String,
    lens: Projection,
    /// Width by height, if the file states it.
    aspect: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
enum Projection {
    /// The full angle from bottom to top, in radians.
    Perspective(f64),
    /// Half the height of the view.
    Orthographic(f64),
}

impl Camera {
    /// Reads an element of `cameras`.
    pub(super) fn read(fields: &Fields<'_>) -> Result<Self> {
        let is_flat = fields
            .need("type", "\"perspective\" or \"orthographic\"")?
            .choice(&[("perspective", false), ("orthographic", true)])?;
        let key = if is_flat { "orthographic" } else { "perspective" };
        let own = fields.need_object(key, "a camera")?;
        let (lens, aspect) = if is_flat {
            // Some files mirror the image with a negative number.
            let size = |key: &'static str| -> Result<f64> {
                let cursor = own.need(key, "a number other than 0")?;
                match cursor.number(Range::COORDINATE)?.abs() {
                    0.0 => Err(cursor.error("must be a number other than 0")),
                    size => Ok(size),
                }
            };
            let (x, y) = (size("xmag")?, size("ymag")?);
            (Projection::Orthographic(y), Some(x / y))
        } else {
            let aspect = own.get("aspectRatio").map(|c| c.number(Range::POSITIVE)).transpose()?;
            let fov = own.need("yfov", "a number above 0")?.number(Range::POSITIVE)?;
            (Projection::Perspective(fov), aspect)
        };
        Ok(Self { name: fields.text("name")?, path: fields.path(), lens, aspect })
    }
}

/// A camera at a node of the scene.
pub(super) struct PlacedCamera<'d> {
    pub(super) number: usize,
    pub(super) camera: &'d Camera,
    /// The name of the node.
    pub(super) node: Option<&'d str>,
    pub(super) world: DAffine3,
}

impl PlacedCamera<'_> {
    fn view(
        &self,
        bounds: &BoundingSphere,
        options: &LoadOptions,
        notes: &Notes<'_>,
    ) -> Result<View> {
        let Self { camera: Camera { path, lens, aspect, .. }, world, .. } = self;
        let axes = [world.matrix3.z_axis, world.matrix3.y_axis].map(direction);
        let [Some(back), Some(up)] = axes else {
            let message = "the transform of the camera's node has a scale of 0";
            let error = notes.error(ErrorKind::Scene, path, message);
            return Err(error.remedy("give the node a scale other than 0"));
        };
        let view = staging::view(options, *aspect)?;
        let position = world.translation;
        let ahead = (position - bounds.center).dot(back);
        let (location, distance, fov) = match *lens {
            Projection::Perspective(fov) => {
                (position, if ahead > 0.0 { ahead } else { bounds.radius }, fov)
            }
            Projection::Orthographic(half) => {
                let message = "an orthographic camera is approximated by a distant one";
                notes.note(path, message, "its rays are nearly parallel");
                let distance = PARALLEL_DISTANCE * bounds.radius.max(half);
                let location = position + back * (distance - ahead);
                (location, distance, 2.0 * libm::atan(half / distance))
            }
        };
        let fov_degrees = fov.to_degrees();
        if !FOV.contains(fov_degrees) {
            let place = format!("{path}.perspective.yfov");
            let message = format!("in degrees, must be {}", FOV.words());
            let error = notes.error(ErrorKind::Scene, &place, message);
            return Err(error.value(format!("{fov_degrees} degrees")));
        }
        let look = location - back * distance;
        Ok(View { location, look, up, fov_degrees, fov_axis: FovAxis::Y, ..view })
    }
}

/// The view of the chosen camera of `all`; `None` if there is none.
///
/// # Errors
/// If the requested camera is not in the scene, or cannot be used.
pub(super) fn chosen(
    all: &[PlacedCamera<'_>],
    bounds: &BoundingSphere,
    options: &LoadOptions,
    notes: &Notes<'_>,
) -> Result<Option<View>> {
    let found = match &options.camera {
        Some(asked) => {
            // By its own name, by that of its node, or by its number.
            let is_it = |shot: &&PlacedCamera<'_>| {
                [shot.camera.name.as_deref(), shot.node].contains(&Some(asked.as_str()))
                    || asked.parse() == Ok(shot.number)
            };
            Some(all.iter().find(is_it).ok_or_else(|| not_there(asked, all, notes))?)
        }
        None => {
            let has_perspective =
                |shot: &&PlacedCamera<'_>| matches!(shot.camera.lens, Projection::Perspective(_));
            all.iter().find(has_perspective).or(all.first())
        }
    };
    found.map(|shot| shot.view(bounds, options, notes)).transpose()
}

fn not_there(asked: &str, all: &[PlacedCamera<'_>], notes: &Notes<'_>) -> Error {
    /// Largest number of cameras to list.
    const MOST_LISTED: usize = 8;
    let describe = |shot: &PlacedCamera<'_>| match shot.camera.name.as_deref().or(shot.node) {
        Some(name) => format!("{} ({name})", shot.number),
        None => shot.number.to_string(),
    };
    let mut names: Vec<String> = all.iter().take(MOST_LISTED).map(describe).collect();
    if all.len() > MOST_LISTED {
        names.push("...".to_owned());
    }
    let error = notes.error(ErrorKind::Usage, "", "the scene has no such camera").value(asked);
    if names.is_empty() {
        return error.remedy("the file has no cameras; leave out --camera to use the default");
    }
    error.remedy(format!("the scene has the cameras {}", names.join(", ")))
}
