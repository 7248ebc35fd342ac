//! Lights: emitters with sampling data, in the order of the file.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use hecs::{Entity, World};

use super::bounds;
use super::census::Findings;
use super::geometry::Output;
use crate::components::{AreaLight, DirectionalLight, Order, PointLight, Settings, Spot};
use crate::corners::direction;
use crate::query::json_path;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::geometry::{Geometry, Primitive};
use wavecrest_core::kernels::camera;
use wavecrest_core::kernels::light::{Cone, Distant, Emitter, Falloff, Light, Triangles};
use wavecrest_core::kernels::quad;
use wavecrest_core::math::sampling::Sampling;
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::Shape;

/// A light of the world.
#[derive(Debug)]
pub struct Found {
    /// Its entity.
    entity: Entity,
    /// Its index among the lights of the file.
    order: Order,
    /// The light, without its dimension yet.
    pub light: Light,
}

/// The lights of the world in the order of the file, moved by `-origin` like its shapes.
pub fn run(
    world: &World,
    extracted: &Output,
    settings: &Settings,
    origin: DVec3,
) -> Result<Vec<Found>> {
    let mut found: Vec<Found> = Vec::new();
    let mut points = world.query::<(Entity, &Order, &PointLight, Option<&Spot>)>();
    for (entity, &order, light, spot) in points.iter() {
        found.push(Found { entity, order, light: point_light(light, spot, origin) });
    }
    let mut size = None;
    for (entity, &order, light) in world.query::<(Entity, &Order, &DirectionalLight)>().iter() {
        // A pass over every position, only if there is such a light.
        let size = *size.get_or_insert_with(|| diameter(&extracted.geometry));
        found.push(Found { entity, order, light: directional_light(light, size) });
    }
    let shapes: HashMap<Entity, &Shape> =
        extracted.shapes.iter().map(|output| (output.entity, &output.shape)).collect();
    for (entity, &order, light) in world.query::<(Entity, &Order, &AreaLight)>().iter() {
        let shape = shapes.get(&entity);
        let emitter = shape
            .and_then(|shape| emitter(&extracted.geometry, shape))
            .ok_or_else(|| no_area(world, entity, settings))?;
        found.push(Found { entity, order, light: area_light(light, emitter) });
    }
    found.sort_by_key(|found| found.order);
    Ok(found)
}

/// The lights to simulate, each with its own dimensions: those that reach a surface in view
/// (`shown`), or all if the schedule skips none.
///
/// A light that reaches nothing draws its numbers, if any, after all others, so that its presence
/// changes none of theirs. Visibility changes no numbers: the noise stays the same when the camera
/// turns.
pub fn keep(
    world: &World,
    settings: &Settings,
    schedule: Schedule,
    found: Vec<Found>,
    Findings { shown, reached, .. }: &Findings,
) -> Result<Vec<Light>> {
    if !schedule.has_shadows() {
        return Ok(Vec::new());
    }
    let all = schedule.is_needless(Step::Shadow);
    let mut found = found;
    let mut dimension = camera::DIMENSION + 1;
    for turn in [true, false] {
        let of_turn = found.iter_mut().zip(reached).filter(|(_, reached)| **reached == turn);
        for (Found { entity, light, .. }, _) in of_turn {
            light.dimension = dimension;
            let drawn = if light.is_sampled() { light.samples() } else { 0 };
            dimension = dimension
                .checked_add(drawn)
                .ok_or_else(|| too_many_samples(world, *entity, settings))?;
        }
    }
    let kept = found.into_iter().zip(shown).filter(|(_, shown)| **shown || all);
    Ok(kept.map(|(found, _)| found.light).collect())
}

fn point_light(light: &PointLight, spot: Option<&Spot>, origin: DVec3) -> Light {
    let position = (light.position - origin).as_vec3();
    let cone =
        |spot: &Spot| Cone::new(unit(spot.direction), spot.inner_degrees, spot.outer_degrees);
    let is_shut = spot.is_some_and(|spot| spot.outer_degrees == 0.0);
    Light {
        emitter: spot.map_or(Emitter::Point(position), |s| Emitter::Spot(position, cone(s))),
        power: if is_shut { Vec3::ZERO } else { power(light.intensity, light.color) },
        falloff: light.falloff,
        sampling: Sampling::Random,
        grid: [1, 1],
        dimension: 0,
    }
}

/// Upper bound on the distance between any two points of the scene.
fn diameter(geometry: &Geometry) -> f64 {
    bounds::of(geometry).map_or(0.0, |[low, high]| (high - low).length())
}

fn directional_light(light: &DirectionalLight, diameter: f64) -> Light {
    let emitter = Distant::new(-unit(light.direction), light.angle_degrees, diameter);
    Light {
        emitter: Emitter::Distant(emitter),
        power: power(light.intensity, light.color),
        falloff: Falloff::None,
        sampling: light.sampling,
        // Parallel rays need only one sample.
        grid: if emitter.is_parallel() { [1, 1] } else { grid(light.sampling, light.samples) },
        dimension: 0,
    }
}

/// A unit vector; a vector without direction becomes down.
pub(super) fn unit(v: DVec3) -> DVec3 {
    direction(v).unwrap_or(DVec3::NEG_Y)
}

/// Columns and rows of the points of a light.
fn grid(sampling: Sampling, samples: u32) -> [u32; 2] {
    match sampling {
        Sampling::Random | Sampling::Sobol => [samples, 1],
        Sampling::Jittered => [samples, samples],
    }
}

fn area_light(light: &AreaLight, emitter: Emitter) -> Light {
    let grid = grid(light.sampling, light.samples);
    let power = power(light.intensity, light.color);
    Light { emitter, power, falloff: light.falloff, sampling: light.sampling, grid, dimension: 0 }
}

fn power(intensity: f64, color: DVec3) -> Vec3 {
    (color * intensity).as_vec3()
}

/// The shape of a light, as an emitter.
fn emitter(geometry: &Geometry, shape: &Shape) -> Option<Emitter> {
    let range = shape.primitives.clone();
    if let Primitive::Sphere(i) = geometry.primitive(range.start) {
        let (center, radius) = geometry.spheres[i];
        return Some(Emitter::Sphere { center, radius });
    }
    let corners = range.flat_map(|number| triangles(geometry, number)).collect();
    Triangles::new(corners).map(Emitter::Triangles)
}

fn triangles(geometry: &Geometry, number: u32) -> Vec<[Vec3; 3]> {
    match geometry.primitive(number) {
        Primitive::Triangle(i) => vec![geometry.triangle(i)],
        Primitive::Quad(i) => quad::halves(&geometry.quad(i)).to_vec(),
        Primitive::Sphere(_) | Primitive::Instanced(_) => vec![],
    }
}

fn no_area(world: &World, entity: Entity, settings: &Settings) -> Error {
    Error::new(ErrorKind::Scene, "the shape of an area light must have an area")
        .in_file(&settings.file)
        .at(format!("{}.shape", json_path(world, entity)))
        .remedy("move the corners apart, or use a point light")
}

/// The error that samples exceed 32-bit numbers: each has its own random numbers.
fn too_many_samples(world: &World, entity: Entity, settings: &Settings) -> Error {
    Error::new(ErrorKind::Limit, "the lights have too many samples in all")
        .in_file(&settings.file)
        .at(format!("{}.samples", json_path(world, entity)))
        .remedy(format!("at most {} are allowed", u32::MAX - 1))
}
