//! Shapes: the kinds of shapes, and what they share.
//!
//! Each kind is a file with its component and its keys.

mod common;
mod disk;
mod flat;
mod instance;
mod mesh;
mod sphere;
mod transform;

use crate::format::{Declaration, Kind, Variants};
use crate::surface::SURFACE;

pub(crate) use common::COMMON;
pub use common::{Hidden, Name, Shading, Sides};
pub use disk::Disk;
pub use flat::{Facing, Quad, Triangle};
pub use instance::InstanceOf;
pub(crate) use instance::{INSTANCE, Names, instance, write};
pub use mesh::{Materials, Mesh, MeshFile};
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
    Variants { name: "a shape", about: "A shape.", kinds: &with(KINDS, &[&SURFACE, &COMMON], &[]) };

/// Shapes of lights, which have a colour of their own and are always visible, from both sides.
pub(crate) const LIT: Variants =
    Variants { kinds: &with(KINDS, &[&common::OF_LIGHT], &SURFACE), ..SHAPES };

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
