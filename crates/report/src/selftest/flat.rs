//! Triangles and quads that are degenerate, thin, or not flat.

use super::prelude::*;
use super::shapes::{CUBE_SIDES, cubes};

/// Case 18. A cube in which faces on one side of an edge have a vertex exactly in its middle, and a
/// degenerate triangle lies along it: there is no gap, and no ray from inside leaves.
pub(super) fn sealed(_: &mut Numbers) -> World {
    let faces = cubes(1, 4.0);
    let split = (0..faces.triangles.len()).flat_map(|face| {
        let [a, b, c] = faces.triangle(face);
        let middle = (a + b) * 0.5;
        [[a, middle, c], [middle, b, c], [a, b, middle]]
    });
    World::new(of_triangles(split), ALL_HIT, move |numbers| {
        let [a, b, _] = faces.triangle(numbers.below(faces.triangles.len()));
        let origin = Vec3::ONE + numbers.ball(0.9).as_vec3();
        let target = a.as_dvec3().lerp(b.as_dvec3(), numbers.one());
        Some(Ray::new(origin, target.as_vec3() - origin))
    })
}

/// Case 19: triangles about `unit` long and a millionth as wide, far from each other.
pub(super) fn slivers(numbers: &mut Numbers) -> World {
    let unit = numbers.magnitude(1e-3, 1e3);
    let geometry = of_triangles([(); 20].map(|()| {
        let (at, along) = (numbers.ball(unit), numbers.direction());
        let aside = along.cross(numbers.direction()).normalize() * 1e-6;
        let apex = at + (along * numbers.one() + aside) * unit;
        [at, at + along * unit, apex].map(|p| p.as_vec3())
    }));
    World::new(geometry.clone(), MIXED, move |numbers| {
        let corners = geometry.triangle(numbers.below(geometry.triangles.len()));
        Some(edge_on(numbers, corners, unit))
    })
}

/// A ray at a point of a triangle, nearly in its plane.
fn edge_on(numbers: &mut Numbers, corners: [Vec3; 3], unit: f64) -> Ray {
    let [a, b, c] = corners.map(|v| v.as_dvec3());
    let target = numbers.within(corners);
    let normal = (b - a).cross(c - a).normalize();
    // Half of them along the sliver, too.
    let any = numbers.direction() * if numbers.once_in(2) { 1.0 } else { 0.01 };
    let within = (b - a).normalize() * 0.1 + any;
    let flat = within - normal * within.dot(normal);
    let direction = flat.normalize() + normal * (numbers.sign() * numbers.magnitude(1e-7, 1e-1));
    let origin = (target - direction * (unit * numbers.magnitude(1e-2, 10.0))).as_vec3();
    Ray::new(origin, target.as_vec3() - origin)
}

/// Case 34: a box with corners moved by up to a tenth, so that none of its sides is flat. Each side
/// starts at a random corner, which determines its diagonal.
pub(super) fn crooked_quads(numbers: &mut Numbers) -> World {
    let scale = numbers.magnitude(1e-3, 1e3);
    let corners: [DVec3; 8] = std::array::from_fn(|i| {
        let corner = DVec3::from([0, 1, 2].map(|k| if i >> k & 1 == 1 { 1.0 } else { -1.0 }));
        ((corner + numbers.direction() * 0.1) * scale).as_vec3().as_dvec3()
    });
    let quads = CUBE_SIDES.map(|mut side| {
        side.rotate_left(numbers.below(4));
        side
    });
    let positions = corners.map(|corner| corner.as_vec3()).to_vec();
    let geometry = Geometry { positions, quads: quads.to_vec(), ..Geometry::default() };
    World::new(geometry, ALL_HIT, move |numbers| {
        let points = numbers.among(quads).map(|corner| corners[corner as usize]);
        let origin = numbers.ball(0.3 * points[0].length()).as_vec3();
        // An edge, or the diagonal from the first corner to the third.
        let first = numbers.below(4);
        let [a, b] = numbers.among([[first, (first + 1) % 4], [0, 2]]).map(|k| points[k]);
        let s = [0.0, numbers.one(), numbers.magnitude(1e-7, 1.0)][numbers.below(3)];
        Some(Ray::new(origin, a.lerp(b, s).as_vec3() - origin))
    })
}
