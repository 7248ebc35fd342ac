//! Attributes at the corners of a mesh's triangles.

use glam::{Vec3, Vec4};

use super::{CornerValues, MeshAttributes, PreparedScene, Shape};
use crate::geometry::Primitive;
use crate::geometry::instance::Instance;

impl PreparedScene {
    /// The shading normals at the corners of a triangle of a mesh.
    #[inline(always)]
    pub(super) fn normals(&self, shape: &Shape, primitive: u32) -> Option<[Vec3; 3]> {
        let normals = self.corners(shape, primitive, |mesh| mesh.normals.as_ref())?;
        Some(self.in_world(primitive, normals, Instance::shading_normal))
    }

    /// The tangents at the corners of a triangle of a mesh.
    pub(super) fn tangents(&self, shape: &Shape, primitive: u32) -> Option<[Vec4; 3]> {
        let tangents = self.corners(shape, primitive, |mesh| mesh.tangents.as_ref())?;
        Some(self.in_world(primitive, tangents, Instance::tangent))
    }

    /// Vectors of a mesh in the world: transformed by the instance that shows the primitive, if one
    /// does.
    #[inline(always)]
    fn in_world<T>(
        &self,
        primitive: u32,
        own: [T; 3],
        transformed: impl Fn(&Instance, T) -> T,
    ) -> [T; 3] {
        let geometry = self.accel.geometry();
        match geometry.primitive(primitive) {
            Primitive::Instanced(instanced) => {
                let (instance, _) = geometry.instance(instanced);
                own.map(|vector| transformed(instance, vector))
            }
            _ => own,
        }
    }

    /// The values of an attribute at the corners of a triangle of a mesh.
    #[inline(always)]
    pub(super) fn corners<'a, T: Copy + 'a>(
        &'a self,
        shape: &Shape,
        primitive: u32,
        attribute: impl Fn(&'a MeshAttributes) -> Option<&'a CornerValues<T>>,
    ) -> Option<[T; 3]> {
        let geometry = self.accel.geometry();
        let mesh = &self.appearance.meshes[shape.mesh? as usize];
        if let Primitive::Instanced(instanced) = geometry.primitive(primitive) {
            let triangle = instanced.triangle as usize;
            let (_, prototype) = geometry.instance(instanced);
            return attribute(mesh)?.corners(triangle, prototype.triangles[triangle]);
        }
        let ([a, b, c], first) = (geometry.triangles[primitive as usize], mesh.first_position);
        let triangle = (primitive - mesh.first_triangle) as usize;
        attribute(mesh)?.corners(triangle, [a - first, b - first, c - first])
    }
}
