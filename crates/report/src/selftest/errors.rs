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

/// The largest errors of hits against exact ones.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HitErrors {
    /// The number of hits.
    pub hits: u64,
    /// Of t, in ulp of the exact t.
    pub t: f64,
    /// Of the point: its distance from the triangle's plane, in ulp of the triangle's largest
    /// coordinate. This error makes a surface shadow itself.
    pub point: f64,
    /// Of the geometric normal, along its largest component, in ulp of that component.
    pub normal: f64,
    /// Triangles that the ray misses but that were hit. Beside an edge a watertight test may give the hit to the
    /// neighbour.
    pub extra: u64,
}

impl HitErrors {
    /// In words.
    pub fn words(&self) -> String {
        let [t, point, normal] = [self.t, self.point, self.normal].map(ulps);
        format!("largest errors: t {t}, points {point}, normals {normal}")
    }

    /// Those of the hit of one ray on a triangle.
    pub(super) fn of(geometry: &Geometry, ray: &Ray, hit: Hit) -> Self {
        let corners = geometry.triangle(hit.primitive as usize);
        let exact_hit = exact::meeting(ray, &corners);
        let exact_hit = exact_hit.filter(|t| t.is_within([ray.t_min, ray.t_max]));
        let Some(exact_t) = exact_hit.map(|t| t.approximate()) else {
            return Self { extra: 1, ..Self::default() };
        };
        let t = (f64::from(hit.t) - exact_t).abs() / ulp(exact_t);
        let surface = surface_at(geometry, ray, hit);
        let [point, _, normal] = surface.map_or([Vec3::NAN; 3], |surface| surface.vectors());
        let size = corners.iter().map(|&v| max_abs(v)).fold(0.0, f32::max);
        let [a, b, c] = corners.map(|v| v.as_dvec3());
        let exact_normal = (b - a).cross(c - a).normalize();
        let height = (point.as_dvec3() - a).dot(exact_normal).abs();
        let unit = ulp(exact_normal.abs().max_element());
        let turned = (normal.as_dvec3() - exact_normal).abs().max_element() / unit;
        // NaN is the largest error, as a number that JSON can represent.
        let finite = |ulp: f64| if ulp.is_finite() { ulp } else { f64::MAX };
        let [t, point, normal] = [t, height / ulp(f64::from(size)), turned].map(finite);
        Self { hits: 1, t, point, normal, extra: 0 }
    }
}

impl Sum for HitErrors {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |sum, one| Self {
            hits: sum.hits + one.hits,
            t: sum.t.max(one.t),
            point: sum.point.max(one.point),
            normal: sum.normal.max(one.normal),
            extra: sum.extra + one.extra,
        })
    }
}

/// Errors above this are not told apart: single precision has no digit right then.
const MOST: f64 = (1 << 23) as f64;

/// A number of ulp in words.
pub fn ulps(ulp: f64) -> String {
    if ulp > MOST {
        return format!("more than {} ulp", figure(MOST));
    }
    if ulp < 10.0 { format!("{ulp:.1} ulp") } else { format!("{} ulp", figure(ulp.round())) }
}

/// The distance between single-precision numbers near `value`.
pub(super) fn ulp(value: f64) -> f64 {
    let value = (value.abs() as f32).clamp(f32::MIN_POSITIVE, f32::MAX / 2.0);
    f64::from(value.next_up()) - f64::from(value)
}
