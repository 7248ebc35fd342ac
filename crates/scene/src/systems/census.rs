//! The census: which effects the scene calls for, and why each other one is left out.
//!
//! An effect is called for where something that is there to be seen shows it. What nothing leads to is
//! left out, and so is what adds nothing: a mirror in a scene without light, the texture of a surface that
//! shows no colour, a light behind all that it could fall on ([`reach`]).

use glam::Vec3;
use hecs::World;

use super::geometry::{self, ShapeOutput};
use super::lights::Found;
use super::{camera, reach};
use crate::components::{Filter, Settings, TextureRef, ThinLens, View};
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::light::Emitter;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::plan::{Decision, Effect};

/// What the census is taken of: the world, and what the systems before have made of it.
#[derive(Clone, Copy)]
pub struct Census<'a> {
    /// The entities.
    pub world: &'a World,
    /// What holds for the whole scene.
    pub settings: &'a Settings,
    /// Primitives and shapes.
    pub extracted: &'a geometry::Output,
    /// What each shape is made of.
    pub materials: &'a [Material],
    /// All lights.
    pub lights: &'a [Found],
    /// Factor on the diffuse colour for the ambient part of all lights together.
    pub ambient: f32,
}

/// What it finds.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// One for each effect.
    pub decisions: Vec<Decision>,
    /// For each light, whether it can add anything besides its ambient part.
    pub reached: Vec<bool>,
    /// For each shape, whether it wears a texture that can be seen.
    pub textured: Vec<bool>,
}

/// Decides every effect.
pub fn run(census: Census<'_>) -> Findings {
    let facts = Facts::new(census);
    let decisions = Effect::ALL.into_iter().map(|effect| facts.decide(effect)).collect();
    let Facts { reached, .. } = facts;
    Findings { decisions, textured: facts.shows_texture, reached }
}

/// What the decisions rest on.
struct Facts<'a> {
    census: Census<'a>,
    /// For each shape, whether it is a surface that rays can meet.
    visible: Vec<bool>,
    reached: Vec<bool>,
    shows_texture: Vec<bool>,
    /// Whether a mirror could show anything but black.
    shines: bool,
}

impl<'a> Facts<'a> {
    fn new(census: Census<'a>) -> Self {
        let shapes = &census.extracted.shapes;
        let visible: Vec<bool> = shapes.iter().map(|shape| is_visible(shape, census)).collect();
        let wears = |shape: &ShapeOutput| census.world.get::<&TextureRef>(shape.entity).is_ok();
        let wearing: Vec<bool> =
            shapes.iter().zip(&visible).map(|(shape, visible)| *visible && wears(shape)).collect();
        let surfaces: Vec<reach::Surface<'_>> = (0..shapes.len())
            .filter(|&i| visible[i])
            .map(|i| reach::Surface {
                shape: &shapes[i].shape,
                material: &census.materials[i],
                textured: wearing[i],
            })
            .collect();
        let lights: Vec<_> = census.lights.iter().map(|found| &found.light).collect();
        let reached = reach::run(&lights, &surfaces, &census.extracted.geometry);
        let is_lit = reached.contains(&true);
        // Diffuse colour shows by ambient light, whatever kd is, and where light is reflected by it.
        let shows_color = |material: &Material| census.ambient > 0.0 || is_lit && material.kd > 0.0;
        let shows_texture: Vec<bool> = wearing
            .iter()
            .zip(census.materials)
            .map(|(wears, material)| *wears && shows_color(material))
            .collect();
        let is_black = |surface: &reach::Surface<'_>| {
            !surface.textured && surface.material.color == Vec3::ZERO
        };
        let glows = |shape: &ShapeOutput| shape.shape.emission.is_some_and(|c| c != Vec3::ZERO);
        let shines = is_lit
            || shapes.iter().any(glows)
            || census.ambient > 0.0 && !surfaces.iter().all(is_black);
        Self { census, visible, reached, shows_texture, shines }
    }

    fn triangles(&self) -> (bool, String) {
        let geometry = &self.census.extracted.geometry;
        let own = geometry.triangles.len();
        if geometry.instances.is_empty() {
            return count(own, "triangle", "no shape is a triangle or a mesh");
        }
        let held: usize =
            geometry.prototypes.iter().map(|prototype| prototype.triangles.len()).sum();
        let instanced = geometry.len() - geometry.own();
        let (_, meshes) = count(geometry.prototypes.len(), "mesh", "");
        let (_, instances) = count(geometry.instances.len(), "instance", "");
        let meshes = meshes.replace("meshs", "meshes");
        let reason = format!("{own}, and {held} in {meshes} that {instances} show as {instanced}");
        (own + instanced > 0, reason)
    }

    fn decide(&self, effect: Effect) -> Decision {
        let geometry = &self.census.extracted.geometry;
        let (present, reason) = match effect {
            Effect::Triangles => self.triangles(),
            Effect::Quads => count(geometry.quads.len(), "quad", "no shape is a plane"),
            Effect::Spheres => count(geometry.spheres.len(), "sphere", "no shape is a sphere"),
            Effect::SmoothShading => self.smooth_shading(),
            Effect::Textures => self.textures(),
            Effect::RayDifferentials => self.ray_differentials(),
            Effect::PointLights => {
                self.lights("point light", |emitter| matches!(emitter, Emitter::Point(_)))
            }
            Effect::AreaLights => {
                self.lights("area light", |emitter| !matches!(emitter, Emitter::Point(_)))
            }
            Effect::Mirrors => self.mirrors(),
            Effect::DepthOfField => self.depth_of_field(),
            Effect::Antialiasing => self.antialiasing(),
        };
        Decision { effect, present, reason }
    }

    /// The number of surfaces that are as `is` says.
    fn surfaces(&self, is: impl Fn(usize) -> bool) -> usize {
        (0..self.visible.len()).filter(|&i| self.visible[i] && is(i)).count()
    }

    fn is_lit(&self) -> bool {
        self.reached.contains(&true)
    }

    fn smooth_shading(&self) -> (bool, String) {
        let shapes = &self.census.extracted.shapes;
        let smooth = self.surfaces(|i| shapes[i].shape.smooth);
        if smooth > 0 && !self.is_lit() && !self.mirrors().0 {
            return (false, "neither light nor mirror asks for a normal".to_owned());
        }
        count(smooth, "smooth mesh", "no mesh with normals asks for it")
    }

    fn textures(&self) -> (bool, String) {
        let textured = self.shows_texture.iter().filter(|shows| **shows).count();
        let has_any = self.census.world.query::<&TextureRef>().iter().next().is_some();
        let none = match (has_any, self.is_lit() || self.census.ambient > 0.0) {
            (false, _) => "no shape has a texture",
            (true, false) => "no light shows the colour of a texture",
            (true, true) => "no surface shows the colour of its texture",
        };
        count(textured, "textured shape", none)
    }

    fn ray_differentials(&self) -> (bool, String) {
        let shapes = &self.census.extracted.shapes;
        let is_trilinear = |shape: &ShapeOutput| {
            let texture = self.census.world.get::<&TextureRef>(shape.entity);
            texture.is_ok_and(|texture| texture.filter == Filter::Trilinear)
        };
        let textured = shapes.iter().zip(&self.shows_texture).filter(|(_, shows)| **shows);
        let n = textured.filter(|(shape, _)| is_trilinear(shape)).count();
        count(n, "trilinear texture", "no texture that is seen is trilinear")
    }

    fn lights(&self, thing: &str, is: impl Fn(&Emitter) -> bool) -> (bool, String) {
        let of_kind = |found: &Found| is(&found.light.emitter);
        let lights = self.census.lights.iter().zip(&self.reached);
        let lights: Vec<_> = lights.filter(|(found, _)| of_kind(found)).collect();
        let reached = lights.iter().filter(|(_, reached)| **reached).count();
        let has_power = lights.iter().any(|(found, _)| found.light.power != Vec3::ZERO);
        let none = match (lights.is_empty(), has_power) {
            (true, _) => format!("there is no {thing}"),
            (false, false) => format!("no {thing} has power"),
            (false, true) => format!("no {thing} falls on a front that reflects it"),
        };
        let (present, mut reason) = count(reached, thing, &none);
        let others = lights.len() - reached;
        if present && others > 0 {
            reason += &format!(", {others} more with nothing but an ambient part");
        }
        (present, reason)
    }

    fn mirrors(&self) -> (bool, String) {
        let n = self.surfaces(|i| self.census.materials[i].kr > 0.0);
        let bounces = self.census.settings.bounces;
        match (n, bounces) {
            (0, _) => (false, "no material has kr above 0".to_owned()),
            (_, 0) => (false, "nbounces is 0".to_owned()),
            _ if !self.shines => (false, "no light shows anything in a mirror".to_owned()),
            (n, bounces) => (true, format!("{n} with kr above 0, nbounces {bounces}")),
        }
    }

    fn depth_of_field(&self) -> (bool, String) {
        match self.census.world.query::<&ThinLens>().iter().next() {
            None => (false, "the camera is a pinhole".to_owned()),
            Some(lens) if camera::radius(lens) == 0.0 => (false, "the aperture is 0".to_owned()),
            Some(lens) => (
                true,
                format!("aperture {}, {} x {} rays", lens.aperture, lens.samples_x, lens.samples_y),
            ),
        }
    }

    fn antialiasing(&self) -> (bool, String) {
        let n = self.census.world.query::<&View>().iter().next().map_or(1, |view| view.antialias);
        match n {
            1 => (false, "antialias is 1".to_owned()),
            n => (true, format!("{n} x {n} rays a pixel")),
        }
    }
}

/// Whether rays can meet a surface there: not the shape of a light, and not without area.
fn is_visible(ShapeOutput { shape, .. }: &ShapeOutput, census: Census<'_>) -> bool {
    let geometry = &census.extracted.geometry;
    // Fast arithmetic does not know for certain what has no area.
    let may_be_hit =
        |number| geometry.precision == Precision::Fast || !geometry.is_degenerate(number);
    shape.emission.is_none() && shape.primitives.clone().any(may_be_hit)
}

/// `n` of a thing, or the reason for none.
fn count(n: usize, thing: &str, none: &str) -> (bool, String) {
    match n {
        0 => (false, none.to_owned()),
        1 => (true, format!("1 {thing}")),
        n => (true, format!("{n} {thing}s")),
    }
}
