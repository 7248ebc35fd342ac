//! Triangles and quads that are degenerate, thin, or not flat.

use super::prelude::*;
use super::shapes::{CUBE_SIDES, cubes};

/// Case 18. A cube in which faces on one side of an edge have a vertex exactly in its middle, and a
/// degenerate triangle lies along it: there is no gap, and no ray from inside leaves.
pub(super) fn sealed(_: &mut InputRng) -> World {
    let faces = cubes(1, 4.0);
    let split = (0..faces.triangles.len()).flat_map(|face| {
        let [a, b, c] = faces.triangle(face);
        let middle = (a + b) * 0.5;
        [[a, middle, c], [middle, b, c], [a, b, middle]]
    });
    World::new(of_triangles(split), ALL_HIT, move |rng| {
        let [a, b, _] = faces.triangle(rng.below(faces.triangles.len()));
        let origin = Vec3::ONE + rng.ball(0.9).as_vec3();
        let target = a.as_dvec3().lerp(b.as_dvec3(), rng.one());
        Some(Ray::new(origin, target.as_vec3() - origin))
    })
}

/// Case 19: triangles about `unit` long and a millionth as wide, far from each other.
pub(super) fn slivers(rng: &mut InputRng) -> World {
    let unit = rng.magnitude(1e-3, 1e3);
    let geometry = of_triangles([(); 20].map(|()| {
        let (at, along) = (rng.ball(unit), rng.direction());
        let aside = along.cross(rng.direction()).normalize() * 1e-6;
        let apex = at + (along * rng.one() + aside) * unit;
        [at, at + along * unit, apex].map(|p| p.as_vec3())
    }));
    World::new(geometry.clone(), MIXED, move |rng| {
        let corners = geometry.triangle(rng.below(geometry.triangles.len()));
        Some(edge_on(rng, corners, unit))
    })
}

/// A ray at a point of a triangle, nearly in its plane.
fn edge_on(rng: &mut InputRng, corners: [Vec3; 3], unit: f64) -> Ray {
    let [a, b, c] = corners.map(|v| v.as_dvec3());
    let target = rng.within(corners);
    let normal = (b - a).cross(c - a).normalize();
    // Half of them along the sliver, too.
    let any = rng.direction() * if rng.once_in(2) { 1.0 } else { 0.01 };
    let within = (b - a).normalize() * 0.1 + any;
    let flat = within - normal * within.dot(normal);
    let direction = flat.normalize() + normal * (rng.sign() * rng.magnitude(1e-7, 1e-1));
    let origin = (target - direction * (unit * rng.magnitude(1e-2, 10.0))).as_vec3();
    Ray::new(origin, target.as_vec3() - origin)
}

/// Case 34: a box with corners moved by up to a tenth, so that none of its sides is flat. Each side
/// starts at a random corner, which determines its diagonal.
pub(super) fn crooked_quads(rng: &mut InputRng) -> World {
    let scale = rng.magnitude(1e-3, 1e3);
    let corners: [DVec3; 8] = std::array::from_fn(|i| {
        let corner = DVec3::from([0, 1, 2].map(|k| if i >> k & 1 == 1 { 1.0 } else { -1.0 }));
        ((corner + rng.direction() * 0.1) * scale).as_vec3().as_dvec3()
    });
    let quads = CUBE_SIDES.map(|mut side| {
        side.rotate_left(rng.below(4));
        side
    });
    let positions = corners.map(|corner| corner.as_vec3()).to_vec();
    let geometry =
        Geometry { positions: positions.into(), quads: quads.to_vec(), ..Geometry::default() };
    World::new(geometry, ALL_HIT, move |rng| {
        let points = rng.among(quads).map(|corner| corners[corner as usize]);
        let origin = rng.ball(0.3 * points[0].length()).as_vec3();
        // An edge, or the diagonal from the first corner to the third.
        let first = rng.below(4);
        let [a, b] = rng.among([[first, (first + 1) % 4], [0, 2]]).map(|k| points[k]);
        let s = [0.0, rng.one(), rng.magnitude(1e-7, 1.0)][rng.below(3)];
        Some(Ray::new(origin, a.lerp(b, s).as_vec3() - origin))
    })
}
