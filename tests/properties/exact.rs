//! Rational numbers, of which none is rounded.

use glam::Vec3;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};

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
