use glam::{DVec2, Vec2, Vec3};
use proptest::prelude::*;
use wavecrest_core::math::random::{Stream, unit_interval};
use wavecrest_core::math::sampling::{Draw, Sampling, cap, disk, sphere, triangle};

/// A number in \[0, 1), as streams give them; often the first or the last.
fn fraction() -> impl Strategy<Value = f32> {
    prop_oneof![any::<u32>(), Just(0), Just(u32::MAX)].prop_map(unit_interval)
}

fn square() -> impl Strategy<Value = [f32; 2]> {
    [fraction(), fraction()]
}

proptest! {
    #![proptest_config(crate::config())]

    #[test]
    fn uniform_numbers_are_from_0_up_to_1(
        seed: u64, pixel: u32, sample: u32, bounce: u32, dimension: u32,
    ) {
        for x in (Stream { seed, pixel, sample, bounce }).uniform(dimension) {
            prop_assert!((0.0..1.0).contains(&x), "{}", x);
            let steps = f64::from(x) * f64::from(1 << 24);
            prop_assert_eq!(steps, steps.floor());
        }
    }

    /// Philox can be undone, round by round: no two places share their words.
    #[test]
    fn no_two_places_share_their_words(
        seed: u64, pixel: u32, sample: u32, bounce: u32, dimension: u32,
    ) {
        let words = (Stream { seed, pixel, sample, bounce }).words(dimension);
        let place = undone(words, [seed as u32, (seed >> 32) as u32]);
        prop_assert_eq!(place, [pixel, sample, bounce, dimension]);
    }

    #[test]
    fn a_jittered_point_is_in_its_own_cell(
        index: u32, columns in 1_u32..4096, rows in 1_u32..4096, seed: u64,
    ) {
        let index = index % (columns * rows);
        let draw = Draw { dimension: 0, first: 0, scramble: 0, grid: [columns, rows] };
        let stream = Stream { seed, pixel: 0, sample: 0, bounce: 0 };
        let number = |_| (index, 0);
        let p = Sampling::Jittered.points::<f32>((), stream, [&[0], &[0]], draw, number);
        let p = Vec2::from(p).as_dvec2();
        let (column, row) = (f64::from(index % columns), f64::from(index / columns));
        // Sum and quotient are rounded once each, relative to the result.
        let (w, h, u) = (f64::from(columns), f64::from(rows), f64::from(f32::EPSILON));
        prop_assert!(p.x >= column / w * (1.0 - u) && p.x <= (column + 1.0) / w * (1.0 + u));
        prop_assert!(p.y >= row / h * (1.0 - u) && p.y <= (row + 1.0) / h * (1.0 + u));
        prop_assert!(p.max_element() < 1.0);
    }

    /// Sine, cosine, root and products are off by a few roundings.
    #[test]
    fn maps_stay_on_their_shapes(square in square()) {
        let u = f64::from(f32::EPSILON);
        let on_disk = Vec2::from(disk(square)).as_dvec2();
        prop_assert!(on_disk.length() <= 1.0 + 4.0 * u, "{}", on_disk);
        let on_sphere = Vec3::from(sphere(square)).as_dvec3();
        prop_assert!((on_sphere.length() - 1.0).abs() <= 4.0 * u, "{}", on_sphere);
        let in_triangle = Vec2::from(triangle(square));
        prop_assert!(in_triangle.min_element() >= 0.0, "{}", in_triangle);
        prop_assert!(in_triangle.as_dvec2().element_sum() <= 1.0 + 2.0 * u, "{}", in_triangle);
    }

    /// The share of the area within is what was asked for.
    #[test]
    fn maps_keep_area_everywhere(square in square(), height in 0.0_f64..=2.0) {
        let u = f64::from(f32::EPSILON);
        let share = Vec2::from(disk(square)).as_dvec2().length_squared();
        prop_assert!((share - f64::from(square[1])).abs() <= 8.0 * u, "{}", share);
        let share = 0.5 * (f64::from(sphere(square).y) + 1.0);
        prop_assert!((share - f64::from(square[1])).abs() <= 8.0 * u, "{}", share);
        let (across, below) = cap::<f32>(square, height);
        prop_assert!((below - f64::from(square[1]) * height).abs() <= 8.0 * u, "{}", below);
        let on_sphere = DVec2::from(across).length_squared() + (1.0 - below) * (1.0 - below);
        prop_assert!((on_sphere - 1.0).abs() <= 8.0 * u, "{}", on_sphere);
        let sum = Vec2::from(triangle(square)).as_dvec2().element_sum();
        prop_assert!((sum * sum - f64::from(square[0])).abs() <= 8.0 * u, "{}", sum);
    }
}

/// The counter whose words these are.
fn undone(mut words: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    const MULTIPLIER: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
    const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    let inverse = MULTIPLIER.map(|m| {
        // Newton's method in the ring of words: each step doubles the bits that are right.
        (0..5).fold(m, |x: u32, _| x.wrapping_mul(2_u32.wrapping_sub(m.wrapping_mul(x))))
    });
    for round in (0..10_u32).rev() {
        let keys = [0, 1].map(|i| key[i].wrapping_add(WEYL[i].wrapping_mul(round)));
        let [w0, w1, w2, w3] = words;
        let (c0, c2) = (w3.wrapping_mul(inverse[0]), w1.wrapping_mul(inverse[1]));
        let high = |m: u32, c: u32| ((u64::from(m) * u64::from(c)) >> 32) as u32;
        let (c1, c3) =
            (w0 ^ high(MULTIPLIER[1], c2) ^ keys[0], w2 ^ high(MULTIPLIER[0], c0) ^ keys[1]);
        words = [c0, c1, c2, c3];
    }
    words
}
