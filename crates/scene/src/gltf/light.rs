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
//! 000 lux would leave nothing but white. With it, white matte surfaces show at most 1 but for those
//! next to lamps.

use std::f64::consts::PI;

use glam::{DAffine3, DVec3};
use hecs::EntityBuilder;

use crate::components::{DirectionalLight, Falloff, JsonPath, PointLight, Sampling, Spot, View};
use crate::corners::direction;
use crate::format::Range;
use crate::scene_file::AMBIENT;
use crate::staging::{BoundingSphere, Scenery};
use wavecrest_base::error::Result;
use wavecrest_base::parallel;

use super::fields::Fields;

/// The largest and the default outer half angle of a spot, in radians.
const WIDEST: f64 = PI / 2.0;
const USUAL: f64 = PI / 4.0;
/// Larger angles are not accepted for cones.
const LARGEST_ANGLE: f64 = 2.0 * PI;

#[derive(Clone, Copy, Debug, PartialEq)]
enum LightKind {
    Point,
    /// With its inner and outer half angle, in radians.
    Spot([f64; 2]),
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
            LightKind::Spot(angles) => {
                let [inner_degrees, outer_degrees] = angles.map(f64::to_degrees);
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
    Ok(LightKind::Spot([angle("innerConeAngle", 0.0)?.min(outer), outer]))
}

/// A lamp ends at this multiple of the radius of a ball with its area: the corners of a ball's mesh
/// lie outside of that.
const LAMP: f64 = 1.1;

/// What a light adds to surfaces, without shadows.
pub(super) struct LightSource {
    /// The greatest channel of its intensity and colour.
    strength: f64,
    /// `None` for a sun.
    position: Option<DVec3>,
    /// The direction of its light, and the least cosine of an angle to it that is lit.
    axis: DVec3,
    least: f64,
    /// What is nearer is the lamp itself.
    nearest: f64,
}

impl LightSource {
    /// A mesh of this emission, area and centre.
    pub(super) fn glowing(emission: DVec3, area: f64, middle: DVec3) -> Self {
        let strength = (emission * area).max_element();
        let nearest = LAMP * (area / (4.0 * PI)).sqrt();
        Self { strength, position: Some(middle), axis: DVec3::ZERO, least: -1.0, nearest }
    }

    /// A light that is not a mesh.
    pub(super) fn of(light: &EntityBuilder) -> Self {
        let cone = |spot: &Spot| (spot.direction, libm::cos(spot.outer_degrees.to_radians()));
        let spot = light.get::<&Spot>().map_or((DVec3::ZERO, -1.0), cone);
        let point = light.get::<&PointLight>();
        let point = point.map(|own| (Some(own.position), own.intensity * own.color, spot));
        let sun = light.get::<&DirectionalLight>();
        let sun = sun.map(|own| (None, own.intensity * own.color, (own.direction, -1.0)));
        let (position, color, (axis, least)) = point.or(sun).unwrap_or_default();
        Self { strength: color.max_element(), position, axis, least, nearest: 0.0 }
    }

    /// The radiance of a white matte surface that faces the light at this distance.
    fn facing(&self, distance: f64) -> f64 {
        match self.position {
            Some(_) => self.strength / (4.0 * PI * distance * distance),
            None => self.strength,
        }
    }

    /// The same in the middle of the scene. Lights within half its radius count as that far away.
    fn in_middle(&self, bounds: &BoundingSphere) -> f64 {
        let distance = self.position.map_or(0.0, |position| position.distance(bounds.center));
        self.facing(distance.max(bounds.radius / 2.0))
    }

    /// The same at a point with a normal, on the side that is lit.
    fn on(&self, [point, normal]: [DVec3; 2]) -> f64 {
        let from = self.position.map_or(self.axis, |position| point - position);
        let (way, normal) = (from.normalize_or_zero(), normal.normalize_or_zero());
        match from.length() >= self.nearest && way.dot(self.axis) >= self.least {
            true => self.facing(from.length()) * way.dot(normal).abs(),
            false => 0.0,
        }
    }
}

/// Multiplies the intensity of a light that is not a mesh.
pub(super) fn expose(light: &mut EntityBuilder, exposure: f64) {
    light.get_mut::<&mut PointLight>().into_iter().for_each(|light| light.intensity *= exposure);
    let sun = light.get_mut::<&mut DirectionalLight>();
    sun.into_iter().for_each(|light| light.intensity *= exposure);
}

pub(super) struct FileLights {
    /// Those that are not meshes,
    pub(super) lights: Vec<LightSource>,
    /// and emissive meshes.
    pub(super) glowing: Vec<LightSource>,
}

/// Smallest radiance from emissive meshes that alone light a file: headlights and diodes give less
/// than a hundredth, the lamp of a room more than a half.
const ENOUGH: f64 = 0.1;

/// The share of the lit surfaces in view that must not be white: others are beside a lamp, and
/// an image that shows these well is dark.
const NOT_WHITE: f64 = 0.97;

impl FileLights {
    /// The reason to add lights, in place of those that are not meshes; `None` to add none.
    pub(super) fn why_more(&self, bounds: &BoundingSphere, replaces: bool) -> Option<&'static str> {
        let emitted: f64 = self.glowing.iter().map(|source| source.in_middle(bounds)).sum();
        let has_lights = !self.lights.is_empty();
        match emitted > 0.0 {
            false if !has_lights => Some("no lights"),
            _ if replaces && has_lights => Some("the lights of the file are replaced"),
            true if replaces => Some("no lights but emission"),
            _ if self.lights.iter().any(|source| source.strength > 0.0) || emitted >= ENOUGH => {
                None
            }
            _ if has_lights => Some("no lights with power"),
            _ => Some("no lights but weak emission"),
        }
    }

    /// The factor at which white matte surfaces in `view` become white, but for the brightest; where
    /// none is lit, one in the middle. Beside added lights, emissive meshes are only scaled down.
    pub(super) fn exposure(&self, contents: &Scenery<'_>, view: &View, has_more: bool) -> f64 {
        let lights = if has_more { &[] } else { &self.lights[..] };
        let sources = || lights.iter().chain(&self.glowing);
        if sources().count() == 0 {
            return 1.0;
        }
        let middle: f64 = sources().map(|source| source.in_middle(&contents.sphere)).sum();
        let on = |surface: &[DVec3; 2]| sources().map(|source| source.on(*surface)).sum();
        let seen = contents.seen(view);
        let mut lit = vec![0.0; seen.len()];
        parallel::each_mut(&mut lit, |i, sum| *sum = on(&seen[i]));
        // Surfaces in whose plane a light is are lit by roundings.
        lit.retain(|sum| *sum > middle * f64::from(f32::EPSILON));
        lit.sort_by(f64::total_cmp);
        let bright = lit.get((lit.len() as f64 * NOT_WHITE) as usize);
        let exposure = (1.0 - AMBIENT) / bright.copied().unwrap_or(middle);
        let is_usable = exposure.is_finite() && exposure > 0.0;
        if is_usable && !(has_more && exposure > 1.0) { exposure } else { 1.0 }
    }
}
