//! Triangle areas and normals.

use glam::{DVec3, Vec3};

use super::UNDERFLOW;
use crate::math::float::{gamma, max};

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
    crate::math::float::normalize_f64((b - a).cross(c - a))
}
