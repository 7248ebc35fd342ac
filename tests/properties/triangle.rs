use fearless_simd::Level;
use glam::Vec3;
use num_traits::Zero;
use proptest::prelude::*;
use wavecrest_core::at_level;
use wavecrest_core::kernels::precision::Exact as ExactPrecision;
use wavecrest_core::kernels::triangle::filter;
use wavecrest_core::kernels::triangle::{
    self, LaneHits, ShearedSpace, exact as without_rounding, is_degenerate,
};
use wavecrest_core::math::float::max_abs;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::Lanes;

use crate::exact::{cross, exact, exact3, meeting, minus, rounded_once};
use crate::inputs::{coordinate, vector};

/// Three of a list: often ones that lie on a line.
fn corners() -> impl Strategy<Value = [Vec3; 3]> {
    let on_a_line = (vector(coordinate), vector(coordinate), -4_i8..=4).prop_map(|(a, b, k)| {
        let c = a + (b - a) * f32::from(k);
        [a, b, c]
    });
    let any = [vector(coordinate), vector(coordinate), vector(coordinate)];
    prop_oneof![any, on_a_line].prop_filter("coordinates that may be", |corners| {
        corners.iter().all(|&c| max_abs(c) <= wavecrest_core::math::float::MAX_COORDINATE)
    })
}

/// Rays aimed at a triangle: at points inside, on its edges, at its corners, and just beside them.
fn aimed() -> impl Strategy<Value = ([Vec3; 3], Ray)> {
    let ends = prop_oneof![Just((0.0, f32::INFINITY)), Just((0.5, 1.0)), Just((-1.0, 1.5))];
    let weight = prop_oneof![Just(0.0_f32), Just(1.0), Just(0.5), 0.0_f32..1.0];
    let near = prop_oneof![Just(0.0_f32), -1e-6_f32..1e-6];
    (corners(), vector(coordinate), (weight, 0.0_f32..1.0), near, ends).prop_map(
        |([a, b, c], origin, (v, w), aside, (t_min, t_max))| {
            let target = a + (b - a) * (v * (1.0 - w)) + (c - a) * (v * w) + (a - b) * aside;
            ([a, b, c], Ray { t_min, t_max, ..Ray::new(origin, target - origin) })
        },
    )
}

/// The six orders of three corners, and two of them once more, by their indices.
const ORDERS: [[u32; 8]; 3] =
    [[0, 1, 2, 0, 2, 1, 0, 1], [1, 2, 0, 2, 1, 0, 1, 2], [2, 0, 1, 1, 0, 2, 2, 0]];

/// The same triangle in each lane of a leaf, in every order of its corners.
#[inline(always)]
fn filtered<S: Lanes>(simd: S, ray: &Ray, [a, b, c]: &[Vec3; 3]) -> LaneHits {
    let row = |k: usize| [a[k], b[k], c[k], a[k], a[k], a[k], a[k], a[k]];
    let positions = [row(0), row(1), row(2), row(0)];
    let packed = ORDERS.map(|order| (0..8).fold(0, |bits, lane| bits | order[lane] << (4 * lane)));
    let extent = (*b - *a).abs().max((*c - *a).abs()).max((*c - *b).abs()).max_element();
    let space = ShearedSpace::new(ray);
    let vertices = (&positions, packed, extent.next_up());
    filter::patch::<S, ExactPrecision>(simd, (ray, &space, ray.t_max), vertices, 0xFF)
}

proptest! {
    #![proptest_config(crate::config())]

    /// Corners on one line, and no others, make no triangle.
    #[test]
    fn degenerate_is_what_has_exactly_no_area(corners in corners()) {
        let [a, b, c] = corners.map(exact3);
        let area = cross(&minus(&b, &a), &minus(&c, &a));
        prop_assert_eq!(is_degenerate(&corners), area.iter().all(Zero::is_zero));
    }

    /// A hit is what rational arithmetic says, to the last bit of t, with rounding and without.
    #[test]
    fn hits_are_those_of_rational_arithmetic((corners, ray) in aimed()) {
        prop_assume!(ray.is_valid());
        let expected = meeting(&ray, &corners).map(|t| rounded_once(&t));
        prop_assert_eq!(without_rounding::meet(&ray, &corners), expected);
        prop_assert_eq!(triangle::meet(&ray, &corners), expected);
        let [a, b, c] = corners;
        for turned in [[b, c, a], [c, a, b], [a, c, b], [c, b, a], [b, a, c]] {
            prop_assert_eq!(triangle::meet(&ray, &turned), expected);
        }
    }

    /// Few bits: rays run through edges, corners and planes, and hits are at the ends of ranges.
    #[test]
    fn hits_on_a_grid_are_those_of_rational_arithmetic(
        corners in prop::array::uniform3(prop::array::uniform3(-4_i8..=4)),
        origin in prop::array::uniform3(-4_i8..=4),
        direction in prop::array::uniform3(-4_i8..=4),
        ends in (-2_i8..=2, 1_i8..=4),
    ) {
        let vector = |v: [i8; 3]| Vec3::from(v.map(f32::from));
        let (corners, ray) = (corners.map(vector), Ray::new(vector(origin), vector(direction)));
        let (t_min, length) = (f32::from(ends.0) / 2.0, f32::from(ends.1) / 2.0);
        let ray = Ray { t_min, t_max: t_min + length, ..ray };
        prop_assume!(ray.is_valid());
        let expected = meeting(&ray, &corners).map(|t| rounded_once(&t));
        prop_assert_eq!(without_rounding::meet(&ray, &corners), expected);
        prop_assert_eq!(triangle::meet(&ray, &corners), expected);
    }

    /// The filter names no miss that is a hit, no hit that is a miss, and no interval without t.
    #[test]
    fn the_filter_is_never_wrong((corners, ray) in aimed()) {
        prop_assume!(ray.is_valid());
        let expected = meeting(&ray, &corners);
        let hits = at_level!(Level::new(), simd => filtered(simd, &ray, &corners));
        for lane in 0..8 {
            let (certain, open) = (hits.certain >> lane & 1 == 1, hits.open >> lane & 1 == 1);
            match &expected {
                Some(t) if certain => {
                    let (low, high) = (hits.low[lane], hits.high[lane]);
                    prop_assert!(exact(low) <= *t && *t <= exact(high), "{} {}", low, high);
                }
                Some(_) => prop_assert!(open, "lane {}", lane),
                None => prop_assert!(!certain, "lane {}", lane),
            }
        }
    }
}
