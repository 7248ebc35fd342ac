//! Lights: emitters with what is needed to sample them, in the order of the file.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use hecs::{Entity, World};

use super::geometry::Output;
use crate::accel::geometry::{Geometry, Primitive};
use crate::error::{Error, ErrorKind, Result};
use crate::kernels::camera;
use crate::kernels::light::{Emitter, Light, Triangles};
use crate::kernels::quad;
use crate::math::sampling::Sampling;
use crate::prepared::Shape;
use crate::scene::components::{AreaLight, JsonPath, Order, PointLight, Settings};

/// What this system makes.
#[derive(Debug)]
pub struct LightsOutput {
    /// The lights with power.
    pub lights: Vec<Light>,
    /// Number of lights, with or without power: each adds its ambient part.
    pub count: usize,
}

/// The lights of the world, moved by `-origin` as its shapes are.
pub fn run(
    world: &World,
    extracted: &Output,
    settings: &Settings,
    origin: DVec3,
) -> Result<LightsOutput> {
    let mut found: Vec<(Order, Entity, Light)> = Vec::new();
    for (entity, order, light) in world.query::<(Entity, &Order, &PointLight)>().iter() {
        found.push((*order, entity, point_light(light, origin)));
    }
    let shapes: HashMap<Entity, &Shape> =
        extracted.shapes.iter().map(|output| (output.entity, &output.shape)).collect();
    for (entity, order, light) in world.query::<(Entity, &Order, &AreaLight)>().iter() {
        let shape = shapes.get(&entity);
        let emitter = shape
            .and_then(|shape| emitter(&extracted.geometry, shape))
            .ok_or_else(|| no_area(world, entity, settings))?;
        found.push((*order, entity, area_light(light, emitter)));
    }
    found.sort_by_key(|(order, ..)| *order);
    let count = found.len();
    let mut lights = Vec::new();
    let mut dimension = camera::DIMENSION + 1;
    for (_, entity, mut light) in found.into_iter().filter(|(.., l)| l.power != Vec3::ZERO) {
        light.dimension = dimension;
        let drawn = if light.is_sampled() { light.samples() } else { 0 };
        dimension = dimension
            .checked_add(drawn)
            .ok_or_else(|| too_many_samples(world, entity, settings))?;
        lights.push(light);
    }
    Ok(LightsOutput { lights, count })
}

fn point_light(light: &PointLight, origin: DVec3) -> Light {
    Light {
        emitter: Emitter::Point(super::single(light.position - origin)),
        power: power(light.intensity, light.color),
        falloff: light.falloff,
        sampling: Sampling::Random,
        grid: [1, 1],
        dimension: 0,
    }
}

fn area_light(light: &AreaLight, emitter: Emitter) -> Light {
    let grid = match light.sampling {
        Sampling::Random | Sampling::Sobol => [light.samples, 1],
        Sampling::Jittered => [light.samples, light.samples],
    };
    let power = power(light.intensity, light.color);
    Light { emitter, power, falloff: light.falloff, sampling: light.sampling, grid, dimension: 0 }
}

fn power(intensity: f64, color: DVec3) -> Vec3 {
    super::single(color * intensity)
}

/// The shape of a light, as something to choose points on.
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
        Primitive::Sphere(_) => vec![],
    }
}

fn place(world: &World, entity: Entity) -> String {
    world.get::<&JsonPath>(entity).map_or_else(|_| String::new(), |p| p.0.clone())
}

fn no_area(world: &World, entity: Entity, settings: &Settings) -> Error {
    Error::new(ErrorKind::Scene, "the shape of an area light must have an area")
        .in_file(&settings.file)
        .at(format!("{}.shape", place(world, entity)))
        .remedy("give it corners that are not on one line, or use a point light")
}

/// Each sample has random numbers of its own, and these are numbered in 32 bits.
fn too_many_samples(world: &World, entity: Entity, settings: &Settings) -> Error {
    Error::new(ErrorKind::Limit, "the lights have too many samples together")
        .in_file(&settings.file)
        .at(format!("{}.samples", place(world, entity)))
        .remedy(format!("at most {} are allowed", u32::MAX - 1))
}
