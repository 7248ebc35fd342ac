//! Rays at shared edges and vertices. Random rays find no leaks, as these have no width.

use super::prelude::*;
use super::shapes::{Closed, height};

/// Rings and segments, and the variation of radii.
const GLOBES: [([u32; 2], f64); 5] =
    [([2, 3], 0.0), ([5, 8], 0.3), ([9, 16], 0.3), ([20, 33], 0.0), ([12, 64], 0.2)];

/// Scales and positions.
const PLACES: [(f64, Vec3); 4] = [
    (1.0, Vec3::ZERO),
    (64.0, Vec3::new(1e5, -1e5, 1e5)),
    (1_048_576.0, Vec3::ZERO),
    (1.0 / 1_048_576.0, Vec3::ZERO),
];

/// Worlds of cases 1 and 2.
pub(super) const CLOSED: usize = GLOBES.len() * PLACES.len();

/// A ray from inside that hits something later than this, relative to its target, has leaked: the
/// target is rounded, and faces seen at a low angle are hit slightly later, but not by this much.
pub(super) const BEYOND: f64 = 1.1;

/// Case 1.
pub(super) fn edges(numbers: &mut Numbers) -> World {
    from_inside(numbers, Numbers::on_edge)
}

/// Case 2.
pub(super) fn vertices(numbers: &mut Numbers) -> World {
    from_inside(numbers, |numbers, corners| numbers.among(corners).as_dvec3())
}

fn from_inside(numbers: &mut Numbers, target: fn(&mut Numbers, [Vec3; 3]) -> DVec3) -> World {
    let (size, bumps) = GLOBES[numbers.index % GLOBES.len()];
    let (scale, offset) = PLACES[numbers.index / GLOBES.len()];
    let closed = Closed::new(numbers, size, bumps, (DVec3::splat(scale), offset));
    World::new(closed.geometry.clone(), move |numbers| {
        let origin = closed.inside(numbers);
        let corners = closed.geometry.triangle(numbers.below(closed.geometry.triangles.len()));
        let target = target(numbers, corners).as_vec3();
        Some((Ray::new(origin, target - origin), ExpectedHit::until(BEYOND)))
    })
}

/// Case 39: globes with one axis up to 1e12 times as long as another.
pub(super) fn needles(numbers: &mut Numbers) -> World {
    let thin = [1e-4, 1e-6][numbers.index % 2];
    let scale = DVec3::new(thin, 1.0, 1.0 / thin);
    let closed = Closed::new(numbers, [16, 24], 0.0, (scale, Vec3::ZERO));
    World::new(closed.geometry.clone(), move |numbers| {
        let origin = closed.inside(numbers);
        let target = (numbers.direction() * scale).as_vec3();
        Some((Ray::new(origin, target - origin), ExpectedHit::ANYTHING))
    })
}

/// The radius of the mesh of case 43.
const RADIUS: f64 = 64.0;

/// Case 43. Rays from up to 10 000 radii away, at edges and vertices of a closed mesh whose
/// surrounding faces are all visible.
pub(super) fn from_afar(_: &mut Numbers) -> World {
    let mesh = convex(6, RADIUS, 1.0 / 64.0);
    let all = 0..mesh.triangles.len();
    // For each face, those around the ends of its first edge.
    let touches =
        |[a, b, _]: [Vec3; 3], other| mesh.triangle(other).iter().any(|v| [a, b].contains(v));
    let around = |face| all.clone().filter(|&other| touches(mesh.triangle(face), other)).collect();
    let around: Vec<Vec<usize>> = all.clone().map(around).collect();
    World::new(mesh.clone(), move |numbers| {
        let face = numbers.below(mesh.triangles.len());
        let corners = mesh.triangle(face);
        let [a, b, _] = corners.map(|v| v.as_dvec3());
        let s = [0.0, numbers.one(), numbers.magnitude(1e-7, 1.0)][numbers.below(3)];
        let target = a + (b - a) * s;
        let away = numbers.magnitude(10.0, 1e4);
        // Towards the camera, on the side of the edge.
        let towards = (target.normalize() + numbers.ball(1.0)).normalize();
        let origin = (towards * (away * RADIUS)).as_vec3();
        let is_steep = |&face: &usize| height(&mesh, face, origin.as_dvec3()) > 0.2 * away * RADIUS;
        let ray = Ray::new(origin, (target - origin.as_dvec3()).as_vec3());
        // A chord at that angle is at least 0.4 radii long: this t is before the centre.
        let expected = ExpectedHit::until(1.0 + 0.2 / away);
        around[face].iter().all(is_steep).then_some((ray, expected))
    })
}

/// Points of a scan along each side, and their distance as seen by the scanner, relative to theirs
/// from it.
const POINTS: u32 = 48;
const BETWEEN: f64 = 1.0 / 64.0;

/// The greatest distance of a hit from the point that was scanned, relative to its distance from
/// the scanner: triangles at jumps are seen at angles down to a few thousandths.
const OFF: f64 = 0.1;

/// Case 51. A depth image as a mesh, seen from where it was taken: every vertex and every edge is
/// exactly on a ray of the scanner, and jumps of the depth are triangles along such rays.
pub(super) fn scans(numbers: &mut Numbers) -> World {
    let scanner = numbers.ball(10.0).as_vec3();
    let turned = numbers.rotation();
    let base = numbers.magnitude(1.0, 100.0);
    let jump = numbers.magnitude(1.001, 4.0);
    let of_point = |i: u32| {
        let side = |k: u32| (f64::from(k) - f64::from(POINTS) / 2.0) * BETWEEN;
        let depth = base * (1.0 + 0.01 * numbers.one()) * numbers.among([1.0, 1.0, 1.0, jump]);
        let way = turned * DVec3::new(side(i % POINTS), side(i / POINTS), 1.0);
        (scanner.as_dvec3() + way * depth).as_vec3()
    };
    let positions: Vec<Vec3> = (0..POINTS * POINTS).map(of_point).collect();
    let cells = (0..(POINTS - 1) * (POINTS - 1)).flat_map(|i| {
        let a = i / (POINTS - 1) * POINTS + i % (POINTS - 1);
        [[a, a + 1, a + POINTS + 1], [a, a + POINTS + 1, a + POINTS]]
    });
    let geometry = Geometry { positions, triangles: cells.collect(), ..Geometry::default() };
    World::new(geometry.clone(), move |numbers| {
        let inner = |numbers: &mut Numbers| 1 + numbers.below(POINTS as usize - 3) as u32;
        let first = inner(numbers) + inner(numbers) * POINTS;
        let [a, b] = [first, first + numbers.among([1, POINTS, POINTS + 1])]
            .map(|vertex| geometry.positions[vertex as usize]);
        let s = [0.0, numbers.one() as f32][numbers.below(2)];
        let target = a + (b - a) * s;
        Some((Ray::new(scanner, target - scanner), ExpectedHit::near(1.0, OFF)))
    })
}
