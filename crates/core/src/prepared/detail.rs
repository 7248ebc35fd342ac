//! Details: properties of shapes other than colour, from textures or constants.
//!
//! Both tracers look them up hit by hit, only on shapes with details; a look-up starts from the
//! shading point without them.

use glam::Vec3;

use super::interaction::{Face, Group, lanes};
use super::{Appearance, LookUps, NormalMap, PreparedScene, Shape, Texture};
use crate::accel::Hit;
use crate::geometry::Geometry;
use crate::kernels::differential::Differential;
use crate::kernels::metal;
use crate::kernels::shade::ShadingPoint;
use crate::kernels::surface::Surface;
use crate::kernels::transmission::Transparency;
use crate::math::ray::Ray;
use crate::math::real::Single;

/// Properties of a shape other than its colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Detail {
    /// Emission, which is visible but does not light other surfaces.
    pub emission: Vec3,
    /// A texture that multiplies the emission.
    pub emission_texture: Option<Texture>,
    /// Colour of the highlight and of mirrored light.
    pub tint: Vec3,
    /// Metalness and roughness, which determine all reflection parameters together with the colour.
    pub metal: Option<Metal>,
    /// Share of ambient light that arrives.
    pub occlusion: Option<Occlusion>,
    /// Change of the shading normal.
    pub normal: Option<NormalMap>,
    /// How it lets light through.
    pub transparency: Option<Transparency>,
    /// A texture that multiplies its opacity, in red.
    pub opacity: Option<Texture>,
}

/// A texture of metalness, in blue, and of roughness, in green.
#[derive(Clone, Debug, PartialEq)]
pub struct Metal {
    /// The texture.
    pub texture: Texture,
    /// Factor on the metalness, 0 to 1.
    pub metallic: f32,
    /// Factor on the roughness, 0 to 1.
    pub roughness: f32,
}

/// A texture of the share of ambient light, in red.
#[derive(Clone, Debug, PartialEq)]
pub struct Occlusion {
    /// The texture.
    pub texture: Texture,
    /// Weight of the texture: 0 none, 1 full.
    pub strength: f32,
}

impl Default for Detail {
    /// A detail that changes nothing.
    fn default() -> Self {
        Self {
            emission: Vec3::ZERO,
            emission_texture: None,
            tint: Vec3::ONE,
            metal: None,
            occlusion: None,
            normal: None,
            transparency: None,
            opacity: None,
        }
    }
}

impl Detail {
    /// The textures of the detail.
    pub fn textures(&self) -> impl Iterator<Item = &Texture> {
        let metal = self.metal.as_ref().map(|metal| &metal.texture);
        let occlusion = self.occlusion.as_ref().map(|occlusion| &occlusion.texture);
        let normal = self.normal.as_ref().map(|normal| &normal.texture);
        let plain = [self.emission_texture.as_ref(), self.opacity.as_ref()];
        plain.into_iter().chain([metal, occlusion, normal]).flatten()
    }
}

/// The place of a look-up.
#[derive(Clone, Copy)]
pub(super) struct TexturePlace<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// Its primitive.
    pub primitive: u32,
    /// The primitives.
    pub geometry: &'a Geometry,
    /// The point.
    pub surface: &'a Surface<f32>,
    /// Returns the ray's differential, the ray and its hit.
    pub arriving: &'a dyn Fn() -> (Differential, Ray, Hit),
}

impl Appearance {
    /// The textures of a shape.
    pub fn textures<'a>(&'a self, shape: &'a Shape) -> impl Iterator<Item = &'a Texture> {
        let detail = shape.detail.and_then(|detail| self.details.get(detail as usize));
        shape.texture.iter().chain(detail.into_iter().flat_map(Detail::textures))
    }

    /// Applies the shape's detail to `point`; `traced` if rays find what is in the way of ambient
    /// light, which its texture then does not tell.
    #[inline(never)]
    fn add_detail(
        &self,
        (detail, traced): (&Detail, bool),
        place: TexturePlace<'_>,
        point: &mut ShadingPoint<f32>,
        look_ups: &mut LookUps,
    ) {
        let mut at = |texture: &Texture| self.texel(texture, place, look_ups);
        point.reflection.tint = detail.tint.into();
        let mut emission = detail.emission;
        if let Some(texture) = &detail.emission_texture {
            emission *= at(texture);
        }
        point.emission = emission.into();
        if let Some(metal) = &detail.metal {
            metal.apply(at(&metal.texture), point);
            // As for the material's own weight, which is replaced.
            let kt = detail.transparency.as_ref().map_or(0.0, |transparency| transparency.kt);
            point.reflection.kd *= 1.0 - kt;
        }
        if let Some(Occlusion { texture, strength }) = &detail.occlusion
            && !traced
        {
            point.occlusion = 1.0 + strength * (at(texture).x - 1.0);
        }
        if let Some(transparency) = &detail.transparency {
            point.opacity = transparency.opacity;
            if let Some(texture) = &detail.opacity {
                point.opacity *= at(texture).x;
            }
            // Light that is refracted is not scattered.
            point.occlusion *= (1.0 - transparency.kt).max(0.0);
        }
        if let Some(normal) = &detail.normal {
            normal.turn(at(&normal.texture), self, place, point);
        }
    }

    /// The colour of the texture at the place.
    #[inline(never)]
    fn texel(&self, texture: &Texture, place: TexturePlace<'_>, look_ups: &mut LookUps) -> Vec3 {
        let TexturePlace { shape, primitive, geometry, surface, arriving } = place;
        self.texture_at(texture, (shape, primitive), geometry, surface, arriving, look_ups)
    }
}

impl<F: Single> Group<F> {
    /// Applies the shapes' details to the points.
    #[inline(never)]
    pub(super) fn details(
        &self,
        point: &mut ShadingPoint<F>,
        surfaces: &Surface<F>,
        scene: &PreparedScene,
        arriving: &dyn Fn(usize) -> (Differential, Ray, Hit),
        look_ups: &mut LookUps,
    ) {
        let (appearance, geometry) = (&scene.appearance, scene.accel.geometry());
        let traced = scene.hemisphere.is_some_and(|hemisphere| hemisphere.traced);
        for lane in lanes(self.detailed & self.used) {
            let Face { primitive, shape, .. } = self.faces[lane];
            let shape = &appearance.shapes[shape as usize];
            let Some(detail) = shape.detail else { continue };
            let (surface, arriving) = (&surfaces.lane(lane), &|| arriving(lane));
            let place = TexturePlace { shape, primitive, geometry, surface, arriving };
            let mut one = point.lane(lane);
            let detail = (&appearance.details[detail as usize], traced);
            appearance.add_detail(detail, place, &mut one, look_ups);
            point.set_material(lane, &one);
        }
    }
}

impl Metal {
    /// Sets the reflection of `point`, which has its colour, from a texel.
    fn apply(&self, texel: Vec3, point: &mut ShadingPoint<f32>) {
        let [metallic, roughness] = [self.metallic * texel.z, self.roughness * texel.y]
            .map(|share| f64::from(share).clamp(0.0, 1.0));
        let color = Vec3::from(point.color).as_dvec3();
        let look = metal::look(color, metallic, roughness);
        let reflection = &mut point.reflection;
        reflection.ks = look.ks as f32;
        reflection.kd = look.kd as f32;
        reflection.exponent = look.exponent as f32;
        reflection.tint = look.tint.as_vec3().into();
        point.kr = look.kr as f32;
    }
}
