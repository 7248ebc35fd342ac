//! Transparent surfaces: light that goes straight on, and light that is refracted.
//!
//! Refraction is that of Whitted, *An Improved Illumination Model for Shaded Display* (1980), with
//! the reflectance of smooth dielectrics by Fresnel's equations for unpolarised light. The front
//! of a surface is its exterior and its back the interior.

use glam::{DVec3, Vec3};

use super::ShadingPoint;
use crate::math::{Mask, Real, Single, Vector};

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

/// Refracted light, in each lane of a mask.
#[derive(Clone, Copy, Debug)]
pub struct Refracted<F: Single> {
    /// The lanes with refracted light.
    pub asked: F::Mask,
    /// Its weight.
    pub weight: Vector<F>,
    /// The direction away from the viewer that it comes from, of unit length: that of the ray, to
    /// the last bit, where nothing bends it.
    pub direction: Vector<F>,
    /// Whether it was bent about the shading normal, not the geometric one.
    pub smooth: F::Mask,
    /// The index of refraction on the viewer's side over that beyond.
    pub ratio: F,
}

/// The mirrored share of light, the directions from which the rest comes, and the lanes in which there is a rest.
type Through<D> = (D, Vector<D>, <D as Real>::Mask);

impl Transparency {
    /// How light along `point.view`, towards the viewer, is made up: the weight of mirrored light by
    /// Fresnel's equations alone, and refracted light, if not all is mirrored. `iors` are the indices of
    /// refraction on the viewer's side and beyond, of which a thin sheet takes its own.
    #[inline(always)]
    pub fn split<F: Single>(
        &self,
        point: &ShadingPoint<F>,
        [before, beyond]: [F; 2],
    ) -> (F, Refracted<F>) {
        let token = before.token();
        let (view, normal) = (point.view.widen(), point.normal.widen());
        let one = before.widen().same(1.0);
        let ratio = match self.thin {
            true => one / one.same(self.ior.into()),
            false => before.widen() / beyond.widen(),
        };
        let zero = one.zero();
        let (mut mirrored, mut direction, mut rest) =
            self.through(view, point.shading_normal.widen(), ratio);
        // An interpolated normal may bend a ray to its own side.
        let turns = rest & !direction.dot(normal).lt(zero);
        if turns.any() {
            let flat = self.through(view, normal, ratio);
            mirrored = Real::select(turns, flat.0, mirrored);
            direction = Vector::select(turns, flat.1, direction);
            rest = rest & !turns | turns & flat.2;
        }
        let kt = one.same(self.kt.into());
        let weight = kt * (one - mirrored);
        let asked = rest & weight.gt(zero) & direction.dot(normal).lt(zero);
        let refracted = Refracted {
            asked: F::mask(token, asked.bits()),
            weight: self.tint(point.color).scale(F::narrow(weight)),
            direction: Vector::narrow(direction),
            smooth: F::mask(token, !turns.bits()),
            ratio: F::narrow(ratio),
        };
        (F::narrow(kt * mirrored), refracted)
    }

    /// The colour of refracted light at a point with this base colour, which counts once on the way
    /// into a solid and out of it.
    #[inline(always)]
    pub fn tint<F: Single>(&self, base: Vector<F>) -> Vector<F> {
        let color = Vector::splat(base.x.token(), self.color);
        match (self.tinted, self.thin) {
            (false, _) => color,
            (true, true) => color * base,
            (true, false) => color * Vector::new(base.x.sqrt(), base.y.sqrt(), base.z.sqrt()),
        }
    }

    /// Of light along `view`, at surfaces with this `normal`.
    #[inline(always)]
    fn through<D: Real<Element = f64>>(
        &self,
        view: Vector<D>,
        normal: Vector<D>,
        ratio: D,
    ) -> Through<D> {
        let (zero, one) = (ratio.zero(), ratio.same(1.0));
        // Rounding, and interpolated normals, may give a little less than 0.
        let cosine = view.dot(normal).max(zero).min(one);
        let mirrored = self.reflectance(cosine, ratio);
        // Unbent, a ray keeps its direction to the last bit.
        let unbent = if self.thin { one.eq(one) } else { ratio.eq(one) };
        if !(!unbent).any() {
            return (mirrored, -view, unbent);
        }
        let (beyond, leaves) = cosine_beyond(cosine, ratio);
        let bent = normal.scale(ratio * cosine - beyond) - view.scale(ratio);
        let direction = Vector::select(unbent, -view, bent.normalize_wide());
        (mirrored, direction, unbent | leaves)
    }

    /// The share of mirrored light for the `cosine` of the angle to the normal. A thin sheet
    /// mirrors at both sides, again and again: 2 F / (1 + F).
    #[inline(always)]
    fn reflectance<D: Real<Element = f64>>(&self, cosine: D, ratio: D) -> D {
        let one = ratio.same(1.0);
        let once = fresnel(cosine, ratio);
        let all = if self.thin { once.times(2.0) / (one + once) } else { once };
        D::select(ratio.eq(one), ratio.zero(), all)
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
        let tint = Vec3::from(self.tint::<f32>(base.into())).as_dvec3();
        DVec3::splat(1.0 - opacity) + tint * (opacity * refracted)
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

/// The cosine of the refracted ray's angle to the normal by Snell's law, and the lanes in which there is one:
/// those without total internal reflection.
#[inline(always)]
fn cosine_beyond<D: Real<Element = f64>>(cosine: D, ratio: D) -> (D, D::Mask) {
    let one = ratio.same(1.0);
    let square = one - ratio * ratio * (one - cosine * cosine);
    (square.sqrt(), square.gt(ratio.zero()))
}

/// The reflectance of a smooth dielectric, by Fresnel's equations for unpolarised light: `cosine` of
/// the angle to the normal, `ratio` of the index of refraction on this side over that beyond.
#[inline(always)]
pub fn fresnel<D: Real<Element = f64>>(cosine: D, ratio: D) -> D {
    let (beyond, leaves) = cosine_beyond(cosine, ratio);
    let across = (ratio * cosine - beyond) / (ratio * cosine + beyond);
    let along = (ratio * beyond - cosine) / (ratio * beyond + cosine);
    D::select(leaves, (across * across + along * along) / ratio.same(2.0), ratio.same(1.0))
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
        let base = Vector::<f32>::from(Vec3::new(0.25, 1.0, 0.0));
        assert_eq!(through.tint(base), base);
        through.thin = false;
        assert_eq!(through.tint(base) * through.tint(base), base);
    }
}
