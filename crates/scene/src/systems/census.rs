//! The census: which effects the scene needs, and why others are skipped.
//!
//! An effect is needed if something in view ([`super::view`]) shows it. Effects that cannot be
//! reached are skipped, and so are those that add nothing: a mirror of which only the back is seen,
//! the texture of a surface that shows no colour, a light behind every surface ([`reach`]).

use glam::Vec3;
use hecs::World;

mod kinds;
mod onward;
mod pixels;
mod shows;
mod surroundings;

use super::geometry::{self, ShapeOutput};
use super::reach;
use super::reach::Faces;
use crate::components::{Settings, SurfaceComponents, TextureRef};
use crate::environment;
use crate::lights::Found;
pub(crate) use shows::Shows;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Primitive;
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::hemisphere::Hemisphere;
use wavecrest_core::kernels::light::Emitter;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::plan::{Decision, Effect};

/// The inputs of the census: the world, and the output of earlier systems.
#[derive(Clone, Copy)]
pub(crate) struct Census<'a> {
    /// The entities.
    pub world: &'a World,
    /// The components of each shape's surface.
    pub surfaces: &'a [SurfaceComponents<'a>],
    /// Settings of the whole scene.
    pub settings: &'a Settings,
    /// Primitives and shapes.
    pub extracted: &'a geometry::Output,
    /// The material of each shape.
    pub materials: &'a [Material],
    /// All lights.
    pub lights: &'a [Found],
    /// Whether the environment has only one colour.
    pub is_even: bool,
    /// See [`super::camera::resolution`].
    pub resolution: &'a dyn Fn() -> (f64, f64),
    /// Whether lights have an ambient part.
    pub has_ambient: bool,
    /// The hemispheric light.
    pub hemisphere: Option<&'a Hemisphere>,
    /// For each shape in view, its visible sides that lights can reach.
    pub in_view: &'a [Option<Faces>],
}

/// The results of the census.
#[derive(Clone, Debug, Default)]
pub(crate) struct Findings {
    /// One for each effect.
    pub decisions: Vec<Decision>,
    /// For each light, whether it adds more than its ambient part to a surface in view.
    pub shown: Vec<bool>,
    /// For each light, whether it can add anything to any surface.
    pub reached: Vec<bool>,
    /// For each shape, which properties of its material are visible.
    pub shows: Vec<Shows>,
    /// For each shape, whether light goes through it where rays may meet it.
    pub transparent: Vec<bool>,
    /// For each shape, whether it has holes that rays may meet.
    pub holes: Vec<bool>,
}

/// Decides every effect. `has_holes` tells of the shapes that it is asked for whether their cut-outs
/// remove anything, `occludes` of one whether its map keeps any ambient light away.
///
/// # Errors
/// If an image cannot be decoded.
pub(crate) fn run(
    census: Census<'_>,
    has_holes: impl FnOnce(&[bool]) -> Result<Vec<bool>>,
    mut occludes: impl FnMut(usize) -> Result<bool>,
) -> Result<Findings> {
    let mut facts = Facts::new(census);
    for i in (0..facts.solid.len()).filter(|&i| facts.visible[i]) {
        let shown = &mut facts.found.shows[i].occlusion;
        *shown = *shown && occludes(i)?;
    }
    let cut = |i: usize| facts.is_met(i) && census.surfaces[i].cut_out.is_some();
    let asked: Vec<bool> = (0..facts.solid.len()).map(cut).collect();
    facts.found.holes = if asked.contains(&true) { has_holes(&asked)? } else { asked };
    let decisions = Effect::ALL.into_iter().map(|effect| facts.decide(effect)).collect();
    let transparent =
        (0..facts.solid.len()).map(|i| facts.is_transparent(i) && facts.is_met(i)).collect();
    let seen = |(seen, shows): (&bool, &Shows)| if *seen { *shows } else { Shows::default() };
    let shows = facts.visible.iter().zip(&facts.found.shows).map(seen).collect();
    Ok(Findings { decisions, shows, transparent, ..facts.found })
}

/// The facts behind the decisions.
struct Facts<'a> {
    census: Census<'a>,
    /// For each shape, whether it is a surface that rays can meet, and whether such rays are
    /// traced.
    solid: Vec<bool>,
    visible: Vec<bool>,
    /// What is known of the results; properties of a material that are visible where the shape is.
    found: Findings,
    /// Whether there is ambient light, and whether any surface in view shows it.
    has_ambient: bool,
    shows_ambient: bool,
    /// Whether a mirror could show anything but black.
    shines: bool,
}

impl<'a> Facts<'a> {
    fn new(census: Census<'a>) -> Self {
        let shapes = &census.extracted.shapes;
        let solid: Vec<bool> = shapes.iter().map(|shape| is_solid(shape, census)).collect();
        let visible: Vec<bool> = solid
            .iter()
            .zip(census.in_view)
            .map(|(solid, seen)| *solid && seen.is_some())
            .collect();
        // Where the shape is not in view, what would be seen of it.
        let faces: Vec<Faces> = (shapes.iter().zip(census.in_view))
            .map(|(shape, seen)| seen.unwrap_or(Faces::lit(&shape.shape)))
            .collect();
        let surface = |i: usize, faces: Faces| reach::Surface {
            shape: &shapes[i].shape,
            material: &census.materials[i],
            textured: census.surfaces[i].texture.is_some(),
            faces,
        };
        let lights: Vec<_> = census.lights.iter().map(|found| &found.light).collect();
        let numbers =
            |those: &[bool]| -> Vec<usize> { (0..shapes.len()).filter(|&i| those[i]).collect() };
        let reached_of = |surfaces: &[reach::Surface<'_>]| {
            reach::run(&lights, surfaces, &census.extracted.geometry)
        };
        let surfaces_of = |those: &[bool], faces: &[Faces]| -> Vec<reach::Surface<'_>> {
            numbers(those).into_iter().map(|i| surface(i, faces[i])).collect()
        };
        let surfaces = surfaces_of(&visible, &faces);
        let seen = reached_of(&surfaces);
        let lit: Vec<Faces> = shapes.iter().map(|shape| Faces::lit(&shape.shape)).collect();
        let anywhere = match visible == solid && faces == lit {
            true => seen.clone(),
            false => reached_of(&surfaces_of(&solid, &lit)),
        };
        let mut is_reached = vec![false; shapes.len()];
        for (those, found) in [(&solid, &anywhere), (&visible, &seen)] {
            numbers(those)
                .into_iter()
                .zip(&found.surfaces)
                .for_each(|(i, lit)| is_reached[i] = *lit);
        }
        let (shown, reached) = (seen.lights, anywhere.lights);
        let is_lit = shown.contains(&true);
        let has_ambient = census.has_ambient || census.hemisphere.is_some_and(|h| !h.is_black());
        let shows_of = |i: usize| match solid[i] {
            true => Shows::of(census, i, (is_reached[i], faces[i]), has_ambient),
            false => Shows::default(),
        };
        let shows: Vec<Shows> = (0..shapes.len()).map(shows_of).collect();
        let is_black = |surface: &reach::Surface<'_>| {
            let Material { color, ambient, .. } = surface.material;
            *ambient == 0.0 || !surface.textured && *color == Vec3::ZERO
        };
        let shows_ambient = has_ambient && !surfaces.iter().all(is_black);
        let is_bright = |shape: &ShapeOutput| shape.shape.light.is_some_and(|c| c != Vec3::ZERO);
        let glows = shows.iter().any(|shows| shows.emission);
        let has_sky = census.hemisphere.is_some_and(|sky| !sky.is_black())
            || environment::is_bright(census.world);
        let shines = is_lit || glows || shapes.iter().any(is_bright) || shows_ambient || has_sky;
        let found = Findings { shown, reached, shows, ..Findings::default() };
        Self { census, solid, visible, found, shines, has_ambient, shows_ambient }
    }

    fn decide(&self, effect: Effect) -> Decision {
        let shows = |is: fn(Shows) -> bool, thing, none| {
            self.surfaces(|i| is(self.found.shows[i]), thing, none)
        };
        let (present, reason) = match effect {
            Effect::Triangles => self.triangles(),
            Effect::Quads => {
                self.kind(|one| matches!(one, Primitive::Quad(_)), "quad", "rays meet no plane")
            }
            Effect::Spheres => {
                self.quadrics(|one| one.sphere().is_some(), "sphere", "rays meet no sphere")
            }
            Effect::Disks => {
                self.quadrics(|one| one.sphere().is_none(), "disk", "rays meet no disk")
            }
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
                let is_trilinear = |i: usize| self.found.shows[i].trilinear(self.census, i);
                self.surfaces(is_trilinear, "trilinear texture", "no visible texture is trilinear")
            }
            Effect::HemisphereLight => self.hemisphere(),
            Effect::Environment => self.environment(),
            Effect::PointLights => {
                self.lights("point light", |emitter| matches!(emitter, Emitter::Point(_)))
            }
            Effect::SpotLights => {
                self.lights("spot light", |emitter| matches!(emitter, Emitter::Spot(..)))
            }
            Effect::DirectionalLights => self.lights("directional light", Emitter::is_distant),
            Effect::AmbientOcclusion => self.occlusion(),
            Effect::AreaLights => self.lights("area light", |emitter| {
                matches!(
                    emitter,
                    Emitter::Sphere { .. } | Emitter::Disk(..) | Emitter::Triangles(_)
                )
            }),
            Effect::Mirrors => self.mirrors(),
            Effect::Transparency => self.transparency(),
            Effect::DepthOfField => self.depth_of_field(),
            Effect::Antialiasing => self.antialiasing(),
        };
        Decision { effect, present, reason }
    }

    /// The number of surfaces in view with the property `is`, or the reason for none.
    fn surfaces(&self, is: impl Fn(usize) -> bool, thing: &str, none: &str) -> (bool, String) {
        let number = |those: &[bool]| (0..those.len()).filter(|&i| those[i] && is(i)).count();
        let (seen, all) = (number(&self.visible), number(&self.solid));
        let (found, reason) = count(all, thing, none);
        match (seen, all - seen) {
            (_, 0) => (found, reason),
            (0, _) => (false, format!("{reason}, not in view")),
            (_, unseen) => {
                (true, format!("{}, {unseen} more not in view", count(seen, thing, "").1))
            }
        }
    }

    /// Whether rays may meet a surface of the shape.
    fn is_met(&self, i: usize) -> bool {
        self.solid[i] && self.census.extracted.shapes[i].is_met
    }

    fn is_lit(&self) -> bool {
        self.found.shown.contains(&true)
    }

    fn smooth_shading(&self) -> (bool, String) {
        let shapes = &self.census.extracted.shapes;
        let none = "no mesh asks for smooth shading";
        let found = self.surfaces(|i| shapes[i].shape.smooth, "smooth mesh", none);
        let sends_rays = self.mirrors().0 || self.transparency().0;
        if found.0 && !self.is_lit() && !sends_rays && !self.hemisphere().0 {
            return (false, "no light and no mirror needs normals".to_owned());
        }
        found
    }

    fn vertex_colors(&self) -> (bool, String) {
        let is_colored = |i: usize| self.census.extracted.shapes[i].shape.colored;
        let none = match (0..self.solid.len()).any(is_colored) {
            true => "no light reaches vertex colours",
            false => "no mesh has vertex colours",
        };
        let shows = |i: usize| is_colored(i) && self.found.shows[i].color;
        let found = self.surfaces(shows, "mesh with vertex colours", none);
        or_in_the_way(found, self.tints(is_colored))
    }

    /// Whether the base colour of such shapes tints the light that they let through.
    fn tints(&self, is: impl Fn(usize) -> bool) -> bool {
        let through = |i: usize| self.census.surfaces[i].transparency;
        let tints = |i: usize| {
            self.is_transparent(i) && self.is_met(i) && through(i).is_some_and(|t| t.tinted)
        };
        (0..self.solid.len()).any(|i| is(i) && tints(i))
    }

    fn textures(&self) -> (bool, String) {
        let has_any = self.census.world.query::<&TextureRef>().iter().next().is_some();
        let none = match (has_any, self.is_lit() || self.has_ambient) {
            (false, _) => "no shape has a texture",
            (true, false) => "no light reaches a texture",
            (true, true) => "no surface uses the colour of its texture",
        };
        let found = self.surfaces(|i| self.found.shows[i].texture, "textured shape", none);
        or_in_the_way(found, self.tints(|i| self.census.surfaces[i].texture.is_some()))
    }

    fn cut_outs(&self) -> (bool, String) {
        let is = |i: usize| self.census.surfaces[i].cut_out.is_some();
        let is_cut = |i: usize| is(i) && (self.found.holes[i] || !self.is_met(i));
        let none = match (0..self.solid.len()).any(|i| self.is_met(i) && is(i)) {
            true => "no image of a cut-out has a transparent texel",
            false => "no shape has cut-outs",
        };
        let found = self.surfaces(is_cut, "shape with cut-outs", none);
        or_in_the_way(found, self.found.holes.contains(&true))
    }

    fn lights(&self, thing: &str, is: impl Fn(&Emitter) -> bool) -> (bool, String) {
        let of_kind = |found: &Found| is(&found.light.emitter);
        let number = |those: &[bool]| {
            let lights = self.census.lights.iter().zip(those);
            lights.filter(|(found, counts)| **counts && of_kind(found)).count()
        };
        let all = self.census.lights.iter().filter(|found| of_kind(found)).count();
        let (shown, reached) = (number(&self.found.shown), number(&self.found.reached));
        let has_power = |found: &Found| found.light.power != Vec3::ZERO;
        let none = match all {
            0 => format!("there is no {thing}"),
            _ if reached > 0 => format!("no {thing} shines on anything in view"),
            _ if self.census.lights.iter().any(|found| of_kind(found) && has_power(found)) => {
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

/// Whether rays can meet a surface of the shape: not of a light's, and not without area.
fn is_solid(ShapeOutput { shape, is_met, .. }: &ShapeOutput, census: Census<'_>) -> bool {
    let geometry = &census.extracted.geometry;
    // Fast precision cannot tell for certain what has no area.
    let may_be_hit =
        |number| geometry.precision == Precision::Fast || !geometry.is_degenerate(number);
    shape.light.is_none() && (!is_met || shape.primitives.clone().any(may_be_hit))
}

/// What is `found` in view, or else is met by shadow rays.
fn or_in_the_way((found, reason): (bool, String), is_met: bool) -> (bool, String) {
    match found || !is_met {
        true => (found, reason),
        false => (true, format!("{reason}, but in the way of light")),
    }
}

/// `n` of a thing, or the reason for none.
fn count(n: usize, thing: &str, none: &str) -> (bool, String) {
    match n {
        0 => (false, none.to_owned()),
        1 => (true, format!("1 {thing}")),
        n => (true, format!("{n} {}", plural(thing))),
    }
}

/// "smooth meshes" for "smooth mesh", and "shapes with maps" for "shape with maps".
fn plural(thing: &str) -> String {
    let (noun, rest) = thing.find(" with ").map_or((thing, ""), |at| thing.split_at(at));
    let ending = if noun.ends_with("sh") { "es" } else { "s" };
    format!("{noun}{ending}{rest}")
}
