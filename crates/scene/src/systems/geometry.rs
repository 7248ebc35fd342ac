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
use meshes::ArrayLengths;
use occurrence::Form;
use occurrences::{Geometries, Occurrences, Shown};
use wavecrest_base::error::Result;

pub(crate) use occurrence::{Occurrence, Round};
pub(crate) use output::{Output, ShapeOutput};

/// Converts every shape to primitives, and moves all by `-origin`. A mesh with several instances is
/// stored once, unless `flat`.
pub(crate) fn run(world: &World, origin: DVec3, flat: bool) -> Result<Output> {
    let (mut shown, mut geometries) = (world.query::<Shown<'_>>(), world.query::<Geometries<'_>>());
    let geometries = geometries.view();
    let mut occurrences = Occurrences::of(shown.iter(), &geometries, origin, flat);
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
