use glam::Vec3;

use super::*;
use wavecrest_core::geometry::Quadric;
use wavecrest_core::kernels::disk;
use wavecrest_core::kernels::light::{Falloff, Triangles};
use wavecrest_core::kernels::precision::Exact;
use wavecrest_core::kernels::shade::{ShadingPoint, shadow_request};
use wavecrest_core::kernels::surface;
use wavecrest_core::math::float::{dot, normalize};
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::sampling::Sampling;
use wavecrest_core::math::vector::{Line, Vector};

const WHITE: Material =
    Material { ks: 0.5, kd: 0.5, exponent: 8.0, color: Vec3::ONE, ..Material::BLACK };

fn light(emitter: Emitter) -> Light {
    let (falloff, sampling) = (Falloff::Linear, Sampling::Random);
    Light { emitter, power: Vec3::ONE, falloff, sampling, grid: [1, 1], dimension: 7 }
}

fn shape(two_sided: bool, flipped: bool) -> Shape {
    Shape { primitives: 0..1, flipped, two_sided, ..Shape::default() }
}

fn of_triangle(corners: [Vec3; 3]) -> Geometry {
    Geometry {
        positions: corners.to_vec().into(),
        triangles: vec![[0, 1, 2]].into(),
        ..Geometry::default()
    }
}

fn of_quadric(quadric: Quadric) -> Geometry {
    Geometry { quadrics: vec![quadric], ..Geometry::default() }
}

fn reaches(light: &Light, shape: &Shape, material: &Material, geometry: &Geometry) -> bool {
    let receiver = Receiver { shape, material, textured: false, faces: Faces::lit(shape) };
    let [lights, receivers] = reached(&[light], &[receiver], geometry);
    assert_eq!(lights, receivers);
    lights[0]
}

fn random(index: u32, dimension: u32) -> Vec3 {
    let [x, y, z, _] = Stream { seed: 3, pixel: index, sample: 0, bounce: 0 }.uniform(dimension);
    Vec3::new(x, y, z) - 0.5
}

/// Whether the shading step asks the light for anything where `ray` arrives.
fn asks(
    light: &Light,
    at: surface::SurfacePoint<f32>,
    flipped: bool,
    ray: &Ray,
    index: u32,
) -> bool {
    let outward = if flipped { -at.normal } else { at.normal };
    let is_front = dot(outward.into(), ray.direction) < 0.0;
    let normal = if is_front { outward } else { -outward };
    let [point, error, _] = at.vectors();
    let point = ShadingPoint::plain([point, error, normal.into()], -ray.direction, &WHITE);
    let point = ShadingPoint { shading_normal: outward, lit: is_front, ..point };
    let stream = Stream { seed: 5, pixel: index, sample: 0, bounce: 0 };
    shadow_request(&point, Vec3::ONE.into(), light, &light.point(0, &stream), None).is_some()
}

/// A light near the plane of a triangle somewhere, on either side: at a point, on a sphere, on a triangle.
fn near_plane(index: u32, corners: &[Vec3; 3], size: f32) -> Light {
    let [a, b, c] = *corners;
    let normal = triangle::normal(corners).as_vec3();
    let height = libm::exp2f(-24.0 * (random(index, 20).x + 0.5)) * size;
    let side = if random(index, 20).y < 0.0 { -height } else { height };
    let place = a + (b - a) * random(index, 21).x * 3.0 + (c - a) * random(index, 21).y * 3.0;
    let place = place + normal * side;
    light(match index % 3 {
        0 => Emitter::Point(place),
        1 => Emitter::Sphere { center: place, radius: height * (random(index, 22).x + 0.5) },
        _ => {
            let corner = |d| place + random(index, d) * height;
            let corners = vec![[corner(23), corner(24), corner(25)]];
            // Far out, corners so near to each other are one.
            Triangles::new(corners).map_or(Emitter::Point(place), Emitter::Triangles)
        }
    })
}

/// How many lights were left out, and how often others were asked for.
#[derive(Default)]
struct Trials {
    left_out: u32,
    asked: u32,
}

impl Trials {
    /// Checks that no ray to a shape, given by its end and its start, asks for a light that was left
    /// out.
    fn add(
        &mut self,
        index: u32,
        light: &Light,
        shape: &Shape,
        geometry: &Geometry,
        arrival: impl Fn(u32) -> [Vec3; 2],
    ) {
        let out = !reaches(light, shape, &WHITE, geometry);
        self.left_out += u32::from(out);
        for [target, origin] in (0..8).map(arrival) {
            let ray = Ray::new(origin, normalize(target - origin));
            if !ray.is_valid() {
                continue;
            }
            let line = Line::from(&ray);
            let at = match geometry.quadrics.first() {
                Some(quadric) => {
                    let t = match quadric {
                        Quadric::Sphere(..) => Some(0.0),
                        Quadric::Disk(disk) => disk::intersect_exactly(&ray, disk),
                    };
                    let Some(t) = t else { continue };
                    let columns = quadric.columns().map(Vector::from);
                    surface::quadric_at::<f32, Exact>(&line, t, &columns)
                }
                None => {
                    let corners = geometry.triangle(0).map(Vector::from);
                    surface::triangle_at::<f32, Exact>(&line, 0.0, &corners)
                }
            };
            let asks = asks(light, at, shape.flipped, &ray, index);
            self.asked += u32::from(asks);
            assert!(!(out && asks), "{index}: {light:?} {geometry:?}");
        }
    }

    fn are_at_least(&self, left_out: u32, asked: u32) {
        let Self { left_out: out, asked: times } = *self;
        assert!(out > left_out && times > asked, "{out} left out, asked {times} times");
    }
}

/// A size of any order, and a place as far away as it or nearer.
fn somewhere(index: u32) -> (f32, Vec3) {
    let size = libm::exp2f(40.0 * random(index, 1).x);
    (size, random(index, 2) * size * libm::exp2f(20.0 * random(index, 3).x))
}

/// A point near a triangle, or in it.
fn beside(corners: &[Vec3; 3], index: u32, turn: u32) -> Vec3 {
    let weights = random(index, 30 + turn).abs() * 2.0;
    let weights = weights / (weights.x + weights.y + weights.z);
    corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z
}

#[test]
fn surfaces_for_which_a_light_is_left_out_never_sample_it() {
    let mut trials = Trials::default();
    for index in 0..20_000 {
        let (size, offset) = somewhere(index);
        let corners = [10, 11, 12].map(|d| offset + random(index, d) * size);
        let geometry = of_triangle(corners);
        if geometry.is_degenerate(0) {
            continue;
        }
        let light = near_plane(index, &corners, size);
        trials.add(index, &light, &shape(false, index % 2 == 0), &geometry, |turn| {
            let target = beside(&corners, index, turn);
            [target, target + random(index, 40 + turn) * size]
        });
    }
    trials.are_at_least(4000, 10_000);
}

#[test]
fn surfaces_for_which_a_cone_is_left_out_are_in_its_dark() {
    let mut trials = Trials::default();
    for index in 0..20_000 {
        let (size, offset) = somewhere(index);
        let center = offset + random(index, 4) * size;
        let radius = size * (0.51 + random(index, 5).x);
        let disk = Disk { center, normal: normalize(random(index, 6)), radius };
        let quadric = match index % 6 {
            0 => Some(Quadric::Sphere(center, radius)),
            3 => Some(Quadric::Disk(disk)),
            _ => None,
        };
        let corners = [10, 11, 12].map(|d| offset + random(index, d) * size);
        let geometry = quadric.map_or_else(|| of_triangle(corners), of_quadric);
        if geometry.is_degenerate(0) {
            continue;
        }
        let outer = 90.0 * f64::from(random(index, 6).x + 0.5);
        // Half of the axes are nearly at the edge of what is there.
        let place = offset + random(index, 7) * size * 3.0;
        let towards = if quadric.is_some() { center } else { corners[0] } - place;
        let across = normalize(towards.cross(random(index, 8)));
        let (sine, cosine) = libm::sincos(outer.to_radians());
        let near = random(index, 9) * libm::exp2f(-20.0 * (random(index, 9).y + 0.5));
        let axis = normalize(towards).as_dvec3() * cosine + across.as_dvec3() * sine;
        let axis = if index % 2 == 0 { axis + near.as_dvec3() } else { random(index, 9).into() };
        let cone = Cone::new(normalize_f64(axis), outer / 2.0, outer);
        let light = light(Emitter::Spot(place, cone));
        trials.add(index, &light, &shape(true, false), &geometry, |turn| {
            let there = normalize(random(index, 50 + turn));
            let target = match quadric.map(|quadric| quadric.parts().2) {
                Some(front) => center + (there - front * front.dot(there)) * radius,
                None => beside(&corners, index, turn),
            };
            [target, target + (there + random(index, 40 + turn)) * size]
        });
    }
    trials.are_at_least(2000, 3000);
}

/// A triangle in the plane z = 0 whose front, as in mesh files, is on +z.
fn facing_z() -> Geometry {
    of_triangle([Vec3::ZERO, Vec3::X, Vec3::Y])
}

#[test]
fn a_light_is_kept_only_for_what_reflects_its_colour() {
    let red = Light { power: Vec3::X, ..light(Emitter::Point(Vec3::Z)) };
    let seen = |material: &Material| reaches(&red, &shape(false, false), material, &facing_z());
    assert!(seen(&WHITE));
    assert!(!seen(&Material { ks: 0.0, kd: 0.0, ..WHITE }));
    assert!(!seen(&Material { ks: 0.0, color: Vec3::new(0.0, 1.0, 1.0), ..WHITE }));
    assert!(seen(&Material { color: Vec3::ZERO, ..WHITE }), "highlights are of the light's colour");
    let black = Light { power: Vec3::ZERO, ..red.clone() };
    assert!(!reaches(&black, &shape(true, false), &WHITE, &facing_z()));
    let green = Material { ks: 0.0, color: Vec3::Y, ..WHITE };
    let (shape, faces) = (&shape(false, false), Faces::FRONT);
    let receiver = Receiver { shape, material: &green, textured: true, faces };
    let [found, _] = reached(&[&red], &[receiver], &facing_z());
    assert_eq!(found, [true], "a texture may be of any colour");
}
