//! The kernels one by one, each over the same random inputs: time per input.
//!
//! Run with `cargo bench --bench kernels`, and a word to select by name.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use glam::{Vec2, Vec3};

use wavecrest_core::kernels::blinn_phong::{self, Material};
use wavecrest_core::kernels::precision::Exact;
use wavecrest_core::kernels::slab::{Aabb, SlabRay};
use wavecrest_core::kernels::texture::{Filter, Image, Texels, Wrap};
use wavecrest_core::kernels::triangle::{self, ShearedSpace, exact};
use wavecrest_core::kernels::{sphere, surface};
use wavecrest_core::math::float::normalize;
use wavecrest_core::math::random::{Stream, philox_4x32_10};
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::vector::{Line, Vector};

/// Inputs of a sample: few enough for the first-level cache.
const INPUTS: u32 = 256;

fn main() {
    divan::main();
}

/// Times `kernel` over all `inputs`.
fn each<I, O>(bencher: Bencher<'_, '_>, inputs: &[I], kernel: impl Fn(&I) -> O) {
    bencher.counter(ItemsCount::new(inputs.len())).bench_local(|| {
        for input in inputs {
            black_box(kernel(black_box(input)));
        }
    });
}

/// The results of `make` for every input's random numbers.
fn inputs<T>(make: impl Fn(&dyn Fn(u32) -> Vec3) -> T) -> Vec<T> {
    let point = |pixel, dimension| {
        let stream = Stream { seed: 1, pixel, sample: 0, bounce: 0 };
        let [x, y, z, _] = stream.uniform(dimension);
        Vec3::new(x, y, z) * 2.0 - 1.0
    };
    (0..INPUTS).map(|pixel| make(&|dimension| point(pixel, dimension))).collect()
}

/// A ray towards the centre, and corners around it: about half of them are hit.
fn rays_and_corners<const N: usize>() -> Vec<(Ray, [Vec3; N])> {
    inputs(|point| {
        let ray = Ray::new(point(0) + Vec3::Z * 5.0, point(1) * 0.3 - Vec3::Z);
        (ray, std::array::from_fn(|k| point(2 + k as u32)))
    })
}

/// A quad in the plane z = 0, as random corners would not be planar.
fn rays_and_quads() -> Vec<(Ray, [Vec3; 4])> {
    let turn = |(ray, [a, ..]): (Ray, [Vec3; 4])| {
        let (x, y) = (Vec3::new(a.x, a.y, 0.0), Vec3::new(-a.y, a.x, 0.0));
        (ray, [x, y, -x, -y])
    };
    rays_and_corners().into_iter().map(turn).collect()
}

#[divan::bench]
fn triangle_intersect(bencher: Bencher<'_, '_>) {
    each(bencher, &rays_and_corners(), |(ray, corners)| triangle::meet(ray, corners));
}

#[divan::bench]
fn triangle_intersect_exactly(bencher: Bencher<'_, '_>) {
    each(bencher, &rays_and_corners(), |(ray, corners)| exact::meet(ray, corners));
}

#[divan::bench]
fn triangle_prepare_ray(bencher: Bencher<'_, '_>) {
    each(bencher, &rays_and_corners::<3>(), |(ray, _)| ShearedSpace::new(ray));
}

#[divan::bench]
fn triangle_surface(bencher: Bencher<'_, '_>) {
    each(bencher, &rays_and_corners(), |(ray, corners)| {
        let corners = corners.map(Vector::from);
        surface::triangle_at::<f32, Exact>(&Line::from(ray), 0.0, &corners)
    });
}

#[divan::bench]
fn triangle_is_degenerate(bencher: Bencher<'_, '_>) {
    each(bencher, &rays_and_corners(), |(_, corners)| triangle::is_degenerate(corners));
}

/// The hard case: corners on one line, which only exact arithmetic detects.
#[divan::bench]
fn triangle_is_degenerate_on_a_line(bencher: Bencher<'_, '_>) {
    let line = |(_, [a, b, _]): (Ray, [Vec3; 3])| [a, b, a + (b - a) * 0.5];
    let inputs: Vec<_> = rays_and_corners().into_iter().map(line).collect();
    each(bencher, &inputs, triangle::is_degenerate);
}

#[divan::bench]
fn quad_halves(bencher: Bencher<'_, '_>) {
    each(bencher, &rays_and_quads(), |(ray, corners)| {
        surface::quad_halves(&Line::from(ray), 0.0, &corners.map(Vector::from), 1)
    });
}

#[divan::bench]
fn sphere_intersect(bencher: Bencher<'_, '_>) {
    each(bencher, &rays_and_corners(), |(ray, [center])| {
        let range = [ray.t_min, ray.t_max];
        sphere::meet::<f32, Exact>(&Line::from(ray), *center, 0.5, range)
    });
}

#[divan::bench]
fn sphere_surface(bencher: Bencher<'_, '_>) {
    each(bencher, &rays_and_corners(), |(ray, [center])| {
        let columns = [*center, Vec3::splat(0.5), Vec3::ZERO].map(Vector::from);
        surface::quadric_at::<f32, Exact>(&Line::from(ray), 0.0, &columns)
    });
}

#[divan::bench]
fn slab_interval(bencher: Bencher<'_, '_>) {
    let prepare = |(ray, corners): (Ray, [Vec3; 2])| (SlabRay::new(&ray), Aabb::around(corners));
    let inputs: Vec<_> = rays_and_corners().into_iter().map(prepare).collect();
    each(bencher, &inputs, |(ray, bounds)| ray.interval(bounds));
}

#[divan::bench]
fn slab_prepare_ray(bencher: Bencher<'_, '_>) {
    each(bencher, &rays_and_corners::<1>(), |(ray, _)| SlabRay::new(ray));
}

#[divan::bench]
fn philox(bencher: Bencher<'_, '_>) {
    let counters: Vec<_> = (0..INPUTS).map(|i| [i, 1, 0, 3]).collect();
    each(bencher, &counters, |counter| philox_4x32_10(*counter, [7, 0]));
}

/// Exponents: no highlight, integers by squaring, and one that needs `powf`.
#[divan::bench(args = ["diffuse", "exponent 20", "exponent 1000", "exponent 20.5"])]
fn blinn_phong(bencher: Bencher<'_, '_>, kind: &str) {
    let exponent = kind.strip_prefix("exponent ").and_then(|number| number.parse().ok());
    let material = Material {
        ks: if exponent.is_some() { 0.2 } else { 0.0 },
        kd: 0.8,
        exponent: exponent.unwrap_or(1.0),
        color: Vec3::new(0.9, 0.5, 0.1),
        ..Material::BLACK
    };
    let inputs = inputs(|point| [0, 1, 2].map(|k| normalize(point(k) + Vec3::Z)));
    each(bencher, &inputs, |[normal, view, light]| {
        let [normal, view, light] = [*normal, *view, *light].map(Vector::from);
        blinn_phong::reflect(&material.reflection(), material.color.into(), normal, view, light)
    });
}

fn texture() -> Image {
    let texels = (0..256 * 256_u32).map(u32::to_le_bytes).collect();
    Image::new(256, 256, Texels::Bytes(texels))
}

#[divan::bench(args = [Filter::Nearest, Filter::Bilinear])]
fn texture_look_up(bencher: Bencher<'_, '_>, filter: Filter) {
    let image = texture();
    let inputs = inputs(|point| Vec2::new(point(0).x, point(0).y));
    each(bencher, &inputs, |uv| image.look_up(uv.to_array(), filter, Wrap::Repeat));
}

/// With the footprint's level: within one level, and between two.
#[divan::bench(args = [1.0, 2.5])]
fn trilinear_look_up(bencher: Bencher<'_, '_>, texels: f32) {
    let mut image = texture();
    image.build_pyramid();
    let side = texels / 256.0;
    let footprint = [[side, 0.0], [0.0, side]];
    let inputs = inputs(|point| Vec2::new(point(0).x, point(0).y));
    each(bencher, &inputs, |uv| {
        image.look_up_at(uv.to_array(), image.level(&footprint), Wrap::Repeat).0
    });
}
