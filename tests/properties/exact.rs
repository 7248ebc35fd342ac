//! Rational numbers, of which none is rounded, and what is defined in them.

use glam::Vec3;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use wavecrest_core::math::ray::Ray;

pub(crate) type Exact = BigRational;

/// The number that `x` is, which must be finite.
pub(crate) fn exact(x: f32) -> Exact {
    Exact::from_float(x).expect("it is finite")
}

pub(crate) fn exact3(v: Vec3) -> [Exact; 3] {
    v.to_array().map(exact)
}

/// Rounded once.
pub(crate) fn rounded(x: &Exact) -> f64 {
    x.to_f64().expect("every rational number is near some")
}

pub(crate) fn minus([ax, ay, az]: &[Exact; 3], [bx, by, bz]: &[Exact; 3]) -> [Exact; 3] {
    [ax - bx, ay - by, az - bz]
}

pub(crate) fn dot([ax, ay, az]: &[Exact; 3], [bx, by, bz]: &[Exact; 3]) -> Exact {
    ax * bx + ay * by + az * bz
}

pub(crate) fn cross([ax, ay, az]: &[Exact; 3], [bx, by, bz]: &[Exact; 3]) -> [Exact; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

/// The nearest number of single precision, of two the even one.
pub(crate) fn rounded_once(x: &Exact) -> f32 {
    let near = rounded(x) as f32;
    let off = |y: f32| (exact(y) - x).abs();
    [near, near.next_down(), near.next_up()]
        .into_iter()
        .filter(|y| y.is_finite())
        .min_by(|&y, &z| off(y).cmp(&off(z)).then((y.to_bits() & 1).cmp(&(z.to_bits() & 1))))
        .expect("there is a finite one")
}

/// The definition: the t at which the ray meets the closed triangle within its range.
pub(crate) fn meeting(ray: &Ray, corners: &[Vec3; 3]) -> Option<Exact> {
    let (origin, direction) = (exact3(ray.origin), exact3(ray.direction));
    let [a, b, c] = corners.map(|corner| minus(&exact3(corner), &origin));
    let sides = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| dot(&cross(p, q), &direction));
    if sides.iter().any(Signed::is_negative) && sides.iter().any(Signed::is_positive) {
        return None;
    }
    let normal = cross(&minus(&b, &a), &minus(&c, &a));
    let slope = dot(&normal, &direction);
    if slope.is_zero() {
        return None;
    }
    let t = dot(&normal, &a) / slope;
    is_within(ray, &t).then_some(t)
}

/// Whether t is within the ray's range.
pub(crate) fn is_within(ray: &Ray, t: &Exact) -> bool {
    let [start, end] = [ray.t_min, ray.t_max].map(|t| exact(t.clamp(f32::MIN, f32::MAX)));
    *t > start && *t < end
}
