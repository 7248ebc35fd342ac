//! From hits to shading points: one hit at a time, or eight of a kind.
//!
//! The data of hits is spread over memory. A [`Group`] fetches it; the same code then computes one
//! hit or eight.

use glam::Vec3;

use super::{Appearance, LookUps, PreparedScene, Shape};
use crate::accel::Hit;
use crate::geometry::{Geometry, Primitive, ShadingKind};
use crate::kernels::blinn_phong::{Material, Reflection};
use crate::kernels::differential::Differential;
use crate::kernels::precision::Arithmetic;
use crate::kernels::shade::ShadingPoint;
use crate::kernels::surface::{self, Surface};
use crate::math::ray::Ray;
use crate::math::real::Single;
use crate::math::simd::LANES;
use crate::math::vector::{Line, Vector};

/// The surface interaction of a traced ray.
#[derive(Clone, Copy, Debug)]
pub enum Interaction {
    /// Nothing.
    Nothing,
    /// The shape of a light, with its colour.
    Light(Vec3),
    /// A surface.
    Surface(ShadingPoint<f32>),
}

/// A hit on a surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct Face {
    /// The ray, by its number.
    pub ray: u32,
    /// The primitive, by its number.
    pub primitive: u32,
    /// Its shape's index in [`Appearance::shapes`].
    pub shape: u32,
}

/// A row for each axis.
type AxisRows<F> = [<F as Single>::Row; 3];

/// The data of hits of one kind, up to as many as there are lanes.
#[derive(Clone, Copy, Debug)]
pub struct Group<F: Single> {
    /// The hits, one in each lane; unused lanes repeat the last one.
    pub faces: [Face; LANES],
    /// Hits in use, a bit each, like the following.
    pub used: u32,
    /// Hits on shapes that are lit from both sides.
    two_sided: u32,
    /// Hits on shapes with a texture.
    textured: u32,
    /// Hits on shapes with a detail.
    pub(super) detailed: u32,
    /// Hits on triangles with normals.
    smooth: u32,
    /// Hits on triangles with vertex colours.
    colored: u32,
    /// Hits on quads.
    quads: u32,
    /// Corners of the triangles, in the prototype's space for instances; or centres of spheres,
    /// with their radii in each row of the second.
    corners: [AxisRows<F>; 3],
    /// Origins and directions of rays at instances, in the space of the prototype.
    carried: [AxisRows<F>; 2],
    /// Normals at the corners, if any.
    normals: [AxisRows<F>; 3],
    /// Colours at the corners, if any.
    tints: [AxisRows<F>; 3],
    /// -1 if the winding is clockwise on the front, else 1.
    side: F::Row,
    /// Diffuse colours of materials.
    color: AxisRows<F>,
    /// Weights of the highlight and of the diffuse part, and the highlight's exponent.
    reflection: AxisRows<F>,
    /// Weight of the mirror ray.
    kr: F::Row,
}

impl<F: Single> Default for Group<F> {
    fn default() -> Self {
        Self {
            faces: [Face::default(); LANES],
            used: 0,
            two_sided: 0,
            textured: 0,
            detailed: 0,
            smooth: 0,
            colored: 0,
            quads: 0,
            corners: Default::default(),
            carried: Default::default(),
            normals: Default::default(),
            tints: Default::default(),
            side: F::Row::default(),
            color: Default::default(),
            reflection: Default::default(),
            kr: F::Row::default(),
        }
    }
}

impl<F: Single> Group<F> {
    /// Starts a group of at least one of `faces`, up to as many as there are lanes: fetches
    /// everything except corners and normals.
    #[inline(always)]
    pub fn begin(&mut self, faces: &[Face], appearance: &Appearance) {
        let last = faces[faces.len() - 1];
        self.used = ((1_u64 << faces.len()) - 1) as u32;
        (self.two_sided, self.textured, self.detailed) = (0, 0, 0);
        (self.smooth, self.colored, self.quads) = (0, 0, 0);
        for lane in 0..F::LANES {
            // Unused lanes compute harmless values.
            let face = faces.get(lane).copied().unwrap_or(last);
            self.faces[lane] = face;
            let shape = &appearance.shapes[face.shape as usize];
            self.two_sided |= u32::from(shape.two_sided) << lane;
            self.textured |= u32::from(shape.texture.is_some()) << lane;
            self.detailed |= u32::from(shape.detail.is_some()) << lane;
            self.side.as_mut()[lane] = if shape.flipped { -1.0 } else { 1.0 };
            let material = &appearance.materials[face.shape as usize];
            let Material { ks, kd, exponent, color, kr } = *material;
            set::<F>(&mut self.color, lane, color);
            set::<F>(&mut self.reflection, lane, Vec3::new(ks, kd, exponent));
            self.kr.as_mut()[lane] = kr;
        }
    }

    /// Fetches the corners and corner values of one hit of `ray`.
    #[inline(always)]
    pub fn fetch(
        &mut self,
        lane: usize,
        geometry: &Geometry,
        appearance: &Appearance,
        ray: impl Fn() -> Ray,
    ) {
        let Face { primitive, shape, .. } = self.faces[lane];
        let shape = &appearance.shapes[shape as usize];
        if shape.smooth {
            self.fetch_normals(lane, shape, primitive, geometry, appearance);
        }
        if shape.colored
            && let Some(colors) = appearance.colors(shape, geometry, primitive)
        {
            self.colored |= 1 << lane;
            set_three::<F>(&mut self.tints, lane, colors);
        }
        self.fetch_corners(lane, geometry, ray);
    }

    /// Fetches the corners of one hit of `ray`.
    #[inline(always)]
    fn fetch_corners(&mut self, lane: usize, geometry: &Geometry, ray: impl Fn() -> Ray) {
        let Face { primitive, .. } = self.faces[lane];
        // Separate arms: a shared array of corners would go through memory in pieces.
        match geometry.primitive(primitive) {
            Primitive::Triangle(i) => {
                set_three::<F>(&mut self.corners, lane, geometry.triangle(i));
            }
            Primitive::Quad(i) => {
                self.quads |= 1 << lane;
                let half = surface::quad_half(&ray(), &geometry.quad(i));
                set_three::<F>(&mut self.corners, lane, half);
            }
            Primitive::Instanced(instanced) => {
                let (instance, prototype) = geometry.instance(instanced);
                let carried = instance.carried(&ray());
                set::<F>(&mut self.carried[0], lane, carried.origin);
                set::<F>(&mut self.carried[1], lane, carried.direction);
                let corners = prototype.triangle(instanced.triangle as usize);
                set_three::<F>(&mut self.corners, lane, corners);
            }
            Primitive::Quadric(i) => {
                set_three::<F>(&mut self.corners, lane, geometry.quadrics[i].columns());
            }
        }
    }

    #[inline(always)]
    fn fetch_normals(
        &mut self,
        lane: usize,
        shape: &Shape,
        primitive: u32,
        geometry: &Geometry,
        appearance: &Appearance,
    ) {
        let Some(normals) = appearance.normals(shape, geometry, primitive) else { return };
        self.smooth |= 1 << lane;
        set_three::<F>(&mut self.normals, lane, normals);
    }

    /// The number of hits in use with vertex colours.
    #[inline(always)]
    pub fn colored(&self) -> u64 {
        (self.colored & self.used).count_ones().into()
    }

    /// Diffuse colours of materials.
    #[inline(always)]
    pub fn colors(&self, token: F::Token) -> Vector<F> {
        Vector::load(token, &self.color)
    }

    /// The points at `t` of `line` on the primitives that were hit.
    #[inline(always)]
    pub fn surfaces<P: Arithmetic>(
        &self,
        kind: ShadingKind,
        line: &Line<F>,
        t: F,
        geometry: &Geometry,
    ) -> Surface<F> {
        let token = t.token();
        let corners = three(token, &self.corners);
        match kind {
            ShadingKind::Flat => {
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
    fn in_world(&self, mut found: Surface<F>, geometry: &Geometry) -> Surface<F> {
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
    /// `arriving` returns the differential of a lane's ray, the ray and its hit; it is called only
    /// if a texture needs them.
    #[inline(always)]
    pub fn shading_points<P: Arithmetic>(
        &self,
        kind: ShadingKind,
        line: &Line<F>,
        t: F,
        scene: &PreparedScene,
        arriving: impl Fn(usize) -> (Differential, Ray, Hit),
        look_ups: &mut LookUps,
    ) -> ShadingPoint<F> {
        let token = t.token();
        let (appearance, geometry) = (&scene.appearance, scene.accel.geometry());
        let surfaces = self.surfaces::<P>(kind, line, t, geometry);
        let outward = surfaces.normal.scale(F::load(token, &self.side));
        let at_back = outward.dot(line.direction).gt(t.zero());
        let normal = Vector::select(at_back, -outward, outward);
        let mut shading_normal = normal;
        if self.smooth != 0 {
            let corners = three(token, &self.normals);
            let smooth = F::mask(token, self.smooth);
            shading_normal =
                surface::interpolated_normal(&corners, surfaces.barycentric, normal, smooth);
        }
        let mut color = self.colors(token);
        for lane in lanes(self.textured & self.used) {
            let Face { primitive, shape, .. } = self.faces[lane];
            let shape = &appearance.shapes[shape as usize];
            let Some(texture) = &shape.texture else { continue };
            let (surface, arriving) = (surfaces.lane(lane), || arriving(lane));
            let face = (shape, primitive);
            let found =
                appearance.texture_at(texture, face, geometry, &surface, arriving, look_ups);
            color.set_lane(lane, found);
        }
        if self.colored != 0 {
            let tint = surface::interpolated(&three(token, &self.tints), surfaces.barycentric);
            color = Vector::select(F::mask(token, self.colored), color * tint, color);
        }
        let Vector { x: ks, y: kd, z: exponent } = Vector::load(token, &self.reflection);
        let mut point = ShadingPoint {
            point: surfaces.point,
            error: surfaces.error,
            normal,
            shading_normal,
            view: -line.direction,
            color,
            occlusion: F::splat(token, 1.0),
            emission: Vector::splat(token, Vec3::ZERO),
            reflection: Reflection { ks, kd, exponent, tint: Vector::splat(token, Vec3::ONE) },
            kr: F::load(token, &self.kr),
            opacity: F::splat(token, 1.0),
            lit: F::mask(token, self.used) & (F::mask(token, self.two_sided) | !at_back),
            inside: at_back,
        };
        if self.detailed & self.used != 0 {
            // Copies, so that the point stays in registers if there are no details.
            let (mut detailed, surfaces) = (point, surfaces);
            self.details(&mut detailed, &surfaces, scene, &arriving, look_ups);
            point = detailed;
        }
        point
    }
}

/// The vectors of three rows. Written out, like other arrays of vectors here: `map` is not inlined,
/// and vectors stored in pieces stall when they are reloaded.
#[inline(always)]
fn three<F: Single>(token: F::Token, [a, b, c]: &[AxisRows<F>; 3]) -> [Vector<F>; 3] {
    [Vector::load(token, a), Vector::load(token, b), Vector::load(token, c)]
}

#[inline(always)]
fn set<F: Single>([x, y, z]: &mut AxisRows<F>, lane: usize, v: Vec3) {
    (x.as_mut()[lane], y.as_mut()[lane], z.as_mut()[lane]) = (v.x, v.y, v.z);
}

#[inline(always)]
fn set_three<F: Single>(rows: &mut [AxisRows<F>; 3], lane: usize, [a, b, c]: [Vec3; 3]) {
    let [in_a, in_b, in_c] = rows;
    set::<F>(in_a, lane, a);
    set::<F>(in_b, lane, b);
    set::<F>(in_c, lane, c);
}

/// The lanes whose bits are set, in order.
#[inline(always)]
pub fn lanes(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}

/// The point of the surface that `ray` hits, as it is shaded.
pub fn surface<P: Arithmetic>(geometry: &Geometry, ray: &Ray, hit: &Hit) -> Surface<f32> {
    let mut group = Group::default();
    group.faces[0].primitive = hit.primitive;
    group.fetch_corners(0, geometry, || *ray);
    group.surfaces::<P>(geometry.kind(hit.primitive), &Line::from(ray), hit.t, geometry)
}

impl PreparedScene {
    /// The surface interaction of `ray`, of unit direction, with `hit`. Its `differential` is
    /// called only if a texture needs it.
    // Not inlined, nor once for each caller's closure: a call for each hit costs nothing, a copy
    // some 10 KB.
    #[inline(never)]
    pub fn interaction<P: Arithmetic>(
        &self,
        ray: &Ray,
        hit: &Hit,
        differential: &dyn Fn() -> Differential,
        look_ups: &mut LookUps,
    ) -> Interaction {
        if hit.is_miss() {
            return Interaction::Nothing;
        }
        let index = self.appearance.shape_of(hit.primitive);
        if let Some(color) = self.appearance.shapes[index].light {
            return Interaction::Light(color);
        }
        let arriving = |_| (differential(), *ray, *hit);
        let (kind, line) = (self.accel.geometry().kind(hit.primitive), Line::from(ray));
        let group = self.group(ray, hit, index);
        let point = group.shading_points::<P>(kind, &line, hit.t, self, arriving, look_ups);
        look_ups.colors += group.colored();
        Interaction::Surface(point)
    }

    /// The group of one hit, on the shape at `index`.
    #[inline(always)]
    fn group(&self, ray: &Ray, hit: &Hit, index: usize) -> Group<f32> {
        let face = Face { ray: 0, primitive: hit.primitive, shape: index as u32 };
        let mut group = Group::default();
        group.begin(&[face], &self.appearance);
        group.fetch(0, self.accel.geometry(), &self.appearance, || *ray);
        group
    }
}
