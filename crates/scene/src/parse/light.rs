//! Light sources.

use glam::DVec3;

use crate::components::{AreaLight, DirectionalLight, Falloff, PointLight, Sampling, Spot};
use crate::reader::{Cursor, Key, Kind, Object, Range, keys};
use crate::schema::Light;
use wavecrest_base::error::{ErrorKind, Result};

use super::shape::light_shape;
use super::warn_above_1;

/// Largest value of `samples`.
const MOST_SAMPLES: u32 = 65_536;
/// Largest number of points on a light, 2^24.
const MOST_POINTS: u64 = 1 << 24;

/// Angles between the direction of a spot and the edge of a cone, in degrees.
const HALF_ANGLE: Range = Range::new(0.0, 90.0);

wavecrest_base::choices! {
    /// The lights.
    #[derive(Clone, Copy, PartialEq)]
    pub(crate) enum LightKind {
        /// A light at a point.
        Point = "pointlight",
        /// A light at a point, within a cone.
        Spot = "spotlight",
        /// A light infinitely far away.
        Directional = "directionallight",
        /// A light with a shape.
        Area = "arealight",
    }
}

pub(crate) const POINT_LIGHT: Kind = Kind::new(
    "a point light",
    "A light that shines from a point in all directions.",
    &[KEYS, POSITION_KEYS, COLOR_KEYS, FALLOFF_KEYS],
);

pub(crate) const SPOT_LIGHT: Kind = Kind::new(
    "a spot light",
    "A light that shines from a point within a cone.",
    &[KEYS, POSITION_KEYS, DIRECTION_KEYS, CONE_KEYS, COLOR_KEYS, FALLOFF_KEYS],
);

pub(crate) const DIRECTIONAL_LIGHT: Kind = Kind::new(
    "a directional light",
    "A light infinitely far away, equally strong everywhere.",
    &[KEYS, DIRECTION_KEYS, COLOR_KEYS, SKY_KEYS],
);

pub(crate) const AREA_LIGHT: Kind = Kind::new(
    "an area light",
    "A light with a shape, visible in the colour of the light.",
    &[KEYS, UNUSED_KEYS, COLOR_KEYS, FALLOFF_KEYS, AREA_KEYS],
);

const KEYS: &[Key] = keys! {
    /// The kind of light.
    "type": word::<LightKind>(), Required;
    /// Strength; with the default falloff 40 to 100 suits distances of 10 to 20.
    "intensity": Number(Range::NOT_NEGATIVE), Required;
};

const POSITION_KEYS: &[Key] = keys! {
    /// Position of a point light. An area light has the position of its shape.
    "position": Point, Required;
};

const UNUSED_KEYS: &[Key] = keys! {
    /// Position of a point light. An area light has the position of its shape.
    "position": Point;
};

const COLOR_KEYS: &[Key] = keys! {
    /// The colour of the light.
    "color": Color, Required;
};

const FALLOFF_KEYS: &[Key] = keys! {
    /// At distance d: 1/(4 pi d), 1/(4 pi d^2), or 1.
    "falloff": word::<Falloff>(), Says("linear");
};

const DIRECTION_KEYS: &[Key] = keys! {
    /// Direction in which the light shines.
    "direction": Point, Required;
};

const CONE_KEYS: &[Key] = keys! {
    /// Angle from the direction, in degrees, up to which the light has full strength.
    "inner": Number(HALF_ANGLE), Is(0.0);
    /// Angle from the direction, in degrees, beyond which there is no light.
    "outer": Number(HALF_ANGLE), Required;
};

const SKY_KEYS: &[Key] = keys! {
    /// Diameter of the light in the sky, in degrees: 0.53 for the sun. It softens shadows.
    "angle": Number(Range::new(0.0, 180.0)), Is(0.0);
    /// Distribution of the directions to the light: random, one in each cell of a grid, or Sobol.
    "sampling": word::<Sampling>(), Says("sobol");
    /// Directions to the light; with jittered sampling, along each side of the grid.
    "samples": Integer(1, MOST_SAMPLES), Is(1.0);
};

const AREA_KEYS: &[Key] = keys! {
    /// Distribution of the points on the light: random, one in each cell of a grid, or Sobol.
    "sampling": word::<Sampling>(), Says("jittered");
    /// Points on the light; with jittered sampling, along each side of the grid.
    "samples": Integer(1, MOST_SAMPLES), Is(4.0);
    /// The shape that emits the light; it needs no material.
    "shape": Definition("lit-shape"), Required;
};

/// Reads an element of `scene.lightsources`.
pub(super) fn light(cursor: &Cursor<'_>) -> Result<Light> {
    match cursor.kind("a light")? {
        LightKind::Point => point_light(&cursor.object(POINT_LIGHT)?),
        LightKind::Spot => spot_light(&cursor.object(SPOT_LIGHT)?),
        LightKind::Directional => directional_light(&cursor.object(DIRECTIONAL_LIGHT)?),
        LightKind::Area => area_light(&cursor.object(AREA_LIGHT)?),
    }
}

/// Warns of a light without any but its ambient part.
fn warn_of_power(object: &Object<'_>) {
    let message = "is 0, so the light has no effect";
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

/// Warns of the intensity and the colour of a light without a shape.
fn warn_of_strength(object: &Object<'_>) {
    warn_of_power(object);
    // The shape of an area light may well be meant to have such a colour.
    let remedy = "use a colour from 0 to 1 and a higher \"intensity\"";
    warn_above_1(object, "color", "is above 1", remedy);
}

fn at_a_point(object: &Object<'_>) -> Result<PointLight> {
    warn_of_strength(object);
    Ok(PointLight {
        intensity: object.number("intensity"),
        position: object.point("position"),
        color: object.color("color"),
        falloff: object.word("falloff"),
    })
}

fn point_light(object: &Object<'_>) -> Result<Light> {
    Ok(Light::Point { path: object.cursor().path(), light: at_a_point(object)? })
}

fn spot_light(object: &Object<'_>) -> Result<Light> {
    let light = at_a_point(object)?;
    let (inner_degrees, outer_degrees) = (object.number("inner"), object.number("outer"));
    if inner_degrees > outer_degrees {
        let cursor = object.need("inner", "a number")?;
        let error = cursor.error(format!("is more than \"outer\", {outer_degrees}"));
        return Err(error.remedy("use an \"inner\" angle below \"outer\""));
    }
    if outer_degrees == 0.0 {
        let message = "is 0, so the light has no effect";
        object.need("outer", "a number")?.warn(message, "use an angle above 0, up to 90");
    }
    let spot = Spot { direction: direction(object)?, inner_degrees, outer_degrees };
    Ok(Light::Spot { path: object.cursor().path(), light, spot })
}

fn directional_light(object: &Object<'_>) -> Result<Light> {
    warn_of_strength(object);
    let sampling = object.word("sampling");
    let light = DirectionalLight {
        intensity: object.number("intensity"),
        color: object.color("color"),
        direction: direction(object)?,
        angle_degrees: object.number("angle"),
        sampling,
        samples: samples(object, sampling)?,
    };
    Ok(Light::Directional { path: object.cursor().path(), light })
}

/// The key `direction`, of any length but zero.
fn direction(object: &Object<'_>) -> Result<DVec3> {
    let direction = object.point("direction");
    if direction != DVec3::ZERO {
        return Ok(direction);
    }
    let cursor = object.need("direction", "a direction, [x, y, z]")?;
    Err(cursor.error("must not be zero").remedy("use a vector such as [0, -1, 0]"))
}

fn area_light(object: &Object<'_>) -> Result<Light> {
    warn_of_power(object);
    // The report's format has this key, but the shape gives the position.
    object.get("position").map(|cursor| cursor.point()).transpose()?;
    let sampling = object.word("sampling");
    let samples = samples(object, sampling)?;
    note_samples(object, sampling, samples);
    let light = AreaLight {
        intensity: object.number("intensity"),
        color: object.color("color"),
        falloff: object.word("falloff"),
        sampling,
        samples,
    };
    let shape = Box::new(light_shape(&object.need("shape", "a shape, an object { ... }")?)?);
    Ok(Light::Area { path: object.cursor().path(), light, shape })
}

/// Says how many points an area light takes if that is left open: they decide time and noise.
fn note_samples(object: &Object<'_>, sampling: Sampling, samples: u32) {
    let is_absent = |key: &&str| !object.has(key);
    let absent: Vec<String> = ["sampling", "samples"]
        .iter()
        .filter(|key| is_absent(key))
        .map(|key| format!("{key:?}"))
        .collect();
    if absent.is_empty() {
        return;
    }
    let points = match sampling {
        Sampling::Jittered => format!("{samples} x {samples}"),
        _ => samples.to_string(),
    };
    let cursor = object.cursor();
    let message = format!("has no {}", absent.join(" and "));
    let remedy = format!("{points} {} points on it are used", sampling.name());
    cursor.notes().note(&cursor.path(), &message, &remedy);
}

/// The `samples` of a light: the total, or along each side of a grid.
fn samples(object: &Object<'_>, sampling: Sampling) -> Result<u32> {
    let samples = object.integer("samples");
    let points = u64::from(samples) * u64::from(samples);
    if sampling != Sampling::Jittered || points <= MOST_POINTS {
        return Ok(samples);
    }
    let message = format!("jittered sampling would take {samples} x {samples} = {points} points");
    let cursor = object.need("samples", "an integer")?;
    let error = cursor.error_of(ErrorKind::Limit, message);
    Err(error.remedy(format!("at most {MOST_POINTS} (2^24) are allowed")))
}
