//! Arithmetic on single values and glam's vectors: [`Vector`] at width one.

use glam::{DVec3, Vec3};

use super::{Real, Vector};

pub use super::bounds::{MAX_COORDINATE, UNIT_ROUNDOFF, error_of_offset, gamma, offset_of_error};

/// The larger of two numbers, neither of them NaN: one instruction, unlike [`f32::max`].
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    Real::max(a, b)
}

/// The smaller of two numbers, neither of them NaN: one instruction, unlike [`f32::min`].
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    Real::min(a, b)
}

/// See [`Vector::max_abs`].
#[inline(always)]
pub fn max_abs(v: Vec3) -> f32 {
    Vector::from(v).max_abs()
}

/// See [`Vector::dot`].
#[inline(always)]
pub fn dot(a: Vec3, b: Vec3) -> f32 {
    Vector::from(a).dot(b.into())
}

/// See [`Vector::dot`].
#[inline(always)]
pub fn dot_f64(a: DVec3, b: DVec3) -> f64 {
    Vector::from(a).dot(b.into())
}

/// See [`Vector::normalize`].
#[inline]
pub fn normalize(v: Vec3) -> Vec3 {
    Vector::from(v).normalize().into()
}

/// See [`Vector::normalize_wide`].
#[inline]
pub fn normalize_f64(v: DVec3) -> DVec3 {
    Vector::from(v).normalize_wide().into()
}

/// See [`Vector::offset_origin`].
#[inline]
pub fn offset_origin(point: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    Vector::from(point).offset_origin(error.into(), normal.into(), direction.into()).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hc08_sums_of_three_do_not_depend_on_their_order() {
        let sum = |[x, y, z]: [f32; 3]| Vector::new(x, y, z).element_sum();
        for i in 0..10_000 {
            let stream = crate::math::random::Stream { seed: 8, pixel: i, sample: 0, bounce: 0 };
            let [a, b, c, d] = stream.uniform(0);
            let (a, b, c) =
                (a - 0.5, (b - 0.5) * 1e-3, (c - 0.5) * if d < 0.5 { 1.0 } else { 1e3 });
            let orders = [[a, b, c], [a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]];
            for [x, y, z] in orders {
                assert_eq!(sum([x, y, z]), sum([a, b, c]));
                let wide = [x, y, z].map(|v| f64::from(v) / 3.0);
                let first = [a, b, c].map(|v| f64::from(v) / 3.0);
                let sums = [wide, first].map(|[x, y, z]| Vector::new(x, y, z).element_sum());
                assert_eq!(sums[0], sums[1]);
            }
            let exact = f64::from(a) + f64::from(b) + f64::from(c);
            let size = a.abs() + b.abs() + c.abs();
            assert!((f64::from(sum([a, b, c])) - exact).abs() <= f64::from(gamma(2) * size));
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
