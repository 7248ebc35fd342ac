//! What the maps of a class change, at one hit or at eight.

use glam::Vec3;

use super::class::{Map, Property};
use super::look_up::{LookUp, turned_by};
use super::{Class, Group, PreparedScene, SampleCounts, Texture, UvMap, three};
use crate::kernels::metal::{self, MetalParameters};
use crate::kernels::texture::sphere_directions;
use crate::kernels::{Footprint, Reflection, ShadingPoint, SurfacePoint, surface};
use crate::math::vector::set;
use crate::math::{Line, Single, Vector, both};

/// Returns the footprint of the ray in a lane.
pub(super) type FootprintOf<'a> = &'a dyn Fn(usize) -> Footprint;

/// A group of hits at which maps are looked up.
pub(super) struct MappedHits<'a, F: Single> {
    /// Their data.
    pub(super) group: &'a Group<F>,
    /// Their points.
    pub(super) surfaces: &'a SurfacePoint<F>,
    /// Their rays.
    pub(super) line: &'a Line<F>,
    /// Their t.
    pub(super) t: F,
    pub(super) scene: &'a PreparedScene,
    /// Their footprints; `None` for rays without width, which see the finest level of every image.
    pub(super) footprint: Option<FootprintOf<'a>>,
}

impl<'a, F: Single> MappedHits<'a, F> {
    /// Applies the maps of the class, and vertex colours after that of the base colour.
    #[inline(always)]
    pub(super) fn apply(
        &'a self,
        class: &'a Class,
        point: &mut ShadingPoint<F>,
        counts: &'a mut SampleCounts,
    ) {
        let mut look_up = LookUp::at(self, counts);
        look_up.prefetch(class);
        point.color = self.color(class, &mut look_up);
        for Map { property, texture } in &class.maps {
            if *property == Property::Color {
                continue;
            }
            let one = self.t.same(1.0);
            let texel = match texture {
                Some(texture) => look_up.texel(texture),
                None => Vector::new(one, one, one),
            };
            match *property {
                Property::Color => {}
                Property::Emission => point.emission = point.emission * texel,
                Property::Metal { metallic, roughness } => {
                    metal([texel.z.times(metallic), texel.y.times(roughness)], point);
                    point.occlusion = point.occlusion * point.reflection.kd;
                    // As for the material's own weight, which is replaced.
                    point.reflection.kd = point.reflection.kd.times(1.0 - class.kt());
                }
                // Rays find what is in the way, if they are traced.
                Property::Occlusion { .. } if self.scene.hemisphere.is_some_and(|of| of.traced) => {
                }
                Property::Occlusion { strength } => {
                    let arrives = one + (texel.x - one).times(strength);
                    point.occlusion = point.occlusion * arrives;
                }
                Property::Opacity => point.opacity = point.opacity * texel.x,
                Property::Alpha => point.opacity = point.opacity * self.alpha(),
                Property::Normal { strength } => {
                    if let Some(texture) = texture {
                        self.turn(texture, texel, strength, point);
                    }
                }
                Property::Unlit => {
                    point.emission = point.emission + point.color;
                    point.color = Vector::splat(one.token(), Vec3::ZERO);
                }
            }
        }
    }

    /// The base colours.
    #[inline(always)]
    fn color(&'a self, class: &'a Class, look_up: &mut LookUp<'a, F>) -> Vector<F> {
        let color = match class.color() {
            Some(texture) => look_up.texel(texture),
            None => Vector::splat(self.t.token(), class.material.color),
        };
        self.group.with_vertex_colors(color, self.surfaces.barycentric)
    }

    /// The alphas of vertex colours.
    #[inline(always)]
    fn alpha(&self) -> F {
        let Vector { x: a, y: b, z: c } = Vector::<F>::load(self.t.token(), &self.group.alphas);
        let [y, z] = self.surfaces.barycentric;
        a * (y.same(1.0) - y - z) + b * y + c * z
    }

    /// What of the class changes the light that passes straight: opacities, and base colours.
    #[inline(always)]
    pub(super) fn opacity_and_tint(
        &'a self,
        class: &'a Class,
        counts: &'a mut SampleCounts,
    ) -> (F, Vector<F>) {
        let (mut look_up, mut opacity) = (LookUp::at(self, counts), self.t.same(class.opacity()));
        for map in &class.maps {
            match map {
                Map { property: Property::Opacity, texture: Some(texture) } => {
                    opacity = opacity * look_up.texel(texture).x;
                }
                Map { property: Property::Alpha, .. } => opacity = opacity * self.alpha(),
                _ => {}
            }
        }
        let is_tinted = class.transparency.is_some_and(|transparency| transparency.tinted);
        let white = Vector::splat(self.t.token(), Vec3::ONE);
        (opacity, if is_tinted { self.color(class, &mut look_up) } else { white })
    }

    /// Turns the shading normals of the points by texels, in the tangent frames there: red along u,
    /// green along v, blue along the normal. On meshes, tangents are interpolated from the corners and
    /// give the bitangent, as in programs that bake normal maps (Mikkelsen, *Simulation of Wrinkled
    /// Surfaces Revisited*, 2008). Normals are unchanged at a strength of 0, without tangents, as where
    /// texture coordinates span no area, or if the result would have no direction.
    #[inline(always)]
    fn turn(
        &self,
        texture: &Texture,
        texel: Vector<F>,
        strength: f32,
        point: &mut ShadingPoint<F>,
    ) {
        if strength == 0.0 {
            return;
        }
        let sided = point.shading_normal;
        // The texture belongs to the front, and so do the tangents.
        let front = self.group.front_normals(self.surfaces);
        let is_back = front.dot(sided).lt(texel.x.zero());
        let normal = Vector::select(is_back, -sided, sided);
        let [along_u, along_v] = self.tangents(&texture.coordinates.map, normal);
        let one = texel.x.same(1.0);
        let Vector { x, y, z } = texel.scale(texel.x.same(2.0)) - Vector::new(one, one, one);
        let turned = along_u.scale(x.times(strength)) + along_v.scale(y.times(strength));
        let turned = turned + normal.scale(z);
        let turned = turned.normalize();
        let is_turned = turned.is_not_zero() & along_u.is_not_zero();
        let turned = Vector::select(is_back, -turned, turned);
        point.shading_normal = Vector::select(is_turned, turned, sided);
    }

    /// The directions in which u and v grow, of about unit length; zero if they do not.
    #[inline(always)]
    fn tangents(&self, map: &UvMap, normal: Vector<F>) -> [Vector<F>; 2] {
        let token = self.t.token();
        match map {
            UvMap::Planar(map) => {
                let [u, v] = map.directions();
                [Vector::splat(token, u), Vector::splat(token, v)]
            }
            UvMap::Sphere(to_own) => {
                let own = turned_by(to_own, self.surfaces.normal).normalize();
                let [u, v] = sphere_directions(own);
                let to_world = to_own.transpose();
                [turned_by(&to_world, u), turned_by(&to_world, v)]
            }
            UvMap::Mesh => {
                let (mut rows, mut mirrored) = (<[[F::Row; 3]; 3]>::default(), 0);
                for lane in 0..F::LANES {
                    let face = self.group.faces[lane];
                    let shape = &self.scene.appearance.shapes[face.shape as usize];
                    let tangents = self.scene.tangents(shape, face.primitive);
                    let corners = tangents.unwrap_or_default();
                    // All corners of a triangle are on the same side, except in inconsistent files.
                    mirrored |= u32::from(corners[0].w < 0.0) << lane;
                    for (row, corner) in rows.iter_mut().zip(corners) {
                        set::<F>(row, lane, corner.truncate());
                    }
                }
                let corners = three(token, &rows);
                let tangent = surface::interpolated(&corners, self.surfaces.barycentric);
                let across = normal.cross(tangent);
                [tangent, Vector::select(F::mask(token, mirrored), -across, across)]
            }
        }
    }
}

/// Replaces the reflection of points, which have their colours, by that of metalness and roughness.
#[inline(always)]
fn metal<F: Single>(of: [F; 2], point: &mut ShadingPoint<F>) {
    let [metallic, roughness] = both(
        of,
        #[inline(always)]
        |share| share.max(share.zero()).min(share.same(1.0)),
    );
    let MetalParameters { ks, kd, exponent, kr, tint } =
        metal::look(point.color, metallic, roughness);
    point.reflection = Reflection { ks, kd, exponent, tint };
    point.kr = kr;
}
