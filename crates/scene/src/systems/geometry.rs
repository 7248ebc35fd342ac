//! Geometry: converts shapes to primitives in world space, in one set of arrays.
//!
//! Shapes keep the order of the file within their kind, and shapes of lights come last. Meshes are
//! moved, not copied: the first one's arrays become the scene's, are extended once, and receive the
//! others, each of which is dropped before the next. A mesh with several instances stays separate,
//! as their prototype ([`instances`]).

mod builder;
mod common;
mod instances;
mod meshes;
mod occurrences;
mod output;
mod tangents;

use glam::DVec3;
use hecs::World;

use builder::Builder;
use meshes::Room;
use occurrences::Occurrences;
use wavecrest_base::error::Result;

pub(crate) use common::{Common, Round};
pub use output::{Output, ShapeOutput};

/// Converts every shape to primitives, and moves all by `-origin`. A mesh with several instances is
/// stored once, unless `flat`.
pub fn run(world: &mut World, origin: DVec3, flat: bool) -> Result<Output> {
    let mut occurrences = Occurrences::of(world, flat);
    let room = Room::of(world, &occurrences);
    let mut builder = Builder { origin, room, ..Builder::default() };
    for occurrence in occurrences.triangles(world) {
        builder.add_triangles(world, occurrence, &mut occurrences)?;
    }
    for occurrence in occurrences.quads(world) {
        builder.add_quad(world, occurrence)?;
    }
    for occurrence in occurrences.quadrics(world) {
        builder.add_quadric(world, occurrence)?;
    }
    builder.add_instances(world, &mut occurrences)?;
    Ok(builder.finish())
}
