use glam::Vec3;
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use wavecrest_core::kernels::precision::Exact as ExactPrecision;
use wavecrest_core::kernels::sphere::{intersect_exactly, meet};
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::vector::Line;

use crate::exact::{Exact, dot, exact, exact3, is_within, minus, rounded_once};
use crate::inputs::{coordinate, magnitude, moderate, unit, vector};

/// The root of a number, to 2^-500; those of squares exactly.
fn root(x: &Exact) -> Exact {
    let scale = num_traits::pow(exact(2.0), 500);
    let one = x.numer() / x.numer().abs();
    let wide = (x * &scale * &scale).floor();
    let exactly = Exact::new(x.numer().sqrt(), x.denom().sqrt());
    if &exactly * &exactly == *x { exactly } else { Exact::new(wide.numer().sqrt(), one) / scale }
}

/// The t within its range at which a ray meets a sphere, in order: to 2^-500 of the ray's length.
pub(crate) fn meetings(ray: &Ray, center: Vec3, radius: f32) -> Vec<Exact> {
    let (f, d, r) =
        (minus(&exact3(ray.origin), &exact3(center)), exact3(ray.direction), exact(radius));
    let (a, b, c) = (dot(&d, &d), -dot(&f, &d), dot(&f, &f) - &r * &r);
    let discriminant = &b * &b - &a * &c;
    if discriminant.is_negative() {
        return Vec::new();
    }
    let root = if discriminant.is_zero() { discriminant } else { root(&discriminant) };
    [(&b - &root) / &a, (&b + &root) / &a].into_iter().filter(|t| is_within(ray, t)).collect()
}

fn intersect(ray: &Ray, center: Vec3, radius: f32) -> Option<f32> {
    let range = [ray.t_min, ray.t_max];
    let (t, is_hit) = meet::<f32, ExactPrecision>(&Line::from(ray), center, radius, range);
    is_hit.then_some(t)
}

proptest! {
    #![proptest_config(crate::config())]

    /// Through the middle, the rim and beyond, from near and far: both the filter with its exact end and the
    /// reference answer as the definition does.
    #[test]
    fn a_hit_of_a_sphere_is_the_exact_one(
        center in vector(moderate),
        size in (magnitude(-10, 11), magnitude(-6, 17)),
        directions in (unit(), unit()),
        aside in 0.0_f32..2.0,
        length in magnitude(-10, 11),
    ) {
        let (radius, away) = (size.0.abs(), size.1.abs());
        let origin = center + directions.0 * (radius * away);
        let target = center + directions.1 * (radius * aside);
        let ray = Ray::new(origin, (target - origin) * length.abs());
        prop_assume!(ray.is_valid());
        let defined = meetings(&ray, center, radius).first().map(rounded_once);
        prop_assert_eq!(intersect(&ray, center, radius), defined);
        prop_assert_eq!(intersect_exactly(&ray, center, radius), defined);
    }

    /// Whatever the numbers, t is one.
    #[test]
    fn t_is_a_number_after_the_start(
        center in vector(coordinate),
        radius in magnitude(-149, 128),
        origin in vector(coordinate),
        direction in vector(coordinate),
        t_min in prop_oneof![Just(0.0), magnitude(-30, 30)],
    ) {
        let ray = Ray { t_min, ..Ray::new(origin, direction) };
        prop_assume!(ray.is_valid() && radius != 0.0);
        let hit = intersect(&ray, center, radius.abs());
        prop_assert!(hit.is_none_or(|t| t > t_min), "{:?}", hit);
    }
}
