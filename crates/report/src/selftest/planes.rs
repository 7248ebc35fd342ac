//! Coplanar surfaces: floors, copies of a triangle, and hits before a ray's origin.

use glam::{DMat3, DQuat, DVec3, Vec3};

use super::case::{Effort, Outcome};
use super::closed::globe;
use super::trees::add_triangle;
use super::ways::{Numbers, Tests, every_way, inputs};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, Hit};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::math::float::offset_origin;
use wavecrest_core::math::ray::Ray;

/// Floors of case 37.
const FLOORS: usize = 100;

/// Case 37. A light at a height of 1e-5 to 1e-2 of the floor's width sees every point of the floor.
pub(super) fn floors(effort: &Effort) -> Outcome {
    (0..FLOORS).map(|floor| floor_under_a_light(effort, floor)).sum()
}

fn floor_under_a_light(effort: &Effort, floor: usize) -> Outcome {
    let mut numbers = Numbers::new(effort, 37, usize::MAX - floor);
    let turned = rotation(&mut numbers);
    let width = numbers.magnitude(1e-3, 1e3);
    let moved = numbers.direction() * width * [0.0, 1.0, 100.0][numbers.below(3)];
    let place = |x: f64, y: f64, z: f64| (turned * DVec3::new(x, y, z) * width + moved).as_vec3();
    let corners =
        [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| place(x, y, 0.0));
    let mut geometry = Geometry { positions: corners.to_vec(), ..Geometry::default() };
    if floor.is_multiple_of(2) {
        geometry.triangles.extend([[0, 1, 2], [0, 2, 3]]);
    } else {
        geometry.quads.push([0, 1, 2, 3]);
    }
    let [x, y] = [(); 2].map(|()| numbers.one() - 0.5);
    let light = place(x, y, numbers.magnitude(1e-5, 1e-2));
    let near = numbers.magnitude(1e-2, 1.0);
    let tests = Tests::of(effort);
    let start = floor * 1_000_000;
    let rays: Vec<Ray> = inputs(effort, 37, start..start + effort.of(10_000_000) / FLOORS)
        .filter_map(|mut numbers| {
            let [u, v] = [(); 2].map(|()| (2.0 * numbers.one() - 1.0) * near);
            // Points near the light, and near the diagonal.
            let (u, v) = (x + u, if numbers.below(2) == 0 { x + u + v * 1e-3 } else { y + v });
            let eye = place(u, v, 1.0);
            let down = Ray::new(eye, place(u, v, 0.0) - eye);
            let half = [[0, 1, 2], [0, 2, 3]].map(|half: [usize; 3]| half.map(|v| corners[v]));
            let met = half.iter().find_map(|half| Some((tests.triangle(&down, half)?, half)));
            let (t, half) = met?;
            let [point, error, normal] = tests.surface(&down, t, half).vectors();
            let origin = offset_origin(point, error, normal, light - point);
            Some(Ray { t_max: 1.0, ..Ray::new(origin, light - origin) })
        })
        .collect();
    every_way(effort.accel(geometry, Preset::VeryFast), &rays, |_, _, hit| {
        (!hit.is_miss()).then(|| format!("the floor shadows itself at {}", hit.t))
    })
}

/// A random rotation.
pub(super) fn rotation(numbers: &mut Numbers) -> DMat3 {
    let angle = std::f64::consts::TAU * numbers.one();
    DMat3::from_quat(DQuat::from_axis_angle(numbers.direction(), angle))
}

/// Case 38. Copies have their corners in every order. Other triangles are coplanar with them,
/// across an axis.
pub(super) fn copies(effort: &Effort) -> Outcome {
    const SCENES: usize = 50;
    (0..SCENES)
        .map(|scene| {
            let mut numbers = Numbers::new(effort, 38, usize::MAX - scene);
            let k = numbers.below(3);
            let (size, height) = (numbers.magnitude(1e-3, 1e3), numbers.one() as f32);
            let mut corner = || {
                let mut at = (numbers.direction() * size).as_vec3();
                at[k] = height;
                at
            };
            let first = [(); 3].map(|()| corner());
            let others = [(); 5].map(|()| [(); 3].map(|()| corner()));
            let mut geometry = Geometry::default();
            let [a, b, c] = first;
            for turned in [[a, b, c], [c, a, b], [b, a, c], [b, c, a], [c, b, a], [a, c, b]] {
                add_triangle(&mut geometry, turned);
            }
            others.into_iter().for_each(|other| add_triangle(&mut geometry, other));
            let start = scene * 1_000_000;
            let rays: Vec<Ray> = inputs(effort, 38, start..start + effort.of(1_000_000) / SCENES)
                .map(|mut numbers| {
                    let target = numbers.within(first);
                    let middle = (a + b + c).as_dvec3() / 3.0;
                    // Clear of the edges.
                    let target = target + (middle - target) * 0.01;
                    let origin =
                        target + numbers.direction() * numbers.magnitude(0.01, 100.0) * size;
                    Ray::new(origin.as_vec3(), (target - origin.as_vec3().as_dvec3()).as_vec3())
                })
                .collect();
            every_way(effort.accel(geometry, Preset::VeryFast), &rays, |_, ray, hit| {
                // A ray almost in the plane may meet it beyond the triangle, after its target is
                // rounded.
                let is_steep = ray.direction[k].abs() > 1e-3 * ray.direction.length();
                (is_steep && hit.primitive != 0).then(|| format!("{hit:?} and not the first"))
            })
        })
        .sum()
}

/// Case 39: globes with one axis up to 1e12 times as long as another.
pub(super) fn needles(effort: &Effort) -> Outcome {
    [1e-4, 1e-6]
        .into_iter()
        .enumerate()
        .map(|(i, thin)| {
            let case = 39 + 64 * i as u32;
            let scale = DVec3::new(thin, 1.0, 1.0 / thin);
            let whole = (1.0, Vec3::ZERO);
            let mut closed = globe(Numbers::new(effort, case, usize::MAX), [16, 24], 0.0, whole);
            let stretch = |p: &mut Vec3| *p = (p.as_dvec3() * scale).as_vec3();
            closed.geometry.positions.iter_mut().for_each(stretch);
            let rays: Vec<Ray> = inputs(effort, case, 0..effort.either(40_000, 1_000_000))
                .map(|mut numbers| {
                    let inside =
                        numbers.direction() * 0.5 * f64::from(closed.radius) * numbers.one();
                    let origin = (inside * scale).as_vec3();
                    let target = (numbers.direction() * scale).as_vec3();
                    Ray::new(origin, target - origin)
                })
                .collect();
            every_way(effort.accel(closed.geometry, Preset::VeryFast), &rays, |_, _, hit| {
                hit.is_miss().then(|| "it leaves".to_owned())
            })
        })
        .sum()
}

/// Case 40: ranges of t that begin before the origin.
pub(super) fn before_the_origin(effort: &Effort) -> Outcome {
    inputs(effort, 40, 0..effort.of(10_000))
        .map(|mut numbers| {
            let corners = [(); 3].map(|()| numbers.direction().as_vec3());
            let t = -numbers.magnitude(1e-2, 1e2);
            let target = numbers.within(corners);
            let direction = numbers.direction();
            let origin = (target - direction * t).as_vec3();
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).as_dvec3();
            let sides = [0, 1, 2].map(|i: usize| (corners[(i + 1) % 3] - corners[i]).as_dvec3());
            let inward = [0, 1, 2].map(|i: usize| {
                let from_edge = target - corners[i].as_dvec3();
                sides[i].cross(from_edge).dot(normal) / (normal.length() * sides[i].length())
            });
            // Certain to be hit: clear of the edges, and not grazing.
            if inward.into_iter().fold(f64::INFINITY, f64::min) < 1e-2
                || direction.dot(normal).abs() < 0.1 * normal.length()
            {
                return Outcome::default();
            }
            let mut geometry = Geometry::default();
            add_triangle(&mut geometry, corners);
            let ray = |t_min: f64, t_max: f64| Ray {
                t_min: t_min as f32,
                t_max: t_max as f32,
                ..Ray::new(origin, direction.as_vec3())
            };
            let rays = [
                ray(1.1 * t, f64::INFINITY),
                ray(1.1 * t, 0.9 * t),
                ray(0.9 * t, 1e9),
                ray(1.2 * t, 1.1 * t),
            ];
            let accel: Accel = effort.accel(geometry, Preset::VeryFast);
            every_way(accel, &rays, |i, _, hit: Hit| {
                let is_right =
                    if i >= 2 { hit.is_miss() } else { (f64::from(hit.t) / t - 1.0).abs() < 1e-3 };
                (!is_right).then(|| format!("{hit:?} and not {t}"))
            })
        })
        .sum()
}

/// Half the widths of the floors of case 47, in units of the [`AXES`]. Times the sum of two axes
/// they are exact in single precision, so that the floors are flat.
const HALF_WIDTHS: [f64; 4] = [1e1, 1e4, 1e6, 1e9];

/// Axes at right angles, of whole numbers and of one length.
const AXES: [[DVec3; 3]; 3] = [
    [DVec3::X, DVec3::Y, DVec3::Z],
    [DVec3::new(3.0, 4.0, 0.0), DVec3::new(-4.0, 3.0, 0.0), DVec3::new(0.0, 0.0, 5.0)],
    [DVec3::new(1.0, 2.0, 2.0), DVec3::new(2.0, 1.0, -2.0), DVec3::new(-2.0, 2.0, -1.0)],
];

/// Floors of case 47: each width with each set of axes, four times.
const WIDE_FLOORS: usize = 4 * HALF_WIDTHS.len() * AXES.len();

/// Case 47. A ray that comes down on a floor clear of its edges must hit it, also if it passes the
/// diagonal more closely than rounding can tell, before or behind its start.
pub(super) fn floors_from_just_above(effort: &Effort) -> Outcome {
    (0..WIDE_FLOORS).map(|floor| floor_from_just_above(effort, floor)).sum()
}

fn floor_from_just_above(effort: &Effort, floor: usize) -> Outcome {
    let mut numbers = Numbers::new(effort, 47, usize::MAX - floor);
    let half = HALF_WIDTHS[floor % HALF_WIDTHS.len()];
    let mut axes = AXES[floor / HALF_WIDTHS.len() % AXES.len()];
    axes.rotate_left(numbers.below(3));
    let [u, v, normal] = axes;
    let mut corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| ((u * x + v * y) * half).as_vec3());
    // Either diagonal, in either direction.
    corners.rotate_left(numbers.below(4));
    let diagonal = (corners[2] - corners[0]).as_dvec3() / (2.0 * half);
    let geometry =
        Geometry { positions: corners.to_vec(), quads: vec![[0, 1, 2, 3]], ..Geometry::default() };
    let height = half * numbers.magnitude(1e-9, 1e-4);
    // Of every axis.
    let squared = normal.length_squared();
    let start = floor * 1_000_000;
    let rays: Vec<Ray> = inputs(effort, 47, start..start + effort.of(2_000_000) / WIDE_FLOORS)
        .filter_map(|mut numbers| {
            let mut within = |size: f64| {
                let [x, y] = [(); 2].map(|()| (2.0 * numbers.one() - 1.0) * size);
                u * x + v * y
            };
            let foot = within(10.0 * height);
            let anywhere = within(1.0);
            let along = if numbers.below(4) == 0 { anywhere } else { diagonal * numbers.sign() };
            let target = along * height * numbers.magnitude(0.1, 1e4);
            let eye = (foot + normal * height).as_vec3();
            let ray = Ray::new(eye, (target - eye.as_dvec3()).as_vec3());
            // Where this ray, as rounded, comes down.
            let [origin, direction] = [ray.origin, ray.direction].map(|v| v.as_dvec3());
            let t = origin.dot(normal) / -direction.dot(normal);
            let place = origin + direction * t;
            let is_within = |axis| place.dot(axis).abs() < 0.9 * half * squared;
            (t > 0.0 && is_within(u) && is_within(v)).then_some(ray)
        })
        .collect();
    every_way(effort.accel(geometry, Preset::VeryFast), &rays, |_, _, hit| {
        hit.is_miss()
            .then(|| format!("it falls through a floor {:e} wide", 2.0 * half * squared.sqrt()))
    })
}
