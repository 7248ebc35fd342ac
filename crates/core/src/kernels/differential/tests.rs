//! Derivatives against differences of neighbouring rays, which are followed in double precision.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::*;
use crate::kernels::texture::{PlanarMap, sphere_uv_change};
use crate::math::float::normalize_f64;
use crate::math::random::Stream;

/// Width of the central difference in samples: errors of the second order are below the bound.
const STEP: f64 = 1e-3;

/// Random numbers, one after the other.
struct Numbers {
    stream: Stream,
    drawn: u32,
}

impl Numbers {
    fn new(index: u32) -> Self {
        Self { stream: Stream { seed: 41, pixel: index, sample: 0, bounce: 0 }, drawn: 0 }
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        let number = self.stream.uniform(self.drawn / 4)[self.drawn as usize % 4];
        self.drawn += 1;
        low + (high - low) * f64::from(number)
    }

    fn direction(&mut self) -> DVec3 {
        normalize_f64(DVec3::from_array([0; 3].map(|_| self.between(-1.0, 1.0))))
    }
}

/// Solved for as a system of equations, unlike the kernel does it.
fn weights_of(corners: &[Vec3; 3], point: DVec3) -> [f64; 2] {
    let [a, b, c] = corners.map(|v| v.as_dvec3());
    let (u, v, p) = (b - a, c - a, point - a);
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let (pu, pv) = (p.dot(u), p.dot(v));
    let determinant = uu * vv - uv * uv;
    [(pu * vv - pv * uv) / determinant, (pv * uu - pu * uv) / determinant]
}

#[test]
fn texture_coordinates_change_as_their_neighbours_say() {
    for index in 0..1000 {
        let mut numbers = Numbers::new(index);
        let corners = [0; 3].map(|_| (numbers.direction() * 4.0).as_vec3());
        let uvs = [0; 3].map(|_| {
            Vec2::new(numbers.between(-3.0, 3.0) as f32, numbers.between(-3.0, 3.0) as f32)
        });
        let [a, b, c] = corners.map(|v| v.as_dvec3());
        let normal = (b - a).cross(c - a);
        if normal.length() < 0.5 {
            continue;
        }
        let step = (b - a) * numbers.between(-1.0, 1.0) + (c - a) * numbers.between(-1.0, 1.0);
        let uv_at = |point: DVec3| {
            let [y, z] = weights_of(&corners, point);
            let [a, b, c] = uvs.map(|uv| uv.as_dvec2());
            a * (1.0 - y - z) + b * y + c * z
        };
        let exact = uv_at(a + step) - uv_at(a);
        let found = uv_change(&corners, &uvs, step.as_vec3());
        let size = uvs.iter().fold(0.0, |m: f32, uv| m.max(uv.length()));
        let error = found.as_dvec2().distance(exact) / f64::from(size);
        assert!(error < 1e-4, "{index}: {found} is off {exact} by {error:e}");

        let map = PlanarMap::new(corners[0], corners[1] - corners[0], corners[2] - corners[0]);
        let whole = map.change(corners[1] - corners[0]).x;
        assert!((whole - 1.0).abs() < 1e-5, "{whole}");
    }
}

/// The coordinates of a sphere's point, from a normal of any length.
fn sphere_uv64(n: DVec3) -> DVec2 {
    let n = normalize_f64(n);
    DVec2::new(n.x.atan2(n.z), n.y.asin() * 2.0) / std::f64::consts::TAU
}

#[test]
fn coordinates_of_a_sphere_change_as_their_neighbours_say() {
    for index in 0..3000 {
        let mut numbers = Numbers::new(index);
        let normal = numbers.direction();
        if normal.y.abs() > 0.99 {
            continue;
        }
        let across = numbers.direction();
        let turn = (across - normal * across.dot(normal)) * STEP;
        let [after, before] = [1.0, -1.0].map(|side| sphere_uv64(normal + turn * side));
        let mut exact = (after - before) / 2.0;
        // Behind, u begins again.
        if exact.x.abs() > 0.25 {
            exact.x -= 0.5_f64.copysign(exact.x);
        }
        let found = sphere_uv_change(normal.as_vec3(), turn.as_vec3()).as_dvec2();
        let error = found.distance(exact) / exact.length();
        // A step of a thousandth, near the poles of a tenth of the way there.
        assert!(error < 1e-4 / (1.0 - normal.y * normal.y), "{index}, {normal}: {error:e}");
    }
}

#[test]
fn hc30_at_the_poles_of_a_sphere_coordinates_change_by_finite_amounts() {
    for pole in [1.0, -1.0] {
        for beside in [0.0, 1e-45, 1e-30, 1e-20, 1e-7] {
            for step in [0.0, 1e-30, 1e-4, 1.0, 1e30] {
                for turn in [Vec3::X, Vec3::Z, Vec3::new(-0.6, 0.0, 0.8)] {
                    let found = sphere_uv_change(Vec3::new(beside, pole, -beside), turn * step);
                    assert!(found.is_finite() && found.x.abs() <= 0.25, "{found}");
                }
            }
        }
    }
    // A step away from the pole goes along a meridian, and by as much in v.
    let [away, aside] = [Vec3::Z, Vec3::X].map(|turn| sphere_uv_change(Vec3::Y, turn * 0.01));
    assert!((away.y.abs() * std::f32::consts::PI - 0.01).abs() < 1e-8 && away.x == 0.0, "{away}");
    assert!(aside == Vec2::new(0.25, 0.0), "{aside}");
}

#[test]
fn a_grazing_ray_spreads_without_bound_and_never_silently() {
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let differential =
        Differential { origin: [Vec3::ZERO; 2], direction: [Vec3::Y * 0.1, Vec3::Z * 0.1] };
    let [across, along] = differential.at(&ray, 10.0, Vec3::Y);
    assert!(!across.is_finite(), "{across}");
    assert!(!along.is_finite() || along.distance(Vec3::Z) < 1e-6, "{along}");
}
