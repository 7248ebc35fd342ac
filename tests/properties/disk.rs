use glam::Vec3;
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use wavecrest_core::kernels::disk::{Disk, intersect_exactly, meet};
use wavecrest_core::kernels::precision::Exact as ExactPrecision;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::vector::Line;

use crate::exact::{Exact, dot, exact, exact3, is_within, minus, rounded_once};
use crate::inputs::{magnitude, moderate, unit, vector};

/// The t at which a ray meets a disk within its range, in rational numbers.
pub(crate) fn meeting(ray: &Ray, disk: &Disk) -> Option<Exact> {
    let (f, d) = (minus(&exact3(ray.origin), &exact3(disk.center)), exact3(ray.direction));
    let n = exact3(disk.normal);
    let along = dot(&n, &d);
    if along.is_zero() {
        return None;
    }
    let t = -dot(&n, &f) / along;
    let q = [0, 1, 2].map(|k| &f[k] + &d[k] * &t);
    let r = exact(disk.radius);
    (is_within(ray, &t) && !(dot(&q, &q) - &r * &r).is_positive()).then_some(t)
}

proptest! {
    #![proptest_config(crate::config())]

    /// Rays through the rim, the plane and beyond, from near and far, and in the plane itself: both
    /// the filter with its exact end and the reference answer as the definition does.
    #[test]
    fn a_hit_of_a_disk_is_the_exact_one(
        center in vector(moderate),
        size in (magnitude(-10, 11), magnitude(-6, 17)),
        directions in (unit(), unit(), unit()),
        aside in prop_oneof![0.0_f32..2.0, Just(1.0), (-9_i8..9).prop_map(|ulp| 1.0 + f32::from(ulp) * f32::EPSILON)],
        length in magnitude(-10, 11),
        kind in 0_u8..4,
    ) {
        let (radius, away) = (size.0.abs(), size.1.abs());
        // Along an axis, rays hit the rim and run in the plane without rounding.
        let normal = if kind == 0 { Vec3::Y } else { directions.0 };
        let across = normal.cross(directions.1).normalize_or(normal.any_orthonormal_vector());
        let target = center + across * (radius * aside);
        let from = if kind == 1 { across } else { directions.2 };
        let origin = target + from * (radius * away);
        let ray = Ray::new(origin, (target - origin) * length.abs());
        prop_assume!(ray.is_valid());
        let disk = Disk { center, normal, radius };
        let (t, is_hit) =
            meet::<f32, ExactPrecision>(&Line::from(&ray), &disk, [ray.t_min, ray.t_max]);
        let defined = meeting(&ray, &disk).map(|t| rounded_once(&t));
        prop_assert_eq!(is_hit.then_some(t), defined);
        prop_assert_eq!(intersect_exactly(&ray, &disk), defined);
    }

    /// The box around a disk contains its rim.
    #[test]
    fn the_box_of_a_disk_contains_it(
        center in vector(moderate),
        radius in magnitude(-10, 11),
        normal in unit(),
        angle in 0.0_f64..6.3,
    ) {
        let disk = Disk { center, normal, radius: radius.abs() };
        let [u, v] = Disk::axes(normal.as_dvec3());
        let rim = (u * angle.cos() + v * angle.sin()) * f64::from(disk.radius);
        let excess = rim.abs() - disk.half();
        prop_assert!(excess.max_element() <= f64::from(disk.radius) * 1e-15, "{}", excess);
    }
}
