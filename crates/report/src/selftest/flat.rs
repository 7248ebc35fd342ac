//! Triangles and quads that are degenerate, thin, coplanar, wide, or not flat.

use super::prelude::*;
use super::shapes::CUBE_SIDES;

/// Case 18: a closed mesh in which faces on one side of an edge have a vertex exactly in its
/// middle, and a degenerate triangle lies along it: there is no gap, and no ray from inside leaves.
pub(super) fn sealed(_: &mut Numbers) -> World {
    // On a grid, so that the middle of an edge is exactly on it.
    let faces = convex(4, 1000.0, 1.0 / 16.0);
    let split = (0..faces.triangles.len()).flat_map(|face| {
        let [a, b, c] = faces.triangle(face);
        let middle = (a + b) * 0.5;
        [[a, middle, c], [middle, b, c], [a, b, middle]]
    });
    World::new(of_triangles(split), move |numbers| {
        let [a, b, _] = faces.triangle(numbers.below(faces.triangles.len()));
        let origin = numbers.ball(500.0).as_vec3();
        let target = a.as_dvec3().lerp(b.as_dvec3(), numbers.one());
        Some((Ray::new(origin, target.as_vec3() - origin), ExpectedHit::ANYTHING))
    })
}

/// Case 19: triangles about `unit` long and a millionth as wide, far from each other. An ulp is that of
/// the largest coordinate of the ray's origin and of the triangle.
pub(super) fn slivers(numbers: &mut Numbers) -> World {
    const LARGEST_DISTANCE: f64 = 8.0;
    let unit = numbers.magnitude(1e-3, 1e3);
    let geometry = of_triangles([(); 20].map(|()| {
        let (at, along) = (numbers.ball(unit), numbers.direction());
        let aside = along.cross(numbers.direction()).normalize() * 1e-6;
        let apex = at + (along * numbers.one() + aside) * unit;
        [at, at + along * unit, apex].map(|p| p.as_vec3())
    }));
    World::new(geometry.clone(), move |numbers| {
        let corners = geometry.triangle(numbers.below(geometry.triangles.len()));
        let ray = edge_on(numbers, corners, unit);
        let [a, b, c] = corners.map(|v| v.as_dvec3());
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let largest = origin.abs().max(low.abs()).max(high.abs()).max_element();
        let off = LARGEST_DISTANCE * ulp(largest);
        // Where the ray is in the box, enlarged by that.
        let [p, q] = [low - off, high + off].map(|corner| (corner - origin) / direction);
        let t = [p.min(q).max_element(), p.max(q).min_element()];
        Some((ray, ExpectedHit { or_nothing: true, t, ..ExpectedHit::ANYTHING }))
    })
}

/// A ray at a point of a triangle, nearly in its plane.
fn edge_on(numbers: &mut Numbers, corners: [Vec3; 3], unit: f64) -> Ray {
    let [a, b, c] = corners.map(|v| v.as_dvec3());
    let target = numbers.within(corners);
    let normal = (b - a).cross(c - a).normalize();
    let turned = numbers.direction();
    // Half of them along the sliver, too.
    let along = (b - a).normalize() + turned * numbers.magnitude(1e-7, 1e-1);
    let within = if numbers.once_in(2) { along } else { turned };
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
    let sides = CUBE_SIDES.map(|mut side| {
        side.rotate_left(numbers.below(4));
        side.map(|corner| corners[corner as usize])
    });
    let shapes = sides.map(|points| scenes::plane(points, scenes::white()));
    let eye = Eye { look: DVec3::X, ..Eye::at(DVec3::ZERO, 60.0, [4, 4]) };
    let scene = scenes::scene(&eye, &[], &shapes);
    let prepared = scenes::prepare_whole(&numbers.effort, &scene);
    World::of_scene(prepared, |prepared| {
        let others = sides.len() - 1;
        let said = format!("shapes[0].points and {others} others: the four points are not in one");
        let is_warned = prepared.warnings.contains(&said);
        move |numbers: &mut Numbers| {
            let points = numbers.among(sides);
            let origin = numbers.ball(0.3 * points[0].length()).as_vec3();
            // An edge, or the diagonal from the first corner to the third.
            let first = numbers.below(4);
            let [a, b] = numbers.among([[first, (first + 1) % 4], [0, 2]]).map(|k| points[k]);
            let s = [0.0, numbers.one(), numbers.magnitude(1e-7, 1.0)][numbers.below(3)];
            let ray = Ray::new(origin, a.lerp(b, s).as_vec3() - origin);
            // Without the warning no answer is right.
            let off = if is_warned { 1e-3 } else { f64::NAN };
            Some((ray, ExpectedHit::near(1.0, off)))
        }
    })
}

/// Case 37. A light at a height of 1e-5 to 1e-2 of the floor's width sees every point of the floor.
pub(super) fn floors(numbers: &mut Numbers) -> World {
    let (turned, width) = (numbers.rotation(), numbers.magnitude(1e-3, 1e3));
    let moved = numbers.direction() * width * numbers.among([0.0, 1.0, 100.0]);
    let place =
        move |x: f64, y: f64, z: f64| (turned * DVec3::new(x, y, z) * width + moved).as_vec3();
    let corners =
        [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| place(x, y, 0.0));
    let geometry = Geometry { positions: corners.to_vec(), ..Geometry::default() };
    let geometry = if numbers.index.is_multiple_of(2) {
        Geometry { triangles: vec![[0, 1, 2], [0, 2, 3]], ..geometry }
    } else {
        Geometry { quads: vec![[0, 1, 2, 3]], ..geometry }
    };
    let accel = numbers.effort.accel(geometry.clone(), Preset::VeryFast);
    let [x, y] = [(); 2].map(|()| numbers.about(0.5));
    let light = place(x, y, numbers.magnitude(1e-5, 1e-2));
    let near = numbers.magnitude(1e-2, 1.0);
    World::new(geometry, move |numbers| {
        let [u, v] = [(); 2].map(|()| numbers.about(near));
        // Points near the light, and near the diagonal.
        let (u, v) = (x + u, if numbers.once_in(2) { x + u + v * 1e-3 } else { y + v });
        let eye = place(u, v, 1.0);
        let down = Ray::new(eye, place(u, v, 0.0) - eye);
        let (_, [point, error, normal]) = met(&accel, &down, &mut accel.traversal())?;
        let origin = offset_origin(point, error, normal, light - point);
        Some((Ray { t_max: 1.0, ..Ray::new(origin, light - origin) }, ExpectedHit::NOTHING))
    })
}

/// Case 38. Copies have their corners in every order, and others like them are a little larger: a
/// tree keeps those, and one copy. Further triangles are coplanar with them, across an axis.
pub(super) fn copies(numbers: &mut Numbers) -> World {
    let k = numbers.below(3);
    let (size, height) = (numbers.magnitude(1e-3, 1e3), numbers.one() as f32);
    let mut triangle = || {
        [(); 3].map(|()| {
            let mut at = (numbers.direction() * size).as_vec3();
            at[k] = height;
            at
        })
    };
    let first = triangle();
    let [a, b, c] = first;
    let mut all = vec![[a, b, c], [c, a, b], [b, a, c], [b, c, a], [c, b, a], [a, c, b]];
    all.extend([(); 5].map(|()| triangle()));
    let middle = (a + b + c) / 3.0;
    all.extend([(); 5].map(|()| {
        let larger = 1.0 + 0.1 * numbers.one() as f32;
        first.map(|corner| {
            let mut at = middle + (corner - middle) * larger;
            at[k] = height;
            at
        })
    }));
    World::new(of_triangles(all), move |numbers| {
        // Clear of the edges.
        let target = numbers.within(first).lerp((a + b + c).as_dvec3() / 3.0, 0.01);
        let away = numbers.direction() * numbers.magnitude(0.01, 100.0) * size;
        let origin = (target + away).as_vec3();
        let ray = Ray::new(origin, (target - origin.as_dvec3()).as_vec3());
        // A ray almost in the plane may meet it beyond the triangle, after its target is rounded.
        let is_steep = ray.direction[k].abs() > 1e-3 * ray.direction.length();
        is_steep.then(|| (ray, ExpectedHit::of(0..1)))
    })
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
pub(super) const WIDE_FLOORS: usize = 4 * HALF_WIDTHS.len() * AXES.len();

/// Case 47. A ray that comes down on a floor clear of its edges must hit it, also if it passes the
/// diagonal more closely than rounding can tell, before or behind its start.
pub(super) fn from_just_above(numbers: &mut Numbers) -> World {
    let half = HALF_WIDTHS[numbers.index % HALF_WIDTHS.len()];
    let mut axes = AXES[numbers.index / HALF_WIDTHS.len() % AXES.len()];
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
    World::new(geometry, move |numbers| {
        let mut within = |size: f64| u * numbers.about(size) + v * numbers.about(size);
        let (foot, anywhere) = (within(10.0 * height), within(1.0));
        let along = if numbers.once_in(4) { anywhere } else { diagonal * numbers.sign() };
        let target = along * height * numbers.magnitude(0.1, 1e4);
        let eye = (foot + normal * height).as_vec3();
        let ray = Ray::new(eye, (target - eye.as_dvec3()).as_vec3());
        // Where this ray, as rounded, comes down.
        let [origin, direction] = [ray.origin, ray.direction].map(|v| v.as_dvec3());
        let t = origin.dot(normal) / -direction.dot(normal);
        let place = origin + direction * t;
        let is_within = |axis: DVec3| place.dot(axis).abs() < 0.9 * half * axis.length_squared();
        (t > 0.0 && is_within(u) && is_within(v)).then_some((ray, ExpectedHit::ANYTHING))
    })
}
