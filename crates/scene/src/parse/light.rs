//! Light sources.

use glam::DVec3;

use crate::components::{AreaLight, Falloff, PointLight, Sampling};
use crate::reader::{Cursor, Key, Kind, Object, Range, keys};
use crate::schema::Light;
use wavecrest_base::error::{ErrorKind, Result};

use super::shape::light_shape;
use super::warn_above_1;

/// Greatest value of `samples`.
const MOST_SAMPLES: u32 = 65_536;
/// Greatest number of points on a light, 2^24.
const MOST_POINTS: u64 = 1 << 24;

wavecrest_base::choices! {
    /// The lights.
    #[derive(Clone, Copy, PartialEq)]
    pub(crate) enum LightKind {
        /// A light at a point.
        Point = "pointlight",
        /// A light with a shape.
        Area = "arealight",
    }
}

pub(crate) const POINT_LIGHT: Kind =
    Kind::new("a point light", "A light at a point.", &[KEYS, POSITION_KEYS, COLOR_KEYS]);

pub(crate) const AREA_LIGHT: Kind = Kind::new(
    "an area light",
    "A light with a shape, which is seen in its own colour.",
    &[KEYS, UNUSED_KEYS, COLOR_KEYS, AREA_KEYS],
);

const KEYS: &[Key] = keys! {
    /// Which kind of light this is.
    "type": word::<LightKind>(), Required;
    /// Strength; with the usual falloff 40 to 100 suits distances of 10 to 20.
    "intensity": Number(Range::NOT_NEGATIVE), Required;
};

const POSITION_KEYS: &[Key] = keys! {
    /// Where a point light is. An area light is where its shape is.
    "position": Point, Required;
};

const UNUSED_KEYS: &[Key] = keys! {
    /// Where a point light is. An area light is where its shape is.
    "position": Point;
};

const COLOR_KEYS: &[Key] = keys! {
    /// The colour of the light.
    "color": Color, Required;
    /// At distance d: 1/(4 pi d), 1/(4 pi d^2), or 1.
    "falloff": word::<Falloff>(), Says("linear");
};

const AREA_KEYS: &[Key] = keys! {
    /// How points are chosen: at random, one in each cell of a grid, or by a Sobol sequence.
    "sampling": word::<Sampling>(), Required;
    /// Points on the light; with jittered sampling, along each side of the grid.
    "samples": Integer(1, MOST_SAMPLES), Required;
    /// What shines; it needs no material.
    "shape": Definition("lit-shape"), Required;
};

/// Reads an element of `scene.lightsources`.
pub(super) fn light(cursor: &Cursor<'_>) -> Result<Light> {
    match cursor.kind("a light")? {
        LightKind::Point => point_light(&cursor.object(POINT_LIGHT)?),
        LightKind::Area => area_light(&cursor.object(AREA_LIGHT)?),
    }
}

/// Warns of a light that gives none but its ambient part.
fn warn_of_power(object: &Object<'_>) {
    let message = "is 0, so that the light has no power";
    if let Some(cursor) =
        object.get("intensity").filter(|cursor| cursor.value().as_f64() == Some(0.0))
    {
        cursor.warn(message, "use a number above 0, or remove the light");
    } else if let Some(cursor) = object.get("color")
        && cursor.color().is_ok_and(|color| color == DVec3::ZERO)
    {
        cursor.warn(message, "use a colour other than black, or remove the light");
    }
}

fn point_light(object: &Object<'_>) -> Result<Light> {
    warn_of_power(object);
    // The shape of an area light may well be seen in such a colour.
    let remedy = "use a colour from 0 to 1 and a higher \"intensity\"";
    warn_above_1(object, "color", "is above 1", remedy);
    let light = PointLight {
        intensity: object.number("intensity")?,
        position: object.point("position")?,
        color: object.color("color")?,
        falloff: object.word("falloff")?,
    };
    Ok(Light::Point { path: object.cursor().path(), light })
}

fn area_light(object: &Object<'_>) -> Result<Light> {
    warn_of_power(object);
    // The report's format has it, but the shape says where the light is.
    object.get("position").map(|cursor| cursor.point()).transpose()?;
    let sampling = object.word("sampling")?;
    let light = AreaLight {
        intensity: object.number("intensity")?,
        color: object.color("color")?,
        falloff: object.word("falloff")?,
        sampling,
        samples: samples(object, sampling)?,
    };
    let shape = Box::new(light_shape(&object.need("shape", "a shape, an object { ... }")?)?);
    Ok(Light::Area { path: object.cursor().path(), light, shape })
}

/// The `samples` of an area light: all of them, or those along each side of a grid.
fn samples(object: &Object<'_>, sampling: Sampling) -> Result<u32> {
    let samples = object.integer("samples")?;
    let points = u64::from(samples) * u64::from(samples);
    if sampling != Sampling::Jittered || points <= MOST_POINTS {
        return Ok(samples);
    }
    let message = format!("jittered sampling would take {samples} x {samples} = {points} points");
    let cursor = object.need("samples", "an integer")?;
    let error = cursor.error_of(ErrorKind::Limit, message);
    Err(error.remedy(format!("at most {MOST_POINTS} (2^24) are allowed")))
}
