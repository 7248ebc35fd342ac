//! The reflection model of Blinn (*Models of Light Reflection for Computer Synthesized Pictures*,
//! 1977): a diffuse term and a highlight about the half vector.

pub mod lanes;

use glam::Vec3;

use crate::math::float::{dot, normalize};

/// A material's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Weight of the highlight.
    pub ks: f32,
    /// Weight of the diffuse reflection.
    pub kd: f32,
    /// Exponent of the highlight.
    pub exponent: f32,
    /// Diffuse colour, where no texture replaces it.
    pub color: Vec3,
    /// Weight of the mirror ray.
    pub kr: f32,
}

/// Light reflected to `view` from `to_light` (both of unit length, away from the surface), for a
/// light of strength 1: kd D max(0, N.L) + ks max(0, N.H)^exponent.
#[inline]
pub fn reflect(material: &Material, color: Vec3, normal: Vec3, view: Vec3, to_light: Vec3) -> Vec3 {
    let diffuse = color * (material.kd * dot(normal, to_light).max(0.0));
    if material.ks == 0.0 {
        return diffuse;
    }
    // Opposite directions have no half vector: `normalize` gives zero, and no highlight.
    let half = normalize(view + to_light);
    diffuse + Vec3::splat(material.ks * power(dot(normal, half).clamp(0.0, 1.0), material.exponent))
}

/// `base` in 0 to 1 to the power of `exponent` >= 0, the same on every machine.
///
/// Whole exponents, which nearly all are, go by repeated squaring in double precision: exponents
/// up to 10^6 keep single precision.
#[inline]
fn power(base: f32, exponent: f32) -> f32 {
    let whole = exponent as u32;
    if whole as f32 != exponent {
        return libm::powf(base, exponent);
    }
    let (mut square, mut product, mut left) = (f64::from(base), 1.0_f64, whole);
    while left > 0 {
        if left & 1 == 1 {
            product *= square;
        }
        square *= square;
        left >>= 1;
    }
    product as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATTE: Material = Material { ks: 0.0, kd: 0.5, exponent: 1.0, color: Vec3::ONE, kr: 0.0 };

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

    #[test]
    fn the_terms_follow_the_formula() {
        let tilted = normalize(Vec3::new(1.0, 1.0, 0.0));
        let diffuse = reflect(&MATTE, Vec3::new(1.0, 0.5, 0.0), Vec3::Y, Vec3::Y, tilted);
        assert!((diffuse - Vec3::new(0.5, 0.25, 0.0) * tilted.y).length() < 1e-6);
        let shiny = Material { ks: 0.8, exponent: 50.0, ..MATTE };
        let mirrored = Vec3::new(-tilted.x, tilted.y, 0.0);
        let highlight = reflect(&shiny, Vec3::ZERO, Vec3::Y, mirrored, tilted);
        assert!((highlight - 0.8).length() < 1e-5, "full where the half vector is the normal");
    }

    #[test]
    fn hc36_a_light_behind_the_view_gives_no_nan() {
        let shiny = Material { ks: 1.0, exponent: 1e6, ..MATTE };
        assert!(reflect(&shiny, Vec3::ONE, Vec3::Y, Vec3::X, Vec3::NEG_X).is_finite());
    }
}
