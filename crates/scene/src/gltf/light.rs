//! Lights: those of `KHR_lights_punctual`, and meshes that give off light.
//!
//! The format's units are physical: candela for points and spots, lux for the sun, candela on a square
//! metre for surfaces. A white matte surface shows E / pi where E lux fall on it straight; one of ours with
//! kd = 1 shows intensity times falloff. Hence
//!
//! | light | falloff | intensity |
//! |---|---|---|
//! | point, I candela | inverse square, 1 / (4 pi d^2) | 4 I |
//! | sun, E lux | none | E / pi |
//! | surface of radiance L and area A | inverse square | L A |
//!
//! The last is exact for a closed convex surface, seen from all sides on the average: its flux is pi L A.
//! All of them, and what the surfaces show, are multiplied by one factor, the exposure: the sun's 100 000 lux
//! would leave nothing but white. It is such that a white matte surface in the middle of the scene, facing
//! every light at once, shows 1.

use std::f64::consts::PI;

use glam::{DAffine3, DVec3};

use crate::components::{Falloff, PointLight};
use crate::corners::direction;
use crate::load::staging::Sphere;
use crate::reader::Range;
use wavecrest_base::error::Result;

use super::fields::Fields;

/// How far away the sun is, in radii of the scene: its rays are parallel to a thousandth of a radian.
const SUN_DISTANCE: f64 = 1000.0;

/// Which kind of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Point,
    Sun,
}

/// An element of the extension's `lights`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light {
    kind: Kind,
    color: DVec3,
    /// In candela, or in lux.
    intensity: f64,
}

impl Light {
    /// Reads a light; `None` where its type is not known.
    pub(super) fn read(fields: &Fields<'_>) -> Result<Option<Self>> {
        let kind = fields.need("type", "\"point\", \"spot\" or \"directional\"")?;
        let kind = match kind.value().as_str() {
            Some("point") => Kind::Point,
            Some("directional") => Kind::Sun,
            Some("spot") => {
                let message = "the cone of a spot light is ignored";
                fields.once(message, "it shines in all directions");
                Kind::Point
            }
            Some(_) => {
                let message = "a light is of a type that is not known";
                kind.notes().once(&kind.path(), message, "it is left out");
                return Ok(None);
            }
            None => return Err(kind.error("must be \"point\", \"spot\" or \"directional\"")),
        };
        let color = fields.numbers::<3>("color", Range::NOT_NEGATIVE)?;
        if fields.get("range").is_some() {
            let message = "the range of a light is ignored";
            fields.once(message, "its light falls with the square of the distance");
        }
        Ok(Some(Self {
            kind,
            color: color.map_or(DVec3::ONE, DVec3::from_array),
            intensity: fields.number_or("intensity", Range::NOT_NEGATIVE, 1.0)?,
        }))
    }

    /// The light at a node, before exposure, in a scene that `bounds` is about. `None` where the node says
    /// of no sun where it is.
    pub(super) fn placed(&self, world: &DAffine3, bounds: &Sphere) -> Option<PointLight> {
        let &Self { kind, color, intensity } = self;
        Some(match kind {
            Kind::Point => PointLight {
                intensity: 4.0 * intensity,
                position: world.translation,
                color,
                falloff: Falloff::InverseSquare,
            },
            // It shines along its -z.
            Kind::Sun => PointLight {
                intensity: intensity / PI,
                position: bounds.outside(direction(world.matrix3.z_axis)?, SUN_DISTANCE),
                color,
                falloff: Falloff::None,
            },
        })
    }
}

/// The radiance of a white matte surface in the middle of the scene that faces a light of this strength at
/// `position`. Lights within half the scene's radius count as that far away.
pub(super) fn radiance(strength: DVec3, falloff: Falloff, position: DVec3, bounds: &Sphere) -> f64 {
    let distance = position.distance(bounds.center).max(bounds.radius / 2.0);
    let factor = match falloff {
        Falloff::None => 1.0,
        Falloff::Linear => 1.0 / (4.0 * PI * distance),
        Falloff::InverseSquare => 1.0 / (4.0 * PI * distance * distance),
    };
    strength.max_element() * factor
}

/// The factor that brings the radiance under all lights to 1.
pub(super) fn exposure(radiance: f64) -> f64 {
    let exposure = 1.0 / radiance;
    if exposure.is_finite() && exposure > 0.0 { exposure } else { 1.0 }
}
