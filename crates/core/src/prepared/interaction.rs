//! From a hit to a point ready to be shaded.

use glam::{Vec2, Vec3};

use super::{Appearance, LookUps, PreparedScene, Shape, Texture, UvMap};
use crate::accel::Hit;
use crate::accel::geometry::{Geometry, Primitive};
use crate::kernels::differential::Differential;
use crate::kernels::precision::Arithmetic;
use crate::kernels::shade::ShadingPoint;
use crate::kernels::surface::{self, Surface};
use crate::kernels::texture::{self, Filter};
use crate::math::float::{dot, normalize};
use crate::math::ray::Ray;

/// Where a ray that was traced arrives.
#[derive(Clone, Copy, Debug)]
pub enum Interaction {
    /// At nothing.
    Nothing,
    /// At the shape of a light, which shows this colour.
    Light(Vec3),
    /// At a surface.
    Surface(ShadingPoint),
}

impl PreparedScene {
    /// The point of the surface that `ray` hits.
    #[inline]
    pub fn surface<P: Arithmetic>(&self, ray: &Ray, hit: &Hit) -> Surface {
        let geometry = self.accel.geometry();
        match geometry.primitive(hit.primitive) {
            Primitive::Triangle(i) => surface::triangle_at::<P>(ray, hit.t, &geometry.triangle(i)),
            Primitive::Quad(i) => surface::quad_at::<P>(ray, hit.t, &geometry.quad(i)),
            Primitive::Sphere(i) => {
                let (center, radius) = geometry.spheres[i];
                surface::sphere_at::<P>(ray, hit.t, center, radius)
            }
            Primitive::Instanced(instanced) => {
                let (instance, prototype) = geometry.instance(instanced);
                let corners = prototype.triangle(instanced.triangle as usize);
                let carried = instance.carried(ray);
                instance.surface(&surface::triangle_at::<P>(&carried, hit.t, &corners))
            }
        }
    }

    /// Where `ray` arrives with `hit`. Its `differential` is asked for where a texture needs it.
    #[inline]
    pub fn interaction<P: Arithmetic>(
        &self,
        ray: &Ray,
        hit: &Hit,
        differential: impl FnOnce() -> Differential,
        look_ups: &mut LookUps,
    ) -> Interaction {
        if hit.is_miss() {
            return Interaction::Nothing;
        }
        let index = self.appearance.shape_of(hit.primitive);
        let shape = &self.appearance.shapes[index];
        if let Some(color) = shape.emission {
            return Interaction::Light(color);
        }
        let geometry = self.accel.geometry();
        let surface = self.surface::<P>(ray, hit);
        let outward = if shape.flipped { -surface.normal } else { surface.normal };
        let at_back = dot(outward, ray.direction) > 0.0;
        let normal = if at_back { -outward } else { outward };
        let material = self.appearance.materials[index];
        let color = match &shape.texture {
            None => material.color,
            Some(texture) => {
                let face = (shape, hit.primitive);
                let footprint = || {
                    let steps = differential().at(ray, hit.t, surface.normal);
                    self.appearance.footprint(texture, geometry, face, &surface, steps)
                };
                self.appearance
                    .texture_color(texture, geometry, face, &surface, footprint, look_ups)
            }
        };
        Interaction::Surface(ShadingPoint {
            point: surface.point,
            error: surface.error,
            normal,
            shading_normal: self.appearance.shading_normal(shape, geometry, hit, &surface, normal),
            view: -normalize(ray.direction),
            color,
            material,
            lit: shape.two_sided || !at_back,
        })
    }
}

impl Appearance {
    /// The interpolated normal on the side of `normal`, or `normal` itself.
    fn shading_normal(
        &self,
        shape: &Shape,
        geometry: &Geometry,
        hit: &Hit,
        surface: &Surface,
        normal: Vec3,
    ) -> Vec3 {
        if !shape.smooth {
            return normal;
        }
        let interpolated = self
            .normals(shape, geometry, hit.primitive)
            .map(|corners| {
                let [wa, wb, wc] = weights(surface.barycentric);
                normalize(corners[0] * wa + corners[1] * wb + corners[2] * wc)
            })
            .filter(|&n| n != Vec3::ZERO);
        match interpolated {
            Some(n) if dot(n, normal) < 0.0 => -n,
            Some(n) => n,
            None => normal,
        }
    }

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

    /// The colour that a texture gives the point `surface` of the shape's primitive. Its footprint in
    /// texture coordinates is asked for where the filter needs it.
    #[inline]
    pub fn texture_color(
        &self,
        texture: &Texture,
        geometry: &Geometry,
        (shape, primitive): (&Shape, u32),
        surface: &Surface,
        footprint: impl FnOnce() -> [Vec2; 2],
        look_ups: &mut LookUps,
    ) -> Vec3 {
        let uv = match &texture.map {
            UvMap::Planar(map) => map.uv(surface.point),
            UvMap::Sphere(to_own) => texture::sphere_uv(normalize(*to_own * surface.normal)),
            UvMap::Mesh => self.uvs(shape, geometry, primitive).map_or(Vec2::ZERO, |corners| {
                let [wa, wb, wc] = weights(surface.barycentric);
                corners[0] * wa + corners[1] * wb + corners[2] * wc
            }),
        };
        let image = &self.images[texture.image as usize];
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
        self.corners(shape, geometry, primitive, |mesh| mesh.uvs.as_ref())
    }

    /// The values of an attribute at the corners of a triangle of a mesh.
    #[inline(always)]
    fn corners<'a, T: Copy + 'a>(
        &'a self,
        shape: &Shape,
        geometry: &Geometry,
        primitive: u32,
        attribute: impl Fn(&'a super::MeshAttributes) -> Option<&'a super::CornerValues<T>>,
    ) -> Option<[T; 3]> {
        let mesh = &self.meshes[shape.mesh? as usize];
        if let Primitive::Instanced(instanced) = geometry.primitive(primitive) {
            let triangle = instanced.triangle as usize;
            let (_, prototype) = geometry.instance(instanced);
            return attribute(mesh)?.corners(triangle, prototype.triangles[triangle]);
        }
        let positions = geometry.triangles[primitive as usize].map(|v| v - mesh.first_position);
        attribute(mesh)?.corners((primitive - mesh.first_triangle) as usize, positions)
    }
}

fn weights(barycentric: Vec2) -> [f32; 3] {
    [1.0 - barycentric.x - barycentric.y, barycentric.x, barycentric.y]
}
