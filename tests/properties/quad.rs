use glam::Vec3;
use proptest::prelude::*;
use wavecrest_core::kernels::quad::halves;
use wavecrest_core::kernels::surface;
use wavecrest_core::math::float::{MAX_COORDINATE, max_abs};
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::vector::{Line, Vector};

use crate::exact::{meeting, rounded_once};
use crate::inputs::{coordinate, vector};

/// The half that the ray meets at t.
fn quad_half(ray: &Ray, t: f32, corners: &[Vec3; 4]) -> [Vec3; 3] {
    let corners = corners.map(Vector::from);
    surface::quad_halves(&Line::from(ray), t, &corners, 1).map(Vec3::from)
}

/// Any corners, and such as lie in a plane or nearly so; or folded flat, with both halves on one side of
/// the diagonal; or with a corner on the diagonal, or two at one place.
fn corners() -> impl Strategy<Value = [Vec3; 4]> {
    let any = [vector(coordinate), vector(coordinate), vector(coordinate), vector(coordinate)];
    let weight = prop_oneof![Just(-0.5_f32), Just(0.0), Just(0.5), Just(1.0), -1.0_f32..1.0];
    let flat =
        ([vector(coordinate), vector(coordinate), vector(coordinate)], weight.clone(), weight)
            .prop_map(|([a, b, c], v, w)| [a, b, c, a + (c - a) * v + (b - a) * w]);
    prop_oneof![any, flat].prop_filter("coordinates that may be", |corners| {
        corners.iter().all(|&corner| max_abs(corner) <= MAX_COORDINATE)
    })
}

/// Rays aimed at a half: at points inside, on its edges, at its corners, and just beside them.
fn aimed() -> impl Strategy<Value = ([Vec3; 4], Ray)> {
    let ends = prop_oneof![3 => Just((0.0, f32::INFINITY)), 1 => Just((0.5, 1.0))];
    let weight = prop_oneof![Just(0.0_f32), Just(1.0), Just(0.5), 0.0_f32..1.0];
    let near = prop_oneof![Just(0.0_f32), -1e-6_f32..1e-6];
    let target = (0..2_usize, weight, 0.0_f32..1.0, near);
    (corners(), vector(coordinate), target, ends).prop_map(
        |(corners, origin, (half, v, w, aside), (t_min, t_max))| {
            let [a, b, c] = halves(&corners)[half];
            let target = a + (b - a) * (v * (1.0 - w)) + (c - a) * (v * w) + (a - b) * aside;
            (corners, Ray { t_min, t_max, ..Ray::new(origin, target - origin) })
        },
    )
}

/// The half that the ray meets first by the definition, and where, if it hits the quad.
fn first_met(ray: &Ray, corners: &[Vec3; 4]) -> Option<([Vec3; 3], f32)> {
    let met = |half| meeting(ray, &half).map(|t| (half, rounded_once(&t)));
    let [first, second] = halves(corners).map(met);
    match (first, second) {
        (Some((_, s)), Some((_, t))) => {
            if t < s {
                second
            } else {
                first
            }
        }
        (first, second) => first.or(second),
    }
}

proptest! {
    #![proptest_config(crate::config())]

    /// Of quads of all kinds: by the side of the diagonal, or by the least t.
    #[test]
    fn the_half_is_that_of_rational_arithmetic((corners, ray) in aimed()) {
        prop_assume!(ray.is_valid());
        if let Some((half, t)) = first_met(&ray, &corners) {
            prop_assert_eq!(quad_half(&ray, t, &corners), half);
        }
    }

    /// Few bits: rays run through diagonals, their ends and edges, and along planes.
    #[test]
    fn the_half_on_a_grid_is_that_of_rational_arithmetic(
        corners in prop::array::uniform4(prop::array::uniform3(-2_i8..=2)),
        origin in prop::array::uniform3(-4_i8..=4),
        (half, corner, part) in (0..2_usize, 0..3_usize, 0_i8..=4),
    ) {
        let vector = |v: [i8; 3]| Vec3::from(v.map(f32::from));
        let (corners, origin) = (corners.map(vector), vector(origin));
        // A point of an edge.
        let half = halves(&corners)[half];
        let (p, q) = (half[corner], half[(corner + 1) % 3]);
        let ray = Ray::new(origin, p + (q - p) * (f32::from(part) / 4.0) - origin);
        prop_assume!(ray.is_valid());
        if let Some((half, t)) = first_met(&ray, &corners) {
            prop_assert_eq!(quad_half(&ray, t, &corners), half);
        }
    }
}
