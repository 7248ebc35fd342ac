//! Texture look-ups at one hit or at eight.
//!
//! What several textures of a hit share is computed once: coordinates and footprints for each map of
//! coordinates, the level of detail for each size of image.

use std::ops::Range;

use glam::{Mat3, Vec3};

use super::maps::{FootprintOf, MappedHits};
use super::{Class, Coordinates, SampleCounts, Texture, UvMap, three};
use crate::accel::prefetch;
use crate::kernels::differential::uv_change;
use crate::kernels::texture::{sphere_uv, sphere_uv_change};
use crate::kernels::{Filter, Image};
use crate::math::{Mask, Single, Vector, both};

/// The most textures of a class: one for each [`Property`](super::Property) that has any.
const TEXTURES: usize = 6;

/// Where a texture is looked up.
#[derive(Clone, Copy)]
struct Place<'a, F> {
    /// `None` if it cannot be decoded.
    image: Option<&'a Image>,
    /// The coordinates.
    uv: [F; 2],
    /// The level of detail of a trilinear texture; `None` if every hit sees the image itself.
    level: Option<F>,
}

/// Look-ups at hits, with what earlier ones found.
pub(super) struct LookUp<'a, F: Single> {
    hits: &'a MappedHits<'a, F>,
    counts: &'a mut SampleCounts,
    /// The changes of the points from one sample to the next.
    steps: Option<[Vector<F>; 2]>,
    coordinates: Option<(&'a Coordinates, [F; 2])>,
    footprint: Option<(&'a Coordinates, [[F; 2]; 2])>,
    /// For the last footprint, in images of a size and with this coarsest level.
    level: Option<([u32; 3], F)>,
    /// Where the textures of the class are looked up, and the numbers of those to come; none if they are
    /// not known ahead.
    places: [Place<'a, F>; TEXTURES],
    next: Range<usize>,
}

impl<'a, F: Single> LookUp<'a, F> {
    #[inline(always)]
    pub(super) fn at(hits: &'a MappedHits<'a, F>, counts: &'a mut SampleCounts) -> Self {
        Self {
            hits,
            counts,
            steps: None,
            coordinates: None,
            footprint: None,
            level: None,
            places: [Place { image: None, uv: [hits.t.zero(); 2], level: None }; TEXTURES],
            next: 0..0,
        }
    }

    /// Finds where the textures of the class are looked up, in their order, and prefetches the texels of
    /// all of them, so that their loads overlap.
    #[inline(always)]
    pub(super) fn prefetch(&mut self, class: &'a Class) {
        let textures = class.maps.iter().filter_map(|map| map.texture.as_ref());
        for (i, texture) in textures.enumerate() {
            let place @ Place { image, uv, level } = self.place(texture);
            (self.places[i], self.next.end) = (place, i + 1);
            if let Some(image) = image.filter(|image| image.is_large()) {
                image.addresses(uv, level, texture.wrap, prefetch);
            }
        }
    }

    #[inline(always)]
    fn place(&mut self, texture: &'a Texture) -> Place<'a, F> {
        let Texture { image, filter, coordinates, .. } = texture;
        let uv = self.coordinates(coordinates);
        let image = self.hits.scene.appearance.images[*image as usize].usable();
        let level = match (image, self.hits.footprint) {
            (Some(image), Some(footprint)) if *filter == Filter::Trilinear => {
                let level = self.level(image, coordinates, footprint);
                level.ne(level.zero()).any().then_some(level)
            }
            _ => None,
        };
        Place { image, uv, level }
    }

    /// The colours of a texture; black if its image cannot be decoded, which ends a render.
    #[inline(always)]
    pub(super) fn texel(&mut self, texture: &'a Texture) -> Vector<F> {
        let Place { image, uv, level } = match self.next.next() {
            Some(i) => self.places[i],
            None => self.place(texture),
        };
        let Some(image) = image else {
            return Vector::splat(uv[0].token(), Vec3::ZERO);
        };
        let (filter, used) = (texture.filter, self.hits.group.used);
        let read = |hits: u32| filter.texels() * u64::from((hits & used).count_ones());
        self.counts.texels += read(u32::MAX);
        let Some(level) = level else {
            return image.look_up(uv, filter, texture.wrap);
        };
        let (color, between) = image.look_up_at(uv, level, texture.wrap);
        self.counts.texels += read(between);
        color
    }

    #[inline(always)]
    fn coordinates(&mut self, of: &'a Coordinates) -> [F; 2] {
        if let Some((known, uv)) = self.coordinates
            && known == of
        {
            return uv;
        }
        let MappedHits { group, surfaces, .. } = self.hits;
        let own = match &of.map {
            UvMap::Planar(map) => map.uv(surfaces.point),
            UvMap::Sphere(to_own) => sphere_uv(turned_by(to_own, surfaces.normal).normalize()),
            UvMap::Mesh => {
                let [[au, av], [bu, bv], [cu, cv]] = group.uvs(self.hits.t.token());
                let [y, z] = surfaces.barycentric;
                let x = y.same(1.0) - y - z;
                [au * x + bu * y + cu * z, av * x + bv * y + cv * z]
            }
        };
        let uv = if let Some(placing) = &of.placing { placing.apply(own) } else { own };
        self.coordinates = Some((of, uv));
        uv
    }

    /// The changes of texture coordinates from one sample to the next. Not finite where those of the
    /// points are not.
    #[inline(always)]
    fn footprint(&mut self, of: &'a Coordinates, rays: FootprintOf<'_>) -> [[F; 2]; 2] {
        if let Some((known, footprint)) = self.footprint
            && known == of
        {
            return footprint;
        }
        let &MappedHits { group, surfaces, line, t, scene, .. } = self.hits;
        self.counts.footprints += u64::from(group.used.count_ones());
        let steps = match self.steps {
            Some(steps) => steps,
            None => {
                let differential = scene.incoming_differentials(line.direction, rays);
                differential.at(line.direction, t, surfaces.normal)
            }
        };
        self.steps = Some(steps);
        let [right, down] = steps;
        let own = match &of.map {
            UvMap::Planar(map) => [map.change(right), map.change(down)],
            UvMap::Sphere(to_own) => {
                let normal = turned_by(to_own, surfaces.normal).normalize();
                let [_, Vector { x: radius, .. }, _] = three(t.token(), &group.corners);
                both(
                    steps,
                    #[inline(always)]
                    |step| sphere_uv_change(normal, turned_by(to_own, step.over(radius))),
                )
            }
            UvMap::Mesh => {
                let uvs = group.uvs(t.token());
                let corners = group.corners_in_world(t.token(), scene.accel.geometry());
                both(
                    steps,
                    #[inline(always)]
                    |step| {
                        let [u, v] = uv_change(&corners, &uvs, step);
                        let is_known = F::mask(t.token(), group.has_uvs);
                        [F::select(is_known, u, t.zero()), F::select(is_known, v, t.zero())]
                    },
                )
            }
        };
        let [right, down] = own;
        let own = match &of.placing {
            None => own,
            Some(placing) => [placing.change(right), placing.change(down)],
        };
        (self.footprint, self.level) = (Some((of, own)), None);
        own
    }

    #[inline(always)]
    fn level(&mut self, image: &Image, of: &'a Coordinates, rays: FootprintOf<'_>) -> F {
        let footprint = self.footprint(of, rays);
        let size = [image.width, image.height, image.coarsest()];
        if let Some((known, level)) = self.level
            && known == size
        {
            return level;
        }
        let level = image.level(&footprint);
        self.level = Some((size, level));
        level
    }
}

/// Vectors turned by a rotation.
#[inline(always)]
pub(super) fn turned_by<F: Single>(by: &Mat3, v: Vector<F>) -> Vector<F> {
    let token = v.x.token();
    Vector::splat(token, by.x_axis).scale(v.x)
        + Vector::splat(token, by.y_axis).scale(v.y)
        + Vector::splat(token, by.z_axis).scale(v.z)
}
