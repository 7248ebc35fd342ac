//! Where rays meet the planes of faces, in double precision.

use std::cmp::Ordering;

use wavecrest_api::exact::{Expansion, determinant};
use wavecrest_api::glam::DVec3;

/// A determinant counts as computed if its terms add up to at most so many times its size. Each term has
/// eight roundings at most, so the determinant has a relative error of at most 2^-44.
const CERTAIN: f64 = 64.0;

/// The t at which the line from `origin` along `direction` meets the plane through three points, with a
/// relative error of at most 2^-43. Not finite if it is parallel to that.
#[inline(always)]
pub(crate) fn meeting(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (u, v, away) = (b - a, c - a, a - origin);
    let ([above, most], [slope, most_slope]) = (rounded(u, v, away), rounded(u, v, direction));
    if most <= CERTAIN * above.abs() && most_slope <= CERTAIN * slope.abs() {
        return above / slope;
    }
    exact_meeting(origin, direction, [a, b, c])
}

#[cold]
#[inline(never)]
fn exact_meeting(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let [u, v, away] = [(b, a), (c, a), (a, origin)].map(difference);
    let slope = determinant(&u, &v, &exact(direction));
    determinant(&u, &v, &away).value() / slope.value()
}

/// On which side a direction leaves the plane through three points: greater for that of its normal.
pub(crate) fn side(direction: DVec3, [a, b, c]: [DVec3; 3]) -> Ordering {
    let [slope, most] = rounded(b - a, c - a, direction);
    if most <= CERTAIN * slope.abs() {
        return slope.total_cmp(&0.0);
    }
    let [u, v] = [(b, a), (c, a)].map(difference);
    determinant(&u, &v, &exact(direction)).sign()
}

/// The determinant of three columns, and the sum of the sizes of its terms.
#[inline(always)]
fn rounded(u: DVec3, v: DVec3, w: DVec3) -> [f64; 2] {
    let (p, q) = (u.abs(), v.abs());
    let sizes = DVec3::new(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x);
    [u.cross(v).dot(w), sizes.dot(w.abs())]
}

fn exact(v: DVec3) -> [Expansion; 3] {
    v.to_array().map(Expansion::from)
}

fn difference((p, q): (DVec3, DVec3)) -> [Expansion; 3] {
    let (p, q) = (exact(p), exact(q));
    [0, 1, 2].map(|k| &p[k] - &q[k])
}
