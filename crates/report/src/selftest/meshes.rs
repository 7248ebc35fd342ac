//! Triangles without area, slivers, and quads that are not flat.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde_json::json;

use super::case::{Effort, Outcome};
use super::convex::{Mesh, globe};
use super::directions::CUBE_SIDES;
use super::scenes::{self, Eye, PRESETS, camera_rays};
use super::trees::{add_triangle, by_brute_force};
use super::ways::{Numbers, every_way, inputs};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::math::ray::Ray;

/// Case 18.
pub(super) fn without_area(effort: &Effort) -> Outcome {
    let mut outcome = among_others(effort);
    outcome.add(sealed(effort));
    outcome
}

/// The image is the same as without them, each pixel shows the face expected there, and they are
/// counted.
fn among_others(effort: &Effort) -> Outcome {
    let size = effort.either([40, 30], [160, 120]);
    let location = DVec3::new(120.0, 80.0, 150.0);
    let eye = Eye::at(location, 40.0, size);
    // Halves of its sides are single-precision numbers too.
    let clean = globe(6, 64.0, 1.0 / 64.0);
    let lights = [scenes::point_light(1000.0, DVec3::new(-40.0, 190.0, 160.0), "none")];
    let scene = |mesh| scenes::scene(0, &eye.json(), &lights, &[mesh]);
    let shiny =
        json!({"ks": 0.5, "kd": 0.5, "specularexponent": 9.5, "diffusecolor": [1, 0.7, 0.4]});
    let cleaned = scene(scenes::mesh(&clean.positions, &clean.triangles, shiny.clone()));
    let count = effort.of(100_000) as u32;
    let (positions, triangles, kept) = mixed(&mut Numbers::new(effort, 18, 0), &clean, count);
    let scene = scene(scenes::mesh(&positions, &triangles, shiny));
    let mut outcome = scenes::same_images(effort, &scene, &PRESETS, &cleaned);
    outcome.add(Outcome::from(scenes::prepare(effort, &scene, Preset::Medium).map(|prepared| {
        let found = prepared.scene.dropped.degenerate;
        let is_right = found == u64::from(count) && prepared.warns(&format!(" {count} triangles"));
        let context = || format!("{found} of {count} are counted, {:?}", prepared.warnings);
        let mut outcome = Outcome::one((!is_right).then(context));
        let faces: Vec<Option<usize>> = eye
            .pixels()
            .map(|(x, y)| clean.seen(location, eye.direction(x, y)).map(|face| kept[face]))
            .collect();
        let rays = camera_rays(&prepared.scene);
        outcome.add(every_way(prepared.scene.accel, &rays, |i, _, hit| {
            let face = faces[i].filter(|&face| hit.primitive as usize != face);
            face.map(|face| format!("{hit:?} and not {face}"))
        }));
        outcome
    })));
    outcome
}

/// A closed mesh in which faces on one side of an edge have a vertex exactly in its middle, and a
/// degenerate triangle lies along it: there is no gap, and no ray from inside leaves.
fn sealed(effort: &Effort) -> Outcome {
    // On a grid, so that the middle of an edge is exactly on it.
    let Mesh { mut positions, triangles: faces } = globe(4, 1000.0, 1.0 / 16.0);
    let mut triangles = Vec::new();
    for &[a, b, c] in &faces {
        let [p, q] = [a, b].map(|v| positions[v as usize]);
        let middle = positions.len() as u32;
        positions.push((p + q) * 0.5);
        triangles.extend([[a, middle, c], [middle, b, c], [a, b, middle]]);
    }
    let geometry = Geometry { positions, triangles, ..Geometry::default() };
    let rays: Vec<Ray> = inputs(effort, 18, 1..1 + effort.of(1_000_000))
        .map(|mut numbers| {
            let [a, b, _] = faces[numbers.below(faces.len())];
            let [a, b] = [a, b].map(|v| geometry.positions[v as usize].as_dvec3());
            let origin = (numbers.direction() * (500.0 * numbers.one())).as_vec3();
            Ray::new(origin, (a + (b - a) * numbers.one()).as_vec3() - origin)
        })
        .collect();
    let all = [Preset::Brute, Preset::VeryFast, Preset::Medium].map(|preset| {
        every_way(effort.accel(geometry.clone(), preset), &rays, |_, _, hit| {
            hit.is_miss().then(|| "it leaves through a sealed edge".to_owned())
        })
    });
    all.into_iter().sum()
}

/// The vertices and triangles of a mesh with `count` degenerate triangles added, and the new
/// numbers of its own.
fn mixed(numbers: &mut Numbers, mesh: &Mesh, count: u32) -> (Vec<Vec3>, Vec<[u32; 3]>, Vec<usize>) {
    let (mut positions, mut mixed, mut kept) = (mesh.positions.clone(), Vec::new(), Vec::new());
    let mut left = count;
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        // The last of them come after the last triangle.
        let share = left / (mesh.triangles.len() - i) as u32;
        for _ in 0..share {
            mixed.push(nothing(numbers, &mut positions, triangle));
        }
        left -= share;
        kept.push(mixed.len());
        mixed.push(*triangle);
    }
    (positions, mixed, kept)
}

/// A degenerate triangle at a `triangle` with these positions.
fn nothing(numbers: &mut Numbers, positions: &mut Vec<Vec3>, &[a, b, c]: &[u32; 3]) -> [u32; 3] {
    let first = positions.len() as u32;
    let [p, q] = [a, b].map(|v| positions[v as usize]);
    match numbers.below(6) {
        0 => [a, a, a],
        1 => [b, c, c],
        2 => [c, a, c],
        // Three vertices at one place.
        3 => {
            positions.extend([p, p]);
            [first, a, first + 1]
        }
        // The middle of a side, or the same distance beyond its end.
        4 => {
            positions.push((p + q) * 0.5);
            [a, first, b]
        }
        _ => {
            positions.push(q + (q - p));
            [first, a, b]
        }
    }
}

/// Case 19. An ulp is that of the largest coordinate of the ray's origin and of the triangle.
pub(super) fn slivers(effort: &Effort) -> Outcome {
    const LARGEST_DISTANCE: f64 = 8.0;
    let mut outcome = Outcome::default();
    let scenes = 100;
    for s in 0..scenes {
        let mut numbers = Numbers::new(effort, 19, usize::MAX - s);
        let unit = numbers.magnitude(1e-3, 1e3);
        let geometry = some_slivers(&mut numbers, unit);
        let start = s * 100_000;
        let rays: Vec<Ray> = inputs(effort, 19, start..start + effort.of(1_000_000) / scenes)
            .map(|mut numbers| grazing(&mut numbers, &geometry, unit))
            .collect();
        let met =
            by_brute_force(effort, &geometry, &rays).iter().filter(|hit| !hit.is_miss()).count();
        // Rays that miss were aimed at an edge, by rounding; a fifth would be far too few.
        outcome.check(met >= rays.len() / 5, || format!("{met} rays hit anything"));
        for preset in [Preset::Brute, Preset::VeryFast, Preset::Slow] {
            let accel = effort.accel(geometry.clone(), preset);
            outcome.add(every_way(accel, &rays, |_, ray, hit| {
                if hit.is_miss() {
                    return None;
                }
                let corners = geometry.triangle(hit.primitive as usize).map(|v| v.as_dvec3());
                let outside = ulp_outside(corners, ray, hit.t);
                let is_within = outside <= LARGEST_DISTANCE;
                (!is_within).then(|| format!("{hit:?} is {outside} ulp outside {corners:?}"))
            }));
        }
    }
    outcome
}

/// Triangles about `unit` long and a millionth as wide.
fn some_slivers(numbers: &mut Numbers, unit: f64) -> Geometry {
    let mut geometry = Geometry::default();
    for _ in 0..20 {
        let at = numbers.direction() * (unit * numbers.one());
        let along = numbers.direction();
        let aside = along.cross(numbers.direction()).normalize() * 1e-6;
        let apex = at + along * (unit * numbers.one()) + aside * unit;
        add_triangle(&mut geometry, [at, at + along * unit, apex].map(|p| p.as_vec3()));
    }
    geometry
}

/// The distance of the ray's point at `t` from the triangle's box.
fn ulp_outside([a, b, c]: [DVec3; 3], ray: &Ray, t: f32) -> f64 {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let point = origin + direction * f64::from(t);
    let largest = origin.abs().max(low.abs()).max(high.abs()).max_element() as f32;
    let ulp = f64::from(largest.next_up() - largest);
    (low - point).max(point - high).max_element() / ulp
}

/// A ray at a point of a triangle, nearly in its plane.
fn grazing(numbers: &mut Numbers, geometry: &Geometry, unit: f64) -> Ray {
    let corners = geometry.triangle(numbers.below(geometry.triangles.len()));
    let [a, b, c] = corners.map(|v| v.as_dvec3());
    let target = numbers.within(corners);
    let normal = (b - a).cross(c - a).normalize();
    let turned = numbers.direction();
    // Half of them along the sliver, too.
    let within = match numbers.below(2) {
        0 => (b - a).normalize() + turned * numbers.magnitude(1e-7, 1e-1),
        _ => turned,
    };
    let flat = within - normal * within.dot(normal);
    let direction = flat.normalize() + normal * (numbers.sign() * numbers.magnitude(1e-7, 1e-1));
    let origin = (target - direction * (unit * numbers.magnitude(1e-2, 10.0))).as_vec3();
    Ray::new(origin, target.as_vec3() - origin)
}

/// The corners of a cube as in [`CUBE_SIDES`], moved by up to a tenth: none of its sides is flat.
fn crooked(numbers: &mut Numbers, scale: f64) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let bit = |k: usize| f64::from(u8::from(i >> k & 1 == 1)) * 2.0 - 1.0;
        let corner = DVec3::new(bit(0), bit(1), bit(2)) + numbers.direction() * 0.1;
        (corner * scale).as_vec3().as_dvec3()
    })
}

/// Case 34.
pub(super) fn crooked_quads(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    let boxes = effort.either(10, 100);
    for s in 0..boxes {
        let mut numbers = Numbers::new(effort, 34, usize::MAX - s);
        let scale = numbers.magnitude(1e-3, 1e3);
        let corners = crooked(&mut numbers, scale);
        // Each side starts at a random corner, which determines its diagonal.
        let sides = CUBE_SIDES.map(|mut side| {
            side.rotate_left(numbers.below(4));
            side.map(|corner| corners[corner as usize])
        });
        let shapes = sides.map(|points| scenes::plane(points, scenes::matte([1.0; 3])));
        let eye = Eye { look: DVec3::X, ..Eye::at(DVec3::ZERO, 60.0, [4, 4]) };
        let scene = scenes::scene(0, &eye.json(), &[], &shapes);
        let rays: Vec<Ray> = (0..effort.of(1_000_000) / boxes)
            .into_par_iter()
            .map(|n| from_inside(&mut Numbers::new(effort, 34, s * 100_000 + n), &sides))
            .collect();
        for preset in [Preset::Brute, Preset::VeryFast, Preset::Slow] {
            outcome.add(Outcome::from(scenes::prepare(effort, &scene, preset).map(|prepared| {
                let mut outcome = warnings_of(&prepared, &sides);
                outcome.add(every_way(prepared.scene.accel, &rays, |_, _, hit| {
                    let is_right = (0.999..1.001).contains(&hit.t);
                    (!is_right).then(|| format!("{hit:?} and not 1, in {corners:?}"))
                }));
                outcome
            })));
        }
    }
    outcome
}

/// Whether there is a warning that counts all sides.
fn warnings_of(prepared: &scenes::Prepared, sides: &[[DVec3; 4]]) -> Outcome {
    let mut outcome = Outcome::default();
    let others = sides.len() - 1;
    let all = format!("scene.shapes[0].points and {others} others: the four points are not in one");
    outcome.check(prepared.warns(&all), || format!("no warning of {sides:?}"));
    outcome
}

/// A ray from near the centre of the box that meets an edge, a corner or the diagonal from the
/// first corner to the third, at t = 1.
fn from_inside(numbers: &mut Numbers, sides: &[[DVec3; 4]; 6]) -> Ray {
    let points = sides[numbers.below(6)];
    let origin = (numbers.direction() * (0.3 * numbers.one() * points[0].length())).as_vec3();
    let first = numbers.below(4);
    let (a, b) = match numbers.below(2) {
        0 => (points[first], points[(first + 1) % 4]),
        _ => (points[0], points[2]),
    };
    let along = [0.0, numbers.one(), numbers.magnitude(1e-7, 1.0)][numbers.below(3)];
    Ray::new(origin, (a + (b - a) * along).as_vec3() - origin)
}
