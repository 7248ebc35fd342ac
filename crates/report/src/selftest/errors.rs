//! The errors of hits in each precision against exact ones, in units in the last place.
//!
//! The reference is the exact test, with more digits than single precision: t of
//! [`exact::meeting`], and the plane and the normal of the triangle in double precision.

use std::iter::Sum;

use serde::{Deserialize, Serialize};

use super::aim::surface_at;
use super::prelude::*;
use crate::plot::number::figure;
use wavecrest_core::kernels::triangle::exact;
use wavecrest_core::math::exact::Comparable;
use wavecrest_core::math::float::max_abs;

/// Bins of the histogram: up to half an ulp, the error of rounding the exact value once, then up to
/// each power of two, and all larger errors.
const SIZES: usize = 26;

/// A histogram of errors.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Distribution {
    /// Numbers of errors up to half an ulp, up to one, up to two, and so on; the last are larger
    /// than all these.
    pub counts: [u64; SIZES],
    /// The largest error, in ulp.
    pub worst: f64,
}

/// Errors of hits against exact ones.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HitErrors {
    /// Of t, in ulp of the exact t.
    pub t: Distribution,
    /// Of the point: its distance from the triangle's plane, in ulp of the triangle's largest
    /// coordinate. This error makes a surface shadow itself.
    pub point: Distribution,
    /// Of the geometric normal, along its largest component, in ulp of that component.
    pub normal: Distribution,
    /// Always 0, for readers of older records: what is missed is counted by leaks.
    pub lost: u64,
    /// Triangles that the ray misses but that were hit. Beside an edge a watertight test may give the hit to the
    /// neighbour.
    pub extra: u64,
}

impl Distribution {
    /// The upper bound of the errors counted at `index`, in ulp.
    fn bound(index: usize) -> f64 {
        if index + 1 == SIZES { f64::INFINITY } else { libm::exp2(index as f64 - 1.0) }
    }

    /// The number of errors.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }

    fn count(&mut self, ulp: f64) {
        // NaN counts as the largest error, but as a number that JSON can represent.
        let ulp = if ulp.is_finite() { ulp } else { f64::MAX };
        let index = (0..SIZES).find(|&i| ulp <= Self::bound(i)).unwrap_or(SIZES - 1);
        self.counts[index] += 1;
        self.worst = self.worst.max(ulp);
    }

    fn add(&mut self, other: &Self) {
        for (count, more) in self.counts.iter_mut().zip(other.counts) {
            *count += more;
        }
        self.worst = self.worst.max(other.worst);
    }
}

impl HitErrors {
    /// The largest of each, in words.
    pub fn words(&self) -> String {
        let [t, point, normal] = [&self.t, &self.point, &self.normal].map(|e| ulps(e.worst));
        format!("largest errors: t {t}, points {point}, normals {normal}")
    }

    /// Those of the hit of one ray on a triangle.
    pub(super) fn of(geometry: &Geometry, ray: &Ray, hit: Hit) -> Self {
        let mut errors = Self::default();
        let corners = geometry.triangle(hit.primitive as usize);
        let exact_hit = exact::meeting(ray, &corners);
        let exact_hit = exact_hit.filter(|t| t.is_within([ray.t_min, ray.t_max]));
        let Some(exact_t) = exact_hit.map(|t| t.approximate()) else {
            return Self { extra: 1, ..errors };
        };
        errors.t.count((f64::from(hit.t) - exact_t).abs() / ulp(exact_t));
        let surface = surface_at(geometry, ray, hit);
        let [point, _, normal] = surface.map_or([Vec3::NAN; 3], |surface| surface.vectors());
        let size = corners.iter().map(|&v| max_abs(v)).fold(0.0, f32::max);
        let [a, b, c] = corners.map(|v| v.as_dvec3());
        let exact_normal = (b - a).cross(c - a).normalize();
        let height = (point.as_dvec3() - a).dot(exact_normal).abs();
        errors.point.count(height / ulp(f64::from(size)));
        let unit = ulp(exact_normal.abs().max_element());
        errors.normal.count((normal.as_dvec3() - exact_normal).abs().max_element() / unit);
        errors
    }
}

impl Sum for HitErrors {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |mut sum, one| {
            sum.t.add(&one.t);
            sum.point.add(&one.point);
            sum.normal.add(&one.normal);
            sum.extra += one.extra;
            sum
        })
    }
}

/// A number of ulp in words.
pub fn ulps(ulp: f64) -> String {
    // The last bin has no upper bound.
    let most = Distribution::bound(SIZES - 2);
    if ulp > most {
        return format!("more than {} ulp", figure(most));
    }
    if ulp < 10.0 { format!("{ulp:.1} ulp") } else { format!("{} ulp", figure(ulp.round())) }
}

/// The distance between single-precision numbers near `value`.
pub(super) fn ulp(value: f64) -> f64 {
    let value = (value.abs() as f32).clamp(f32::MIN_POSITIVE, f32::MAX / 2.0);
    f64::from(value.next_up()) - f64::from(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_counted_up_to_their_bounds() {
        let mut found = Distribution::default();
        [0.0, 0.5, 0.6, 1.0, 3.0, f64::NAN].into_iter().for_each(|ulp| found.count(ulp));
        assert_eq!(found.counts[..4], [2, 2, 0, 1]);
        assert_eq!(found.counts[SIZES - 1], 1);
        assert!(found.total() == 6 && found.worst > 1e300);
    }
}
