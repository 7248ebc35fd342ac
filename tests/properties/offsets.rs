use glam::Vec3;
use proptest::prelude::*;
use wavecrest_core::math::float::max_abs;
use wavecrest_core::math::vector::Vector;

use crate::inputs::{coordinate, moderate, unit, vector};

/// How far `moved` is before the plane through `point`, less the error's extent, on the side of
/// `normal` that `direction` points to. In double precision, which rounds far less than single.
fn room(moved: Vec3, point: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> f64 {
    let side = if direction.dot(normal) < 0.0 { -1.0 } else { 1.0 };
    let shift = (moved.as_dvec3() - point.as_dvec3()).dot(normal.as_dvec3()) * side;
    shift - normal.as_dvec3().abs().dot(error.as_dvec3())
}

proptest! {
    #![proptest_config(crate::config())]

    /// Wherever in its error box the exact point is, its plane is behind the moved one; but for what
    /// products of an error and a normal lose where they are subnormal, half of the least number each.
    #[test]
    fn a_moved_origin_is_before_its_surface(
        point in vector(coordinate),
        normal in unit(),
        direction in vector(moderate),
        size in 1.0_f32..4.0,
    ) {
        let [start, n, d] = [point, normal, direction].map(Vector::from);
        let error = start.rounding_error(max_abs(point) * size);
        for moved in [start.offset_origin(error, n, d), start.offset_end(error, n, d)] {
            let moved = Vec3::from(moved);
            let room = room(moved, point, error.into(), normal, direction);
            let lost = 6.0 * 0.5 * f64::from(f32::from_bits(1));
            prop_assert!(room >= -lost, "{:?} lacks {}", moved, room);
        }
    }

    /// A point is moved no farther than its error and one rounding ask for.
    #[test]
    fn a_moved_origin_stays_near(
        point in vector(coordinate),
        normal in unit(),
        direction in vector(moderate),
    ) {
        let [start, n, d] = [point, normal, direction].map(Vector::from);
        let error = start.rounding_error(max_abs(point));
        let moved = Vec3::from(start.offset_origin(error, n, d));
        let bound = 4.001 * Vec3::from(error).as_dvec3().element_sum()
            + 2.0 * f64::from(f32::EPSILON) * f64::from(max_abs(point))
            + f64::from(f32::MIN_POSITIVE);
        let far = (moved.as_dvec3() - point.as_dvec3()).abs().max_element();
        prop_assert!(far <= bound, "{} of {}", far, bound);
    }
}
