//! Cameras, and what each sees.

use glam::{DAffine3, DVec3};

use crate::components::{FovAxis, View};
use crate::corners::direction;
use crate::options::LoadOptions;
use crate::parse;
use crate::reader::{Notes, Range};
use crate::staging::{self, Sphere};
use wavecrest_base::error::{ErrorKind, Result};

use super::fields::Fields;

/// Where a camera without perspective is put, in radii of the scene: far enough for rays that are nearly
/// parallel.
const PARALLEL_DISTANCE: f64 = 100.0;

/// An element of `cameras`.
#[derive(Clone, Debug)]
pub(super) struct Camera {
    pub(super) name: Option<String>,
    /// Where it stands in the file.
    path: String,
    lens: Lens,
    /// Width by height, where the file says so.
    aspect: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
enum Lens {
    /// The full angle from bottom to top, in radians.
    Perspective(f64),
    /// Half the height of what is seen.
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
            // Some files mirror the image by a number below 0.
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

    /// Whether what is far away is small.
    pub(super) fn has_perspective(&self) -> bool {
        matches!(self.lens, Lens::Perspective(_))
    }

    /// What the camera sees that stands as `world` says.
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
                "the transform of the camera's node leaves it no direction".to_owned(),
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

    /// Where it stands, how far it looks, and its angle in radians.
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
                let message = "a camera without perspective is one that is very far away";
                notes.once(&self.path, message, "its rays are nearly parallel");
                let distance = PARALLEL_DISTANCE * bounds.radius.max(half);
                let location = position + back * (distance - ahead);
                (location, distance, 2.0 * libm::atan(half / distance))
            }
        }
    }
}

fn checked_fov(degrees: f64, path: &str, notes: &Notes<'_>) -> Result<f64> {
    if parse::FOV.contains(degrees) {
        return Ok(degrees);
    }
    let place = format!("{path}.perspective.yfov");
    let message = format!("in degrees, must be {}", parse::FOV.words());
    Err(notes.error(ErrorKind::Scene, &place, message).value(format!("{degrees} degrees")))
}
