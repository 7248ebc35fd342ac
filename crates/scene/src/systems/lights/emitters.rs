//! The emitters of lights, kind by kind.

use glam::{DVec3, Vec3};
use hecs::{Entity, World};

use crate::components::{
    AreaLight, DirectionalLight, Falloff, Material, PointLight, Sampling, Sky, Spot,
};
use crate::corners::unit;
use crate::query::json_path;
use crate::systems::camera::resolution;
use crate::systems::frame::Frame;
use crate::systems::{bounds, sky};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::geometry::{Geometry, Primitive, Quadric};
use wavecrest_core::kernels::disk::Disk;
use wavecrest_core::kernels::light::{Cone, Distant, Emitter, Light, Triangles};
use wavecrest_core::kernels::quad;
use wavecrest_core::kernels::shade::HALF_LEVEL;
use wavecrest_core::prepared::Shape;

/// Lights with their entities.
type Found = Vec<(Entity, Light)>;

/// The point lights, of which cones narrow some.
pub(super) fn points(world: &World, frame: &Frame) -> Found {
    let mut lights = world.query::<(Entity, &PointLight, Option<&Spot>)>();
    let lights = lights.iter().map(|(entity, light, spot)| {
        let position = (light.position - frame.origin).as_vec3();
        let cone = |spot: &Spot| {
            let Spot { direction, inner_degrees, outer_degrees } = *spot;
            Emitter::Spot(position, Cone::new(unit(direction), inner_degrees, outer_degrees))
        };
        let emitter = spot.map_or(Emitter::Point(position), cone);
        let is_dark = spot.is_some_and(|spot| spot.outer_degrees == 0.0);
        let power = if is_dark { Vec3::ZERO } else { power(light.intensity, light.color) };
        (entity, self::light(emitter, power, light.falloff, (Sampling::Random, 1)))
    });
    lights.collect()
}

/// The directional lights, of a scene with this `geometry`.
pub(super) fn directional(world: &World, frame: &Frame, geometry: &Geometry) -> Found {
    let mut size = None;
    let mut lights = world.query::<(Entity, &DirectionalLight)>();
    let lights = lights.iter().map(|(entity, light)| {
        // A pass over every position, only if there is such a light.
        let size = *size.get_or_insert_with(|| diameter(geometry));
        let is_parallel = is_parallel(light, size, frame, geometry);
        let angle = if is_parallel { 0.0 } else { light.angle_degrees };
        let distant = Distant::new(-unit(light.direction), angle, size);
        // Parallel rays need only one sample.
        let points = (light.sampling, if distant.is_parallel() { 1 } else { light.samples });
        let power = power(light.intensity, light.color);
        (entity, self::light(Emitter::Distant(distant), power, Falloff::None, points))
    });
    lights.collect()
}

/// Whether the size of the light changes less than half of one of 255 levels, expected over positions of a
/// shadow's edge in a pixel: in penumbrae, which are at most as wide as the light is seen from the farthest
/// thing in their way, and on surfaces, by whose highlight it changes most.
fn is_parallel(
    light: &DirectionalLight,
    diameter: f64,
    frame: &Frame,
    geometry: &Geometry,
) -> bool {
    let strength = (light.intensity * light.color.max_element()).max(1.0);
    let changes = 2.0 * libm::sin((light.angle_degrees / 2.0).to_radians()) * strength;
    let least = f64::from(HALF_LEVEL);
    // The slope of a highlight cos^e is at most sqrt(e).
    let is_small = changes * Material::SHARPEST.sqrt() < least;
    is_small && changes * diameter < least * resolution(&frame.cameras, geometry).0
}

/// The area lights.
pub(super) fn areas(world: &World, frame: &Frame) -> Result<Found> {
    let mut lights = world.query::<(Entity, &AreaLight, Option<&mut ShapeEmitter>)>();
    let lights = lights.iter().map(|(entity, light, emitter)| {
        let emitter = emitter.and_then(|emitter| emitter.0.take());
        let emitter = emitter.ok_or_else(|| no_area(world, entity, frame))?;
        let &AreaLight { intensity, color, falloff, sampling, samples } = light;
        let power = power(intensity, color);
        Ok((entity, self::light(emitter, power, falloff, (sampling, samples))))
    });
    lights.collect()
}

/// Ambient light that shadow rays look for.
pub(super) fn skies(world: &World, geometry: &Geometry) -> Found {
    let mut skies = world.query::<(Entity, &Sky)>();
    let lights = skies.iter().filter(|(_, sky)| sky.samples > 0).map(|(entity, sky)| {
        let all = || Distant::reach(diameter(geometry));
        let reach = sky.distance.unwrap_or_else(all) as f32;
        let emitter = Emitter::Around(reach.max(f32::MIN_POSITIVE));
        let power = sky::of(sky, world, None).channels();
        (entity, self::light(emitter, power, Falloff::None, (sky.sampling, sky.samples)))
    });
    lights.collect()
}

/// Upper bound on the distance between any two points of the scene.
fn diameter(geometry: &Geometry) -> f64 {
    bounds::of(geometry).map_or(0.0, |[low, high]| (high - low).length())
}

/// A light, of whose points so many are looked at.
fn light(
    emitter: Emitter,
    power: Vec3,
    falloff: Falloff,
    (sampling, samples): (Sampling, u32),
) -> Light {
    let rows = if sampling == Sampling::Jittered { samples } else { 1 };
    Light { emitter, power, falloff, sampling, grid: [samples, rows], dimension: 0 }
}

fn power(intensity: f64, color: DVec3) -> Vec3 {
    (color * intensity).as_vec3()
}

/// What emits the light of a shape, left beside it until its light takes it; `None` without an area.
pub(crate) struct ShapeEmitter(Option<Emitter>);

impl ShapeEmitter {
    pub(crate) fn of(geometry: &Geometry, shape: &Shape) -> Self {
        let range = shape.primitives.clone();
        let Primitive::Quadric(i) = geometry.primitive(range.start) else {
            let corners = range.flat_map(|number| triangles(geometry, number)).collect();
            return Self(Triangles::new(corners).map(Emitter::Triangles));
        };
        Self(Some(match geometry.quadrics[i] {
            Quadric::Sphere(center, radius) => Emitter::Sphere { center, radius },
            Quadric::Disk(disk) => Emitter::Disk(disk, Disk::axes(disk.normal.as_dvec3())),
        }))
    }
}

fn triangles(geometry: &Geometry, number: u32) -> Vec<[Vec3; 3]> {
    match geometry.primitive(number) {
        Primitive::Triangle(i) => vec![geometry.triangle(i)],
        Primitive::Quad(i) => quad::halves(&geometry.quad(i)).to_vec(),
        Primitive::Quadric(_) | Primitive::Instanced(_) => vec![],
    }
}

fn no_area(world: &World, entity: Entity, frame: &Frame) -> Error {
    Error::new(ErrorKind::Scene, "the shape of an area light must have an area")
        .in_file(&frame.settings.file)
        .at(format!("{}.shape", json_path(world, entity)))
        .remedy("move the corners apart, or use a point light")
}
