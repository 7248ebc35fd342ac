//! Hits on surfaces of one kind, made ready to be shaded eight at a time.
//!
//! What a hit needs lies far apart in memory. It is fetched for a block of hits, loop by loop, so
//! that many look-ups are on their way at a time, and only then computed with.

use glam::{Vec2, Vec3};

use crate::accel::geometry::{Geometry, Primitive};
use crate::kernels::blinn_phong::Material;
use crate::kernels::surface::lanes::Surfaces;
use crate::kernels::surface::{self, Surface};
use crate::math::lanes::Vec3x8;
use crate::math::ray::Ray;
use crate::math::simd::{LANES, Lanes};
use crate::prepared::{Appearance, Shape};

/// Groups in a block.
pub(super) const GROUPS: usize = 8;

/// Hits in a block.
pub(super) const BLOCK: usize = GROUPS * LANES;

/// A hit on a surface.
#[derive(Clone, Copy, Default)]
pub(super) struct Face {
    /// The ray, by its number.
    pub(super) ray: u32,
    pub(super) primitive: u32,
    /// By its place in [`Appearance::shapes`].
    pub(super) shape: u32,
}

/// A row for each axis.
pub(super) type Rows = [[f32; LANES]; 3];

/// What is known about up to eight hits.
#[derive(Clone, Copy, Default)]
pub(super) struct Group {
    pub(super) faces: [Face; LANES],
    /// Rays, by number.
    pub(super) rays: [u32; LANES],
    /// Hits in use, a bit each, as are the following.
    pub(super) used: u32,
    /// Hits on shapes whose back lights reach.
    pub(super) two_sided: u32,
    /// Hits on shapes with a texture.
    pub(super) textured: u32,
    /// Hits on triangles that have normals.
    pub(super) smooth: u32,
    /// Hits on quads.
    pub(super) quads: u32,
    /// Corners of the triangles, those of instances in the space of their prototype; or centres, and radii in
    /// each row of the second.
    pub(super) corners: [Rows; 3],
    /// Origins and directions of rays to instances, in the space of the prototype.
    pub(super) carried: [Rows; 2],
    /// Normals at the corners, where there are any.
    pub(super) normals: [Rows; 3],
    /// -1 where the front is where the winding runs clockwise, else 1.
    pub(super) side: [f32; LANES],
    pub(super) color: Rows,
    /// Weights of the highlight and of the diffuse part, and the highlight's exponent.
    pub(super) reflection: Rows,
    /// Weight of the mirror ray.
    pub(super) kr: [f32; LANES],
}

impl Group {
    /// Fetches all but corners and normals.
    #[inline(always)]
    fn begin(&mut self, faces: &[Face], appearance: &Appearance) {
        let last = faces[faces.len() - 1];
        self.used = ((1_u64 << faces.len()) - 1) as u32;
        (self.two_sided, self.textured, self.smooth, self.quads) = (0, 0, 0, 0);
        for lane in 0..LANES {
            // Lanes out of use repeat the last hit: they compute nothing out of the way.
            let face = faces.get(lane).copied().unwrap_or(last);
            self.faces[lane] = face;
            self.rays[lane] = face.ray;
            let shape = &appearance.shapes[face.shape as usize];
            self.two_sided |= u32::from(shape.two_sided) << lane;
            self.side[lane] = if shape.flipped { -1.0 } else { 1.0 };
            self.textured |= u32::from(shape.texture.is_some()) << lane;
            self.set_material(lane, &appearance.materials[face.shape as usize]);
        }
    }

    #[inline(always)]
    fn set_material(&mut self, lane: usize, material: &Material) {
        let Material { ks, kd, exponent, color, kr } = *material;
        set(&mut self.color, lane, color);
        set(&mut self.reflection, lane, Vec3::new(ks, kd, exponent));
        self.kr[lane] = kr;
    }

    /// Fetches the corners and normals of one hit.
    #[inline(always)]
    fn fetch(
        &mut self,
        lane: usize,
        geometry: &Geometry,
        appearance: &Appearance,
        ray: impl Fn(usize) -> Ray,
    ) {
        let Face { ray: number, primitive, shape } = self.faces[lane];
        if appearance.shapes[shape as usize].smooth {
            let shape = &appearance.shapes[shape as usize];
            self.fetch_normals(lane, shape, primitive, geometry, appearance);
        }
        let corners = match geometry.primitive(primitive) {
            Primitive::Quad(i) => {
                self.quads |= 1 << lane;
                surface::quad_half(&ray(number as usize), &geometry.quad(i))
            }
            Primitive::Triangle(i) => geometry.triangle(i),
            Primitive::Instanced(instanced) => {
                let (instance, prototype) = geometry.instance(instanced);
                let carried = instance.carried(&ray(number as usize));
                set(&mut self.carried[0], lane, carried.origin);
                set(&mut self.carried[1], lane, carried.direction);
                prototype.triangle(instanced.triangle as usize)
            }
            Primitive::Sphere(i) => {
                let (center, radius) = geometry.spheres[i];
                [center, Vec3::splat(radius), Vec3::ZERO]
            }
        };
        for (rows, corner) in self.corners.iter_mut().zip(corners) {
            set(rows, lane, corner);
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
        for (rows, normal) in self.normals.iter_mut().zip(normals) {
            set(rows, lane, normal);
        }
    }

    /// Points of instances, from the space of the prototype to the world's.
    #[inline(always)]
    pub(super) fn in_world<S: Lanes>(
        &self,
        simd: S,
        found: &Surfaces<S>,
        geometry: &Geometry,
    ) -> Surfaces<S> {
        let mut rows = [Rows::default(); 3];
        for lane in 0..LANES {
            let Primitive::Instanced(instanced) = geometry.primitive(self.faces[lane].primitive)
            else {
                continue;
            };
            let of_prototype = Surface {
                point: found.point.lane(lane),
                error: found.error.lane(lane),
                normal: found.normal.lane(lane),
                barycentric: Vec2::ZERO,
            };
            let world = geometry.instance(instanced).0.surface(&of_prototype);
            for (rows, v) in rows.iter_mut().zip([world.point, world.error, world.normal]) {
                set(rows, lane, v);
            }
        }
        let [point, error, normal] = &rows;
        Surfaces {
            point: Vec3x8::load(simd, point),
            error: Vec3x8::load(simd, error),
            normal: Vec3x8::load(simd, normal),
            barycentric: found.barycentric,
        }
    }

    /// The point of one hit, as textures want it.
    #[inline(always)]
    pub(super) fn surface(
        &self,
        lane: usize,
        point: Vec3,
        error: Vec3,
        normal: Vec3,
        barycentric: Vec2,
    ) -> Surface {
        let quad = self.quads >> lane & 1 == 1;
        let barycentric = if quad { Vec2::ZERO } else { barycentric };
        Surface { point, error, normal, barycentric }
    }
}

#[inline(always)]
fn set([x, y, z]: &mut Rows, lane: usize, v: Vec3) {
    (x[lane], y[lane], z[lane]) = (v.x, v.y, v.z);
}

/// Hits that wait until a block is full.
pub(super) struct Faces {
    waiting: [Face; BLOCK],
    count: usize,
    groups: [Group; GROUPS],
}

impl Faces {
    pub(super) fn new() -> Self {
        Self { waiting: [Face::default(); BLOCK], count: 0, groups: [Group::default(); GROUPS] }
    }

    /// Adds a hit. Whether the block is full.
    #[inline(always)]
    pub(super) fn push(&mut self, face: Face) -> bool {
        self.waiting[self.count & (BLOCK - 1)] = face;
        self.count += 1;
        self.count >= BLOCK
    }

    /// Fetches what the hits need, corners where they are asked for, and empties the block.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        with_corners: bool,
        geometry: &Geometry,
        appearance: &Appearance,
        ray: impl Fn(usize) -> Ray + Copy,
    ) -> &[Group] {
        let count = self.count.div_ceil(LANES).min(GROUPS);
        let waiting = &self.waiting[..self.count.min(BLOCK)];
        for (group, faces) in self.groups.iter_mut().zip(waiting.chunks(LANES)) {
            group.begin(faces, appearance);
        }
        let asked = if with_corners { count } else { 0 };
        for group in &mut self.groups[..asked] {
            for lane in 0..LANES {
                group.fetch(lane, geometry, appearance, ray);
            }
        }
        self.count = 0;
        &self.groups[..count]
    }
}
