//! Light sources.

use crate::components::{AreaLight, Falloff, PointLight, Sampling};
use crate::reader::{Cursor, Object, Range};
use crate::schema::Light;
use wavecrest_base::error::{ErrorKind, Result};

use super::shape::light_shape;

pub(super) const COMMON_KEYS: [&str; 5] = ["type", "intensity", "position", "color", "falloff"];
pub(super) const AREA_KEYS: [&str; 3] = ["sampling", "samples", "shape"];

/// Greatest value of `samples`.
pub(super) const MOST_SAMPLES: u32 = 65_536;
/// Greatest number of points on a light, 2^24.
const MOST_POINTS: u64 = 1 << 24;

pub(super) const FALLOFFS: [(&str, Falloff); 3] = [
    ("linear", Falloff::Linear),
    ("inverse-square", Falloff::InverseSquare),
    ("none", Falloff::None),
];

/// How sample points are chosen, by name.
pub(super) const SAMPLINGS: [(&str, Sampling); 3] =
    [("random", Sampling::Random), ("jittered", Sampling::Jittered), ("sobol", Sampling::Sobol)];

#[derive(Clone, Copy)]
pub(super) enum Kind {
    Point,
    Area,
}

pub(super) const KINDS: [(&str, Kind); 2] =
    [("pointlight", Kind::Point), ("arealight", Kind::Area)];

/// Reads an element of `scene.lightsources`.
pub(super) fn light(cursor: &Cursor<'_>) -> Result<Light> {
    match cursor.kind("a light", &KINDS)? {
        Kind::Point => point_light(&cursor.object("a point light", COMMON_KEYS.into())?),
        Kind::Area => {
            area_light(&cursor.object("an area light", [&COMMON_KEYS[..], &AREA_KEYS].concat())?)
        }
    }
}

fn point_light(object: &Object<'_>) -> Result<Light> {
    let light = PointLight {
        intensity: object.number("intensity", Range::NOT_NEGATIVE)?,
        position: object.point(&["position"])?,
        color: object.color("color")?,
        falloff: object.choice_or("falloff", &FALLOFFS, Falloff::default())?,
    };
    Ok(Light::Point { path: object.cursor().path(), light })
}

fn area_light(object: &Object<'_>) -> Result<Light> {
    // The report's format has it, but the shape says where the light is.
    object.get("position").map(|cursor| cursor.point()).transpose()?;
    let sampling = object.choice("sampling", &SAMPLINGS)?;
    let light = AreaLight {
        intensity: object.number("intensity", Range::NOT_NEGATIVE)?,
        color: object.color("color")?,
        falloff: object.choice_or("falloff", &FALLOFFS, Falloff::default())?,
        sampling,
        samples: samples(object, sampling)?,
    };
    let shape = Box::new(light_shape(&object.need("shape", "a shape, an object { ... }")?)?);
    Ok(Light::Area { path: object.cursor().path(), light, shape })
}

/// The `samples` of an area light: all of them, or those along each side of a grid.
fn samples(object: &Object<'_>, sampling: Sampling) -> Result<u32> {
    let samples = object.integer("samples", 1, MOST_SAMPLES)?;
    let points = u64::from(samples) * u64::from(samples);
    if sampling != Sampling::Jittered || points <= MOST_POINTS {
        return Ok(samples);
    }
    let message = format!("jittered sampling would take {samples} x {samples} = {points} points");
    let cursor = object.need("samples", "an integer")?;
    let error = cursor.error_of(ErrorKind::Limit, message);
    Err(error.remedy(format!("at most {MOST_POINTS} (2^24) are allowed")))
}
