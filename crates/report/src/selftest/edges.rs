//! Rays at shared edges and vertices. Random rays find no leaks, as these have no width.

use super::prelude::*;
use super::shapes::Closed;

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

/// A closed mesh, by the number of the world.
fn globe(rng: &mut InputRng) -> Closed {
    let (size, bumps) = GLOBES[rng.index % GLOBES.len()];
    let (scale, offset) = PLACES[rng.index / GLOBES.len() % PLACES.len()];
    Closed::new(rng, size, bumps, DVec3::splat(scale), offset)
}

/// Case 1.
pub(super) fn edges(rng: &mut InputRng) -> World {
    let closed = globe(rng);
    World::new(closed.geometry.clone(), ALL_HIT, move |rng| {
        let origin = closed.inside(rng);
        let corners = closed.geometry.triangle(rng.below(closed.geometry.triangles.len()));
        Some(Ray::new(origin, rng.on_edge(corners).as_vec3() - origin))
    })
}

/// Case 2.
pub(super) fn vertices(rng: &mut InputRng) -> World {
    let closed = globe(rng);
    World::new(closed.geometry.clone(), ALL_HIT, move |rng| {
        let origin = closed.inside(rng);
        let positions = &closed.geometry.positions;
        Some(Ray::new(origin, positions[rng.below(positions.len())] - origin))
    })
}

/// Case 39: globes with one axis up to 1e12 times as long as another.
pub(super) fn needles(rng: &mut InputRng) -> World {
    let thin = [1e-4, 1e-6][rng.index % 2];
    let scale = DVec3::new(thin, 1.0, 1.0 / thin);
    let closed = Closed::new(rng, [16, 24], 0.0, scale, Vec3::ZERO);
    World::new(closed.geometry.clone(), ALL_HIT, move |rng| {
        let origin = closed.inside(rng);
        let target = (rng.direction() * scale).as_vec3();
        Some(Ray::new(origin, target - origin))
    })
}

/// Points of a scan along each side, and their distance as seen by the scanner, relative to theirs
/// from it.
const POINTS: u32 = 48;
const BETWEEN: f64 = 1.0 / 64.0;

/// Case 51. A depth image as a mesh, seen from where it was taken: every vertex and every edge is
/// exactly on a ray of the scanner, and jumps of the depth are triangles along such rays.
pub(super) fn scans(rng: &mut InputRng) -> World {
    let scanner = rng.ball(10.0).as_vec3();
    let turned = rng.rotation();
    let base = rng.magnitude(1.0, 100.0);
    let jump = rng.magnitude(1.001, 4.0);
    let of_point = |i: u32| {
        let side = |k: u32| (f64::from(k) - f64::from(POINTS) / 2.0) * BETWEEN;
        let depth = base * (1.0 + 0.01 * rng.one()) * rng.among([1.0, 1.0, 1.0, jump]);
        let way = turned * DVec3::new(side(i % POINTS), side(i / POINTS), 1.0);
        (scanner.as_dvec3() + way * depth).as_vec3()
    };
    let positions: Vec<Vec3> = (0..POINTS * POINTS).map(of_point).collect();
    let cells = (0..(POINTS - 1) * (POINTS - 1)).flat_map(|i| {
        let a = i / (POINTS - 1) * POINTS + i % (POINTS - 1);
        [[a, a + 1, a + POINTS + 1], [a, a + POINTS + 1, a + POINTS]]
    });
    let geometry =
        Geometry { positions: positions.into(), triangles: cells.collect(), ..Geometry::default() };
    World::new(geometry.clone(), ALL_HIT, move |rng| {
        let inner = |rng: &mut InputRng| 1 + rng.below(POINTS as usize - 3) as u32;
        let first = inner(rng) + inner(rng) * POINTS;
        let [a, b] = [first, first + rng.among([1, POINTS, POINTS + 1])]
            .map(|vertex| geometry.positions[vertex as usize]);
        let target = a.lerp(b, [0.0, rng.one() as f32][rng.below(2)]);
        Some(Ray::new(scanner, target - scanner))
    })
}
