//! Bounds on rounding errors, after Higham, *Accuracy and Stability of Numerical Algorithms*
//! (2002), chapter 3, as Pharr, Jakob and Humphreys apply it to ray tracing (*Physically Based
//! Rendering*, section 6.8).
//!
//! Nothing here is a tuned constant: every tolerance in the renderer is one of these bounds times
//! a magnitude that the computation met.

use glam::{DVec3, Vec3};

/// The unit roundoff of `f32`: one operation is off by at most this factor of its result.
pub const UNIT_ROUNDOFF: f32 = f32::EPSILON * 0.5;

/// Bound on the relative error of `n` operations in a row: n u / (1 - n u).
pub const fn gamma(n: u32) -> f32 {
    let nu = n as f32 * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}

/// The largest absolute coordinate that a scene may hold, in scene units: 2^40.
///
/// The watertight triangle test forms sums of products of three coordinate differences; up to this
/// size they stay below the largest `f32`.
pub const MAX_COORDINATE: f32 = (1_u64 << 40) as f32;

/// The larger of two numbers of which neither is a NaN: one instruction, unlike [`f32::max`].
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers of which neither is a NaN: one instruction, unlike [`f32::min`].
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The largest absolute component.
#[inline(always)]
pub fn max_abs(v: Vec3) -> f32 {
    max(v.x.abs(), max(v.y.abs(), v.z.abs()))
}

/// Sixteen roundings of double precision, as a factor of the numbers that are rounded.
pub(super) const DOUBLE_ROUNDINGS: f32 = 16.0 * f64::EPSILON as f32;

/// Bound on the error of each coordinate of `point` once it is rounded to single precision, where
/// it was computed in double precision from coordinates up to `size`.
#[inline]
pub fn rounding_error(point: DVec3, size: f32) -> Vec3 {
    point.as_vec3().abs() * gamma(2) + DOUBLE_ROUNDINGS * size
}

/// `a + b + c`, the same bits in whatever order they are given: no axis of space is the first.
#[inline(always)]
pub fn sum(a: f32, b: f32, c: f32) -> f32 {
    let (low, high) = (min(a, b), max(a, b));
    (min(low, c) + max(low, min(high, c))) + max(high, c)
}

/// As [`sum`], in double precision.
#[inline(always)]
pub fn sum_f64(a: f64, b: f64, c: f64) -> f64 {
    let min = |a: f64, b: f64| if a < b { a } else { b };
    let max = |a: f64, b: f64| if a > b { a } else { b };
    let (low, high) = (min(a, b), max(a, b));
    (min(low, c) + max(low, min(high, c))) + max(high, c)
}

/// The scalar product, added by [`sum`].
#[inline(always)]
pub fn dot(a: Vec3, b: Vec3) -> f32 {
    sum(a.x * b.x, a.y * b.y, a.z * b.z)
}

/// The scalar product, added by [`sum_f64`].
#[inline(always)]
pub fn dot_f64(a: DVec3, b: DVec3) -> f64 {
    sum_f64(a.x * b.x, a.y * b.y, a.z * b.z)
}

/// `v` with length 1, or zero where `v` has no direction.
///
/// The length is taken in double precision, so that neither tiny nor huge vectors lose it.
#[inline]
pub fn normalize(v: Vec3) -> Vec3 {
    // No square of a single-precision number overflows or vanishes in double precision.
    let v = v.as_dvec3();
    let length = dot_f64(v, v).sqrt();
    if length > 0.0 && length.is_finite() { (v / length).as_vec3() } else { Vec3::ZERO }
}

/// `v` with length 1, or zero where `v` has no direction.
#[inline]
pub fn normalize_f64(v: DVec3) -> DVec3 {
    let size = v.abs().max_element();
    if !(size > 0.0 && size.is_finite()) {
        return DVec3::ZERO;
    }
    let scaled = v / size;
    scaled / dot_f64(scaled, scaled).sqrt()
}

/// Both roots of a t^2 - 2 b t + c = 0 in rising order, given b, c, a > 0 and `root` =
/// sqrt(b^2 - a c).
///
/// Neither root subtracts nearly equal numbers (Press et al., *Numerical Recipes*, section 5.6).
#[inline]
pub fn stable_roots(a: f64, b: f64, c: f64, root: f64) -> (f64, f64) {
    let q = b + root.copysign(b);
    if q == 0.0 {
        return (0.0, 0.0);
    }
    let (t0, t1) = (c / q, q / a);
    if t0 < t1 { (t0, t1) } else { (t1, t0) }
}

/// The steepest crease, as the tangent of the angle between the normals on its sides, at which a
/// moved origin is still in front of both.
pub(super) const STEEPEST_CREASE: f32 = 4.0;

/// Moves `point` off its surface along `normal`, to the side that `direction` points to, just far
/// enough that the exact surface stays behind.
///
/// `error` bounds the rounding error of each coordinate of `point`. To leave its own surface, the
/// point would have to move by that error box's extent along the normal (Pharr et al.,
/// `OffsetRayOrigin`). But error along the surface can carry a point of an edge behind the
/// neighbour that rises there; moving by [`STEEPEST_CREASE`] times the size of the box brings it
/// before that one too. Each coordinate is then rounded away from the surface.
#[inline]
pub fn offset_origin(point: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    move_along(point, normal, direction, STEEPEST_CREASE * sum(error.x, error.y, error.z))
}

/// The error of each coordinate that [`offset_origin`] moves a point by `distance` for.
pub const fn error_of_offset(distance: f32) -> f32 {
    distance / (3.0 * STEEPEST_CREASE)
}

/// As [`offset_origin`], for the point where a ray ends: its own surface must stay behind, but
/// what rises beside it may be met, so the error box's extent along the normal is enough.
#[inline]
pub fn offset_end(point: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    move_along(point, normal, direction, dot(normal.abs(), error))
}

/// `point` moved by `distance` along `normal`, to the side that `direction` points to, and rounded
/// away from where it was.
#[inline(always)]
fn move_along(point: Vec3, normal: Vec3, direction: Vec3, distance: f32) -> Vec3 {
    let side = if dot(direction, normal) < 0.0 { -distance } else { distance };
    let shift = normal * side;
    Vec3::new(
        round_away(point.x + shift.x, shift.x),
        round_away(point.y + shift.y, shift.y),
        round_away(point.z + shift.z, shift.z),
    )
}

/// The neighbour of `x` on the side of `shift`'s sign, or `x` itself where there is no shift.
#[inline(always)]
fn round_away(x: f32, shift: f32) -> f32 {
    if shift > 0.0 {
        x.next_up()
    } else if shift < 0.0 {
        x.next_down()
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gamma_bounds_a_sum_of_rounded_terms() {
        let terms: Vec<f32> = (1..=100).map(|i| 1.0 / i as f32).collect();
        let single: f32 = terms.iter().sum();
        let double: f64 = terms.iter().map(|&x| f64::from(x)).sum();
        assert!((f64::from(single) - double).abs() <= f64::from(gamma(99)) * double);
    }

    #[test]
    fn hc08_sums_of_three_do_not_depend_on_their_order() {
        for i in 0..10_000 {
            let stream = crate::math::random::Stream { seed: 8, pixel: i, sample: 0, bounce: 0 };
            let [a, b, c, d] = stream.uniform(0);
            let (a, b, c) =
                (a - 0.5, (b - 0.5) * 1e-3, (c - 0.5) * if d < 0.5 { 1.0 } else { 1e3 });
            let orders = [[a, b, c], [a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]];
            for [x, y, z] in orders {
                assert_eq!(sum(x, y, z), sum(a, b, c));
                let wide = [x, y, z].map(|v| f64::from(v) / 3.0);
                let first = [a, b, c].map(|v| f64::from(v) / 3.0);
                let sums = [wide, first].map(|[x, y, z]| sum_f64(x, y, z));
                assert_eq!(sums[0], sums[1]);
            }
            let exact = f64::from(a) + f64::from(b) + f64::from(c);
            let size = a.abs() + b.abs() + c.abs();
            assert!((f64::from(sum(a, b, c)) - exact).abs() <= f64::from(gamma(2) * size));
        }
    }

    #[test]
    fn roots_keep_their_digits_when_b_squared_swamps_ac() {
        let (near, far) = stable_roots(1.0, 1e8, 1.0, (1e16_f64 - 1.0).sqrt());
        assert!((near - 5e-9).abs() < 1e-24 && (far - 2e8).abs() < 1e-6, "{near} {far}");
    }

    #[test]
    fn offset_leaves_the_surface_behind_on_either_side() {
        let (p, n) = (Vec3::new(1e5, 3.0, -7e-4), Vec3::new(0.6, 0.0, 0.8));
        let error = p.abs() * gamma(7);
        for d in [n, -n] {
            let moved = offset_origin(p, error, n, d) - p;
            assert!(moved.dot(d) >= n.abs().dot(error));
        }
    }

    #[test]
    fn directions_survive_extreme_lengths() {
        for scale in [1e-38_f32, 1e-20, 1.0, 1e20, 1e38] {
            let v = normalize(Vec3::new(1.0, 2.0, -2.0) * scale);
            assert!((v.length() - 1.0).abs() < 1e-6, "{scale}: {v}");
        }
        assert_eq!(normalize(Vec3::ZERO), Vec3::ZERO);
        for scale in [1e-300_f64, 1e300] {
            let v = normalize_f64(DVec3::new(1.0, 2.0, -2.0) * scale);
            assert!((v.length() - 1.0).abs() < 1e-15, "{scale}: {v}");
        }
    }
}
