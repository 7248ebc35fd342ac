//! The watertight test itself, for pairs of a ray and a triangle: one pair, or eight or sixteen at a time.

use super::{T_TOLERANCE, UNDERFLOW};
use crate::math::float::gamma;
use crate::math::real::{Mask, Real};

/// The corners of a triangle in the sheared space of its ray.
#[derive(Clone, Copy)]
pub(crate) struct Sheared<F> {
    pub(crate) xy: [[F; 2]; 3],
    /// What t would be at the corners.
    pub(crate) z: [F; 3],
}

/// Edge functions of a pair, the least and the greatest of them, and their sum.
#[derive(Clone, Copy)]
pub(crate) struct Edges<F> {
    pub(crate) all: [F; 3],
    pub(super) determinant: F,
    pub(super) low: F,
    pub(super) high: F,
}

/// Of the ray of a pair: by how much z in sheared space is to be scaled to be a depth, and the range of t.
#[derive(Clone, Copy)]
pub(crate) struct RayRange<F> {
    pub(crate) depth: F,
    pub(crate) t_min: F,
    pub(crate) t_max: F,
}

/// Where a ray meets a triangle's plane.
pub(super) struct Distance<F> {
    pub(super) t: F,
    /// The magnitude of the determinant, and by it the bound on the error of t: to divide by it takes longer, and gives
    /// a subnormal number, over which processors take a hundred times as long, where corners have one z.
    determinant: F,
    error: F,
    /// Bound on the errors of the edge functions.
    pub(super) edge: F,
    /// The least and the greatest t of the corners.
    pub(super) near: F,
    pub(super) far: F,
}

/// What single precision says of pairs, a bit each.
pub(crate) struct Decision<F: Real> {
    pub(crate) t: F,
    /// Pairs that certainly meet at t, within the ray's range.
    pub(crate) certain: u32,
    /// Pairs that single precision does not decide on.
    pub(crate) open: u32,
    /// Those of them in which the ray certainly passes through the triangle.
    pub(crate) inside: F::Mask,
}

impl<F: Real<Element = f32>> Edges<F> {
    #[inline(always)]
    pub(crate) fn new([[ax, ay], [bx, by], [cx, cy]]: &[[F; 2]; 3]) -> Self {
        let e0 = *cx * *by - *cy * *bx;
        let e1 = *ax * *cy - *ay * *cx;
        let e2 = *bx * *ay - *by * *ax;
        let (low, middle, high) = sorted([e0, e1, e2]);
        Self { all: [e0, e1, e2], determinant: (low + high) + middle, low, high }
    }

    /// Where the ray certainly passes by: two edge functions of opposite signs say so, as rounding turns no sign.
    /// What is not a number is not outside.
    #[inline(always)]
    pub(crate) fn outside(&self) -> F::Mask {
        let zero = self.low.zero();
        self.low.lt(zero) & self.high.gt(zero)
    }

    /// Where the ray certainly passes through, given a bound on the errors of the edge functions.
    #[inline(always)]
    pub(super) fn are_certain(&self, bound: F) -> F::Mask {
        self.low.gt(bound) | self.high.lt(-bound)
    }

    /// Of corners with these x and y.
    #[inline(always)]
    pub(crate) fn outside_of(xy: &[[F; 2]; 3]) -> F::Mask {
        Self::new(xy).outside()
    }
}

/// The least, the middle and the greatest. The sum of the first and the last, and then the middle, does not depend on
/// which corner is the first, and turns its sign with the numbers.
#[inline(always)]
fn sorted<F: Real>([a, b, c]: [F; 3]) -> (F, F, F) {
    let (low, high) = (a.min(b), a.max(b));
    (low.min(c), low.max(high.min(c)), high.max(c))
}

/// Where rays meet the planes of their triangles, with the error bound of the module documentation. A NaN where
/// nothing is known.
#[inline(always)]
pub(super) fn distance<F: Real<Element = f32>>(
    Sheared { xy: [[ax, ay], [bx, by], [cx, cy]], z: [az, bz, cz] }: &Sheared<F>,
    Edges { all: [e0, e1, e2], determinant, .. }: &Edges<F>,
    depth: F,
) -> Distance<F> {
    let far = az.max(bz.max(*cz));
    let near = az.min(bz.min(*cz));
    let (low, middle, high) = sorted([*e0 * *az, *e1 * *bz, *e2 * *cz]);
    let t = ((low + high) + middle) / *determinant;
    let x = ax.abs().max(bx.abs().max(cx.abs()));
    let y = ay.abs().max(by.abs().max(cy.abs()));
    let z = near.abs().max(far.abs());
    let depth = z * depth;
    let products = x.times(gamma(2)) * y + ((x + depth) * y + (y + depth) * x).times(gamma(5));
    let edge = products.times(2.0);
    let underflow = t.same(UNDERFLOW);
    let edge = edge + underflow;
    let determinant = determinant.abs();
    let sum = edge.times(3.0 * (1.0 + gamma(8))) * (far - near) + underflow;
    let error = sum + z.times(gamma(10)) * determinant;
    Distance { t, determinant, error, edge, near, far }
}

impl<F: Real<Element = f32>> Distance<F> {
    /// Where every corner, and so the hit, lies before the range. A corner's z has the right sign, and is off by
    /// three roundings. What is not a number is not before.
    #[inline(always)]
    pub(super) fn is_before(&self, range: &RayRange<F>) -> F::Mask {
        self.far.lt(range.t_min.min(self.far.zero()).times(1.0 + gamma(8)))
    }

    /// Where the bound leaves no doubt whether t is within the range.
    #[inline(always)]
    pub(super) fn is_decided(&self, range: &RayRange<F>) -> F::Mask {
        self.is_off_ends(range, self.error)
    }

    /// Where the exact t, rounded, is within the range if t is: the bound is many times what that rounding moves it.
    #[inline(always)]
    fn is_decided_exactly(&self, range: &RayRange<F>) -> F::Mask {
        self.is_off_ends(range, self.error + self.error)
    }

    #[inline(always)]
    fn is_off_ends(&self, range: &RayRange<F>, error: F) -> F::Mask {
        let from = |end: F| ((self.t - end).abs() * self.determinant).gt(error);
        from(range.t_max) & from(range.t_min)
    }

    /// Where t is within the range.
    #[inline(always)]
    pub(super) fn is_within(&self, range: &RayRange<F>) -> F::Mask {
        self.t.gt(range.t_min) & self.t.lt(range.t_max)
    }

    /// Where t has the stated tolerance.
    #[inline(always)]
    pub(super) fn is_exact(&self) -> F::Mask {
        self.error.lt(self.t.abs().times(T_TOLERANCE) * self.determinant)
    }

    /// Bound on the error of t.
    pub(super) fn bound(&self) -> F {
        self.error / self.determinant
    }

    /// t, no less than at the nearest corner and no more than at the farthest.
    #[inline(always)]
    pub(super) fn clamped(&self) -> F {
        self.t.max(self.near).min(self.far)
    }
}

/// Decides on the `candidates`, a bit each: pairs that do not certainly pass by each other. Where `any` hit will do,
/// its t need not be known.
#[inline(always)]
pub(crate) fn decide<F: Real<Element = f32>>(
    sheared: &Sheared<F>,
    edges: &Edges<F>,
    range: &RayRange<F>,
    (candidates, any): (u32, bool),
) -> Decision<F> {
    let found = distance(sheared, edges, range.depth);
    let zero = found.t.zero();
    let passes = edges.low.gt(zero) | edges.high.lt(zero);
    let inside = edges.are_certain(found.edge);
    let known = found.is_decided(range) & found.is_exact();
    let known = if any { known | found.is_decided_exactly(range) & inside } else { known };
    let within = found.is_within(range);
    let candidates = candidates & !found.is_before(range).bits();
    Decision {
        t: found.clamped(),
        certain: candidates & (passes & within & known).bits(),
        open: candidates & !(passes & (!within & found.is_decided(range) | known)).bits(),
        inside,
    }
}
