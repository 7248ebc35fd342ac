//! From hits to shading points: one hit at a time, or eight of a kind.
//!
//! A [`Group`] has the data; the same code computes one hit or eight.

use glam::Vec3;

use super::{Class, Face, Group, GroupHits, MappedHits, PreparedScene, SampleCounts, three};
use crate::accel::Hit;
use crate::geometry::{Geometry, Primitive, ShadingKind};
use crate::kernels::{Arithmetic, Footprint, Reflection, ShadingPoint, SurfacePoint, surface};
use crate::math::{Line, Ray, Single, Vector};

/// The surface interaction of a traced ray.
#[derive(Clone, Copy, Debug)]
pub enum Interaction<'a> {
    /// Nothing.
    Nothing,
    /// The shape of a light, with its colour.
    Light(Vec3),
    /// A surface, with its class.
    Surface(ShadingPoint<f32>, &'a Class),
}

impl<F: Single> Group<F> {
    /// The points at `t` of `line` on the primitives that were hit.
    #[inline(always)]
    pub(super) fn surfaces<P: Arithmetic>(
        &self,
        (kind, line, t): GroupHits<'_, F>,
        geometry: &Geometry,
    ) -> SurfacePoint<F> {
        let token = t.token();
        let mut corners = three(token, &self.corners);
        match kind {
            ShadingKind::Flat => {
                if self.quads != 0 {
                    let [a, b, c] = corners;
                    let all = [a, b, c, Vector::load(token, &self.fourth)];
                    let [_, next, last] = surface::quad_halves(line, t, &all, self.quads);
                    let quads = F::mask(token, self.quads);
                    corners = [a, Vector::select(quads, next, b), Vector::select(quads, last, c)];
                }
                let mut found = surface::triangle_at::<F, P>(line, t, &corners);
                if self.quads != 0 {
                    let quads = F::mask(token, self.quads);
                    let [y, z] = found.barycentric;
                    found.barycentric =
                        [F::select(quads, t.zero(), y), F::select(quads, t.zero(), z)];
                }
                found
            }
            ShadingKind::Quadrics => surface::quadric_at::<F, P>(line, t, &corners),
            ShadingKind::Instances => {
                let [origin, direction] = &self.carried;
                let origin = Vector::load(token, origin);
                let carried = Line { origin, direction: Vector::load(token, direction) };
                self.in_world(surface::triangle_at::<F, P>(&carried, t, &corners), geometry)
            }
        }
    }

    /// Points of instances, transformed from the prototype's space to the world.
    #[inline(always)]
    fn in_world(&self, mut found: SurfacePoint<F>, geometry: &Geometry) -> SurfacePoint<F> {
        for lane in 0..F::LANES {
            let primitive = geometry.primitive(self.faces[lane].primitive);
            let Primitive::Instanced(instanced) = primitive else { continue };
            let world = geometry.instance(instanced).0.surface(&found.lane(lane));
            found.point.set_lane(lane, world.point.into());
            found.error.set_lane(lane, world.error.into());
            found.normal.set_lane(lane, world.normal.into());
        }
        found
    }

    /// The shading points at `t` of `line`, of unit direction, on the primitives that were hit.
    /// The `footprint` of a lane's ray is asked for only if a map needs it.
    #[inline(always)]
    pub fn shading_points<P: Arithmetic>(
        &self,
        hits: GroupHits<'_, F>,
        scene: &PreparedScene,
        footprint: &dyn Fn(usize) -> Footprint,
        look_ups: &mut SampleCounts,
    ) -> ShadingPoint<F> {
        let (_, line, t) = hits;
        let token = t.token();
        let surfaces = self.surfaces::<P>(hits, scene.accel.geometry());
        let (normal, at_back) = self.sided_normals(line, &surfaces);
        let mut shading_normal = normal;
        if self.smooth != 0 {
            let corners = three(token, &self.normals);
            let smooth = F::mask(token, self.smooth);
            shading_normal =
                surface::interpolated_normal(&corners, surfaces.barycentric, normal, smooth);
        }
        let Vector { x: ks, y: kd, z: exponent } = Vector::load(token, &self.reflection);
        let mut point = ShadingPoint {
            point: surfaces.point,
            error: surfaces.error,
            normal,
            shading_normal,
            view: -line.direction,
            color: self.colors(token),
            occlusion: F::splat(token, 1.0),
            emission: Vector::splat(token, Vec3::ZERO),
            reflection: Reflection { ks, kd, exponent, tint: Vector::splat(token, Vec3::ONE) },
            kr: F::load(token, &self.kr),
            opacity: F::splat(token, 1.0),
            lit: F::mask(token, self.used) & (F::mask(token, self.two_sided) | !at_back),
            inside: at_back,
        };
        if self.special != 0 {
            point.reflection.tint = Vector::load(token, &self.tint);
            point.emission = Vector::load(token, &self.emission);
            point.occlusion = F::load(token, &self.ambient);
        }
        let class = self.class(&scene.appearance);
        if class.is_plain() {
            point.color = self.with_vertex_colors(point.color, surfaces.barycentric);
            return point;
        }
        point.occlusion = point.occlusion.times((1.0 - class.kt()).max(0.0));
        point.opacity = F::splat(token, class.opacity());
        // Copies, so that the point stays in registers if there are no maps.
        let (mut mapped, surfaces) = (point, surfaces);
        let footprint = Some(footprint);
        let mapped_hits =
            MappedHits { group: self, surfaces: &surfaces, line, t, scene, footprint };
        F::outlined(
            token,
            #[inline(always)]
            || mapped_hits.apply(class, &mut mapped, look_ups),
        );
        mapped
    }

    /// The normals on the side of the rays' origins, and the lanes in which that is the back.
    #[inline(always)]
    pub(super) fn sided_normals(
        &self,
        line: &Line<F>,
        surfaces: &SurfacePoint<F>,
    ) -> (Vector<F>, F::Mask) {
        let zero = surfaces.normal.x.zero();
        let outward = surfaces.normal.scale(F::load(zero.token(), &self.side));
        let at_back = outward.dot(line.direction).gt(zero);
        (Vector::select(at_back, -outward, outward), at_back)
    }
}

/// The point of the surface that `ray` hits, as it is shaded.
pub fn surface<P: Arithmetic>(geometry: &Geometry, ray: &Ray, hit: &Hit) -> SurfacePoint<f32> {
    let mut group = Group::default();
    group.faces[0].primitive = hit.primitive;
    group.fetch_corners(0, geometry, || *ray);
    group.surfaces::<P>((geometry.kind(hit.primitive), &Line::from(ray), hit.t), geometry)
}

impl PreparedScene {
    /// The surface interaction of `ray`, of unit direction and with this `footprint`, with `hit`.
    // Not inlined: a call for each hit costs nothing, a copy some 10 KB.
    #[inline(never)]
    pub fn interaction<P: Arithmetic>(
        &self,
        ray: &Ray,
        hit: &Hit,
        footprint: Footprint,
        look_ups: &mut SampleCounts,
    ) -> Interaction<'_> {
        if hit.is_miss() {
            return Interaction::Nothing;
        }
        let index = self.appearance.shape_of(hit.primitive);
        let shape = &self.appearance.shapes[index];
        if let Some(color) = shape.light {
            return Interaction::Light(color);
        }
        let (kind, line) = (self.accel.geometry().kind(hit.primitive), Line::from(ray));
        let group = self.group_on(ray, hit, index);
        let hits = (kind, &line, hit.t);
        let point = group.shading_points::<P>(hits, self, &|_| footprint, look_ups);
        let class = self.appearance.class(shape);
        group.count(class, look_ups);
        Interaction::Surface(point, class)
    }

    /// The point at which `ray` meets a surface, and whether it comes from behind.
    pub(super) fn surface_of<P: Arithmetic>(
        &self,
        ray: &Ray,
        hit: &Hit,
    ) -> (SurfacePoint<f32>, bool) {
        let (geometry, line) = (self.accel.geometry(), Line::from(ray));
        let group = self.group(ray, hit);
        let hits = (geometry.kind(hit.primitive), &line, hit.t);
        let found = group.surfaces::<P>(hits, geometry);
        let (_, leaves) = group.sided_normals(&line, &found);
        (found, leaves)
    }

    pub(super) fn group(&self, ray: &Ray, hit: &Hit) -> Group<f32> {
        self.group_on(ray, hit, self.appearance.shape_of(hit.primitive))
    }

    /// The group of one hit, on the shape at `index`.
    #[inline(always)]
    fn group_on(&self, ray: &Ray, hit: &Hit, index: usize) -> Group<f32> {
        let face = Face { ray: 0, primitive: hit.primitive, shape: index as u32 };
        let mut group = Group::default();
        group.begin(&[face], &self.appearance);
        group.fetch(0, self, || *ray);
        group
    }
}
