//! Transparent surfaces: light that goes straight on, and light that is refracted.
//!
//! Refraction is that of Whitted, *An Improved Illumination Model for Shaded Display* (1980), with
//! the reflectance of smooth dielectrics by Fresnel's equations for unpolarised light. The front
//! of a surface is its exterior and its back the interior.

use glam::{DVec3, Vec3};

use super::ShadingPoint;
use crate::math::float::{dot_f64, normalize_f64};

/// How a surface lets light through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transparency {
    /// The share of a ray's light that comes from the surface, 0 to 1: the rest comes from straight
    /// behind it.
    pub opacity: f32,
    /// Weight of the light that is not scattered at the surface, but refracted and mirrored by
    /// Fresnel's equations.
    pub kt: f32,
    /// Index of refraction of the inside, relative to the outside.
    pub ior: f32,
    /// Colour of refracted light.
    pub color: Vec3,
    /// Whether the base colour tints refracted light as well.
    pub tinted: bool,
    /// Light absorbed inside, by channel, per scene unit (Beer's law).
    pub absorption: Vec3,
    /// Whether the surface is a thin sheet of its material, both sides of which are met at once: no
    /// ray changes its direction there.
    pub thin: bool,
}

/// Refracted light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refracted {
    /// Its weight.
    pub weight: Vec3,
    /// The direction away from the viewer that it comes from, of unit length: that of the ray, to
    /// the last bit, where nothing bends it.
    pub direction: Vec3,
    /// Whether it was bent about the shading normal, not the geometric one.
    pub smooth: bool,
    /// The index of refraction on the viewer's side over that beyond.
    pub ratio: f64,
}

impl Transparency {
    /// How light along `point.view`, towards the viewer, is made up: the weight of mirrored light by
    /// Fresnel's equations alone, and refracted light, if not all is mirrored. `iors` are the indices of
    /// refraction on the viewer's side and beyond, of which a thin sheet takes its own.
    pub fn split(&self, point: &ShadingPoint<f32>, iors: [f32; 2]) -> (f32, Option<Refracted>) {
        let [view, normal, shading] =
            [point.view, point.normal, point.shading_normal].map(|v| Vec3::from(v).as_dvec3());
        let [before, beyond] = if self.thin { [1.0, self.ior] } else { iors }.map(f64::from);
        let ratio = before / beyond;
        let through = |normal| self.through(view, normal, ratio);
        // An interpolated normal may bend a ray to its own side.
        let leaves = |direction: DVec3| dot_f64(direction, normal) < 0.0;
        let ((mirrored, direction), smooth) = match through(shading) {
            (_, Some(direction)) if !leaves(direction) => (through(normal), false),
            found => (found, true),
        };
        let weight = f64::from(self.kt) * (1.0 - mirrored);
        let refracted = direction.filter(|&direction| weight > 0.0 && leaves(direction));
        let refracted = refracted.map(|direction| Refracted {
            weight: self.tint(point.color.into()) * weight as f32,
            direction: direction.as_vec3(),
            smooth,
            ratio,
        });
        ((f64::from(self.kt) * mirrored) as f32, refracted)
    }

    /// The colour of refracted light at a point with this base colour, which counts once on the way
    /// into a solid and out of it.
    pub fn tint(&self, base: Vec3) -> Vec3 {
        match (self.tinted, self.thin) {
            (false, _) => self.color,
            (true, true) => self.color * base,
            (true, false) => self.color * Vec3::from(base.to_array().map(f32::sqrt)),
        }
    }

    /// The share of light that is mirrored, and the unit direction from which the rest comes.
    fn through(&self, view: DVec3, normal: DVec3, ratio: f64) -> (f64, Option<DVec3>) {
        // Rounding, and interpolated normals, may give a little less than 0.
        let cosine = dot_f64(view, normal).clamp(0.0, 1.0);
        let mirrored = self.reflectance(cosine, ratio);
        // Unbent, a ray keeps its direction to the last bit.
        if self.thin || ratio == 1.0 {
            return (mirrored, Some(-view));
        }
        let beyond = cosine_beyond(cosine, ratio);
        let bent =
            beyond.map(|beyond| normalize_f64(normal * (ratio * cosine - beyond) - view * ratio));
        (mirrored, bent)
    }

    /// The share of mirrored light for the `cosine` of the angle to the normal. A thin sheet
    /// mirrors at both sides, again and again: 2 F / (1 + F).
    fn reflectance(&self, cosine: f64, ratio: f64) -> f64 {
        if ratio == 1.0 {
            return 0.0;
        }
        let once = fresnel(cosine, ratio);
        if self.thin { 2.0 * once / (1.0 + once) } else { once }
    }

    /// The share of each channel of light that passes the surface straight, where it has this `opacity`
    /// and this `base` colour, at the `cosine` to its normal, between media of these indices: shadow rays
    /// are not bent. Whatever side it meets, the light is mirrored as it is on the thinner one.
    pub fn transmittance(&self, opacity: f32, base: Vec3, cosine: f32, iors: [f32; 2]) -> DVec3 {
        if self.kt == 0.0 {
            return DVec3::splat(1.0 - f64::from(opacity));
        }
        let [a, b] = if self.thin { [1.0, self.ior] } else { iors }.map(f64::from);
        let cosine = f64::from(cosine.abs().min(1.0));
        let mirrored = self.reflectance(cosine, a.min(b) / a.max(b));
        let refracted = f64::from(self.kt) * (1.0 - mirrored);
        let opacity = f64::from(opacity);
        DVec3::splat(1.0 - opacity) + self.tint(base).as_dvec3() * (opacity * refracted)
    }
}

/// What remains of light along a way of this length with this absorption (Beer's law); all after an
/// infinite one.
pub fn remaining(absorption: Vec3, length: f64) -> DVec3 {
    // Surfaces at one place may be met in an order that rounding makes a way back.
    if absorption == Vec3::ZERO || !length.is_finite() || length <= 0.0 {
        return DVec3::ONE;
    }
    let exponent = absorption.as_dvec3() * -length;
    DVec3::new(libm::exp(exponent.x), libm::exp(exponent.y), libm::exp(exponent.z))
}

/// The cosine of the refracted ray's angle to the normal by Snell's law; `None` for total internal
/// reflection.
fn cosine_beyond(cosine: f64, ratio: f64) -> Option<f64> {
    let square = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
    (square > 0.0).then(|| square.sqrt())
}

/// The reflectance of a smooth dielectric, by Fresnel's equations for unpolarised light: `cosine` of
/// the angle to the normal, `ratio` of the index of refraction on this side over that beyond.
pub fn fresnel(cosine: f64, ratio: f64) -> f64 {
    let Some(beyond) = cosine_beyond(cosine, ratio) else { return 1.0 };
    let across = (ratio * cosine - beyond) / (ratio * cosine + beyond);
    let along = (ratio * beyond - cosine) / (ratio * beyond + cosine);
    (across * across + along * along) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between these ends `tests/integration/closed_form/transparency.rs` has the formula.
    #[test]
    fn reflectance_is_whole_edge_on_beyond_the_critical_angle_and_for_what_is_dense_enough() {
        assert_eq!(fresnel(0.0, 1.0 / 1.5), 1.0, "edge on");
        for cosine in [0.0, 0.1, 1.0] {
            let ratio = f64::from(crate::math::float::MAX_COORDINATE);
            assert!([ratio, 1.0 / ratio].iter().all(|&r| (fresnel(cosine, r) - 1.0).abs() < 1e-9));
        }
        // The sine of the critical angle is 1 / 1.5.
        let critical = (1.0_f64 - 1.0 / 2.25).sqrt();
        assert_eq!(fresnel(critical - 1e-9, 1.5), 1.0);
        assert!(fresnel(critical + 1e-9, 1.5) < 1.0);
    }

    #[test]
    fn a_way_that_rounding_turns_back_keeps_all_light() {
        let strong = Vec3::new(f32::MAX, 1.0, 0.0);
        for length in [0.0, -1e-7, f64::INFINITY] {
            assert_eq!(remaining(strong, length), DVec3::ONE);
        }
        assert_eq!(remaining(strong, 1e-30).x, 0.0);
    }

    #[test]
    fn the_base_colour_counts_once_in_a_sheet_and_on_the_way_through_a_solid() {
        let mut through = Transparency {
            opacity: 1.0,
            kt: 1.0,
            ior: 1.5,
            color: Vec3::ONE,
            tinted: true,
            absorption: Vec3::ZERO,
            thin: true,
        };
        let base = Vec3::new(0.25, 1.0, 0.0);
        assert_eq!(through.tint(base), base);
        through.thin = false;
        assert_eq!(through.tint(base) * through.tint(base), base);
    }
}
