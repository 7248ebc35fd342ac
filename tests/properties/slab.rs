use glam::Vec3;
use num_traits::Signed;
use proptest::prelude::*;
use wavecrest_core::kernels::slab::{Aabb, SlabRay};
use wavecrest_core::math::ray::Ray;

use crate::exact::{Exact, exact, rounded};
use crate::inputs::{coordinate, magnitude, moderate, vector};

/// The exact range of t >= 0 in which the ray is in the box, if there is one. `None` for an end
/// where there is none.
fn range(ray: &Ray, bounds: &Aabb) -> Option<(Exact, Option<Exact>)> {
    let (mut near, mut far) = (exact(0.0), None::<Exact>);
    for k in 0..3 {
        let (origin, direction) = (exact(ray.origin[k]), exact(ray.direction[k]));
        let (low, high) = (exact(bounds.low[k]) - &origin, exact(bounds.high[k]) - &origin);
        if direction == exact(0.0) {
            if low.is_positive() || high.is_negative() {
                return None;
            }
            continue;
        }
        let (a, b) = (low / &direction, high / &direction);
        let (first, last) = if a < b { (a, b) } else { (b, a) };
        near = near.max(first);
        far = Some(far.map_or(last.clone(), |far| far.min(last)));
    }
    if far.as_ref().is_some_and(|far| *far < near) { None } else { Some((near, far)) }
}

/// A component of a direction: also zero, and as small or large as numbers are.
fn component() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => moderate(),
        1 => prop_oneof![Just(0.0), Just(-0.0)],
        1 => magnitude(-149, 128),
    ]
}

proptest! {
    #![proptest_config(crate::config())]

    /// A ray that meets a box, exactly taken, is found to meet it, and not to enter it later or leave
    /// it earlier.
    #[test]
    fn no_ray_that_meets_a_box_misses_it(
        corners in (vector(coordinate), vector(coordinate)),
        origin in vector(coordinate),
        direction in vector(component),
        towards in prop::option::of(prop::array::uniform3(0.0_f32..=1.0)),
        scale in prop_oneof![3 => Just(1.0_f32), 1 => magnitude(-100, 80)],
    ) {
        let bounds = Aabb::around([corners.0, corners.1]);
        let aimed = towards.map(|weights| {
            let target = bounds.low + (bounds.high - bounds.low) * Vec3::from(weights);
            (target - origin) * scale
        });
        let ray = Ray::new(origin, aimed.unwrap_or(direction));
        prop_assume!(ray.is_valid());
        let Some((near, far)) = range(&ray, &bounds) else { return Ok(()) };
        let slab = SlabRay::new(&ray);
        let [first, last] = slab.interval(&bounds);
        let enters = first <= slab.reach(rounded(&near) as f32);
        let leaves = far.as_ref().is_none_or(|far| last >= rounded(far) as f32);
        let told = far.as_ref().map(rounded);
        prop_assert!(
            first <= last && enters && leaves,
            "{} to {} and not {} to {:?}", first, last, rounded(&near), told
        );
    }
}
