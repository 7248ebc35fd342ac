//! Cameras, and the choice of one.

use glam::{DAffine3, DVec3};

use crate::camera;
use crate::components::{FovAxis, View};
use crate::corners::direction;
use crate::format::{Notes, Range};
use crate::load::LoadOptions;
use crate::load::staging::{self, Sphere};
use wavecrest_base::error::{Error, ErrorKind, Result};

use super::document::Document;
use super::fields::Fields;
use super::node::Placed;

/// Distance of a camera that replaces an orthographic one, in radii of the scene: far enough for
/// nearly parallel rays.
const PARALLEL_DISTANCE: f64 = 100.0;

/// An element of `cameras`.
#[derive(Clone, Debug)]
pub(super) struct Camera {
    pub(super) name: Option<String>,
    /// Its place in the file.
    path: String,
    lens: Lens,
    /// Width by height, if the file states it.
    aspect: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
enum Lens {
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
        let own = Fields::new(fields.need(key, "an object { ... }")?, "a camera")?;
        let positive =
            |key: &'static str| own.need(key, "a number above 0")?.number(Range::POSITIVE);
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
            (Lens::Orthographic(y), Some(x / y))
        } else {
            let aspect = own.get("aspectRatio").map(|c| c.number(Range::POSITIVE)).transpose()?;
            (Lens::Perspective(positive("yfov")?), aspect)
        };
        Ok(Self { name: fields.text("name")?, path: fields.path(), lens, aspect })
    }

    /// Whether it is a perspective camera.
    pub(super) fn has_perspective(&self) -> bool {
        matches!(self.lens, Lens::Perspective(_))
    }

    /// The view of the camera with the transform `world`.
    pub(super) fn view(
        &self,
        world: &DAffine3,
        bounds: &Sphere,
        options: &LoadOptions,
        notes: &Notes<'_>,
    ) -> Result<View> {
        let axes = [world.matrix3.z_axis, world.matrix3.y_axis].map(direction);
        let [Some(back), Some(up)] = axes else {
            let error = notes.error(
                ErrorKind::Scene,
                &self.path,
                "the transform of the camera's node has a scale of 0".to_owned(),
            );
            return Err(error.remedy("give the node a scale other than 0"));
        };
        let (width, height) = staging::size(options, self.aspect)?;
        let (location, distance, fov) = self.placed(world.translation, back, bounds, notes);
        let fov_degrees = checked_fov(fov.to_degrees(), &self.path, notes)?;
        let look = location - back * distance;
        Ok(View {
            location,
            look,
            up,
            fov_degrees,
            fov_axis: FovAxis::Y,
            ..staging::view(width, height)
        })
    }

    /// Its position, its view distance, and its angle in radians.
    fn placed(
        &self,
        position: DVec3,
        back: DVec3,
        bounds: &Sphere,
        notes: &Notes<'_>,
    ) -> (DVec3, f64, f64) {
        let ahead = (position - bounds.center).dot(back);
        match self.lens {
            Lens::Perspective(fov) => {
                let distance = if ahead > 0.0 { ahead } else { bounds.radius };
                (position, distance, fov)
            }
            Lens::Orthographic(half) => {
                let message = "an orthographic camera is approximated by a distant one";
                notes.note(&self.path, message, "its rays are nearly parallel");
                let distance = PARALLEL_DISTANCE * bounds.radius.max(half);
                let location = position + back * (distance - ahead);
                (location, distance, 2.0 * libm::atan(half / distance))
            }
        }
    }
}

fn checked_fov(degrees: f64, path: &str, notes: &Notes<'_>) -> Result<f64> {
    if camera::FOV.contains(degrees) {
        return Ok(degrees);
    }
    let place = format!("{path}.perspective.yfov");
    let message = format!("in degrees, must be {}", camera::FOV.words());
    Err(notes.error(ErrorKind::Scene, &place, message).value(format!("{degrees} degrees")))
}

/// The view of the chosen camera; `None` if the scene has no camera.
///
/// # Errors
/// If the requested camera is not in the scene, or cannot be used.
pub(super) fn chosen(
    document: &Document,
    bounds: &Sphere,
    options: &LoadOptions,
    notes: &Notes<'_>,
) -> Result<Option<View>> {
    let all: Vec<(usize, &Placed)> = document
        .placed
        .iter()
        .filter_map(|place| Some((document.nodes[place.node].camera?, place)))
        .collect();
    let found = match &options.camera {
        Some(asked) => Some(
            all.iter()
                .find(|(camera, place)| is_asked_for(asked, document, *camera, place))
                .ok_or_else(|| not_there(asked, document, &all, notes))?,
        ),
        None => {
            let has_perspective =
                |(camera, _): &&(usize, &Placed)| document.cameras[*camera].has_perspective();
            all.iter().find(has_perspective).or(all.first())
        }
    };
    let Some((camera, place)) = found else { return Ok(None) };
    document.cameras[*camera].view(&place.world, bounds, options, notes).map(Some)
}

/// Whether `asked` is the name or number of a camera: its own name, or that of its node.
fn is_asked_for(asked: &str, document: &Document, camera: usize, place: &Placed) -> bool {
    let is = |name: &Option<String>| name.as_deref() == Some(asked);
    is(&document.cameras[camera].name)
        || is(&document.nodes[place.node].name)
        || asked.parse() == Ok(camera)
}

fn not_there(
    asked: &str,
    document: &Document,
    all: &[(usize, &Placed)],
    notes: &Notes<'_>,
) -> Error {
    /// Largest number of cameras to list.
    const MOST_LISTED: usize = 8;
    let describe = |(camera, place): &(usize, &Placed)| {
        let own = document.cameras[*camera].name.as_ref();
        match own.or(document.nodes[place.node].name.as_ref()) {
            Some(name) => format!("{camera} ({name})"),
            None => camera.to_string(),
        }
    };
    let mut names: Vec<String> = all.iter().take(MOST_LISTED).map(describe).collect();
    if all.len() > MOST_LISTED {
        names.push("...".to_owned());
    }
    let error = notes.error(ErrorKind::Usage, "", "the scene has no such camera".to_owned());
    let error = error.value(asked);
    if names.is_empty() {
        return error.remedy("the file has no cameras; leave out --camera to use the default");
    }
    error.remedy(format!("the scene has the cameras {}", names.join(", ")))
}
