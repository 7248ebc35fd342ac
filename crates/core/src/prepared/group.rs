//! The data of hits, fetched for one hit or for eight of a kind: it is spread over memory.

use bytemuck::Zeroable;
use glam::Vec3;

use super::{Appearance, Class, PreparedScene, SampleCounts};
use crate::accel::prefetch;
use crate::geometry::{Geometry, Primitive, ShadingKind};
use crate::kernels::{Material, SurfacePoint, surface};
use crate::math::vector::set;
use crate::math::{LANES, Line, Ray, Single, Vector};

/// A hit on a surface.
#[derive(Clone, Copy, Debug, Default, Zeroable)]
pub struct Face {
    /// The ray, by its number.
    pub ray: u32,
    /// The primitive, by its number.
    pub primitive: u32,
    /// Its shape's index in [`Appearance::shapes`].
    pub shape: u32,
}

/// Where rays of a group meet surfaces of this kind: at this t.
pub(super) type GroupHits<'a, F> = (ShadingKind, &'a Line<F>, F);

/// A row for each axis.
type AxisRows<F> = [<F as Single>::Row; 3];

/// The data of hits of one kind, up to as many as there are lanes. If the first has a class that is
/// not plain, the others have the same.
#[derive(Clone, Copy, Debug, Zeroable)]
#[zeroable(bound = "")]
pub struct Group<F: Single> {
    /// The hits, one in each lane; unused lanes repeat the last one.
    pub faces: [Face; LANES],
    /// Hits in use, a bit each, like the following.
    pub used: u32,
    /// Hits on shapes that are lit from both sides.
    pub(super) two_sided: u32,
    /// Hits on shapes with a class that is special.
    pub(super) special: u32,
    /// Hits on triangles with normals.
    pub(super) smooth: u32,
    /// Hits on triangles with vertex colours.
    pub(super) colored: u32,
    /// Hits on triangles with texture coordinates.
    pub(super) has_uvs: u32,
    /// Hits on quads.
    pub(super) quads: u32,
    /// Corners of the triangles, in the prototype's space for instances; or centres of spheres and
    /// disks, their radii along each axis, and their fronts: zero for spheres.
    pub(super) corners: [AxisRows<F>; 3],
    /// The fourth corners of quads; which half was hit is found for all lanes at once.
    pub(super) fourth: AxisRows<F>,
    /// Origins and directions of rays at instances, in the space of the prototype.
    pub(super) carried: [AxisRows<F>; 2],
    /// Normals at the corners, if any.
    pub(super) normals: [AxisRows<F>; 3],
    /// Colours at the corners, if any.
    pub(super) tints: [AxisRows<F>; 3],
    /// Opacities at the corners, if the class uses them.
    pub(super) alphas: AxisRows<F>,
    /// Texture coordinates at the corners, if maps use them.
    pub(super) uvs: [[F::Row; 2]; 3],
    /// -1 if the winding is clockwise on the front, else 1.
    pub(super) side: F::Row,
    /// Base colours.
    pub(super) color: AxisRows<F>,
    /// Weights of the highlight and of the diffuse part, and the highlight's exponent.
    pub(super) reflection: AxisRows<F>,
    /// Weight of the mirror ray.
    pub(super) kr: F::Row,
    /// Colours of highlights, and emission, if any of the hits is special.
    pub(super) tint: AxisRows<F>,
    pub(super) emission: AxisRows<F>,
    /// Shares of ambient light that are scattered, if any of the hits is special.
    pub(super) ambient: F::Row,
}

impl<F: Single> Default for Group<F> {
    fn default() -> Self {
        Self::zeroed()
    }
}

impl<F: Single> Group<F> {
    /// Starts a group of at least one of `faces`, up to as many as there are lanes: fetches
    /// everything except corners and normals.
    #[inline(always)]
    pub fn begin(&mut self, faces: &[Face], appearance: &Appearance) {
        let last = faces[faces.len() - 1];
        self.used = ((1_u64 << faces.len()) - 1) as u32;
        (self.two_sided, self.special, self.smooth) = (0, 0, 0);
        (self.colored, self.has_uvs, self.quads) = (0, 0, 0);
        for lane in 0..F::LANES {
            // Unused lanes compute harmless values.
            let face = faces.get(lane).copied().unwrap_or(last);
            self.faces[lane] = face;
            let shape = &appearance.shapes[face.shape as usize];
            let Class { material, is_special, .. } = appearance.class(shape);
            self.two_sided |= u32::from(shape.two_sided) << lane;
            self.special |= u32::from(*is_special) << lane;
            self.side.as_mut()[lane] = if shape.flipped { -1.0 } else { 1.0 };
            let Material { ks, kd, exponent, color, kr, .. } = *material;
            set::<F>(&mut self.color, lane, color);
            set::<F>(&mut self.reflection, lane, Vec3::new(ks, kd, exponent));
            self.kr.as_mut()[lane] = kr;
        }
        for lane in 0..if self.special != 0 { F::LANES } else { 0 } {
            let shape = &appearance.shapes[self.faces[lane].shape as usize];
            let Material { tint, emission, ambient, .. } = appearance.class(shape).material;
            set::<F>(&mut self.tint, lane, tint);
            set::<F>(&mut self.emission, lane, emission);
            self.ambient.as_mut()[lane] = ambient;
        }
    }

    /// As [`Self::begin`], for [`super::ShadowCrossings`]: without what reflects light.
    #[inline(always)]
    pub(super) fn begin_crossings(&mut self, faces: &[Face], appearance: &Appearance) {
        let last = faces[faces.len() - 1];
        self.used = ((1_u64 << faces.len()) - 1) as u32;
        (self.colored, self.has_uvs, self.quads) = (0, 0, 0);
        for lane in 0..F::LANES {
            let face = faces.get(lane).copied().unwrap_or(last);
            self.faces[lane] = face;
            let is_flipped = appearance.shapes[face.shape as usize].flipped;
            self.side.as_mut()[lane] = if is_flipped { -1.0 } else { 1.0 };
        }
    }

    /// Fetches the corners and corner values of one hit of `ray`.
    #[inline(always)]
    pub fn fetch(&mut self, lane: usize, scene: &PreparedScene, ray: impl Fn() -> Ray) {
        let Face { primitive, shape, .. } = self.faces[lane];
        let shape = &scene.appearance.shapes[shape as usize];
        if shape.smooth
            && let Some(normals) = scene.normals(shape, primitive)
        {
            self.smooth |= 1 << lane;
            set_three::<F>(&mut self.normals, lane, normals);
        }
        self.fetch_values(lane, scene);
        self.fetch_corners(lane, scene.accel.geometry(), ray);
    }

    /// Fetches colours, opacities and texture coordinates at the corners of one hit.
    #[inline(always)]
    pub(super) fn fetch_values(&mut self, lane: usize, scene: &PreparedScene) {
        let Face { primitive, shape, .. } = self.faces[lane];
        let shape = &scene.appearance.shapes[shape as usize];
        if shape.colored
            && let Some(colors) = scene.corners(shape, primitive, |mesh| mesh.colors.as_ref())
        {
            self.colored |= 1 << lane;
            set_three::<F>(&mut self.tints, lane, colors);
        }
        let class = scene.appearance.class(shape);
        if class.fades {
            let alphas = scene.corners(shape, primitive, |mesh| mesh.alphas.as_ref());
            set::<F>(&mut self.alphas, lane, alphas.unwrap_or([1.0; 3]).into());
        }
        if class.looks_up_uvs {
            let uvs = scene.corners(shape, primitive, |mesh| mesh.uvs.as_ref());
            self.has_uvs |= u32::from(uvs.is_some()) << lane;
            for ([u, v], at) in self.uvs.iter_mut().zip(uvs.unwrap_or_default()) {
                (u.as_mut()[lane], v.as_mut()[lane]) = (at.x, at.y);
            }
        }
    }

    /// Fetches the corners of one hit of `ray`.
    #[inline(always)]
    pub(super) fn fetch_corners(
        &mut self,
        lane: usize,
        geometry: &Geometry,
        ray: impl Fn() -> Ray,
    ) {
        let Face { primitive, .. } = self.faces[lane];
        // Separate arms: a shared array of corners would go through memory in pieces.
        match geometry.primitive(primitive) {
            Primitive::Triangle(i) => {
                set_three::<F>(&mut self.corners, lane, geometry.triangle(i));
            }
            Primitive::Quad(i) => {
                self.quads |= 1 << lane;
                let [a, b, c, d] = geometry.quad(i);
                set_three::<F>(&mut self.corners, lane, [a, b, c]);
                set::<F>(&mut self.fourth, lane, d);
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

    /// Counts the hits, of this class if it is not plain.
    #[inline(always)]
    pub fn count(&self, class: &Class, counts: &mut SampleCounts) {
        let hits = u64::from(self.used.count_ones());
        *(if class.is_plain() { &mut counts.plain } else { &mut counts.mapped }) += hits;
        counts.maps += hits * class.maps.len() as u64;
        counts.colors += u64::from((self.colored & self.used).count_ones());
    }

    /// Base colours of materials.
    #[inline(always)]
    pub fn colors(&self, token: F::Token) -> Vector<F> {
        Vector::load(token, &self.color)
    }

    /// The class of the first hit, and of all if it is not plain.
    #[inline(always)]
    pub fn class<'a>(&self, appearance: &'a Appearance) -> &'a Class {
        appearance.class(&appearance.shapes[self.faces[0].shape as usize])
    }

    /// Colours times those of vertices, where there are any.
    #[inline(always)]
    pub(super) fn with_vertex_colors(&self, color: Vector<F>, barycentric: [F; 2]) -> Vector<F> {
        if self.colored == 0 {
            return color;
        }
        let token = color.x.token();
        let tint = surface::interpolated(&three(token, &self.tints), barycentric);
        Vector::select(F::mask(token, self.colored), color * tint, color)
    }

    /// Normals on the front, interpolated on smooth triangles; not of unit length.
    #[inline(always)]
    pub(super) fn front_normals(&self, surfaces: &SurfacePoint<F>) -> Vector<F> {
        let token = surfaces.normal.x.token();
        let flat = surfaces.normal.scale(F::load(token, &self.side));
        let smooth = surface::interpolated(&three(token, &self.normals), surfaces.barycentric);
        Vector::select(F::mask(token, self.smooth), smooth, flat)
    }

    /// Texture coordinates at the corners.
    #[inline(always)]
    pub(super) fn uvs(&self, token: F::Token) -> [[F; 2]; 3] {
        let [[au, av], [bu, bv], [cu, cv]] = &self.uvs;
        [
            [F::load(token, au), F::load(token, av)],
            [F::load(token, bu), F::load(token, bv)],
            [F::load(token, cu), F::load(token, cv)],
        ]
    }

    /// The corners of triangles in the world.
    #[inline(always)]
    pub(super) fn corners_in_world(&self, token: F::Token, geometry: &Geometry) -> [Vector<F>; 3] {
        let mut rows = self.corners;
        for lane in 0..if geometry.instances.is_empty() { 0 } else { F::LANES } {
            let corners = geometry.mesh_triangle(self.faces[lane].primitive);
            set_three::<F>(&mut rows, lane, corners.unwrap_or_default());
        }
        three(token, &rows)
    }
}

impl Face {
    /// Prefetches the vertex numbers of a hit on a triangle, for [`Self::prefetch_corners`]; for one on another
    /// primitive, an address that is not read.
    #[inline(always)]
    pub fn prefetch_vertices(&self, geometry: &Geometry) {
        prefetch(geometry.triangles.as_ptr().wrapping_add(self.primitive as usize).cast());
    }

    /// Prefetches the corners of a hit, if it is on a triangle.
    #[inline(always)]
    pub fn prefetch_corners(&self, geometry: &Geometry) {
        for &vertex in geometry.triangles.get(self.primitive as usize).into_iter().flatten() {
            prefetch(geometry.positions.as_ptr().wrapping_add(vertex as usize).cast());
        }
    }
}

/// The vectors of three rows. Written out, like other arrays of vectors here: `map` is not inlined,
/// and vectors stored in pieces stall when they are reloaded.
#[inline(always)]
pub(super) fn three<F: Single>(token: F::Token, [a, b, c]: &[AxisRows<F>; 3]) -> [Vector<F>; 3] {
    [Vector::load(token, a), Vector::load(token, b), Vector::load(token, c)]
}

#[inline(always)]
fn set_three<F: Single>(rows: &mut [AxisRows<F>; 3], lane: usize, [a, b, c]: [Vec3; 3]) {
    let [in_a, in_b, in_c] = rows;
    set::<F>(in_a, lane, a);
    set::<F>(in_b, lane, b);
    set::<F>(in_c, lane, c);
}
