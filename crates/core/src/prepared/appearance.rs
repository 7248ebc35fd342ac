//! Texture and mesh attribute look-ups at hits.

use glam::{Vec2, Vec3, Vec4};

use super::{Appearance, CornerValues, LookUps, MeshAttributes, Shape, Texture, UvMap};
use crate::accel::Hit;
use crate::geometry::{Geometry, Primitive};
use crate::kernels::differential::Differential;
use crate::kernels::surface::Surface;
use crate::kernels::texture::{self, Filter};
use crate::math::float::normalize;
use crate::math::ray::Ray;

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

    /// The colour of `texture` at the point `surface` of the shape's primitive. `arriving` returns
    /// the ray's differential, the ray and its hit; it is called only if the filter needs them.
    #[inline]
    pub fn texture_at(
        &self,
        texture: &Texture,
        face: (&Shape, u32),
        geometry: &Geometry,
        surface: &Surface<f32>,
        arriving: impl FnOnce() -> (Differential, Ray, Hit),
        look_ups: &mut LookUps,
    ) -> Vec3 {
        let footprint = || {
            let (differential, ray, hit) = arriving();
            let steps = differential.at(&ray, hit.t, surface.normal.into());
            self.footprint(texture, geometry, face, surface, steps)
        };
        self.texture_color(texture, geometry, face, surface, footprint, look_ups)
    }

    /// The colour of a texture at the point `surface` of the shape's primitive. The footprint in
    /// texture coordinates is computed only if the filter needs it.
    #[inline]
    fn texture_color(
        &self,
        texture: &Texture,
        geometry: &Geometry,
        (shape, primitive): (&Shape, u32),
        surface: &Surface<f32>,
        footprint: impl FnOnce() -> [Vec2; 2],
        look_ups: &mut LookUps,
    ) -> Vec3 {
        let uv = match &texture.map {
            UvMap::Planar(map) => map.uv(surface.point.into()),
            UvMap::Sphere(to_own) => {
                texture::sphere_uv(normalize(*to_own * Vec3::from(surface.normal)))
            }
            UvMap::Mesh => self.uvs(shape, geometry, primitive).map_or(Vec2::ZERO, |corners| {
                let [wa, wb, wc] = weights(surface.barycentric);
                corners[0] * wa + corners[1] * wb + corners[2] * wc
            }),
        };
        let uv = texture.placing.map_or(uv, |placing| placing.apply(uv));
        let Some(image) = self.images[texture.image as usize].look_up() else { return Vec3::ZERO };
        if texture.filter != Filter::Trilinear {
            look_ups.texels += texture.filter.texels();
            return image.look_up(uv, texture.filter, texture.wrap);
        }
        look_ups.footprints += 1;
        let (color, texels) = image.look_up_at(uv, image.level(&footprint()), texture.wrap);
        look_ups.texels += texels;
        color
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

fn weights([y, z]: [f32; 2]) -> [f32; 3] {
    [1.0 - y - z, y, z]
}
