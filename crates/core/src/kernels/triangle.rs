//! Where a ray meets a triangle.
//!
//! A hit is defined in exact arithmetic ([`exact`]): the ray and the corners are taken as the
//! numbers of single precision that they are, the triangle is closed, and t is rounded once when it
//! is returned. Two triangles that share an edge leave no gap, whatever the ray, and coplanar triangles
//! are met at the same t.
//!
//! - [`filter`] tests one ray against the eight triangles of a leaf, in single precision and with
//!   bounds: certain hits with an interval for t, certain misses, and open pairs.
//! - [`settle`](meet) decides nearly all open pairs in double precision, also with bounds, and
//!   computes the t of hits.
//! - [`exact`] decides the rest. It takes microseconds a pair, and happens for a few rays in
//!   millions, unless rays are aimed at edges.
//!
//! A ray through an edge meets both triangles there, and [crosses](crossing()) one of them.

pub mod exact;
pub mod filter;
pub(crate) mod settle;

use glam::{DVec3, Vec3};

use crate::math::float::{gamma, max, normalize_f64};
pub use filter::{LaneHits, ShearedSpace};
pub(crate) use settle::settled;
pub use settle::{crossing, meet};

/// The least normal number: a bound on what underflow adds to a sum of a few products, far above
/// the true error, as processors divide subnormal numbers a hundred times slower.
const UNDERFLOW: f32 = f32::MIN_POSITIVE;

/// Whether the corners lie on one line, exactly: such a triangle has no normal and no inside.
pub fn is_degenerate([a, b, c]: &[Vec3; 3]) -> bool {
    let (ab, ac) = (b - a, c - a);
    let cross = ab.cross(ac);
    // The differences are rounded once, products and sums of them once each: an area above their
    // error is certain, and nearly every triangle ends here. Products that underflow have larger
    // errors.
    let certain = gamma(8) * max(ab.length_squared(), ac.length_squared()) + UNDERFLOW;
    if cross.abs().max_element() > certain {
        return false;
    }
    let collinear = |x: usize, y: usize| {
        let p = |v: &Vec3| robust::Coord { x: f64::from(v[x]), y: f64::from(v[y]) };
        robust::orient2d(p(a), p(b), p(c)) == 0.0
    };
    collinear(0, 1) && collinear(1, 2) && collinear(2, 0)
}

/// The unit normal of a triangle that is not degenerate, on the side from which its corners run
/// counter-clockwise.
pub fn normal([a, b, c]: &[Vec3; 3]) -> DVec3 {
    let [a, b, c] = [a, b, c].map(|v| v.as_dvec3());
    normalize_f64((b - a).cross(c - a))
}

#[cfg(test)]
mod tests;
