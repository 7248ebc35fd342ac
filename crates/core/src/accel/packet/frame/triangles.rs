//! The triangles of a leaf in the frame of a tile: prepares them, and tests groups of rays.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f32x16, mask32x8};

use super::{Frame, Sizes, cross, three};
use crate::accel::packet::columns::GROUPS;
use crate::accel::{ArenaView, Ref, leaf};
use crate::kernels::Arithmetic;
use crate::math::float::UNIT_ROUNDOFF;
use crate::math::{LANES, Lanes, Mask};

/// The triangles of a leaf in a frame, an axis a row.
pub(crate) struct FramedTriangles {
    /// The normals of the sides opposite to the corners.
    sides: [[[f32; LANES]; 3]; 3],
    /// The edges there, unless all rays have one origin.
    edges: [[[f32; LANES]; 3]; 3],
    normal: [[f32; LANES]; 3],
    /// n . a.
    height: [f32; LANES],
    /// The triangles that some ray may meet, and those that all pass through, a bit each.
    pub(crate) some: u32,
    pub(crate) all: u32,
    /// Bounds on the errors of sides, and of t times |n . d|.
    errors: [[f32; LANES]; 2],
}

/// What the rays of a group do at a triangle, a bit each.
pub(crate) struct GroupTest<S: Lanes> {
    /// Bounds on t.
    pub(crate) t: [f32x16<S>; 2],
    /// The rays that certainly pass through, or that may.
    pub(crate) inside: u32,
    pub(crate) open: u32,
}

impl Frame {
    /// The vectors in the frame, whose axes they have.
    #[inline(always)]
    fn shear<S: Lanes>(&self, simd: S, [x, y, z]: [f32x8<S>; 3]) -> [f32x8<S>; 3] {
        let [sx, sy] = [f32x8::splat(simd, -self.shear[0]), f32x8::splat(simd, -self.shear[1])];
        [z.mul_add(sx, x), z.mul_add(sy, y), z]
    }

    /// The vertex in the frame, whose axes it has.
    #[inline(always)]
    fn place<S: Lanes>(&self, simd: S, [x, y, z]: &[f32x8<S>; 3]) -> [f32x8<S>; 3] {
        let [mx, my, mz] = self.middle;
        self.shear(simd, [*x - mx, *y - my, *z - mz])
    }

    /// Prepares the `used` triangles of a leaf, a bit each.
    #[inline(always)]
    pub(crate) fn prepare<S: Lanes, P: Arithmetic>(
        &self,
        simd: S,
        arena: ArenaView<'_>,
        place: Ref,
        used: u32,
    ) -> FramedTriangles {
        let [a, b, c] = &leaf::corners(simd, arena, place, self.order);
        // Differences before they are sheared, which keeps those of near corners accurate.
        let edges = [
            self.shear(simd, minus(c, b)),
            self.shear(simd, minus(a, c)),
            self.shear(simd, minus(b, a)),
        ];
        let [a, b, c] = &[self.place(simd, a), self.place(simd, b), self.place(simd, c)];
        let sides = [cross(b, c), cross(c, a), cross(a, b)];
        let lengths = [length(&edges[0]), length(&edges[1]), length(&edges[2])];
        // Of the shorter edges.
        let [l, m, n] = lengths;
        let first = select(n.simd_ge(l.max(m)), &edges[0], &edges[2]);
        let second = select(m.simd_ge(l) & m.simd_gt(n), &edges[0], &edges[1]);
        let normal = cross(&first, &second);
        let height = a[0].mul_add(normal[0], a[1].mul_add(normal[1], a[2] * normal[2]));
        let errors = if P::IS_FAST {
            [f32x8::splat(simd, 0.0); 2]
        } else {
            self.errors(simd, [a, b, c], &normal, &lengths)
        };
        let (most, least) = (errors[0], -errors[0]);
        let first = self.range(simd, &sides[0], &edges[0]);
        let second = self.range(simd, &sides[1], &edges[1]);
        let third = self.range(simd, &sides[2], &edges[2]);
        // Of the least values the greatest, and so on.
        let low = first[0].min(second[0]).min(third[0]);
        let high = first[1].max(second[1]).max(third[1]);
        let some_positive = first[0].max(second[0]).max(third[0]).simd_gt(most);
        let some_negative = first[1].min(second[1]).min(third[1]).simd_lt(least);
        let all = (low.simd_gt(most) | high.simd_lt(least)).bits() & used;
        let some = used & !(some_positive & some_negative).bits();
        FramedTriangles {
            sides: [rows(sides[0]), rows(sides[1]), rows(sides[2])],
            edges: [rows(edges[0]), rows(edges[1]), rows(edges[2])],
            normal: rows(normal),
            height: height.into(),
            some,
            all,
            errors: errors.map(Into::into),
        }
    }

    /// Bounds on the errors of sides, and of t times |n . d|.
    #[inline(always)]
    fn errors<S: Lanes>(
        &self,
        simd: S,
        [a, b, c]: [&[f32x8<S>; 3]; 3],
        normal: &[f32x8<S>; 3],
        [e, f, g]: &[f32x8<S>; 3],
    ) -> [f32x8<S>; 2] {
        const U: f32 = UNIT_ROUNDOFF;
        let Sizes { direction, sideways, ratio, origin } = self.sizes;
        let d = size(2, a, b, c);
        // With the errors of x and y themselves.
        let m = d.mul_add(f32x8::splat(simd, 16.0 * U), size(0, a, b, c).max(size(1, a, b, c)));
        let side = d * sideways * (d * 12.0 + m * 36.0)
            + (m * (d * 28.0 + m * 22.0) + m * 60.0 * origin) * direction
            + d * origin * (16.0 * direction + 48.0 * sideways);
        let [x, y, z] = normal;
        let all_sizes = m + d + origin;
        let t = (x.abs() + y.abs() + z.abs()) * all_sizes * (18.0 * U * ratio)
            + *e * *f * *g * (14.0 * U);
        let underflow = (all_sizes + 1.0) * (f32::MIN_POSITIVE * (1.0 + 1.0 / direction) * ratio);
        [
            side.mul_add(
                f32x8::splat(simd, 1.01 * U),
                f32x8::splat(simd, f32::MIN_POSITIVE * (1.0 + direction)),
            ),
            t + underflow,
        ]
    }

    /// The smallest and largest value of a side over all rays.
    #[inline(always)]
    fn range<S: Lanes>(
        &self,
        simd: S,
        side: &[f32x8<S>; 3],
        edge: &[f32x8<S>; 3],
    ) -> [f32x8<S>; 2] {
        let none = f32x8::splat(simd, 0.0);
        let (mut low, mut high) = (none, none);
        for (&side, [least, most]) in side.iter().zip(self.directions) {
            let (p, q) = (side * least, side * most);
            (low, high) = (low + p.min(q), high + p.max(q));
        }
        if !self.has_one_origin {
            for (&edge, [least, most]) in edge.iter().zip(self.moments) {
                let (p, q) = (edge * least, edge * most);
                (low, high) = (low + p.min(q), high + p.max(q));
            }
        }
        [low, high]
    }

    /// Tests the rays of group `g`, of which some are `active`, against a triangle.
    #[inline(always)]
    pub(crate) fn meet<S: Lanes, P: Arithmetic>(
        &self,
        simd: S,
        prepared: &FramedTriangles,
        triangle: usize,
        (g, active): (usize, u32),
    ) -> Option<GroupTest<S>> {
        let (triangle, g) = (triangle % LANES, g % GROUPS);
        let d = three(simd, &self.direction, g);
        let (mut inside, mut open) = (active, 0);
        if prepared.all >> triangle & 1 == 0 {
            let [a, b, c] = &prepared.sides;
            let (mut a, mut b, mut c) = (
                dot(simd, a, triangle, &d),
                dot(simd, b, triangle, &d),
                dot(simd, c, triangle, &d),
            );
            if !self.has_one_origin {
                let m = three(simd, &self.moment, g);
                let [e, f, h] = &prepared.edges;
                (a, b, c) = (
                    a + dot(simd, e, triangle, &m),
                    b + dot(simd, f, triangle, &m),
                    c + dot(simd, h, triangle, &m),
                );
            }
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let (most, least) = (
                f32x16::splat(simd, prepared.errors[0][triangle]),
                f32x16::splat(simd, -prepared.errors[0][triangle]),
            );
            let outside = (low.simd_lt(least) & high.simd_gt(most)).bits();
            let maybe = active & !outside;
            if maybe == 0 {
                return None;
            }
            inside = if P::IS_FAST {
                maybe
            } else {
                maybe & (low.simd_gt(most) | high.simd_lt(least)).bits()
            };
            open = maybe & !inside;
        }
        let part = f32x16::splat(simd, 1.0) / dot(simd, &prepared.normal, triangle, &d);
        let mut height = f32x16::splat(simd, prepared.height[triangle]);
        if !self.has_one_origin {
            let o = three(simd, &self.origin, g);
            height -= dot(simd, &prepared.normal, triangle, &o);
        }
        let t = height * part;
        if P::IS_FAST {
            return Some(GroupTest { t: [t, t], inside, open });
        }
        let error = part.abs() * prepared.errors[1][triangle] + f32::MIN_POSITIVE;
        Some(GroupTest { t: [t - error, t + error], inside, open })
    }
}

#[inline(always)]
fn minus<F: Copy + std::ops::Sub<Output = F>>(u: &[F; 3], v: &[F; 3]) -> [F; 3] {
    [u[0] - v[0], u[1] - v[1], u[2] - v[2]]
}

// Functions instead of closures, which are not always inlined and then lack the level's
// instructions.

/// The scalar products of a triangle's vector with those of a group.
#[inline(always)]
fn dot<S: Lanes>(
    simd: S,
    [x, y, z]: &[[f32; LANES]; 3],
    triangle: usize,
    v: &[f32x16<S>; 3],
) -> f32x16<S> {
    let all = [x, y, z].map(|row| row[triangle]);
    let z = f32x16::splat(simd, all[2]) * v[2];
    let yz = f32x16::splat(simd, all[1]).mul_add(v[1], z);
    f32x16::splat(simd, all[0]).mul_add(v[0], yz)
}

#[inline(always)]
fn rows<S: Lanes>([x, y, z]: [f32x8<S>; 3]) -> [[f32; LANES]; 3] {
    [x.into(), y.into(), z.into()]
}

/// The larger of |x| and |y|, plus |z|.
#[inline(always)]
fn length<S: Lanes>([x, y, z]: &[f32x8<S>; 3]) -> f32x8<S> {
    x.abs().max(y.abs()) + z.abs()
}

/// `a` in the lanes of `mask`, `b` in the others.
#[inline(always)]
fn select<S: Lanes>(mask: mask32x8<S>, a: &[f32x8<S>; 3], b: &[f32x8<S>; 3]) -> [f32x8<S>; 3] {
    [mask.select(a[0], b[0]), mask.select(a[1], b[1]), mask.select(a[2], b[2])]
}

/// The largest magnitude of a component of three vectors.
#[inline(always)]
fn size<S: Lanes>(k: usize, a: &[f32x8<S>; 3], b: &[f32x8<S>; 3], c: &[f32x8<S>; 3]) -> f32x8<S> {
    a[k].abs().max(b[k].abs()).max(c[k].abs())
}
