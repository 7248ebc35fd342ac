use super::*;
use crate::at_level;
use crate::math::random::Stream;
use crate::math::simd::{LANES, Lanes, Level};
use fearless_simd::f32x8;

/// Numbers of every size, and zeros of both signs.
fn vector(index: u32, dimension: u32) -> Vec3 {
    let [a, b, c, d] = Stream { seed: 5, pixel: index, sample: 0, bounce: 0 }.uniform(dimension);
    let size = libm::powf(10.0, 60.0 * d - 30.0);
    let number = |u: f32| match u {
        u if u < 0.1 => 0.0,
        u if u < 0.2 => -0.0,
        u => (u - 0.6) * size,
    };
    Vec3::new(number(a), number(b), number(c))
}

fn eight(group: u32, dimension: u32) -> [Vec3; LANES] {
    std::array::from_fn(|lane| vector(group * 8 + lane as u32, dimension))
}

fn rows(vectors: [Vec3; LANES]) -> [[f32; LANES]; 3] {
    [vectors.map(|v| v.x), vectors.map(|v| v.y), vectors.map(|v| v.z)]
}

fn found<S: Lanes>(simd: S, inputs: [[Vec3; LANES]; 4]) -> [[Vec3; LANES]; 5] {
    let load = |v: [Vec3; LANES]| Vector::<f32x8<S>>::load(simd, &rows(v));
    let [point, error, normal, direction] = inputs.map(load);
    let error = error.abs();
    let results = [
        point.normalize(),
        Vector::narrow(point.widen().normalize_wide()),
        point.offset_origin(error, normal, direction),
        point.offset_end(error, normal, direction),
        point.rounding_error(error.max_abs()),
    ];
    results.map(|v| std::array::from_fn(|lane| v.lane(lane)))
}

fn expected(inputs: [Vec3; 4]) -> [Vec3; 5] {
    let [p, e, n, d] = inputs.map(Vector::from);
    let e = e.abs();
    [
        p.normalize(),
        Vector::narrow(p.widen().normalize_wide()),
        p.offset_origin(e, n, d),
        p.offset_end(e, n, d),
        p.rounding_error(e.max_abs()),
    ]
    .map(Vec3::from)
}

#[test]
fn lanes_have_the_bits_of_single_vectors() {
    for level in Level::available() {
        let token = level.token().expect("it is available");
        for group in 0..500 {
            let inputs = [0, 1, 2, 3].map(|dimension| eight(group, dimension));
            let found = at_level!(token, simd => found(simd, inputs));
            for lane in 0..LANES {
                let input = inputs.map(|vectors| vectors[lane]);
                let found = found.map(|vectors| vectors[lane].to_array().map(f32::to_bits));
                let expected = expected(input).map(|v| v.to_array().map(f32::to_bits));
                assert_eq!(found, expected, "{level:?}: {input:?}");
            }
        }
    }
}
