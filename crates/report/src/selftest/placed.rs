//! Moved, scaled and turned scenes, which must look the same, and degenerate triangles among
//! others.

use super::prelude::*;
use super::scenes::{PRESETS, camera_rays};
use super::shapes::{convex, height, seen};

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

/// The mesh `by` which the scene is moved, as numbers of the file: double precision represents them
/// even there.
fn moved_points(mesh: &Geometry, by: DVec3) -> Vec<[f64; 3]> {
    mesh.positions.iter().map(|p| (p.as_dvec3() + by).to_array()).collect()
}

fn lit(effort: &Effort, by: DVec3, shapes: &[Value]) -> Value {
    let light = scenes::point_light(1000.0, LIGHT + by, "none");
    scenes::scene(&eye(effort, by), &[light], shapes)
}

fn as_mesh(mesh: &Geometry, by: DVec3) -> Vec<Value> {
    let mut shape = scenes::mesh(&[], &mesh.triangles, scenes::white());
    shape["points"] = json!(moved_points(mesh, by));
    vec![shape]
}

fn as_triangles(mesh: &Geometry, by: DVec3) -> Vec<Value> {
    let points = moved_points(mesh, by);
    let triangle = |corners: &[u32; 3]| {
        json!({"type": "triangle", "points": corners.map(|v| points[v as usize]),
               "sides": "both", "material": scenes::white()})
    };
    mesh.triangles.iter().map(triangle).collect()
}

/// Every pixel of the globe's scene shows the face that is there; `kept` are the faces' numbers.
fn faces(
    numbers: &Numbers,
    scene: &Value,
    presets: &'static [Preset],
    kept: impl Fn(usize) -> u32,
) -> World {
    let (mesh, still) = (globe(), eye(&numbers.effort, DVec3::ZERO));
    let prepared = scenes::prepare_whole(&numbers.effort, scene, Preset::VeryFast);
    World::of_scene(prepared, presets, |prepared| {
        let width = still.size[0] as usize;
        let aimed = camera_rays(&prepared.scene).into_iter().enumerate().filter_map(|(i, ray)| {
            let direction = still.direction((i % width) as u32, (i / width) as u32);
            let face = kept(seen(&mesh, EYE, direction)?);
            Some((ray, Expected::of(face..face + 1)))
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
    faces(numbers, &scene, PRESETS, |face| face as u32)
}

/// Case 7: no part of a convex shape that faces the light is in its own shadow.
pub(super) fn without_acne(numbers: &mut Numbers) -> Vec<Picture> {
    let (by, mesh, effort) = (by(numbers.index, &NEAR), globe(), numbers.effort);
    // Closer to a face's plane than this, rounding decides whether the light is in front of it.
    let doubtful = 64.0 * f64::from(f32::EPSILON) * (by.abs().max_element() + 256.0);
    // Expected values are computed at the scene's original place, where the numbers are exact.
    let still = eye(&effort, DVec3::ZERO);
    let of_mesh = lit(&effort, by, &as_mesh(&mesh, by));
    let on_mesh = move |direction| {
        let face = seen(&mesh, EYE, direction);
        face.is_some_and(|face| height(&mesh, face, LIGHT) > doubtful)
    };
    let of_ball = lit(&effort, by, &[scenes::sphere(by, RADIUS, scenes::white())]);
    let on_ball = move |direction: DVec3| {
        let nearest = -EYE.dot(direction);
        let beside = RADIUS * RADIUS - (EYE + direction * nearest).length_squared();
        let point = EYE + direction * (nearest - beside.max(0.0).sqrt());
        beside >= 1.0 && point.normalize().dot(LIGHT - point) > doubtful
    };
    let picture = |scene, faces_light: Box<dyn Fn(DVec3) -> bool + Send + Sync>| {
        let shows =
            move |x, y, pixel| faces_light(still.direction(x, y)).then_some(pixel != [0.0; 3]);
        Picture { presets: PRESETS, ..Picture::new(scene, shows) }
    };
    vec![picture(of_mesh, Box::new(on_mesh)), picture(of_ball, Box::new(on_ball))]
}

/// Case 42. Inline points are moved to the camera before they are rounded.
pub(super) fn far_away(numbers: &mut Numbers) -> World {
    let (by, mesh) = (by(numbers.index / 2, &FAR), globe());
    let shapes = [as_mesh, as_triangles][numbers.index % 2](&mesh, by);
    let scene = scenes::scene(&eye(&numbers.effort, by), &[], &shapes);
    faces(numbers, &scene, &[Preset::VeryFast], |face| face as u32)
}

/// A scene with everything; the last shape and the last light are round.
fn everything(effort: &Effort) -> Value {
    let ball = convex(3, 1.0, 1.0 / 1024.0);
    let points =
        ball.positions.iter().map(|p| (p.as_dvec3() * 0.8 + DVec3::new(-1.5, 0.4, 0.3)).to_array());
    let points: Vec<[f64; 3]> = points.collect();
    let [width, height] = effort.either([40, 30], [100, 75]);
    let shiny = |color: [f64; 3], kr: f64| {
        json!({"ks": 0.4, "kd": 0.7, "kr": kr, "specularexponent": 30.5,
               "diffusecolor": color})
    };
    json!({
        "nbounces": 4,
        "camera": {"type": "thinlens", "width": width, "height": height, "fov": 50,
                   "location": [0.4, 1.3, 6.1], "look": [0.1, 0.2, 0.0], "up": [0.1, 1.0, 0.05],
                   "aperture": 0.1, "focal": 6.0, "nsamplesx": 2, "nsamplesy": 2},
        "scene": {"backgroundcolor": scenes::BACKGROUND, "lightsources": [
            {"type": "pointlight", "intensity": 30.0, "color": [1, 0.9, 0.8],
             "position": [-3.1, 4.3, 3.7], "falloff": "linear"},
            {"type": "pointlight", "intensity": 0.3, "position": [3.1, 2.3, 2.9],
             "color": [0.3, 0.9, 0.8], "falloff": "none"},
            {"type": "arealight", "intensity": 0.9, "color": [0.8, 0.9, 1.0],
             "falloff": "inverse-square", "sampling": "jittered", "samples": 2, "shape":
             {"type": "plane", "points": [[1.0, 3.0, 0.0], [1.0, 3.1, 1.0], [2.0, 3.2, 1.0],
                                          [2.0, 3.1, 0.0]]}},
            {"type": "arealight", "intensity": 9.0, "color": [1, 1, 1], "falloff": "linear",
             "sampling": "random", "samples": 3,
             "shape": {"type": "sphere", "center": [0.1, 2.9, 1.7], "radius": 0.2}}
        ], "shapes": [
            {"type": "plane", "sides": "both", "material": shiny([0.7, 0.6, 0.5], 0.3),
             "points": [[-4.0, -1.0, 4.0], [-4.0, -1.3, -4.0], [4.0, -1.3, -4.0],
                        [4.0, -1.0, 4.0]]},
            {"type": "triangle", "sides": "both", "material": shiny([0.2, 0.7, 0.9], 0.2),
             "points": [[-2.0, -0.7, -2.0], [0.3, 2.1, -2.4], [2.2, -0.9, -1.7]]},
            {"type": "trimesh", "sides": "both", "material": shiny([0.9, 0.3, 0.2], 0.1),
             "points": points, "indices": ball.triangles, "shading": "smooth",
             "normals": ball.positions.iter().map(|p| p.as_dvec3().to_array()).collect::<Vec<_>>()},
            scenes::sphere(DVec3::new(1.3, 0.1, 0.4), 0.9, shiny([0.4, 0.9, 0.4], 0.5))
        ]}
    })
}

/// The scene with its axes permuted by `turn`, where 1 is x to y to z to x, and lengths times
/// `unit`: lights that fall off with the distance or its square grow with it.
fn in_axes(key: &str, value: &Value, [unit, turn]: [f64; 2]) -> Value {
    let of = |key: &str, value: &Value| in_axes(key, value, [unit, turn]);
    let times = |factor: f64| json!(value.as_f64().unwrap_or(f64::NAN) * factor);
    match (key, value) {
        (_, Value::Object(object)) => {
            let mut placed: Value =
                object.iter().map(|(key, value)| (key.clone(), of(key, value))).collect();
            let power = match object.get("falloff").and_then(Value::as_str) {
                Some("linear") => unit,
                Some("inverse-square") => unit * unit,
                _ => 1.0,
            };
            if let Some(intensity) = object.get("intensity").and_then(Value::as_f64) {
                placed["intensity"] = json!(intensity * power);
            }
            placed
        }
        ("radius" | "aperture" | "focal", Value::Number(_)) => times(unit),
        (
            "center" | "points" | "location" | "look" | "position" | "up" | "normals",
            Value::Array(items),
        ) if items.len() == 3 && items[0].is_number() => {
            let length = if matches!(key, "up" | "normals") { 1.0 } else { unit };
            let mut turned = [0, 1, 2].map(|k| items[k].as_f64().unwrap_or(f64::NAN) * length);
            turned.rotate_right(turn as usize);
            json!(turned)
        }
        (_, Value::Array(items)) => items.iter().map(|item| of(key, item)).collect(),
        _ => value.clone(),
    }
}

/// Powers of two by which scenes of case 8 are scaled, the largest first, after two that are
/// turned.
pub(super) const SCALES: [usize; 2] = [4, 45];

/// Case 8. Turned scenes have nothing round: spherical lights have an axis of their own.
pub(super) fn scaled(numbers: &mut Numbers) -> Vec<Picture> {
    let mut still = everything(&numbers.effort);
    let axes = if numbers.index < 2 {
        for round in ["shapes", "lightsources"] {
            if let Some(all) = still["scene"][round].as_array_mut() {
                all.pop();
            }
        }
        [1.0, (numbers.index + 1) as f64]
    } else {
        let power = [-20, 20, -7, 0].into_iter().chain(-19..=19).nth(numbers.index - 2);
        [libm::exp2(f64::from(power.unwrap_or(0))), 0.0]
    };
    let scene = in_axes("", &still, axes);
    vec![Picture { presets: PRESETS, ..Picture::same(scene, &still) }]
}

/// The globe with `count` degenerate triangles among its own, whose new numbers are returned too.
fn mixed(numbers: &mut Numbers, count: u32) -> (Geometry, Vec<u32>) {
    let mesh = globe();
    let (mut mixed, mut kept) = (Geometry { triangles: vec![], ..mesh.clone() }, Vec::new());
    let mut left = count;
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        // The last of them come after the last triangle.
        let share = left / (mesh.triangles.len() - i) as u32;
        for _ in 0..share {
            let nothing = nothing(numbers, &mut mixed.positions, triangle);
            mixed.triangles.push(nothing);
        }
        left -= share;
        kept.push(mixed.triangles.len() as u32);
        mixed.triangles.push(*triangle);
    }
    (mixed, kept)
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

/// The number of degenerate triangles of case 18.
fn without_area(effort: &Effort) -> u32 {
    effort.of(100_000) as u32
}

/// Case 18: the image is the same as without them.
pub(super) fn among_others(numbers: &mut Numbers) -> Vec<Picture> {
    let effort = numbers.effort;
    let (mixed, _) = mixed(numbers, without_area(&effort));
    let [mixed, clean] =
        [mixed, globe()].map(|mesh| lit(&effort, DVec3::ZERO, &as_mesh(&mesh, DVec3::ZERO)));
    vec![Picture { presets: PRESETS, ..Picture::same(mixed, &clean) }]
}

/// Case 18: each pixel shows the face expected there.
pub(super) fn faces_among_others(numbers: &mut Numbers) -> World {
    let effort = numbers.effort;
    let (mixed, kept) = mixed(numbers, without_area(&effort));
    let scene = lit(&effort, DVec3::ZERO, &as_mesh(&mixed, DVec3::ZERO));
    faces(numbers, &scene, &[Preset::VeryFast], move |face| kept[face])
}

/// Case 18: they are counted, and a warning has the number.
pub(super) fn counted(effort: &Effort) -> Outcome {
    let count = without_area(effort);
    let (mixed, _) = mixed(&mut Numbers::new(effort, [18, 0], 0), count);
    let scene = lit(effort, DVec3::ZERO, &as_mesh(&mixed, DVec3::ZERO));
    Outcome::from(scenes::prepare(effort, &scene, Preset::Medium).map(|prepared| {
        let found = prepared.scene.dropped.degenerate;
        let is_right = found == u64::from(count) && prepared.warns(&format!(" {count} triangles"));
        Outcome::of(is_right, || format!("{found} of {count} are counted, {:?}", prepared.warnings))
    }))
}
