//! The watertight test itself, for one, eight or sixteen pairs of a ray and a triangle.

use super::{T_TOLERANCE, UNDERFLOW};
use crate::math::float::gamma;
use crate::math::real::{Mask, Real};

/// The corners of a triangle in the sheared space of its ray.
#[derive(Clone, Copy)]
pub(crate) struct Sheared<F> {
    pub(crate) xy: [[F; 2]; 3],
    /// t at the corners.
    pub(crate) z: [F; 3],
}

/// Edge functions of a pair, the smallest and largest of them, and their sum.
#[derive(Clone, Copy)]
pub(crate) struct Edges<F> {
    pub(crate) all: [F; 3],
    pub(super) determinant: F,
    pub(super) low: F,
    pub(super) high: F,
}

/// The ray of a pair: the scale of z in sheared space to a depth, and the range of t.
#[derive(Clone, Copy)]
pub(crate) struct RayRange<F> {
    pub(crate) depth: F,
    pub(crate) t_min: F,
    pub(crate) t_max: F,
}

/// The meeting of a ray with a triangle's plane.
pub(super) struct Distance<F> {
    pub(super) t: F,
    /// The magnitude of the determinant; the bound on the error of t is `error` divided by it.
    /// Comparisons multiply instead: division takes longer, and if all corners have one z it gives
    /// a subnormal number, on which processors take a hundred times as long.
    determinant: F,
    error: F,
    /// Bound on the errors of the edge functions.
    pub(super) edge: F,
    /// The smallest and largest t of the corners.
    pub(super) near: F,
    pub(super) far: F,
}

/// The decisions of single precision on pairs, a bit each.
pub(crate) struct Decision<F: Real> {
    pub(crate) t: F,
    /// Pairs that certainly meet, at t within the ray's range.
    pub(crate) certain: u32,
    /// Pairs that single precision does not decide.
    pub(crate) open: u32,
    /// Those of the open pairs in which the ray certainly passes through the triangle.
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

    /// The lanes whose ray certainly misses: two edge functions have opposite signs, which rounding
    /// cannot reverse. A NaN is not outside.
    #[inline(always)]
    pub(crate) fn outside(&self) -> F::Mask {
        let zero = self.low.zero();
        self.low.lt(zero) & self.high.gt(zero)
    }

    /// The lanes whose ray certainly passes through, given a bound on the errors of the edge
    /// functions.
    #[inline(always)]
    pub(super) fn are_certain(&self, bound: F) -> F::Mask {
        self.low.gt(bound) | self.high.lt(-bound)
    }

    /// As [`Self::outside`], for corners with these x and y.
    #[inline(always)]
    pub(crate) fn outside_of(xy: &[[F; 2]; 3]) -> F::Mask {
        Self::new(xy).outside()
    }
}

/// The smallest, middle and largest. The sum of the first and the last, plus the middle, does not
/// depend on which corner is first, and its sign reverses with the numbers.
#[inline(always)]
fn sorted<F: Real>([a, b, c]: [F; 3]) -> (F, F, F) {
    let (low, high) = (a.min(b), a.max(b));
    (low.min(c), low.max(high.min(c)), high.max(c))
}

/// The meetings of rays with the planes of their triangles, with the error bound of the module
/// documentation. NaN where unknown.
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
    /// The lanes in which every corner, and so the hit, lies before the range. A corner's z has the
    /// right sign, and is off by three roundings. A NaN is not before.
    #[inline(always)]
    pub(super) fn is_before(&self, range: &RayRange<F>) -> F::Mask {
        self.far.lt(range.t_min.min(self.far.zero()).times(1.0 + gamma(8)))
    }

    /// The lanes in which the bound proves whether t is within the range.
    #[inline(always)]
    pub(super) fn is_decided(&self, range: &RayRange<F>) -> F::Mask {
        self.is_off_ends(range, self.error)
    }

    /// The lanes in which the exact t, rounded, is within the range if t is: the bound is many
    /// times the rounding error.
    #[inline(always)]
    fn is_decided_exactly(&self, range: &RayRange<F>) -> F::Mask {
        self.is_off_ends(range, self.error + self.error)
    }

    #[inline(always)]
    fn is_off_ends(&self, range: &RayRange<F>, error: F) -> F::Mask {
        let from = |end: F| ((self.t - end).abs() * self.determinant).gt(error);
        from(range.t_max) & from(range.t_min)
    }

    /// The lanes in which t is within the range.
    #[inline(always)]
    pub(super) fn is_within(&self, range: &RayRange<F>) -> F::Mask {
        self.t.gt(range.t_min) & self.t.lt(range.t_max)
    }

    /// The lanes in which t has the stated tolerance.
    #[inline(always)]
    pub(super) fn is_exact(&self) -> F::Mask {
        self.error.lt(self.t.abs().times(T_TOLERANCE) * self.determinant)
    }

    /// Bound on the error of t.
    pub(super) fn bound(&self) -> F {
        self.error / self.determinant
    }

    /// t, clamped to the range of the corners.
    #[inline(always)]
    pub(super) fn clamped(&self) -> F {
        self.t.max(self.near).min(self.far)
    }
}

/// Decides on the `candidates`, a bit each: pairs that do not certainly miss. If `any` hit
/// suffices, t need not be known.
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
