//! Moved, scaled and turned scenes, which must look the same, and degenerate triangles among
//! others.

use super::prelude::*;
use super::scenes::WarnedScene;
use super::shapes::{face_at, height};

/// The grid of vertices: at coordinates of 2^17 it is the resolution of single precision. Halves of
/// sides are single-precision numbers too.
const STEP: f64 = 1.0 / 64.0;

/// The radius of the globe, and the camera and the light relative to its centre.
const RADIUS: f64 = 64.0;
const EYE: DVec3 = DVec3::new(120.0, 80.0, 150.0);
const LIGHT: DVec3 = DVec3::new(-40.0, 190.0, 160.0);

fn globe() -> Geometry {
    convex(6, RADIUS, STEP)
}

fn eye(effort: &Effort, by: DVec3) -> Eye {
    let size = effort.either([48, 40], [128, 120]);
    Eye { look: by, ..Eye::at(EYE + by, 40.0, size) }
}

fn lit(effort: &Effort, by: DVec3, shapes: &[Value]) -> Value {
    let light = scenes::point_light(1000.0, LIGHT + by, "none");
    scenes::scene(&eye(effort, by), &[light], shapes)
}

/// The mesh `by` which the scene is moved, in numbers of the file: double precision represents them
/// even there.
fn as_mesh(mesh: &Geometry, by: DVec3) -> Vec<Value> {
    let points: Vec<DVec3> = mesh.positions.iter().map(|p| p.as_dvec3() + by).collect();
    vec![scenes::mesh(&points, &mesh.triangles, scenes::white())]
}

/// The same, triangle by triangle.
fn as_triangles(mesh: &Geometry, by: DVec3) -> Vec<Value> {
    let triangle = |i| {
        let points = mesh.triangle(i).map(|v| (v.as_dvec3() + by).to_array());
        json!({"type": "triangle", "points": points, "sides": "both", "material": scenes::white()})
    };
    (0..mesh.triangles.len()).map(triangle).collect()
}

/// Every pixel of the globe's scene shows the face that is there, which has the number `of_face`.
fn faces(numbers: &Numbers, scene: &Value, of_face: impl Fn(&WarnedScene, usize) -> u32) -> World {
    let (mesh, still) = (globe(), eye(&numbers.effort, DVec3::ZERO));
    let prepared = scenes::prepare_whole(&numbers.effort, scene);
    World::of_scene(prepared, |prepared| {
        let [width, height] = still.size;
        let stream = Stream { seed: 0, pixel: 0, sample: 0, bounce: 0 };
        let aimed = (0..width * height).filter_map(|i| {
            let (x, y) = (i % width, i / width);
            let face = of_face(prepared, face_at(&mesh, EYE, still.direction(x, y))?);
            let ray = prepared.scene.camera.ray(x, y, &stream);
            Some((ray, ExpectedHit::of(face..face + 1)))
        });
        let aimed: Vec<_> = aimed.collect();
        move |numbers: &mut Numbers| Some(aimed[numbers.below(aimed.len())].clone())
    })
}

/// The vector by which input `index` is moved: by powers of two, along several diagonals.
fn by(index: usize, powers: &[i32]) -> DVec3 {
    let diagonals = [DVec3::ONE, DVec3::new(1.0, -1.0, 0.0), DVec3::new(0.0, 0.0, -1.0)];
    diagonals[index % 3] * libm::exp2(f64::from(powers[index / 3 % powers.len()]))
}

/// Powers for case 7, the largest first, and for case 42, up to the largest coordinates of a scene.
const NEAR: [i32; 18] = [17, 16, 9, 0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12, 13, 14, 15];
const FAR: [i32; 4] = [0, 20, 30, 38];

/// The numbers of such inputs: of case 7 quick and in full, and of case 42.
pub(super) const MOVES: [usize; 2] = [6, 3 * NEAR.len()];
pub(super) const PLACES: usize = 6 * FAR.len();

/// Case 7: every pixel shows the primitive that it shows if nothing is moved.
pub(super) fn moved(numbers: &mut Numbers) -> World {
    let by = by(numbers.index, &NEAR);
    let scene = lit(&numbers.effort, by, &as_mesh(&globe(), by));
    faces(numbers, &scene, |_, face| face as u32)
}

/// Case 7: no part of a convex mesh that faces the light is in its own shadow.
pub(super) fn without_acne(numbers: &mut Numbers) -> Vec<Picture> {
    let (by, mesh, effort) = (by(numbers.index, &NEAR), globe(), numbers.effort);
    // Closer to a face's plane than this, rounding decides whether the light is in front of it.
    let doubtful = 64.0 * f64::from(f32::EPSILON) * (by.abs().max_element() + 256.0);
    // Expected values are computed at the scene's original place, where the numbers are exact.
    let still = eye(&effort, DVec3::ZERO);
    let shows = move |x, y, pixel| {
        let face = face_at(&mesh, EYE, still.direction(x, y))?;
        (height(&mesh, face, LIGHT) > doubtful).then_some(pixel != [0.0; 3])
    };
    vec![Picture::new(lit(&effort, by, &as_mesh(&globe(), by)), shows)]
}

/// Case 42. Inline points are moved to the camera before they are rounded.
pub(super) fn far_away(numbers: &mut Numbers) -> World {
    let (by, mesh) = (by(numbers.index / 2, &FAR), globe());
    let shapes = [as_mesh, as_triangles][numbers.index % 2](&mesh, by);
    let scene = scenes::scene(&eye(&numbers.effort, by), &[], &shapes);
    faces(numbers, &scene, |_, face| face as u32)
}

/// A scene with everything, with lengths times `unit` and the axes permuted by `turn`, where 1 is x to
/// y to z to x. Lights that fall off with the distance or its square grow with it.
fn everything(effort: &Effort, unit: f64, turn: usize, is_round: bool) -> Value {
    let along = |mut direction: [f64; 3]| {
        direction.rotate_right(turn);
        direction
    };
    let at = |point: [f64; 3]| along(point.map(|x| x * unit));
    let ball = convex(3, 1.0, 1.0 / 1024.0);
    let normals: Vec<DVec3> = ball.positions.iter().map(|p| p.as_dvec3()).collect();
    let moved = |p: &DVec3| at((*p * 0.8 + DVec3::new(-1.5, 0.4, 0.3)).to_array());
    let points: Vec<[f64; 3]> = normals.iter().map(moved).collect();
    let normals: Vec<[f64; 3]> = normals.iter().map(|p| along(p.to_array())).collect();
    let shiny = |color: [f64; 3], kr: f64| {
        let more = json!({"ks": 0.4, "kd": 0.7, "kr": kr, "specularexponent": 30.5});
        scenes::with(scenes::matte(color), more)
    };
    let mut lights = vec![
        json!({"type": "pointlight", "intensity": 30.0 * unit, "color": [1, 0.9, 0.8],
               "position": at([-3.1, 4.3, 3.7])}),
        json!({"type": "pointlight", "intensity": 0.3, "color": [0.3, 0.9, 0.8],
               "position": at([3.1, 2.3, 2.9]), "falloff": "none"}),
        json!({"type": "arealight", "intensity": 0.9 * unit * unit, "color": [0.8, 0.9, 1.0],
               "falloff": "inverse-square", "samples": 2, "shape":
               {"type": "plane", "points": [at([1.0, 3.0, 0.0]), at([1.0, 3.1, 1.0]),
                                            at([2.0, 3.2, 1.0]), at([2.0, 3.1, 0.0])]}}),
    ];
    let mut shapes = vec![
        json!({"type": "plane", "sides": "both", "material": shiny([0.7, 0.6, 0.5], 0.3),
               "points": [at([-4.0, -1.0, 4.0]), at([-4.0, -1.3, -4.0]),
                          at([4.0, -1.3, -4.0]), at([4.0, -1.0, 4.0])]}),
        json!({"type": "triangle", "sides": "both", "material": shiny([0.2, 0.7, 0.9], 0.2),
               "points": [at([-2.0, -0.7, -2.0]), at([0.3, 2.1, -2.4]), at([2.2, -0.9, -1.7])]}),
        json!({"type": "trimesh", "sides": "both", "material": shiny([0.9, 0.3, 0.2], 0.1),
               "points": points, "indices": ball.triangles, "shading": "smooth",
               "normals": normals}),
    ];
    if is_round {
        lights.push(json!({"type": "arealight", "intensity": 9.0 * unit, "color": [1, 1, 1],
                           "sampling": "random", "samples": 3, "shape":
                           {"type": "sphere", "center": at([0.1, 2.9, 1.7]),
                            "radius": 0.2 * unit}}));
        let center = DVec3::from(at([1.3, 0.1, 0.4]));
        shapes.push(scenes::sphere(center, 0.9 * unit, shiny([0.4, 0.9, 0.4], 0.5)));
    }
    let [width, height] = effort.either([40, 30], [100, 75]);
    json!({
        "nbounces": 4,
        "camera": {"type": "thinlens", "width": width, "height": height, "fov": 50,
                   "location": at([0.4, 1.3, 6.1]), "look": at([0.1, 0.2, 0.0]),
                   "up": along([0.1, 1.0, 0.05]), "aperture": 0.1 * unit, "focal": 6.0 * unit,
                   "nsamplesx": 2, "nsamplesy": 2},
        "scene": {"backgroundcolor": scenes::BACKGROUND, "lightsources": lights, "shapes": shapes}
    })
}

/// Powers of two by which scenes of case 8 are scaled, the largest first, after two that are
/// turned.
pub(super) const SCALES: [usize; 2] = [4, 43];

/// Case 8. Turned scenes have nothing round: spherical lights have an axis of their own.
pub(super) fn scaled(numbers: &mut Numbers) -> Vec<Picture> {
    let is_turned = numbers.index < 2;
    let (power, turn) = match numbers.index {
        turned @ (0 | 1) => (0, turned + 1),
        2 => (-20, 0),
        3 => (20, 0),
        other => (other as i32 - 23, 0),
    };
    let of = |unit, turn| everything(&numbers.effort, unit, turn, !is_turned);
    vec![Picture::same(of(libm::exp2(f64::from(power)), turn), &of(1.0, 0))]
}

/// The globe with `each` degenerate triangles before each of its own.
fn mixed(numbers: &mut Numbers, each: usize) -> Geometry {
    let mut mesh = globe();
    for face in std::mem::take(&mut mesh.triangles) {
        for _ in 0..each {
            let nothing = nothing(numbers, &mut mesh.positions, face);
            mesh.triangles.push(nothing);
        }
        mesh.triangles.push(face);
    }
    mesh
}

/// A degenerate triangle at a triangle with these positions.
fn nothing(numbers: &mut Numbers, positions: &mut Vec<Vec3>, [a, b, c]: [u32; 3]) -> [u32; 3] {
    let first = positions.len() as u32;
    let [p, q] = [a, b].map(|v| positions[v as usize]);
    match numbers.below(3) {
        0 => numbers.among([[a, a, a], [b, c, c], [c, a, c]]),
        // Three vertices at one place.
        1 => {
            positions.extend([p, p]);
            [first, a, first + 1]
        }
        // The middle of a side, or as far from its start as from its end, beyond it.
        _ => {
            positions.push(p + (q - p) * numbers.among([0.5, 2.0]));
            [a, first, b]
        }
    }
}

/// Case 18: each pixel shows the face expected there, and a warning has the number of degenerate
/// triangles.
pub(super) fn among_others(numbers: &mut Numbers) -> World {
    let effort = numbers.effort;
    let own = globe().triangles.len();
    let each = effort.of(100_000) / own;
    let mixed = mixed(numbers, each);
    let scene = lit(&effort, DVec3::ZERO, &as_mesh(&mixed, DVec3::ZERO));
    let count = each * own;
    faces(numbers, &scene, move |prepared, face| {
        let is_counted = prepared.scene.dropped.degenerate == count as u64
            && prepared.warnings.contains(&format!(" {count} triangles"));
        // Otherwise no answer is right.
        if is_counted { ((face + 1) * (each + 1) - 1) as u32 } else { u32::MAX - 1 }
    })
}
