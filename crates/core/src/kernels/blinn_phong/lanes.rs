//! Eight reflections at a time: the operations of [`super::reflect`] in each lane, and so the same
//! bits.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f64x8};

use crate::math::lanes::{Vec3x8, narrow, widen};
use crate::math::simd::{LANES, Lanes};

/// What [`super::Material`] says of reflection, in each lane.
#[derive(Clone, Copy)]
pub struct Reflection<S: Lanes> {
    /// Weight of the highlight.
    pub ks: f32x8<S>,
    /// Weight of the diffuse reflection.
    pub kd: f32x8<S>,
    /// Exponent of the highlight.
    pub exponent: f32x8<S>,
}

/// See [`super::reflect`].
#[inline(always)]
pub fn reflect<S: Lanes>(
    material: &Reflection<S>,
    color: Vec3x8<S>,
    normal: Vec3x8<S>,
    view: Vec3x8<S>,
    to_light: Vec3x8<S>,
) -> Vec3x8<S> {
    let zero = f32x8::splat(color.x.token(), 0.0);
    let cosine = normal.dot(to_light);
    let diffuse = color.scale(material.kd * cosine.simd_gt(0.0).select(cosine, zero));
    let shiny = material.ks.simd_ne(0.0);
    if shiny.to_bitmask() & 0xFF == 0 {
        return diffuse;
    }
    let half = (view + to_light).normalize();
    let cosine = normal.dot(half);
    let cosine = cosine.simd_lt(0.0).select(zero, cosine);
    let cosine = cosine.simd_gt(1.0).select(f32x8::splat(zero.token(), 1.0), cosine);
    let highlight = material.ks * power(cosine, material.exponent);
    (diffuse + Vec3x8::new(highlight, highlight, highlight)).or(shiny, diffuse)
}

/// See [`super::power`].
#[inline(always)]
fn power<S: Lanes>(base: f32x8<S>, exponent: f32x8<S>) -> f32x8<S> {
    let exponents: [f32; LANES] = exponent.into();
    let first = exponents[0];
    if first as u32 as f32 == first && exponents == [first; LANES] {
        return narrow(whole_power(base, first as u32));
    }
    // Materials differ.
    let (bases, mut powers) = (<[f32; LANES]>::from(base), [0.0; LANES]);
    for lane in 0..LANES {
        powers[lane] = super::power(bases[lane], exponents[lane]);
    }
    powers.simd_into(base.token())
}

/// All bases to one whole power.
#[inline(always)]
fn whole_power<S: Lanes>(base: f32x8<S>, whole: u32) -> f64x8<S> {
    let (mut square, mut left) = (widen(base), whole);
    let mut product = f64x8::splat(base.token(), 1.0);
    while left > 0 {
        if left & 1 == 1 {
            product *= square;
        }
        square *= square;
        left >>= 1;
    }
    product
}
