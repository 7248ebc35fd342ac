//! Geometry: converts shapes to primitives in world space, in one set of arrays.
//!
//! Shapes keep the order of the file within their kind, and shapes of lights come last. Meshes are
//! moved, not copied: the first one's arrays become the scene's, are extended once, and receive the
//! others, each of which is dropped before the next. A mesh with several instances stays separate,
//! as their prototype ([`instances`]).

mod builder;
mod instances;
mod meshes;
mod occurrence;
mod occurrences;
mod output;
mod tangents;

use glam::DVec3;
use hecs::World;

use crate::components::{Quad, Triangle};
use builder::GeometryBuilder;
pub(crate) use builder::is_varied;
use meshes::ArrayLengths;
use occurrences::{Geometries, Occurrences, Shown};
use wavecrest_base::error::Result;
use wavecrest_core::prepared::UvMap;

pub(crate) use occurrence::{Form, Occurrence, Round};
pub(crate) use output::{Output, ShapeOutput};

/// Converts every shape to primitives, and moves all by `-origin`; the second output has the shapes of
/// lights that no ray can meet. A mesh with several instances is stored once, unless `flat`. `meet` finds
/// out what no ray can meet, of which the first output has no primitives.
pub(crate) fn run(
    world: &World,
    origin: DVec3,
    flat: bool,
    meet: impl FnOnce(&mut [Occurrence<'_>]) -> Result<()>,
) -> Result<[Output; 2]> {
    let (mut shown, mut geometries) = (world.query::<Shown<'_>>(), world.query::<Geometries<'_>>());
    let geometries = geometries.view();
    let mut all = occurrences::of(shown.iter(), &geometries, origin);
    meet(&mut all)?;
    let (met, unmet): (Vec<_>, Vec<_>) = all.into_iter().partition(|one| one.is_met);
    let (lights, unmet): (Vec<_>, Vec<_>) = unmet.into_iter().partition(|one| one.light.is_some());
    let mut output = build(world, met, flat)?;
    let absent = unmet.iter().map(|one| one.output(one.shape(0..0, false), UvMap::Mesh));
    output.shapes.splice(0..0, absent);
    Ok([output, build(world, lights, true)?])
}

/// Converts shapes, given in the order of the file, to primitives.
pub(super) fn build(world: &World, all: Vec<Occurrence<'_>>, flat: bool) -> Result<Output> {
    let mut occurrences = Occurrences::new(all, flat);
    let room = ArrayLengths::of(world, &occurrences);
    let mut builder = GeometryBuilder { room, ..GeometryBuilder::default() };
    // Numbers of primitives follow their kinds: triangles, quads, quadrics.
    for i in 0..occurrences.all.len() {
        let occurrence = occurrences.all[i];
        match occurrence.form {
            Form::Triangle(Triangle { points }) => builder.add_triangle(&occurrence, points)?,
            Form::Mesh if !occurrences.is_instance(&occurrence) => {
                let (mesh, _) = occurrences.take(world, occurrence.prototype);
                builder.add_mesh(&occurrence, mesh)?;
            }
            _ => {}
        }
    }
    for occurrence in &occurrences.all {
        if let Form::Quad(Quad { points }) = occurrence.form {
            builder.add_quad(occurrence, points)?;
        }
    }
    for occurrence in &occurrences.all {
        match occurrence.form {
            Form::Sphere(sphere) => builder.add_quadric(occurrence, sphere.in_world(occurrence)?),
            Form::Disk(disk) => builder.add_quadric(occurrence, disk.in_world(occurrence)?),
            _ => {}
        }
    }
    builder.add_instances(world, &mut occurrences)?;
    Ok(builder.finish())
}
