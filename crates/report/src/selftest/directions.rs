//! Directions with components that are zero, nearly zero, or not finite.

use glam::Vec3;

use super::case::{Effort, Outcome};
use super::ways::{Numbers, every_way, inputs};
use wavecrest_core::accel::Hit;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::math::ray::Ray;

/// A grid of `n` by `n` by `n` cubes with sides of half the distance between them, each of twelve
/// triangles.
pub(super) fn cubes(n: u32, distance: f32) -> Geometry {
    let mut geometry = Geometry::default();
    for i in 0..n * n * n {
        let low = Vec3::new((i % n) as f32, (i / n % n) as f32, (i / n / n) as f32) * distance;
        add_cube(&mut geometry, low, distance / 2.0);
    }
    geometry
}

/// The corners of each side of a cube. Corner `i` has the higher x, y and z if its bits 0, 1 and 2
/// are 1.
pub(super) const CUBE_SIDES: [[u32; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn add_cube(geometry: &mut Geometry, low: Vec3, side: f32) {
    let first = geometry.positions.len() as u32;
    let bit = |i: u32, k: u32| (i >> k & 1) as f32 * side;
    geometry.positions.extend((0..8).map(|i| low + Vec3::new(bit(i, 0), bit(i, 1), bit(i, 2))));
    for [a, b, c, d] in CUBE_SIDES.map(|side| side.map(|v| first + v)) {
        geometry.triangles.extend([[a, b, c], [a, c, d]]);
    }
}

/// Rays along each axis, in both directions, with zeros of both signs, in the planes of faces,
/// along edges, and from planes.
pub(super) fn along_axes(effort: &Effort) -> Outcome {
    let geometry = cubes(4, 2.0);
    let mut rays = Vec::new();
    for mut numbers in inputs(effort, 4, 0..effort.of(1_000_000) / 6) {
        for k in 0..3 {
            for sign in [1.0, -1.0] {
                // Across the ray, within the cubes of a row: on a face's plane, on an edge or
                // inside.
                let mut origin = Vec3::ZERO;
                for other in [(k + 1) % 3, (k + 2) % 3] {
                    let within = [0.0, 0.5, 1.0, numbers.one() as f32][numbers.below(4)];
                    origin[other] = 2.0 * numbers.below(4) as f32 + within;
                }
                // Along the ray: before all cubes, or on the plane of a face with others behind it.
                let steps = 2.0 * numbers.below(3) as f32;
                origin[k] = if sign > 0.0 { steps } else { 7.0 - steps };
                if numbers.below(2) == 0 {
                    origin[k] -= sign * 4.0;
                }
                let zero = [0.0, -0.0][numbers.below(2)];
                let mut direction = Vec3::splat(zero);
                direction[k] = sign;
                rays.push(Ray::new(origin, direction));
            }
        }
    }
    every_way(effort.accel(geometry, Preset::VeryFast), &rays, |_, _, hit| {
        hit.is_miss().then(|| "it hits nothing".to_owned())
    })
}

/// The same rays with every zero of both signs.
pub(super) fn signed_zeros(effort: &Effort) -> Outcome {
    let geometry = cubes(3, 2.0);
    let pairs = effort.of(1_000_000) / 2;
    let make = |mut numbers: Numbers, zero: f32| {
        let mut vector = || Vec3::from([(); 3].map(|()| (7.0 * numbers.one() - 1.0) as f32));
        let (origin, mut direction) = (vector(), vector() - 2.5);
        let kept = numbers.below(3);
        let both = numbers.below(2) == 0;
        direction[(kept + 1) % 3] = zero;
        if both {
            direction[(kept + 2) % 3] = zero;
        }
        Ray::new(origin, direction)
    };
    let [positive, negative] = [0.0, -0.0].map(|zero| {
        inputs(effort, 5, 0..pairs).map(|numbers| make(numbers, zero)).collect::<Vec<Ray>>()
    });
    let accel = effort.accel(geometry.clone(), Preset::VeryFast);
    let mut expected = vec![Hit::MISS; pairs];
    accel.closest_of(&positive[..], &mut expected, &mut accel.traversal());
    let judged = [&positive, &negative].map(|rays| {
        let accel = effort.accel(geometry.clone(), Preset::VeryFast);
        every_way(accel, rays, |i, _, hit| {
            (hit != expected[i]).then(|| format!("{hit:?} and not {:?}", expected[i]))
        })
    });
    judged.into_iter().sum()
}

/// Nearly axis-parallel rays at small cubes from far away.
pub(super) fn tiny_components(effort: &Effort) -> Outcome {
    const SIDE: f32 = 0.01;
    let mut geometry = Geometry::default();
    for k in 0..3 {
        add_cube(&mut geometry, Vec3::AXES[k] * 100.0, SIDE);
    }
    let rays: Vec<Ray> = inputs(effort, 6, 0..effort.of(1_000_000))
        .map(|mut numbers| {
            let k = numbers.below(3);
            let t = numbers.magnitude(1.0, 1e6);
            let tiny = numbers.magnitude(1e-45, 1e-6);
            let mut direction = Vec3::AXES[k];
            let mut target = (Vec3::AXES[k] * 100.0).as_dvec3();
            for other in [(k + 1) % 3, (k + 2) % 3] {
                direction[other] = (numbers.sign() * tiny * numbers.one()) as f32;
                target[other] += f64::from(SIDE) * (0.1 + 0.8 * numbers.one());
            }
            // The origin from which the ray reaches the target in double precision. Rounding moves
            // it across the ray by far less than a tenth of the cube.
            let mut origin = target - direction.as_dvec3() * t;
            origin[k] = origin[k].round();
            Ray::new(origin.as_vec3(), direction)
        })
        .collect();
    every_way(effort.accel(geometry, Preset::VeryFast), &rays, |_, _, hit| {
        hit.is_miss().then(|| "it misses its cube".to_owned())
    })
}

/// Invalid rays.
pub(super) fn invalid(effort: &Effort) -> Outcome {
    let wrong = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let accel = effort.accel(cubes(3, 2.0), Preset::VeryFast);
    let ask = |mut numbers: Numbers| {
        let mut ray = Ray::new(Vec3::splat(-1.0), Vec3::ONE);
        let (which, value) = (numbers.below(3), wrong[numbers.below(3)]);
        match numbers.below(4) {
            0 => ray.origin[which] = value,
            1 => ray.direction[which] = value,
            2 => ray.direction = Vec3::ZERO,
            _ => ray.t_min = f32::NAN,
        }
        let mut traversal = accel.traversal();
        let hit = accel.closest(&ray, &mut traversal);
        let any = accel.occluded(&ray, &mut traversal);
        let visits = traversal.tests.nodes;
        let is_right = hit.is_miss() && !any && visits == 0;
        Outcome::one((!is_right).then(|| format!("{ray}: {hit:?}, {any}, {visits} nodes")))
    };
    inputs(effort, 26, 0..effort.of(100_000)).map(ask).sum()
}
