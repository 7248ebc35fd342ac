//! Geometry: converts shapes to primitives in world space, in one set of arrays.
//!
//! Shapes keep the order of the file within their kind, and shapes of lights come last. Meshes are
//! moved, not copied, unless others own them, too: the first one's arrays become the scene's, are extended once, and receive the
//! others, each of which is dropped before the next. A mesh that is shown twice or more is stored once, in its own
//! space, and becomes a prototype with [`instances`]. Other prototypes are a few numbers, and a mesh that is shown
//! once is best stored in world space: these become primitives of the scene's own. So do shapes of lights, whose
//! triangles are sampled, and transparent ones, all of which a shadow ray must find.

mod builder;
mod instances;
mod meshes;
mod tangents;

use std::ops::Range;

use hecs::World;

use super::frame::Frame;
use super::lights::ShapeEmitter;
use super::placement::ShapeInstance;
use super::visibility::{MaterialBound, Source, Visibility};
use builder::GeometryBuilder;
pub(crate) use builder::is_varied;
use meshes::Meshes;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::prepared::{MeshAttributes, Shape, UvMap};

/// The arrays of a scene's geometry.
#[derive(Debug, Default)]
pub(crate) struct Arrays {
    /// The primitives.
    pub(crate) geometry: Geometry,
    pub(crate) meshes: Vec<MeshAttributes>,
}

/// A shape in the arrays: components of its entity.
pub(super) type BuiltShape = (Source, Visibility, Shape, UvMap);

/// Converts every shape to primitives, and spawns an entity for each in the order of its primitives: with
/// what is known of it, and components that later systems fill in. No component is added or removed after
/// that, so that every query visits shapes in this order. What no ray can meet has no primitives, but shapes
/// of lights leave their [`ShapeEmitter`].
pub(crate) fn run(
    world: &mut World,
    frame: &Frame,
    all: Vec<ShapeInstance>,
    flat: bool,
) -> Result<Arrays> {
    let (met, unmet): (Vec<_>, Vec<_>) = all.into_iter().partition(|one| one.visibility.is_met);
    let (lights, absent): (Vec<_>, Vec<_>) =
        unmet.into_iter().partition(ShapeInstance::is_of_light);
    let build = |shapes, flat| {
        build(world, shapes, flat).map_err(|error| error.in_file(&frame.settings.file))
    };
    let (mut arrays, mut shapes) = build(met, flat)?;
    let (unmet, unmet_lights) = build(lights, true)?;
    leave_emitters(world, &arrays.geometry, &shapes);
    leave_emitters(world, &unmet.geometry, &unmet_lights);
    arrays.geometry.set_precision(frame.precision);
    let geometry = &mut arrays.geometry;
    for (_, visibility, shape, _) in &mut shapes {
        visibility.is_surface &= has_area(shape, geometry);
        let primitives = || shape.primitives.clone();
        if visibility.lets_light_through() {
            geometry.transparent.push(primitives());
        }
        // Shadow rays pass shapes of lights, and transparent ones, which take some of their light.
        if visibility.lets_light_through() || shape.light.is_some() && !primitives().is_empty() {
            geometry.passed.push(primitives());
        }
    }
    let absent = absent.into_iter().map(|mut one| {
        one.shape.flipped = false;
        one.built(0..0, UvMap::Mesh)
    });
    let entities = absent.chain(shapes).map(|(source, visibility, shape, uv_map)| {
        (source, visibility, shape, uv_map, Material::BLACK, MaterialBound(Material::BLACK))
    });
    world.spawn_batch(entities);
    Ok(arrays)
}

/// Converts shapes, given in the order of the file, to primitives. Their meshes are moved out of the world here.
pub(super) fn build(
    world: &World,
    all: Vec<ShapeInstance>,
    flat: bool,
) -> Result<(Arrays, Vec<BuiltShape>)> {
    let mut meshes = Meshes::moved_out_of(world, &all, flat);
    let mut builder = GeometryBuilder { room: meshes.room(&all), ..GeometryBuilder::default() };
    let (instances, mut own): (Vec<_>, Vec<_>) =
        all.into_iter().partition(|instance| meshes.is_shared(instance));
    own.sort_by_key(|instance| instance.geometry.kind());
    for instance in own {
        builder.add(&instance, &mut meshes)?;
    }
    builder.add_instances(&instances, meshes)?;
    Ok((builder.arrays, builder.shapes))
}

impl ShapeInstance {
    /// The shape with these primitives.
    fn built(&self, primitives: Range<u32>, uv_map: UvMap) -> BuiltShape {
        let shape = Shape { primitives, ..self.shape.clone() };
        (Source(self.entity), self.visibility, shape, uv_map)
    }
}

/// Leaves what emits the light of shapes of lights with these.
fn leave_emitters(world: &mut World, geometry: &Geometry, shapes: &[BuiltShape]) {
    for (source, _, shape, _) in shapes.iter().filter(|(.., shape, _)| shape.light.is_some()) {
        let emitter = ShapeEmitter::of(geometry, shape);
        let _ = world.insert_one(source.0, emitter);
    }
}

/// Whether rays can meet any of the shape.
fn has_area(shape: &Shape, geometry: &Geometry) -> bool {
    // Fast precision cannot tell for certain what has no area.
    let may_be_hit =
        |number| geometry.precision == Precision::Fast || !geometry.is_degenerate(number);
    shape.primitives.clone().any(may_be_hit)
}
