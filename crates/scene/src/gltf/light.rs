//! Lights: those of `KHR_lights_punctual`, and emissive meshes.
//!
//! The format's units are physical: candela for points and spots, lux for the sun, candela per
//! square metre for surfaces. A white matte surface shows E / pi at a perpendicular illuminance of
//! E lux; one of ours with kd = 1 shows intensity times falloff. Hence
//!
//! | light | falloff | intensity |
//! |---|---|---|
//! | point or spot, I candela | inverse square, 1 / (4 pi d^2) | 4 I |
//! | sun, E lux | none | E / pi |
//! | surface of radiance L and area A | inverse square | L A |
//!
//! The last is exact for a closed convex surface, averaged over all directions: its flux is pi L A.
//! One factor, the exposure, multiplies all of them and the colours of the surfaces: the sun's 100
//! 000 lux would leave nothing but white. With it, a white matte surface in the middle of the scene
//! that faces every light at once shows 1.

use std::f64::consts::PI;

use glam::{DAffine3, DVec3};
use hecs::EntityBuilder;

use crate::components::{DirectionalLight, Falloff, JsonPath, PointLight, Sampling, Spot};
use crate::corners::direction;
use crate::format::Range;
use crate::staging::BoundingSphere;
use wavecrest_base::error::Result;

use super::fields::Fields;

/// The largest and the default outer half angle of a spot, in radians.
const WIDEST: f64 = PI / 2.0;
const USUAL: f64 = PI / 4.0;
/// Larger angles are not accepted for cones.
const LARGEST_ANGLE: f64 = 2.0 * PI;

/// The kind of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LightKind {
    Point,
    /// With half angles in radians.
    Spot {
        inner: f64,
        outer: f64,
    },
    Sun,
}

/// An element of the extension's `lights`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light {
    kind: LightKind,
    color: DVec3,
    /// In candela, or in lux.
    intensity: f64,
}

impl Light {
    /// Reads a light; `None` if its type is unknown.
    pub(super) fn read(fields: &Fields<'_>) -> Result<Option<Self>> {
        let kind = fields.need("type", "\"point\", \"spot\" or \"directional\"")?;
        let kind = match kind.value().as_str() {
            Some("point") => LightKind::Point,
            Some("directional") => LightKind::Sun,
            Some("spot") => spot(fields)?,
            Some(_) => {
                let message = "the type of the light is unknown";
                kind.notes().note(&kind.path(), message, "it is left out");
                return Ok(None);
            }
            None => return Err(kind.error("must be \"point\", \"spot\" or \"directional\"")),
        };
        let color = fields.vector_or("color", Range::NOT_NEGATIVE, DVec3::ONE)?;
        if fields.get("range").is_some() {
            let message = "the range of the light is ignored";
            fields.warn(message, "it falls off with the square of the distance");
        }
        let intensity = fields.number_or("intensity", Range::NOT_NEGATIVE, 1.0)?;
        Ok(Some(Self { kind, color, intensity }))
    }

    /// The light at a node, before exposure. `None` for a spot or sun without a direction.
    pub(super) fn placed(&self, path: String, world: &DAffine3) -> Option<EntityBuilder> {
        let &Self { kind, color, intensity } = self;
        // Along its -z axis.
        let direction = || direction(-world.matrix3.z_axis);
        let light = PointLight {
            intensity: 4.0 * intensity,
            position: world.translation,
            color,
            falloff: Falloff::InverseSquare,
        };
        let mut entity = EntityBuilder::new();
        entity.add(JsonPath(path));
        match kind {
            LightKind::Point => entity.add(light),
            LightKind::Spot { inner, outer } => {
                let [inner_degrees, outer_degrees] = [inner, outer].map(degrees);
                let spot = Spot { direction: direction()?, inner_degrees, outer_degrees };
                entity.add(light).add(spot)
            }
            LightKind::Sun => entity.add(DirectionalLight {
                intensity: intensity / PI,
                color,
                direction: direction()?,
                angle_degrees: 0.0,
                sampling: Sampling::Sobol,
                samples: 1,
            }),
        };
        Some(entity)
    }
}

/// The cone of a spot: `inner` from 0 to below `outer`, and `outer` up to a right angle.
fn spot(fields: &Fields<'_>) -> Result<LightKind> {
    let angles = fields.object("spot")?;
    let angle = |key: &str, default: f64| {
        angles
            .map_or(Ok(default), |own| own.number_or(key, Range::new(0.0, LARGEST_ANGLE), default))
    };
    let outer = angle("outerConeAngle", USUAL)?.min(WIDEST);
    Ok(LightKind::Spot { inner: angle("innerConeAngle", 0.0)?.min(outer), outer })
}

/// In degrees; in single precision a right angle may be slightly larger.
fn degrees(radians: f64) -> f64 {
    if radians >= WIDEST { 90.0 } else { radians.to_degrees().min(90.0) }
}

/// The radiance of a white matte surface in the middle of the scene that faces a light of this
/// strength at `position`, with the inverse square of the distance. Lights within half the scene's
/// radius count as that far away.
pub(super) fn radiance(strength: DVec3, position: DVec3, bounds: &BoundingSphere) -> f64 {
    let distance = position.distance(bounds.center).max(bounds.radius / 2.0);
    strength.max_element() * (1.0 / (4.0 * PI * distance * distance))
}

/// The same for a light that is not a mesh. The middle counts as inside the cone of every spot.
pub(super) fn radiance_of(light: &EntityBuilder, bounds: &BoundingSphere) -> f64 {
    let point = light.get::<&PointLight>();
    let point = point.map(|light| radiance(light.color * light.intensity, light.position, bounds));
    let sun = light.get::<&DirectionalLight>();
    let sun = sun.map(|light| (light.color * light.intensity).max_element());
    point.or(sun).unwrap_or(0.0)
}

/// Multiplies the intensity of a light that is not a mesh.
pub(super) fn expose(light: &mut EntityBuilder, exposure: f64) {
    light.get_mut::<&mut PointLight>().into_iter().for_each(|light| light.intensity *= exposure);
    let sun = light.get_mut::<&mut DirectionalLight>();
    sun.into_iter().for_each(|light| light.intensity *= exposure);
}

/// The lights of a file, and the radiance of a white surface in the middle under them.
pub(super) struct Own {
    /// Number of lights that are not meshes.
    pub(super) count: usize,
    /// The radiance under these,
    pub(super) radiance: f64,
    /// and under emissive meshes.
    pub(super) emitted: f64,
}

/// Smallest radiance from emissive meshes that alone light a file: headlights and diodes give less
/// than a hundredth, the lamp of a room more than a half.
const ENOUGH: f64 = 0.1;

impl Own {
    /// The reason to add lights, in place of those that are not meshes; `None` to add none.
    pub(super) fn why_more(&self, replaces: bool) -> Option<&'static str> {
        let has_lights = self.count > 0;
        match self.emitted > 0.0 {
            false if !has_lights => Some("no lights"),
            _ if replaces && has_lights => Some("the lights of the file are replaced"),
            true if replaces => Some("no lights but emission"),
            _ if self.radiance > 0.0 || self.emitted >= ENOUGH => None,
            _ if has_lights => Some("no lights with power"),
            _ => Some("no lights but weak emission"),
        }
    }

    /// The factor that scales the radiance under all lights to 1; beside added lights, that under
    /// emissive meshes is only scaled down.
    pub(super) fn exposure(&self, has_more: bool) -> f64 {
        match has_more {
            true => exposure(self.emitted).min(1.0),
            false => exposure(self.radiance + self.emitted),
        }
    }
}

fn exposure(radiance: f64) -> f64 {
    let exposure = 1.0 / radiance;
    if exposure.is_finite() && exposure > 0.0 { exposure } else { 1.0 }
}
