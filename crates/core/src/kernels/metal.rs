//! Converts base colour, metalness and roughness, the parameters of physically based models, to
//! Blinn-Phong.
//!
//! The models differ, so the rule is our own; [`look`] states it. Both the readers of files and
//! texture look-ups use it.

use crate::math::{Real, Vector};

/// The Blinn-Phong parameters for a base colour, metalness and roughness, or for those in each lane.
/// The diffuse colour is the base colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetalParameters<D = f64> {
    /// Weight of the highlight.
    pub ks: D,
    /// Weight of the diffuse reflection.
    pub kd: D,
    /// Exponent of the highlight, a whole number.
    pub exponent: D,
    /// Weight of the mirror ray.
    pub kr: D,
    /// Colour of the highlight and of the mirror; its largest channel is 1.
    pub tint: Vector<D>,
}

/// Reflectance of smooth nonmetals at normal incidence.
pub const DIELECTRIC: f64 = 0.04;
/// The greatest exponent for any roughness. The highlight of a point light is then about a degree
/// wide.
const GREATEST_EXPONENT: f64 = 10_000.0;

/// The parameters for a base colour C, metalness m and roughness r, all from 0 to 1. With the
/// reflectance at normal incidence F = 0.04 (1 - m) + m C, and f its largest channel:
///
/// - the highlight and the mirror have the colour F / f, so metals tint them,
/// - kr = m f (1 - r)^2: smooth metals are mirrors,
/// - kd = 1 - m (1 - r)^2, with the diffuse colour C: light that is not mirrored is scattered,
/// - exponent n = 2 / r^4 - 2, rounded, at most 10 000: the width of the highlight of physically based models
///   (Karis, *Specular BRDF Reference*, 2013),
/// - ks = (1 - r) min(1, f (n + 2) / 8): the height of that highlight, reduced with roughness.
#[inline(always)]
pub fn look<D: Real>(color: Vector<D>, metallic: D, roughness: D) -> MetalParameters<D> {
    let number = |value| metallic.same_rounded(value);
    let (zero, one, two) = (metallic.zero(), number(1.0), number(2.0));
    let dielectric = (one - metallic) * number(DIELECTRIC);
    let straight = Vector::new(dielectric, dielectric, dielectric) + color.scale(metallic);
    let greatest = straight.x.max(straight.y.max(straight.z));
    let mirrored = metallic * (one - roughness) * (one - roughness);
    let kr = mirrored * greatest;
    let alpha = roughness * roughness;
    let exponent = (two / (alpha * alpha) - two).min(number(GREATEST_EXPONENT));
    let whole = exponent.floor();
    let exponent = D::select((exponent - whole).lt(number(0.5)), whole, whole + one);
    let height = (greatest * (exponent + two) / number(8.0)).min(one);
    let is_tinted = greatest.gt(zero);
    MetalParameters {
        ks: (one - roughness) * height,
        kd: one - mirrored,
        exponent,
        kr,
        tint: Vector::select(is_tinted, straight.over(greatest), Vector::new(one, one, one)),
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;

    fn look(color: DVec3, metallic: f64, roughness: f64) -> MetalParameters {
        super::look(color.into(), metallic, roughness)
    }

    #[test]
    fn looks_follow_the_rule() {
        let white = |metallic, roughness| look(DVec3::ONE, metallic, roughness);
        let matte = white(0.0, 1.0);
        assert_eq!((matte.kd, matte.ks, matte.kr, matte.exponent), (1.0, 0.0, 0.0, 0.0));
        let mirror = white(1.0, 0.0);
        assert_eq!((mirror.kd, mirror.kr, mirror.exponent), (0.0, 1.0, 10_000.0));
        let plastic = white(0.0, 0.5);
        assert_eq!((plastic.kd, plastic.kr, plastic.exponent), (1.0, 0.0, 30.0));
        assert!((plastic.ks - 0.08).abs() < 1e-12);
    }

    #[test]
    fn metals_are_tinted_and_nothing_gains_light() {
        let gold = DVec3::new(0.9, 0.6, 0.3);
        assert!((DVec3::from(look(gold, 1.0, 0.2).tint) - gold / 0.9).length() < 1e-12);
        assert!((DVec3::from(look(gold, 0.0, 0.2).tint) - DVec3::ONE).length() < 1e-12);
        for color in [DVec3::ZERO, gold, DVec3::ONE] {
            for metallic in [0.0, 0.3, 1.0] {
                for roughness in [0.0, 1e-9, 0.2, 0.7, 1.0] {
                    let MetalParameters { ks, kd, exponent, kr, tint } =
                        look(color, metallic, roughness);
                    assert!((0.0..=1.0).contains(&ks) && (0.0..=1.0).contains(&kr));
                    assert!(kd >= 0.0 && kd + kr <= 1.0 + 1e-12, "{color} {metallic} {roughness}");
                    assert!((0.0..=10_000.0).contains(&exponent));
                    let tint = DVec3::from(tint);
                    assert!(tint.is_finite() && tint.max_element() <= 1.0);
                    let single: Vector<f32> = color.as_vec3().into();
                    let single = super::look(single, metallic as f32, roughness as f32);
                    let MetalParameters { ks, kd, exponent, kr, tint } = single;
                    assert!((0.0..=1.0).contains(&ks) && (0.0..=1.0).contains(&kr));
                    assert!(kd >= 0.0 && kd + kr <= 1.0 + 1e-6, "{color} {metallic} {roughness}");
                    assert!((0.0..=10_000.0).contains(&exponent));
                    assert!(Vec3::from(tint).max_element() <= 1.0);
                }
            }
        }
    }
}
