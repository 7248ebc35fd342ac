//! Normal maps: textures that change the shading normal.
//!
//! A texel is a vector in the frame of tangent, bitangent and normal: red along u, green along v,
//! blue along the normal. On meshes, tangents are interpolated from the corners and give the
//! bitangent, as in programs that bake normal maps (Mikkelsen, *Simulation of Wrinkled Surfaces
//! Revisited*, 2008).

use glam::Vec3;

use super::detail::TexturePlace;
use super::{Appearance, Texture, UvMap};
use crate::kernels::shade::ShadingPoint;
use crate::kernels::texture::sphere_directions;
use crate::math::float::{dot, normalize};

/// A texture of normals.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMap {
    /// The texture: a value x stands for 2 x - 1.
    pub texture: Texture,
    /// Factor on the tangential part.
    pub strength: f32,
}

impl NormalMap {
    /// Turns the shading normal of `point` by the texel, in the tangent frame there. The normal is
    /// unchanged at a strength of 0, if there are no tangents, as where texture coordinates span no area, or if the
    /// result would have no direction.
    pub(super) fn turn(
        &self,
        texel: Vec3,
        appearance: &Appearance,
        place: TexturePlace<'_>,
        point: &mut ShadingPoint<f32>,
    ) {
        if self.strength == 0.0 {
            return;
        }
        let sided = Vec3::from(point.shading_normal);
        // The texture belongs to the front, and so do the tangents.
        let is_back = dot(appearance.front_normal(place), sided) < 0.0;
        let normal = if is_back { -sided } else { sided };
        let [along_u, along_v] = appearance.tangents(&self.texture.map, place, normal);
        let Vec3 { x, y, z } = texel * 2.0 - 1.0;
        let turned = along_u * (x * self.strength) + along_v * (y * self.strength) + normal * z;
        let turned = normalize(turned);
        if turned.is_finite() && turned != Vec3::ZERO && along_u != Vec3::ZERO {
            point.shading_normal = if is_back { -turned } else { turned }.into();
        }
    }
}

impl Appearance {
    /// The normal on the front, interpolated on smooth shapes; not of unit length.
    fn front_normal(&self, place: TexturePlace<'_>) -> Vec3 {
        let TexturePlace { shape, primitive, geometry, surface, .. } = place;
        let smooth = shape.smooth.then(|| self.normals(shape, geometry, primitive)).flatten();
        if let Some(corners) = smooth {
            return between(corners, surface.barycentric);
        }
        let normal = Vec3::from(surface.normal);
        if shape.flipped { -normal } else { normal }
    }

    /// The directions in which u and v grow, of about unit length; zero if they do not.
    fn tangents(&self, map: &UvMap, place: TexturePlace<'_>, normal: Vec3) -> [Vec3; 2] {
        let TexturePlace { shape, primitive, geometry, surface, .. } = place;
        match map {
            UvMap::Planar(map) => map.directions(),
            UvMap::Sphere(to_own) => {
                let own = normalize(*to_own * Vec3::from(surface.normal));
                sphere_directions(own).map(|direction| to_own.transpose() * direction)
            }
            UvMap::Mesh => {
                let Some(corners) = self.corner_tangents(shape, geometry, primitive) else {
                    return [Vec3::ZERO; 2];
                };
                let tangent = between(corners.map(|corner| corner.truncate()), surface.barycentric);
                // All corners of a triangle are on the same side, except in inconsistent files.
                let across = normal.cross(tangent);
                [tangent, if corners[0].w < 0.0 { -across } else { across }]
            }
        }
    }
}

/// The weighted mean of three corner values.
fn between([a, b, c]: [Vec3; 3], [y, z]: [f32; 2]) -> Vec3 {
    a * (1.0 - y - z) + b * y + c * z
}
