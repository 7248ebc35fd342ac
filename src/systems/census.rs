//! The census: which effects the scene calls for, and why each other one is left out.

use glam::DVec3;
use hecs::World;

use crate::plan::{Decision, Effect, Plan};
use crate::scene::components::{
    AreaLight, Filter, Material, Mesh, PointLight, Quad, Settings, Shading, Sphere, TextureRef,
    ThinLens, Triangle, View,
};

/// Decides every effect.
pub fn run(world: &World) -> Plan {
    Plan::new(Effect::ALL.into_iter().map(|effect| decide(world, effect)).collect())
}

fn decide(world: &World, effect: Effect) -> Decision {
    let (present, reason) = match effect {
        Effect::Triangles => triangles(world),
        Effect::Quads => count(quads(world), "quad", "no shape is a plane"),
        Effect::Spheres => count(spheres(world), "sphere", "no shape is a sphere"),
        Effect::SmoothShading => smooth(world),
        Effect::Textures => count(textured(world), "textured shape", "no shape has a texture"),
        Effect::RayDifferentials => ray_differentials(world),
        Effect::PointLights => {
            count(point_lights(world), "point light", "no point light has power")
        }
        Effect::AreaLights => count(area_lights(world), "area light", "no area light has power"),
        Effect::Mirrors => mirrors(world),
        Effect::DepthOfField => depth_of_field(world),
        Effect::Antialiasing => antialiasing(world),
    };
    Decision { effect, present, reason }
}

/// `n` of a thing, or the reason for none.
fn count(n: usize, thing: &str, none: &str) -> (bool, String) {
    match n {
        0 => (false, none.to_owned()),
        1 => (true, format!("1 {thing}")),
        n => (true, format!("{n} {thing}s")),
    }
}

fn triangles(world: &World) -> (bool, String) {
    let single = world.query::<&Triangle>().iter().count();
    let in_meshes: usize = world.query::<&Mesh>().iter().map(|m| m.data.triangles.len()).sum();
    count(single + in_meshes, "triangle", "no shape is a triangle or a mesh")
}

fn quads(world: &World) -> usize {
    world.query::<&Quad>().iter().count()
}

fn spheres(world: &World) -> usize {
    world.query::<&Sphere>().iter().count()
}

fn smooth(world: &World) -> (bool, String) {
    let n = world
        .query::<(&Mesh, &Shading)>()
        .without::<&AreaLight>()
        .iter()
        .filter(|(mesh, shading)| **shading == Shading::Smooth && mesh.data.normals.is_some())
        .count();
    count(n, "smooth mesh", "no mesh with normals asks for it")
}

fn textured(world: &World) -> usize {
    world.query::<&TextureRef>().without::<&AreaLight>().iter().count()
}

fn ray_differentials(world: &World) -> (bool, String) {
    let mut textures = world.query::<&TextureRef>().without::<&AreaLight>();
    let n = textures.iter().filter(|texture| texture.filter == Filter::Trilinear).count();
    count(n, "trilinear texture", "no texture is trilinear")
}

/// A light of no intensity or of a black colour lights nothing.
fn has_power(intensity: f64, color: DVec3) -> bool {
    intensity > 0.0 && color != DVec3::ZERO
}

fn point_lights(world: &World) -> usize {
    world.query::<&PointLight>().iter().filter(|l| has_power(l.intensity, l.color)).count()
}

fn area_lights(world: &World) -> usize {
    world.query::<&AreaLight>().iter().filter(|l| has_power(l.intensity, l.color)).count()
}

fn mirrors(world: &World) -> (bool, String) {
    let bounces = world.query::<&Settings>().iter().next().map_or(0, |s| s.bounces);
    let n =
        world.query::<&Material>().without::<&AreaLight>().iter().filter(|m| m.kr > 0.0).count();
    match (n, bounces) {
        (0, _) => (false, "no material has kr above 0".to_owned()),
        (_, 0) => (false, "nbounces is 0".to_owned()),
        (n, bounces) => (true, format!("{n} with kr above 0, nbounces {bounces}")),
    }
}

fn depth_of_field(world: &World) -> (bool, String) {
    match world.query::<&ThinLens>().iter().next() {
        None => (false, "the camera is a pinhole".to_owned()),
        Some(lens) if lens.aperture == 0.0 => (false, "the aperture is 0".to_owned()),
        Some(lens) => (
            true,
            format!("aperture {}, {} x {} rays", lens.aperture, lens.samples_x, lens.samples_y),
        ),
    }
}

fn antialiasing(world: &World) -> (bool, String) {
    let n = world.query::<&View>().iter().next().map_or(1, |view| view.antialias);
    match n {
        1 => (false, "antialias is 1".to_owned()),
        n => (true, format!("{n} x {n} rays a pixel")),
    }
}
