//! Lights: the kinds of lights, and what they share.
//!
//! Each kind is a file with its component and its keys. What a light adds at a point is in
//! [`wavecrest_core::kernels::light`].

mod area;
mod directional;
mod point;
mod sky;
mod spot;

use glam::DVec3;

use crate::camera::Sampling;
use crate::format::{Object, Variants};
use wavecrest_base::error::{ErrorKind, Result};

pub use area::AreaLight;
pub use directional::DirectionalLight;
pub use point::PointLight;
pub(crate) use sky::SKY;
pub use sky::Sky;
pub use spot::Spot;

/// Largest value of `samples`.
const MOST_SAMPLES: u32 = 65_536;
/// Largest number of points on a light, 2^24.
const MOST_POINTS: u64 = 1 << 24;

/// The kinds of lights.
pub(crate) const LIGHTS: Variants = Variants {
    name: "a light",
    about: "A light.",
    kinds: &[point::KIND, spot::KIND, directional::KIND, area::KIND],
};

/// Warns of a light without any but its ambient part.
fn warn_of_power(object: &Object<'_>, intensity: f64, color: DVec3) {
    let message =
        "is 0, so of the light only its ambient part, and its shape if it has one, are left";
    if intensity == 0.0 {
        object.warn("intensity", message, "use a number above 0, or remove the light");
    } else if color == DVec3::ZERO {
        object.warn("color", message, "use a colour other than black, or remove the light");
    }
}

/// Warns of the intensity and the colour of a light without a shape.
fn warn_of_strength(object: &Object<'_>, intensity: f64, color: DVec3) {
    warn_of_power(object, intensity, color);
    // The shape of an area light may well be meant to have such a colour.
    let remedy = "use a colour from 0 to 1 and a higher \"intensity\"";
    object.warn_above_1("color", "is above 1", remedy);
}

/// Checks the `samples` of a light: the total, or along each side of a grid.
fn check_samples(object: &Object<'_>, sampling: Sampling, samples: u32) -> Result<()> {
    let points = u64::from(samples) * u64::from(samples);
    if sampling != Sampling::Jittered || points <= MOST_POINTS {
        return Ok(());
    }
    let message = format!("jittered sampling would take {samples} x {samples} = {points} points");
    let cursor = object.need("samples", "an integer")?;
    let error = cursor.error_of(ErrorKind::Limit, message);
    Err(error.remedy(format!("at most {MOST_POINTS} (2^24) are allowed")))
}
