//! Rays at the faces of boxes, along axes, and through triangles that a tree cannot tell apart. Most
//! coordinates are integers, so that many rays meet edges, corners and planes exactly.

use super::prelude::*;
use super::shapes::{add_cube, cubes};

/// The unit of a grid on which corners and rays lie.
const UNIT: f32 = 4096.0;

/// A random integer coordinate from -1 to 1 in units, or a multiple of a quarter unit: on faces and
/// edges.
fn coordinate(rng: &mut InputRng) -> f32 {
    if rng.once_in(2) {
        (rng.below(9) as f32 / 4.0 - 1.0) * UNIT
    } else {
        (rng.about(1.0) as f32 * UNIT).round()
    }
}

fn point(rng: &mut InputRng) -> Vec3 {
    Vec3::from([(); 3].map(|()| coordinate(rng)))
}

/// A point with integer coordinates from -`most` to `most`.
fn whole_point(rng: &mut InputRng, most: usize) -> Vec3 {
    Vec3::from([(); 3].map(|()| rng.below(2 * most + 1) as f32 - most as f32))
}

/// A ray from one of these points, which are far apart, towards another.
fn between_points(rng: &mut InputRng) -> Ray {
    let (origin, target) = (point(rng) * 2.0, point(rng));
    Ray::new(origin, target - origin)
}

/// Cubes around the origin, on whose faces many rays start and end.
fn cubes_of_units() -> Geometry {
    let mut geometry = cubes(3, 0.75 * UNIT);
    geometry.positions.iter_mut().for_each(|p| *p -= UNIT);
    geometry
}

/// The scales of case 3.
const SCALES: [f32; 3] = [1.0 / UNIT, 1_048_576.0 / UNIT, 1.0 / (UNIT * 1_048_576.0)];

/// Case 3.
pub(super) fn faces(rng: &mut InputRng) -> World {
    let scale = SCALES[rng.index % 3];
    let mut geometry = cubes_of_units();
    for _ in 0..200 {
        let center = point(rng);
        let size = rng.magnitude(1e-3, 1.0) as f32;
        let corners = [(); 3].map(|()| center + (point(rng) * size).round());
        add_triangle(&mut geometry, corners);
    }
    geometry.positions.iter_mut().for_each(|p| *p *= scale);
    World::new(geometry, MIXED, move |rng| {
        let ray = between_points(rng);
        Some(Ray::new(ray.origin * scale, ray.direction * scale))
    })
}

/// Case 4. Rays along each axis, in both directions, with zeros of both signs, in the planes of
/// faces, along edges, and from planes.
pub(super) fn along_axes(_: &mut InputRng) -> World {
    World::new(cubes(4, 2.0), ALL_HIT, |rng| {
        let (k, sign) = (rng.below(3), rng.sign() as f32);
        // Across the ray, within the cubes of a row: on a face's plane, on an edge or inside.
        let mut origin = Vec3::ZERO;
        for other in [(k + 1) % 3, (k + 2) % 3] {
            let within = [0.0, 0.5, 1.0, rng.one() as f32][rng.below(4)];
            origin[other] = 2.0 * rng.below(4) as f32 + within;
        }
        // Along the ray: before all cubes, or on the plane of a face with others behind it.
        let steps = 2.0 * rng.below(3) as f32;
        let before = rng.among([0.0, 4.0]);
        origin[k] = if sign > 0.0 { steps - before } else { 7.0 - steps + before };
        let mut direction = Vec3::splat(rng.among([0.0, -0.0]));
        direction[k] = sign;
        Some(Ray::new(origin, direction))
    })
}

/// Case 5. One or two components are zeros of either sign.
pub(super) fn signed_zeros(_: &mut InputRng) -> World {
    World::new(cubes_of_units(), MIXED, |rng| {
        let (mut ray, k) = (between_points(rng), rng.below(3));
        for k in [k, (k + rng.below(2)) % 3] {
            ray.direction[k] = rng.among([0.0, -0.0]);
        }
        Some(ray)
    })
}

/// Case 6. Nearly axis-parallel rays at small cubes from far away.
pub(super) fn tiny_components(_: &mut InputRng) -> World {
    const SIDE: f32 = 0.01;
    let mut geometry = Geometry::default();
    Vec3::AXES.into_iter().for_each(|axis| add_cube(&mut geometry, axis * 100.0, SIDE));
    World::new(geometry, ALL_HIT, |rng| {
        let k = rng.below(3);
        let t = rng.magnitude(1.0, 1e6);
        let tiny = rng.magnitude(1e-45, 1e-6);
        let mut direction = Vec3::AXES[k];
        let mut target = (Vec3::AXES[k] * 100.0).as_dvec3();
        for other in [(k + 1) % 3, (k + 2) % 3] {
            direction[other] = rng.about(tiny) as f32;
            target[other] += f64::from(SIDE) * (0.1 + 0.8 * rng.one());
        }
        // The origin from which the ray reaches the target in double precision. Rounding moves it
        // across the ray by far less than a tenth of the cube.
        let mut origin = target - direction.as_dvec3() * t;
        origin[k] = origin[k].round();
        Some(Ray::new(origin.as_vec3(), direction))
    })
}

/// Case 48.
pub(super) fn at_ends(rng: &mut InputRng) -> World {
    between(rng, [0.0, -1.0, 0.25], [0.5, 1.0, 1.0])
}

/// Case 40. Ranges that begin, and some that end, before the origin.
pub(super) fn before_the_origin(rng: &mut InputRng) -> World {
    between(rng, [-0.5, -1.0, -2.0], [-0.25, 1.0, f32::INFINITY])
}

/// Corners, origins and targets are small integers, so that many rays pass through edges and
/// corners, and end or begin exactly at what they meet: between one of these t and another.
fn between(rng: &mut InputRng, first: [f32; 3], last: [f32; 3]) -> World {
    let triangles = [(); 24].map(|()| [(); 3].map(|()| whole_point(rng, 4)));
    World::new(of_triangles(triangles), MIXED, move |rng| {
        let (origin, target) = (whole_point(rng, 4), whole_point(rng, 4));
        let (t_min, t_max) = (rng.among(first), rng.among(last));
        Some(Ray { t_min, t_max, ..Ray::new(origin, target - origin) })
    })
}

/// Case 20. The ray is exactly in the plane: it meets nothing.
pub(super) fn in_the_plane(rng: &mut InputRng) -> World {
    let corner = whole_point(rng, 50);
    let [a, b] = [(); 2].map(|()| whole_point(rng, 20));
    World::new(of_triangles([[corner, corner + a, corner + b]]), ALL_MISS, move |rng| {
        let mut along = || {
            let Vec3 { x, y, .. } = whole_point(rng, 10);
            a * x + b * y
        };
        Some(Ray::new(corner + along(), along()))
    })
}

/// Case 21: every triangle several times, in any order.
pub(super) fn duplicates(rng: &mut InputRng) -> World {
    let base = cubes_of_units();
    let mut triangles: Vec<[u32; 3]> = base.triangles.iter().flat_map(|&t| [t; 5]).collect();
    for i in (1..triangles.len()).rev() {
        triangles.swap(i, rng.below(i + 1));
    }
    World::new(Geometry { triangles: triangles.into(), ..base }, MIXED, |rng| {
        Some(between_points(rng))
    })
}

/// Number of triangles in case 23, and the ratio of consecutive sizes.
const NESTED: usize = 500;
const LARGER: f64 = 1.1;

/// Case 23: nested triangles. The one of size s is across x = s, from -s to s.
pub(super) fn nested(_: &mut InputRng) -> World {
    let triangle = |i: usize| {
        let s = (1e-10 * libm::pow(LARGER, i as f64)) as f32;
        [[-s, -s], [s, -s], [0.0, s]].map(|[y, z]| Vec3::new(s, y, z))
    };
    World::new(of_triangles((0..NESTED).map(triangle)), MIXED, |rng| {
        let far = rng.magnitude(1e-10, 1e11);
        let target = rng.direction() * rng.magnitude(1e-10, 1e10);
        let origin = [DVec3::X, rng.direction()][rng.below(2)] * far;
        Some(Ray::new(origin.as_vec3(), (target - origin).as_vec3()))
    })
}

/// Case 26: rays that are not finite, or have no direction.
pub(super) fn invalid(_: &mut InputRng) -> World {
    World::new(cubes(3, 2.0), ALL_MISS, |rng| {
        let mut ray = Ray::new(Vec3::splat(-1.0), Vec3::ONE);
        let wrong = rng.among([f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
        let which = rng.below(3);
        match rng.below(4) {
            0 => ray.origin[which] = wrong,
            1 => ray.direction[which] = wrong,
            2 => ray.direction = Vec3::ZERO,
            _ => ray.t_min = f32::NAN,
        }
        Some(ray)
    })
}
