//! Attributes at the corners of a mesh's triangles.

use glam::{Vec2, Vec3, Vec4};

use super::{Appearance, CornerValues, MeshAttributes, Shape};
use crate::geometry::{Geometry, Primitive};

impl Appearance {
    /// The shading normals at the corners of a triangle of a mesh.
    #[inline(always)]
    pub fn normals(&self, shape: &Shape, geometry: &Geometry, primitive: u32) -> Option<[Vec3; 3]> {
        let normals = self.corners(shape, geometry, primitive, |mesh| mesh.normals.as_ref())?;
        Some(match geometry.primitive(primitive) {
            Primitive::Instanced(instanced) => {
                let (instance, _) = geometry.instance(instanced);
                normals.map(|normal| instance.shading_normal(normal))
            }
            _ => normals,
        })
    }

    /// The colours at the corners of a triangle of a mesh.
    #[inline(always)]
    pub(super) fn colors(
        &self,
        shape: &Shape,
        geometry: &Geometry,
        primitive: u32,
    ) -> Option<[Vec3; 3]> {
        self.corners(shape, geometry, primitive, |mesh| mesh.colors.as_ref())
    }

    /// The alphas at the corners of a triangle of a mesh.
    #[inline(always)]
    pub(super) fn alphas(
        &self,
        shape: &Shape,
        geometry: &Geometry,
        primitive: u32,
    ) -> Option<[f32; 3]> {
        self.corners(shape, geometry, primitive, |mesh| mesh.alphas.as_deref())
    }

    /// The tangents at the corners of a triangle of a mesh.
    pub(super) fn corner_tangents(
        &self,
        shape: &Shape,
        geometry: &Geometry,
        primitive: u32,
    ) -> Option<[Vec4; 3]> {
        let tangents = self.corners(shape, geometry, primitive, |mesh| mesh.tangents.as_ref())?;
        Some(match geometry.primitive(primitive) {
            Primitive::Instanced(instanced) => {
                let (instance, _) = geometry.instance(instanced);
                tangents.map(|tangent| instance.tangent(tangent))
            }
            _ => tangents,
        })
    }

    /// The texture coordinates at the corners of a triangle of a mesh.
    #[inline(always)]
    pub(super) fn uvs(
        &self,
        shape: &Shape,
        geometry: &Geometry,
        primitive: u32,
    ) -> Option<[Vec2; 3]> {
        self.corners(shape, geometry, primitive, |mesh| mesh.uvs.as_deref())
    }

    /// The values of an attribute at the corners of a triangle of a mesh.
    #[inline(always)]
    fn corners<'a, T: Copy + 'a>(
        &'a self,
        shape: &Shape,
        geometry: &Geometry,
        primitive: u32,
        attribute: impl Fn(&'a MeshAttributes) -> Option<&'a CornerValues<T>>,
    ) -> Option<[T; 3]> {
        let mesh = &self.meshes[shape.mesh? as usize];
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
