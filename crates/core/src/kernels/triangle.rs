//! The watertight ray-triangle test of Woop, Benthin and Wald (*Watertight Ray/Triangle
//! Intersection*, JCGT 2013).
//!
//! The vertices are sheared into a space in which the ray is the z axis; three edge functions in
//! the xy plane then tell on which side of each edge the ray passes. Two triangles that share an
//! edge compute the same function of the same numbers with opposite sign, so no ray slips between
//! them. If a function is zero in single precision, its sign is taken in double precision, in which
//! the products are exact.
//!
//! # Error of t
//!
//! The result is the average of the vertices' z, weighted by the edge functions. With u the unit
//! roundoff, X, Y, Z, D the largest |x|, |y|, |z| and unsheared depth of the vertices, the error of
//! a sheared x is at most gamma(5) (X + D), that of an edge function E = 2 (gamma(2) X Y + gamma(5)
//! ((X + D) Y + (Y + D) X)). Weights that sum to one move the average by at most half the span of z
//! times the sum of their changes, so that |error of t| <= 3 E span / |det| + gamma(8) Z. Underflow
//! of products adds up to [`UNDERFLOW`] to both terms.
//!
//! This bound grows with the product of span and depth. It may exceed [`T_TOLERANCE`] times |t|,
//! for triangles that are large compared with their distance or grazed by the ray. Or it may leave
//! open whether the hit is within the ray's range, for rays that start on a triangle, or a light
//! just in front of or behind it. Then t is computed otherwise:
//!
//! 1. If the edge functions exceed E, the ray certainly passes through the triangle, and the
//!    triangle's plane in double precision gives the exact t, rounded once ([`plane`]).
//! 2. If that does not decide either, the exact test does ([`exact`]).
//! 3. If the exact test finds that the ray misses, although it meets the rounded vertices, t is
//!    that of the nearest point of the triangle's boundary, and the answer is [`Meeting::Near`]: a
//!    hit only if the ray really meets the surface that the triangle is part of. So no ray slips
//!    through an edge, and no ray that leaves a flat floor is stopped by a neighbouring triangle of
//!    the floor.
//!
//! The stated error of t is therefore at most [`T_TOLERANCE`] |t|; away from grazing angles it is a
//! few ulp. The tree relies on this: t belongs to a point of the triangle, and the ray passes that
//! point within the error with which single precision places vertices ([`super::slab`]).
//!
//! Sums do not depend on order: t does not depend on which corner is first, the winding, or the
//! order of the axes.

use glam::{BVec3A, DVec3, Vec3, Vec3A, Vec3Swizzles};

use crate::math::float::{UNIT_ROUNDOFF, gamma, max, max_abs};
use crate::math::ray::Ray;
use crate::math::real::{Real, Single};
use crate::math::vector::{Line, Vector};

mod area;
mod edges;
pub mod exact;
pub mod fast;
pub(crate) mod lanes;
mod nearest;
pub(crate) mod plane;

pub use area::{is_degenerate, normal};
pub(crate) use edges::{Decision, Edges, RayRange, Sheared, decide};
pub use lanes::LaneHits;

use edges::distance;
use nearest::{edges_f64, is_beside, nearest_on_boundary, weights};
use plane::Plane;

/// Bound on the error that underflow adds to a sum of a few products: far above the true error, but
/// the least normal number, as processors divide subnormal ones a hundred times slower.
const UNDERFLOW: f32 = f32::MIN_POSITIVE;

/// Bound on the relative error of t: 2^-16.
pub const T_TOLERANCE: f32 = 1.0 / 65536.0;

/// The meeting of a ray with a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meeting {
    /// The ray misses, or meets the triangle outside its range.
    Miss,
    /// A hit at this t.
    Hit(f32),
    /// The ray misses, but too closely for single precision to tell it from a hit of a neighbour: a
    /// hit at this t if the ray meets the surface.
    Near(f32),
}

impl Meeting {
    /// A hit at `t` if `t` is within the range of the ray.
    #[inline(always)]
    pub(crate) fn within(t: Option<f32>, ray: &Ray) -> Self {
        t.filter(|&t| t > ray.t_min && t < ray.t_max).map_or(Self::Miss, Self::Hit)
    }
}

/// An axis of world space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    /// The axis along which `d` is longest, the first of equals. Without a branch, which rays of
    /// different directions would mispredict.
    #[inline(always)]
    fn longest(d: Vec3A) -> Self {
        let size = d.abs();
        let longest = size.cmpeq(Vec3A::splat(size.max_element())).bitmask();
        [Self::X, Self::Y, Self::Z][longest.trailing_zeros().min(2) as usize]
    }

    /// The coordinates permuted so that this axis is last. A match instead of an index keeps the
    /// coordinates in registers.
    #[inline(always)]
    fn to_last<T>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        match self {
            Self::X => [y, z, x],
            Self::Y => [z, x, y],
            Self::Z => [x, y, z],
        }
    }

    /// As [`Self::to_last`], for the corners of a triangle at once.
    #[inline(always)]
    fn corners_to_last(self, corners: &[Vec3; 3]) -> [[f32; 3]; 3] {
        let corners = corners.map(|v| v.to_array());
        match self {
            Self::X => corners.map(|v| Self::X.to_last(v)),
            Self::Y => corners.map(|v| Self::Y.to_last(v)),
            Self::Z => corners.map(|v| Self::Z.to_last(v)),
        }
    }
}

/// The space of a ray in which the ray starts at 0 and runs along z, so that t is z. Its z is along
/// the longest axis of the direction.
#[derive(Clone, Copy, Debug)]
pub struct ShearedSpace {
    longest: Axis,
    /// Permuted so that the longest axis is last, like the following.
    origin: [f32; 3],
    direction: [f32; 3],
    /// The shear of x and y along the direction, and the reciprocal of its z.
    shear: [f32; 3],
    /// The ray's range of t.
    t_min: f32,
    t_max: f32,
}

impl ShearedSpace {
    /// The space of `ray`.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
        let longest = Axis::longest(direction);
        let along = |axis| BVec3A::splat(longest == axis);
        let (along_x, along_y) = (along(Axis::X), along(Axis::Y));
        let turned = |v: Vec3A| Vec3A::select(along_x, v.yzx(), Vec3A::select(along_y, v.zxy(), v));
        let direction = turned(direction);
        let shear = direction.with_z(1.0) / Vec3A::splat(direction.z);
        Self {
            longest,
            origin: turned(origin).to_array(),
            direction: direction.to_array(),
            shear: shear.to_array(),
            t_min: ray.t_min,
            t_max: ray.t_max,
        }
    }

    /// The space of a ray from values already known, with axes permuted so that the `longest` is
    /// last.
    #[inline(always)]
    pub(crate) fn from_turned(
        longest: Axis,
        origin: [f32; 3],
        direction: [f32; 3],
        shear: [f32; 3],
        [t_min, t_max]: [f32; 2],
    ) -> Self {
        Self { longest, origin, direction, shear, t_min, t_max }
    }

    /// The space of an inactive ray, which tests no triangle.
    pub(crate) const NONE: Self = Self {
        longest: Axis::Z,
        origin: [0.0; 3],
        direction: [0.0, 0.0, 1.0],
        shear: [0.0, 0.0, 1.0],
        t_min: 0.0,
        t_max: 0.0,
    };

    /// A vertex with permuted axes, in this space.
    #[inline(always)]
    fn shear(&self, [x, y, z]: [f32; 3]) -> Vec3 {
        let [ox, oy, oz] = self.origin;
        let [sx, sy, sz] = self.shear;
        let (x, y, z) = (x - ox, y - oy, z - oz);
        Vec3::new(x - sx * z, y - sy * z, sz * z)
    }

    fn shear_f64(&self, vertex: Vec3) -> DVec3 {
        let v = DVec3::from(self.longest.to_last(vertex.as_dvec3().to_array()));
        let v = v - DVec3::from(self.origin.map(f64::from));
        let d = self.direction.map(f64::from);
        let t = v.z / d[2];
        DVec3::new(v.x - d[0] * t, v.y - d[1] * t, t)
    }

    /// The corners of a triangle in this space.
    #[inline(always)]
    fn sheared(&self, triangle: &[Vec3; 3]) -> Sheared<f32> {
        let [a, b, c] = self.longest.corners_to_last(triangle).map(|v| self.shear(v));
        Sheared { xy: [[a.x, a.y], [b.x, b.y], [c.x, c.y]], z: [a.z, b.z, c.z] }
    }

    #[inline(always)]
    fn range(&self) -> RayRange<f32> {
        let Self { t_min, t_max, direction, .. } = *self;
        RayRange { depth: direction[2].abs(), t_min, t_max }
    }

    /// Whether the ray certainly misses `triangle`: [`Self::intersect`] is then `None`.
    #[inline(always)]
    pub fn passes_by(&self, triangle: &[Vec3; 3]) -> bool {
        Edges::outside_of(&self.sheared(triangle).xy)
    }

    /// The t at which the ray meets `triangle` within its range, from either side, or passes it too
    /// closely for single precision to tell.
    ///
    /// The relative error of t is at most [`T_TOLERANCE`].
    #[inline(always)]
    pub fn intersect(&self, triangle: &[Vec3; 3]) -> Option<f32> {
        match self.meet(triangle) {
            Meeting::Miss => None,
            Meeting::Hit(t) | Meeting::Near(t) => Some(t),
        }
    }

    /// The meeting of the ray with `triangle`.
    #[inline(always)]
    pub fn meet(&self, triangle: &[Vec3; 3]) -> Meeting {
        let sheared = self.sheared(triangle);
        let Some(edges) = edges_of_one(&sheared) else { return Meeting::Miss };
        let range = self.range();
        let found = distance(&sheared, &edges, range.depth);
        if found.is_before(&range) {
            return Meeting::Miss;
        }
        if found.is_decided(&range) {
            if !found.is_within(&range) {
                return Meeting::Miss;
            }
            if found.is_exact() {
                return Meeting::Hit(found.clamped());
            }
        }
        self.settle(triangle, edges.are_certain(found.edge))
    }

    /// Bound on the error of a `t` that [`Self::intersect`] returned for `triangle`: that of single
    /// precision, or half an ulp if t came from the exact tests. `None` if the ray does not pass
    /// through.
    pub fn error_of(&self, triangle: &[Vec3; 3], t: f32) -> Option<f32> {
        let sheared = self.sheared(triangle);
        let edges = edges_of_one(&sheared)?;
        let found = distance(&sheared, &edges, self.range().depth);
        let is_single = found.is_decided(&self.range()) && found.is_exact();
        Some(if is_single { found.bound() } else { UNIT_ROUNDOFF * t.abs() })
    }

    /// As [`Self::meet`], for triangles that single precision does not decide; `is_inside` if the
    /// ray certainly passes through.
    #[inline(never)]
    fn settle(&self, triangle: &[Vec3; 3], is_inside: bool) -> Meeting {
        if is_inside {
            let corners = triangle.map(|v| Vector::from(v.as_dvec3()));
            let line = Line { origin: self.origin(), direction: self.direction() };
            let settled = Plane::of(&corners).settle(&line, &self.range());
            if settled.hit {
                return Meeting::Hit(settled.t);
            }
            if settled.miss {
                return Meeting::Miss;
            }
        }
        self.settle_exactly(triangle)
    }

    #[cold]
    #[inline(never)]
    fn settle_exactly(&self, triangle: &[Vec3; 3]) -> Meeting {
        let Self { t_min, t_max, .. } = *self;
        let (origin, direction) = (self.origin().into(), self.direction().into());
        let ray = Ray { origin, direction, t_min, t_max };
        let is_within = |t: f32| t > t_min && t < t_max;
        match exact::intersect(&ray, triangle) {
            Some(t) if is_within(t as f32) => Meeting::Hit(t as f32),
            Some(_) => Meeting::Miss,
            None => {
                let nearest = self.nearest_t(triangle).filter(|&t| is_within(t));
                nearest.map_or(Meeting::Miss, Meeting::Near)
            }
        }
    }

    /// The t of the point of the triangle's boundary that is nearest to the ray. `None` if the ray
    /// passes farther off than rounding in single precision explains: edge functions of huge
    /// coordinates are NaN and say nothing.
    fn nearest_t(&self, triangle: &[Vec3; 3]) -> Option<f32> {
        let vertices = triangle.map(|v| self.shear_f64(v));
        let weights = nearest_on_boundary(&vertices);
        let is_beside = is_beside(&vertices, weights, self.sideways(triangle));
        is_beside.then(|| weights.dot(DVec3::from(vertices.map(|v| v.z))) as f32)
    }

    /// The origin in world space.
    #[inline(always)]
    fn origin(&self) -> Vector<f32> {
        self.turned_back(self.origin)
    }

    /// The direction in world space.
    #[inline(always)]
    fn direction(&self) -> Vector<f32> {
        self.turned_back(self.direction)
    }

    #[inline(always)]
    fn turned_back(&self, v: [f32; 3]) -> Vector<f32> {
        let [kx, ky, kz] = lanes::ORDERS[self.longest as usize];
        let mut world = [0.0; 3];
        (world[kx.min(2)], world[ky.min(2)], world[kz.min(2)]) = (v[0], v[1], v[2]);
        let [x, y, z] = world;
        Vector::new(x, y, z)
    }

    /// Bound on the sideways error with which single precision places vertices:
    /// [`crate::kernels::slab`] leaves room for it.
    fn sideways(&self, triangle: &[Vec3; 3]) -> f64 {
        let size = triangle.iter().fold(0.0, |size, &v| max(size, max_abs(v)));
        Self::sideways_of(size, max_abs(Vec3::from(self.origin)))
    }

    /// As [`Self::sideways`], for corners with coordinates up to `size` and rays that start at
    /// coordinates up to `origin`.
    #[inline(always)]
    pub(super) fn sideways_of<F: Single>(size: F, origin: F) -> F::Double {
        let sum = size.widen() + origin.widen();
        sum.times(f64::from(gamma(10))) + sum.same(f64::from(UNDERFLOW))
    }

    /// Barycentric coordinates of the point at which the ray's line meets the triangle, each in 0
    /// to 1 with sum 1. If the line lies in the triangle's plane, those of the centroid.
    pub fn barycentric(&self, triangle: &[Vec3; 3]) -> DVec3 {
        let vertices = triangle.map(|v| self.shear_f64(v));
        weights(&vertices, self.sideways(triangle)).unwrap_or(DVec3::splat(1.0 / 3.0))
    }
}

/// The edge functions of a ray that passes through its triangle.
#[inline(always)]
fn edges_of_one(sheared: &Sheared<f32>) -> Option<Edges<f32>> {
    let edges = Edges::new(&sheared.xy);
    if edges.all.contains(&0.0) {
        return passes_on_an_edge(sheared);
    }
    (!edges.outside()).then_some(edges)
}

/// The edge functions' signs in double precision: exact, as a product of two `f32` is.
#[cold]
#[inline(never)]
fn passes_on_an_edge(sheared: &Sheared<f32>) -> Option<Edges<f32>> {
    let wide = |k: usize| {
        let ([x, y], z) = (sheared.xy[k], sheared.z[k]);
        Vec3::new(x, y, z).as_dvec3()
    };
    let edges = edges_f64(&[wide(0), wide(1), wide(2)]);
    let outside = edges.iter().any(|&e| e < 0.0) && edges.iter().any(|&e| e > 0.0);
    let determinant = edges[0] + edges[1] + edges[2];
    // A determinant that rounds to zero makes the error bound infinite and leaves t to double
    // precision.
    let all = edges.map(|e| e as f32);
    let known = Edges { all, determinant: determinant as f32, low: 0.0, high: 0.0 };
    (!outside && determinant != 0.0).then_some(known)
}

#[cfg(test)]
mod tests;
