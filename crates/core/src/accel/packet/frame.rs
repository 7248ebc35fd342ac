//! The filter of all rays of a tile against the eight triangles of a leaf, in single precision and
//! with bounds.
//!
//! In a frame about the tile's middle, sheared along its middle ray, a triangle's edge from p to q
//! has the normal p x q. A ray with direction d and moment m = o x d, o being its origin, passes
//! the edge on the side given by the sign of (p x q) . d + (q - p) . m: the coordinates of Plücker.
//! With n the cross product of two edges from the corner a, t = n . (a - o) / n . d. If all rays have
//! one origin, it is the middle, and moments are zero.
//!
//! So a triangle is prepared once for all rays. Bounds on the directions and moments of the tile
//! then drop most triangles, and certify some, for all rays at once; others take nine or eighteen
//! multiplications a ray.
//!
//! # The bounds
//!
//! With u the unit roundoff, M the largest |x| and |y| of the vertices in the frame and D their
//! largest |z|; O the largest |x| or |y|, plus the largest |z|, of origins; R the largest component
//! of a direction, and Q that of its x and y: x and y of a vertex are off by 3 u (M + D), z by u D;
//! those of an origin by 3 u O and u O; x and y of a direction by 4 u R. Products and sums add their
//! roundings, so that a side is off by at most
//!
//! E = u (Q D (12 D + 36 M) + R M (28 D + 22 M) + 60 R O M + D O (16 R + 48 Q)).
//!
//! Edges are sheared after their difference, so that their errors do not depend on where they are:
//! with W = max(|x|, |y|) + |z| of an edge, its x and y are off by 3 u W, its z by u W. The normal n
//! is the cross product of the two shorter edges e and f, so that its x and y are off by 6 u W_e W_f,
//! and its z by 12 u W_e W_f. With h the exact hit, n . (a - h), which is zero for the exact normal,
//! is off by 12 u W_e W_f W_g, g being the longest edge, which a - h does not exceed. The errors of a,
//! of o and of t d, and the roundings of both scalar products and of the quotient, add at most 16 u
//! |n| (M + D + O) r, where |n| is the sum of magnitudes and r the ratio of R to the smallest |z| of a
//! direction. The sum of both over |n . d| bounds the error of t; 14 and 18 in their place cover the
//! roundings of the bound. Underflow adds less than the least normal number, times the size of the factors:
//! tiles whose rays are very long or short, or start far away, are left to other kernels.

mod triangles;

use fearless_simd::f32x16;
use fearless_simd::prelude::*;

use super::beam::greatest;
use super::columns::{GROUPS, Spans, TileColumn, WIDTH, load};
use crate::kernels::triangle::filter::ORDERS;
use crate::math::Lanes;
use crate::math::float::max;
pub(super) use triangles::GroupTest;

/// The middle of a tile, by index.
const MIDDLE: usize = 39;

/// The frame of a tile, and its rays in it. Axes are permuted so that the longest of the middle ray
/// comes last.
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub(super) struct Frame {
    direction: [TileColumn; 3],
    /// Origins and moments, unless all rays have one origin.
    origin: [TileColumn; 3],
    moment: [TileColumn; 3],
    order: [usize; 3],
    middle: [f32; 3],
    /// Of x and y along z.
    shear: [f32; 2],
    /// The smallest and largest of each component.
    directions: [[f32; 2]; 3],
    moments: [[f32; 2]; 3],
    sizes: Sizes,
    has_one_origin: bool,
}

/// See the module documentation.
#[derive(Clone, Copy, Debug, Default)]
struct Sizes {
    /// R.
    direction: f32,
    /// Q.
    sideways: f32,
    /// r.
    ratio: f32,
    /// O.
    origin: f32,
}

/// The smallest and largest components.
#[inline(always)]
fn ends<S: Lanes>(Spans([x, y, z], [u, v, w]): &Spans<S, 3>) -> [[f32; 2]; 3] {
    [
        [x.reduce_min(), u.reduce_max()],
        [y.reduce_min(), v.reduce_max()],
        [z.reduce_min(), w.reduce_max()],
    ]
}

impl Frame {
    /// Sets the frame of rays.
    #[inline(always)]
    pub(super) fn set<S: Lanes>(
        &mut self,
        simd: S,
        origin: &[TileColumn; 3],
        direction: &[TileColumn; 3],
        has_one_origin: bool,
    ) {
        let at = |columns: &[TileColumn; 3]| {
            [0, 1, 2].map(|k: usize| columns[k][MIDDLE / WIDTH][MIDDLE % WIDTH])
        };
        let [x, y, z] = at(direction).map(f32::abs);
        let longest = if z >= x && z >= y { 2 } else { usize::from(y >= x) };
        let [x, y, z, _] = ORDERS[longest].map(usize::from);
        let order = [x.min(2), y.min(2), z.min(2)];
        let turned = |v: [f32; 3]| order.map(|axis| v[axis]);
        let [dx, dy, dz] = turned(at(direction));
        (self.order, self.middle, self.shear) = (order, turned(at(origin)), [dx / dz, dy / dz]);
        self.has_one_origin = has_one_origin;
        let mut directions = Spans::none(simd);
        let mut nearest = f32x16::splat(simd, f32::INFINITY);
        for g in 0..GROUPS {
            let d = self.sheared(simd, direction, g, [0.0; 3]);
            nearest = nearest.min(d[2].abs());
            for (column, &d) in self.direction.iter_mut().zip(&d) {
                column[g] = d.into();
            }
            directions.add(&d);
        }
        self.directions = ends(&directions);
        let [qx, qy, qz] = self.directions.map(greatest);
        let sideways = max(qx, qy);
        let direction = max(sideways, qz);
        let ratio = direction / nearest.reduce_min();
        self.sizes = Sizes { direction, sideways, ratio, origin: 0.0 };
        if !has_one_origin {
            self.set_moments(simd, origin);
        }
    }

    #[inline(always)]
    fn set_moments<S: Lanes>(&mut self, simd: S, origin: &[TileColumn; 3]) {
        let (mut origins, mut moments) = (Spans::none(simd), Spans::none(simd));
        for g in 0..GROUPS {
            let o = self.sheared(simd, origin, g, self.middle);
            let m = cross(&o, &three(simd, &self.direction, g));
            for k in 0..3 {
                self.origin[k][g] = o[k].into();
                self.moment[k][g] = m[k].into();
            }
            origins.add(&o);
            moments.add(&m);
        }
        let [ox, oy, oz] = ends(&origins).map(greatest);
        self.sizes.origin = max(ox, oy) + oz;
        self.moments = ends(&moments);
    }

    /// A group's vectors relative to `from`, in the frame.
    #[inline(always)]
    fn sheared<S: Lanes>(
        &self,
        simd: S,
        columns: &[TileColumn; 3],
        g: usize,
        [x, y, z]: [f32; 3],
    ) -> [f32x16<S>; 3] {
        let [kx, ky, kz] = self.order;
        let z = load(simd, &columns[kz], g) - z;
        let [sx, sy] = [f32x16::splat(simd, -self.shear[0]), f32x16::splat(simd, -self.shear[1])];
        [
            z.mul_add(sx, load(simd, &columns[kx], g) - x),
            z.mul_add(sy, load(simd, &columns[ky], g) - y),
            z,
        ]
    }
}

#[inline(always)]
fn cross<S: Lanes, F: SimdFloat<S>>(u: &[F; 3], v: &[F; 3]) -> [F; 3] {
    [
        u[1].mul_sub(v[2], u[2] * v[1]),
        u[2].mul_sub(v[0], u[0] * v[2]),
        u[0].mul_sub(v[1], u[1] * v[0]),
    ]
}

/// A group's vectors.
#[inline(always)]
fn three<S: Lanes>(simd: S, [x, y, z]: &[TileColumn; 3], g: usize) -> [f32x16<S>; 3] {
    [load(simd, x, g), load(simd, y, g), load(simd, z, g)]
}
