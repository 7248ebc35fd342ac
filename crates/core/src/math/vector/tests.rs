use super::*;
use crate::math::float::{self, normalize, offset_end, offset_origin};
use crate::math::random::Stream;
use crate::math::simd::{Kernel, LANES, Lanes, Level, dispatch};
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

struct All([[Vec3; LANES]; 4]);

impl Kernel for All {
    type Output = [[Vec3; LANES]; 5];

    fn run<S: Lanes>(self, simd: S) -> Self::Output {
        let load = |v: [Vec3; LANES]| Vector::<f32x8<S>>::load(simd, &rows(v));
        let [point, error, normal, direction] = self.0.map(load);
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
}

fn expected([p, e, n, d]: [Vec3; 4]) -> [Vec3; 5] {
    let e = e.abs();
    [
        normalize(p),
        float::normalize_f64(p.as_dvec3()).as_vec3(),
        offset_origin(p, e, n, d),
        offset_end(p, e, n, d),
        float::rounding_error(p, float::max_abs(e)),
    ]
}

#[test]
fn lanes_have_the_bits_of_single_vectors() {
    for level in Level::available() {
        let token = level.token().expect("it is available");
        for group in 0..500 {
            let inputs = [0, 1, 2, 3].map(|dimension| eight(group, dimension));
            let found = dispatch(token, All(inputs));
            for lane in 0..LANES {
                let input = inputs.map(|vectors| vectors[lane]);
                let found = found.map(|vectors| vectors[lane].to_array().map(f32::to_bits));
                let expected = expected(input).map(|v| v.to_array().map(f32::to_bits));
                assert_eq!(found, expected, "{level:?}: {input:?}");
            }
        }
    }
}
