//! The census: which effects the scene needs, and why others are skipped.
//!
//! An effect is needed if something in view ([`super::view`]) shows it. Effects that cannot be
//! reached are skipped, and so are those that add nothing: a mirror of which only the back is seen,
//! the texture of a surface that shows no colour, a light behind every surface ([`super::reach`]).

mod ambient;
mod kinds;
mod onward;
mod pixels;

use glam::Vec3;
use hecs::World;

use super::frame::Frame;
use super::reach::Illuminates;
use super::surface::{SurfaceColumns, SurfaceComponents};
use super::visibility::{MaterialBound, Shows, Source, Visibility};
use crate::components::TextureRef;
use wavecrest_core::geometry::{Geometry, Primitive};
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::light::{EmitterKind, Light};
use wavecrest_core::plan::{Decision, Effect};
use wavecrest_core::prepared::Shape;

/// What systems know of a shape.
struct ShapeFacts<'a> {
    shape: &'a Shape,
    surface: SurfaceComponents<'a>,
    /// The largest weights of its material.
    bound: &'a Material,
    visibility: &'a Visibility,
}

impl ShapeFacts<'_> {
    /// Whether the base colour tints the light that the shape lets through.
    fn tints(&self) -> bool {
        let is_tinted = self.surface.transparency.is_some_and(|through| through.tinted);
        is_tinted && self.visibility.lets_light_through()
    }
}

/// What is known of the scene.
struct Census<'a> {
    world: &'a World,
    frame: &'a Frame,
    geometry: &'a Geometry,
    shapes: Vec<ShapeFacts<'a>>,
    lights: Vec<(&'a Light, &'a Illuminates)>,
}

/// Decides every effect.
pub(crate) fn run(world: &World, frame: &Frame, geometry: &Geometry) -> Vec<Decision> {
    let surfaces = world.view::<SurfaceColumns<'_>>();
    let mut shapes = world.query::<(&Source, &Shape, &MaterialBound, &Visibility)>();
    let facts = shapes.iter().map(|(source, shape, MaterialBound(bound), visibility)| {
        let surface = SurfaceComponents::of(&surfaces, source.0);
        ShapeFacts { shape, surface, bound, visibility }
    });
    let shapes = facts.collect();
    let mut lights = world.query::<(&Light, &Illuminates)>();
    let lights = lights.iter().collect();
    let census = Census { world, frame, geometry, shapes, lights };
    Effect::ALL.into_iter().map(|effect| census.decide(effect)).collect()
}

impl Census<'_> {
    fn decide(&self, effect: Effect) -> Decision {
        let shows = |is: fn(Shows) -> bool, thing, none| {
            self.surfaces(|shape| is(shape.visibility.shows), thing, none)
        };
        let (present, reason) = match effect {
            Effect::Triangles => self.triangles(),
            Effect::Quads => {
                self.kind(|one| matches!(one, Primitive::Quad(_)), "quad", "rays meet no plane")
            }
            Effect::Spheres => self.quadrics(true, "sphere"),
            Effect::Disks => self.quadrics(false, "disk"),
            Effect::SmoothShading => self.smooth_shading(),
            Effect::VertexColors => self.vertex_colors(),
            Effect::Textures => self.textures(),
            Effect::NormalMaps => {
                shows(|s| s.normal, "shape with a normal map", "no normal map is visible")
            }
            Effect::MaterialTextures => {
                let none = "no material map is visible";
                shows(|s| s.metal || s.occlusion, "shape with material maps", none)
            }
            Effect::TintedHighlights => {
                shows(|s| s.tint, "shape with a specular colour", "no highlight has a colour")
            }
            Effect::Emission => shows(|s| s.emission, "emissive shape", "no material is emissive"),
            Effect::CutOuts => self.cut_outs(),
            Effect::RayDifferentials => {
                let is_trilinear = |shape: &ShapeFacts<'_>| shape.visibility.is_trilinear;
                self.surfaces(is_trilinear, "trilinear texture", "no visible texture is trilinear")
            }
            Effect::HemisphereLight => self.hemisphere(),
            Effect::Environment => self.environment(),
            Effect::PointLights => self.lights(EmitterKind::Point),
            Effect::SpotLights => self.lights(EmitterKind::Spot),
            Effect::DirectionalLights => self.lights(EmitterKind::Directional),
            Effect::AmbientOcclusion => self.occlusion(),
            Effect::AreaLights => self.lights(EmitterKind::Area),
            Effect::Mirrors => self.mirrors(),
            Effect::Transparency => self.transparency(),
            Effect::DepthOfField => self.depth_of_field(),
            Effect::Antialiasing => self.antialiasing(),
        };
        Decision { effect, present, reason }
    }

    /// Whether any shape `is` so.
    fn any(&self, is: impl Fn(&ShapeFacts<'_>) -> bool) -> bool {
        self.shapes.iter().any(is)
    }

    /// The number of surfaces in view with the property `is`, or the reason for none.
    fn surfaces(&self, is: impl Fn(&ShapeFacts<'_>) -> bool, thing: &str, none: &str) -> Found {
        let those = || self.shapes.iter().filter(|shape| shape.visibility.is_surface && is(shape));
        let all = those().count();
        let seen = those().filter(|shape| shape.visibility.faces.is_some()).count();
        let (found, reason) = count(all, thing, none);
        match (seen, all - seen) {
            (_, 0) => (found, reason),
            (0, _) => absent(format!("{reason}, not in view")),
            (_, unseen) => {
                present(format!("{}, {unseen} more not in view", count(seen, thing, "").1))
            }
        }
    }

    fn is_lit(&self) -> bool {
        self.lights.iter().any(|(_, illuminates)| illuminates.in_view)
    }

    fn smooth_shading(&self) -> Found {
        let none = "no mesh asks for smooth shading";
        let found = self.surfaces(|shape| shape.shape.smooth, "smooth mesh", none);
        let sends_rays = self.mirrors().0 || self.transparency().0;
        if found.0 && !self.is_lit() && !sends_rays && !self.hemisphere().0 {
            return absent("no light and no mirror needs normals");
        }
        found
    }

    fn vertex_colors(&self) -> Found {
        let none = match self.any(|shape| shape.shape.colored) {
            true => "no light reaches vertex colours",
            false => "no mesh has vertex colours",
        };
        let shows = |shape: &ShapeFacts<'_>| shape.shape.colored && shape.visibility.shows.color;
        let found = self.surfaces(shows, "mesh with vertex colours", none);
        or_in_the_way(found, self.any(|shape| shape.shape.colored && shape.tints()))
    }

    fn textures(&self) -> Found {
        let has_any = self.world.query::<&TextureRef>().iter().next().is_some();
        let none = match (has_any, self.is_lit() || self.has_ambient()) {
            (false, _) => "no shape has a texture",
            (true, false) => "no light reaches a texture",
            (true, true) => "no surface uses the colour of its texture",
        };
        let found = self.surfaces(|shape| shape.visibility.shows.texture, "textured shape", none);
        or_in_the_way(found, self.any(|shape| shape.surface.texture.is_some() && shape.tints()))
    }

    fn cut_outs(&self) -> Found {
        let is = |shape: &ShapeFacts<'_>| shape.surface.cut_out.is_some();
        let none = match self.any(|shape| shape.visibility.is_surface_met() && is(shape)) {
            true => "no image of a cut-out has a transparent texel",
            false => "no shape has cut-outs",
        };
        let is_cut = |shape: &ShapeFacts<'_>| {
            is(shape) && (shape.visibility.has_holes || !shape.visibility.is_surface_met())
        };
        let found = self.surfaces(is_cut, "shape with cut-outs", none);
        or_in_the_way(found, self.any(|shape| shape.visibility.has_holes))
    }

    fn lights(&self, kind: EmitterKind) -> Found {
        let thing = kind.name();
        let those = || self.lights.iter().filter(|(light, _)| light.emitter.kind() == kind);
        let all = those().count();
        let shown = those().filter(|(_, illuminates)| illuminates.in_view).count();
        let none = match all {
            0 => format!("there is no {thing}"),
            _ if those().any(|(_, illuminates)| illuminates.anywhere) => {
                format!("no {thing} shines on anything in view")
            }
            _ if those().any(|(light, _)| light.power != Vec3::ZERO) => {
                format!("no {thing} shines on the front of a surface")
            }
            _ => format!("no {thing} has power"),
        };
        let (present, mut reason) = count(shown, thing, &none);
        if present && all > shown {
            reason += &format!(", {} more with only an ambient part", all - shown);
        }
        (present, reason)
    }
}

/// Whether an effect is present, and the reason.
type Found = (bool, String);

fn present(reason: impl Into<String>) -> Found {
    (true, reason.into())
}

fn absent(reason: impl Into<String>) -> Found {
    (false, reason.into())
}

/// What is `found` in view, or else is met by shadow rays.
fn or_in_the_way((found, reason): Found, is_met: bool) -> Found {
    match found || !is_met {
        true => (found, reason),
        false => present(format!("{reason}, but in the way of light")),
    }
}

/// `n` of a thing, or the reason for none.
fn count(n: usize, thing: &str, none: &str) -> Found {
    match n {
        0 => absent(none),
        1 => present(format!("1 {thing}")),
        n => present(format!("{n} {}", plural(thing))),
    }
}

/// "smooth meshes" for "smooth mesh", and "shapes with maps" for "shape with maps".
fn plural(thing: &str) -> String {
    let (noun, rest) = thing.find(" with ").map_or((thing, ""), |at| thing.split_at(at));
    let ending = if noun.ends_with("sh") { "es" } else { "s" };
    format!("{noun}{ending}{rest}")
}
