use glam::{DVec2, DVec3, Vec2, Vec3};
use wavecrest_core::kernels::differential::{Differential, turn_between, uv_change};
use wavecrest_core::kernels::texture::{PlanarMap, sphere_uv_change};
use wavecrest_core::math::float::normalize_f64;
use wavecrest_core::math::vector::Vector;

use crate::kernels::Numbers;

/// How far a derivative may be from the difference, in parts of its length, at 60 degrees or less from the normal.
const RELATIVE_ERROR: f64 = 2e-5;

/// Width of the central difference: errors of the second order are below the bound.
const STEP: f64 = 1e-4;

impl Numbers {
    /// Others for each case.
    fn new(index: u32) -> Self {
        Self(index << 12)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.one())
    }

    fn direction(&mut self) -> DVec3 {
        normalize_f64(DVec3::from_array([0; 3].map(|_| self.between(-1.0, 1.0))))
    }

    /// Directions that single precision has.
    fn directions<const N: usize>(&mut self) -> [DVec3; N] {
        [(); N].map(|()| self.direction().as_vec3().as_dvec3())
    }
}

fn single(v: DVec3) -> Vector<f32> {
    v.as_vec3().into()
}

#[track_caller]
fn check(found: Vector<f32>, of: impl Fn(f64) -> DVec3) {
    let exact = (of(STEP) - of(-STEP)) / (2.0 * STEP);
    let error = Vec3::from(found).as_dvec3().distance(exact) / exact.length();
    assert!(error <= RELATIVE_ERROR, "{found:?} is off {exact} by {error:e}");
}

#[test]
fn points_and_mirrored_directions_change_as_their_neighbours_say() {
    for index in 0..3000 {
        let mut numbers = Numbers::new(index);
        let [ahead, normal, moved, turned, bend] = numbers.directions();
        if ahead.dot(normal).abs() < 0.5 {
            continue;
        }
        let t = numbers.between(0.5, 5.0) as f32;
        let differential =
            Differential { origin: [single(moved); 2], direction: [single(turned); 2] };
        let steps = differential.at(single(ahead), t, single(normal));
        check(steps[0], |s| {
            let direction = ahead + turned * s;
            let to_plane = ahead * f64::from(t) - moved * s;
            moved * s + direction * (to_plane.dot(normal) / direction.dot(normal))
        });
        let turns = [single(bend); 2];
        let sent = differential.turned(single(ahead), steps, single(normal), turns, None);
        check(sent.direction[1], |s| {
            let (direction, normal) = (ahead + turned * s, normal + bend * s);
            direction - normal * (2.0 * direction.dot(normal))
        });
        assert!(sent.origin == steps && steps[0] == steps[1]);
    }
}

/// From either side.
#[test]
fn interpolated_normals_turn_as_their_neighbours_say() {
    for index in 0..3000 {
        let mut numbers = Numbers::new(index);
        let (corners, [upright, a, b, c]) = (numbers.directions::<3>(), numbers.directions());
        let normals = [a, b, c].map(|aside| upright + aside * 0.3);
        let normals = normals.map(|normal| normal.as_vec3().as_dvec3());
        let singles = corners.map(|corner| corner.as_vec3());
        let [to_b, to_c] = [corners[1], corners[2]].map(|corner| corner - corners[0]);
        if to_b.cross(to_c).length() < 0.5 {
            continue;
        }
        let (point, step) = ((to_b + to_c) / 3.0, to_b * 0.5 - to_c);
        let at = |s: f64| {
            let [y, z] = weights_of(&singles, corners[0] + point + step * s);
            normalize_f64(normals[0] * (1.0 - y - z) + normals[1] * y + normals[2] * z)
        };
        for side in [1.0, -1.0] {
            let place = (single(corners[0] + point), single(at(0.0) * side));
            let found =
                turn_between(&corners.map(single), &normals.map(single), place, single(step));
            check(found, |s| at(s) * side);
        }
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
        let found = Vec2::from(uv_change(
            &corners.map(Vector::from),
            &uvs.map(|uv| uv.to_array()),
            step.as_vec3().into(),
        ));
        let size = uvs.iter().fold(0.0, |m: f32, uv| m.max(uv.length()));
        let error = found.as_dvec2().distance(exact) / f64::from(size);
        assert!(error < 1e-4, "{index}: {found} is off {exact} by {error:e}");

        let map = PlanarMap::new(corners[0], corners[1] - corners[0], corners[2] - corners[0]);
        let [whole, _] = map.change(Vector::from(corners[1] - corners[0]));
        assert!((whole - 1.0).abs() < 1e-5, "{whole}");
    }
}

/// The coordinates of a sphere's point, from a normal of any length.
fn sphere_uv64(n: DVec3) -> DVec2 {
    let n = normalize_f64(n);
    DVec2::new(n.x.atan2(n.z), n.y.asin() * 2.0) / std::f64::consts::TAU
}

fn change_on_sphere(normal: Vec3, turn: Vec3) -> Vec2 {
    sphere_uv_change(Vector::from(normal), turn.into()).into()
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
        let found = change_on_sphere(normal.as_vec3(), turn.as_vec3()).as_dvec2();
        let error = found.distance(exact) / exact.length();
        // A small step, but near the poles of a hundredth of the way there.
        assert!(error < 1e-4 / (1.0 - normal.y * normal.y), "{index}, {normal}: {error:e}");
    }
}

#[test]
fn hc30_at_the_poles_of_a_sphere_coordinates_change_by_finite_amounts() {
    for pole in [1.0, -1.0] {
        for beside in [0.0, 1e-45, 1e-30, 1e-20, 1e-7] {
            for step in [0.0, 1e-30, 1e-4, 1.0, 1e30] {
                for turn in [Vec3::X, Vec3::Z, Vec3::new(-0.6, 0.0, 0.8)] {
                    let found = change_on_sphere(Vec3::new(beside, pole, -beside), turn * step);
                    assert!(found.is_finite() && found.x.abs() <= 0.25, "{found}");
                }
            }
        }
    }
    // A step away from the pole goes along a meridian, and by as much in v.
    let [away, aside] = [Vec3::Z, Vec3::X].map(|turn| change_on_sphere(Vec3::Y, turn * 0.01));
    assert!((away.y.abs() * std::f32::consts::PI - 0.01).abs() < 1e-8 && away.x == 0.0, "{away}");
    assert!(aside == Vec2::new(0.25, 0.0), "{aside}");
}

#[test]
fn a_grazing_ray_spreads_without_bound_and_never_silently() {
    let direction = [Vec3::Y * 0.1, Vec3::Z * 0.1].map(Vector::from);
    let differential = Differential { origin: [Vec3::ZERO.into(); 2], direction };
    let [across, along] = differential.at(Vec3::X.into(), 10.0, Vec3::Y.into()).map(Vec3::from);
    assert!(!across.is_finite(), "{across}");
    assert!(!along.is_finite() || along.distance(Vec3::Z) < 1e-6, "{along}");
}
