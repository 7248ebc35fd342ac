//! The reflection model of Blinn (*Models of Light Reflection for Computer Synthesized Pictures*,
//! 1977): a diffuse term and a highlight around the half vector.

use glam::Vec3;

use crate::math::{Mask, Real, Single, Vector};

/// The constants of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Weight of the highlight.
    pub ks: f32,
    /// Weight of the diffuse reflection.
    pub kd: f32,
    /// Exponent of the highlight.
    pub exponent: f32,
    /// Base colour, unless a texture replaces it: that of diffuse light.
    pub color: Vec3,
    /// Weight of the mirror ray.
    pub kr: f32,
    /// Colour of the highlight and of mirrored light.
    pub tint: Vec3,
    /// Emission, which is visible but does not light other surfaces.
    pub emission: Vec3,
    /// The share of ambient light that is scattered: what is mirrored is not.
    pub ambient: f32,
}

/// The reflection parameters of a material.
#[derive(Clone, Copy, Debug)]
pub struct Reflection<F: Single> {
    /// Weight of the highlight.
    pub ks: F,
    /// Weight of the diffuse reflection.
    pub kd: F,
    /// Exponent of the highlight.
    pub exponent: F,
    /// Colour of the highlight and of mirrored light.
    pub tint: Vector<F>,
}

impl<F: Single> Reflection<F> {
    /// The parameters in lane `i`.
    pub fn lane(&self, i: usize) -> Reflection<f32> {
        let Self { ks, kd, exponent, tint } = self;
        let (ks, kd, exponent) = (ks.lane(i), kd.lane(i), exponent.lane(i));
        Reflection { ks, kd, exponent, tint: tint.lane(i).into() }
    }
}

/// Light from direction `to_light` reflected towards `view` (unit vectors away from the surface),
/// for a light of strength 1: kd D max(0, N.L) + ks T max(0, N.H)^exponent.
#[inline(always)]
pub fn reflect<F: Single>(
    material: &Reflection<F>,
    color: Vector<F>,
    normal: Vector<F>,
    view: Vector<F>,
    to_light: Vector<F>,
) -> Vector<F> {
    let zero = color.x.zero();
    let cosine = normal.dot(to_light);
    let diffuse = color.scale(material.kd * F::select(cosine.gt(zero), cosine, zero));
    let is_shiny = material.ks.ne(zero);
    if !is_shiny.any() {
        return diffuse;
    }
    // Opposite directions have no half vector: `normalize` returns zero, so there is no
    // highlight.
    let half = (view + to_light).normalize();
    let cosine = normal.dot(half);
    let cosine = F::select(cosine.lt(zero), zero, cosine);
    let one = zero.same(1.0);
    let cosine = F::select(cosine.gt(one), one, cosine);
    let highlight = material.ks * power(cosine, material.exponent);
    let both = diffuse + material.tint.scale(highlight);
    Vector::select(is_shiny, both, diffuse)
}

/// `base`, 0 to 1, to the power of `exponent` >= 0, with the same bits on every machine.
///
/// Whole exponents, the common case, use repeated squaring in double precision: the result keeps
/// single precision up to exponents of 10^6.
#[inline(always)]
fn power<F: Single>(base: F, exponent: F) -> F {
    let first = exponent.lane(0);
    if is_whole(first) && !exponent.ne(exponent.same(first)).any() {
        return F::narrow(whole_power(base.widen(), first as u32));
    }
    // Materials differ, or the exponent is not whole.
    let mut powers = base;
    for lane in 0..F::LANES {
        let (base, exponent) = (base.lane(lane), exponent.lane(lane));
        let power = match is_whole(exponent) {
            true => whole_power(f64::from(base), exponent as u32) as f32,
            false => libm::powf(base, exponent),
        };
        powers.set_lane(lane, power);
    }
    powers
}

#[inline(always)]
fn is_whole(exponent: f32) -> bool {
    exponent as u32 as f32 == exponent
}

#[inline(always)]
fn whole_power<F: Real<Element = f64>>(base: F, whole: u32) -> F {
    let (mut square, mut product, mut left) = (base, base.same(1.0), whole);
    while left > 0 {
        if left & 1 == 1 {
            product = product * square;
        }
        square = square * square;
        left >>= 1;
    }
    product
}

impl Material {
    /// Reflects and emits nothing.
    pub const BLACK: Self = Self {
        ks: 0.0,
        kd: 0.0,
        exponent: 0.0,
        color: Vec3::ZERO,
        kr: 0.0,
        tint: Vec3::ONE,
        emission: Vec3::ZERO,
        ambient: 1.0,
    };

    /// Whether it emits light, colours its highlights or scatters only a share of ambient light.
    pub fn is_special(&self) -> bool {
        let special = |of: &Self| (of.emission, of.tint, of.ambient);
        special(self) != special(&Self::BLACK)
    }

    /// The reflection parameters.
    pub fn reflection(&self) -> Reflection<f32> {
        let Self { ks, kd, exponent, tint, .. } = *self;
        Reflection { ks, kd, exponent, tint: tint.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn powers_agree_with_the_library() {
        for exponent in [0.0_f32, 1.0, 2.0, 20.0, 20.5, 1000.0, 1e6] {
            for base in [0.0_f32, 0.1, 0.5, 0.9, 0.999_999, 1.0] {
                let expected = f64::from(base).powf(f64::from(exponent));
                let error = (f64::from(power(base, exponent)) - expected).abs();
                assert!(error <= 3e-6 * expected + 1e-38, "{base}^{exponent}");
            }
        }
    }
}
