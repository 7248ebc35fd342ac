//! Shapes: the kinds of shapes, and what they share.
//!
//! Each kind is a file with its component and its keys.

mod disk;
mod flat;
mod instance;
mod mesh;
mod place;
mod sphere;
mod transform;

use hecs::EntityBuilder;

use crate::components::AreaLight;
use crate::format::{Cursor, Declaration, Kind, Variants};
use crate::surface::SURFACE;
use wavecrest_base::error::Result;

pub use disk::Disk;
pub use flat::{Facing, Quad, Triangle};
pub use instance::InstanceOf;
pub(crate) use instance::{INSTANCE, Names, instance, write};
pub use mesh::{Materials, Mesh, MeshFile, VertexColors};
pub(crate) use place::PLACED;
pub use place::{Hidden, Name, Shading, Sides};
pub use sphere::Sphere;
pub use transform::Transform;

/// The kinds of shapes, without what they share.
const KINDS: [Kind; 7] = [
    sphere::KIND,
    disk::KIND,
    flat::PLANE,
    flat::TRIANGLE,
    mesh::FROM_FILE,
    mesh::INDEXED,
    mesh::STRIP,
];

/// Shapes of the scene.
pub(crate) const SHAPES: Variants =
    Variants { name: "a shape", about: "A shape.", kinds: &with(KINDS, &[&SURFACE, &PLACED], &[]) };

/// Shapes of lights, which have a colour of their own and are always visible, from both sides.
pub(crate) const LIT: Variants =
    Variants { kinds: &with(KINDS, &[&place::OF_LIGHT], &SURFACE), ..SHAPES };

/// The kinds with these components too.
const fn with<const N: usize>(
    mut kinds: [Kind; N],
    more: &'static [&'static [Declaration]],
    unread: &'static [Declaration],
) -> [Kind; N] {
    let mut i = 0;
    while i < N {
        kinds[i].more = more;
        kinds[i].unread = unread;
        i += 1;
    }
    kinds
}

/// Reads a shape as components of an `entity`.
pub(crate) fn read(
    cursor: &Cursor<'_>,
    variants: &Variants,
    entity: &mut EntityBuilder,
) -> Result<()> {
    let object = cursor.variant(variants)?;
    object.components(entity)?;
    let is_light = entity.has::<AreaLight>();
    if is_light
        && entity.get::<&Triangle>().is_some_and(|triangle| !triangle.has_area())
        && let Some(points) = object.get("points")
    {
        return Err(points.error("a light must have an area").remedy("move the corners apart"));
    }
    Ok(())
}
