use glam::Vec3;
use num_traits::Signed;
use proptest::prelude::*;
use wavecrest_core::kernels::sphere::intersect;
use wavecrest_core::math::ray::Ray;

use crate::exact::{dot, exact, exact3, minus, rounded};
use crate::inputs::{magnitude, moderate, unit, vector};

proptest! {
    #![proptest_config(crate::config())]

    /// A ray that passes well within a sphere, or well outside, is answered so; and t is that of the
    /// exact equation, within four ulp of the greater of distance and radius.
    #[test]
    fn roots_are_those_of_the_exact_equation(
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
        // a t^2 - 2 b t + c = 0
        let f = minus(&exact3(ray.origin), &exact3(center));
        let d = exact3(ray.direction);
        let r = exact(radius);
        let (a, b, c) = (dot(&d, &d), -dot(&f, &d), dot(&f, &f) - &r * &r);
        let discriminant = &b * &b - &a * &c;
        // As a share of the greatest it can be: how deep the ray passes within the sphere.
        let depth = rounded(&(&discriminant / (&a * &r * &r)));
        let hit = intersect(&ray, center, radius);
        if discriminant.is_negative() {
            prop_assert!(hit.is_none() || depth > -1e-6, "{:?} at depth {}", hit, depth);
            return Ok(());
        }
        prop_assume!(depth > 0.02);
        // The root is rounded once, and neither sum cancels.
        let root = rounded(&discriminant).sqrt();
        let (a, b, c) = (rounded(&a), rounded(&b), rounded(&c));
        let q = b + root.copysign(b);
        let (one, other) = (q / a, c / q);
        let (near, far) = (one.min(other), one.max(other));
        let distance = rounded(&dot(&f, &f)).sqrt();
        let ulp = f64::from(f32::EPSILON) * distance.max(f64::from(radius)) / a.sqrt();
        // Where a root is at the start itself, either answer is right.
        prop_assume!(near.abs() > 4.0 * ulp && far.abs() > 4.0 * ulp);
        let right = [near, far].into_iter().find(|&t| t > 0.0);
        match (hit, right) {
            (Some(t), Some(right)) => {
                prop_assert!((f64::from(t) - right).abs() <= 4.0 * ulp, "{} and not {}", t, right);
            }
            (hit, right) => prop_assert_eq!(hit.is_some(), right.is_some(), "{:?}", right),
        }
    }

    /// Whatever the numbers, t is one.
    #[test]
    fn t_is_a_number_after_the_start(
        center in vector(crate::inputs::coordinate),
        radius in magnitude(-149, 128),
        origin in vector(crate::inputs::coordinate),
        direction in vector(crate::inputs::coordinate),
        t_min in prop_oneof![Just(0.0), magnitude(-30, 30)],
    ) {
        let ray = Ray { t_min, ..Ray::new(origin, direction) };
        prop_assume!(ray.is_valid() && radius != 0.0);
        let hit = intersect(&ray, center, radius.abs());
        prop_assert!(hit.is_none_or(|t| t > t_min), "{:?}", hit);
    }
}

/// The reference itself: a ray down an axis.
#[test]
fn the_exact_numbers_are_exact() {
    let third = exact(1.0) / exact(3.0);
    assert_eq!(&third + &third + &third, exact(1.0));
    assert_eq!(dot(&exact3(Vec3::new(1.0, 2.0, 3.0)), &exact3(Vec3::ONE)), exact(6.0));
}
