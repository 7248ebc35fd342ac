//! Transparent surfaces: what is seen through them, and the light that passes.

use super::prelude::*;
use wavecrest_core::prepared::{LookUps, PreparedScene};
use wavecrest_core::with_precision;

/// Surfaces nearer to each other than this along a ray may be met as one: points on them carry an
/// error bound, by which the next ray starts behind.
const LEAST_GAP: f64 = 1e-3;

/// The largest relative error of what is seen through surfaces.
const LARGEST_ERROR: f64 = 1e-5;

/// A material of which nothing is seen but what goes through it.
fn clear(more: Value) -> Value {
    scenes::with(scenes::matte([0.0; 3]), more)
}

fn is_near(pixel: [f32; 3], right: DVec3, error: f64) -> bool {
    let off = DVec3::from(pixel.map(f64::from)) - right;
    off.abs().cmple(right * error).all()
}

/// Balls, each but the first concentric with another, or touching it from inside or outside, or
/// with its centre on the other's surface.
fn balls(numbers: &mut Numbers) -> Vec<(DVec3, f64)> {
    const NUMBER: usize = 4;
    let mut balls = vec![(numbers.ball(0.5), 1.0 + numbers.one())];
    while balls.len() < NUMBER {
        let (center, radius) = balls[numbers.below(balls.len())];
        let own = radius * (0.2 + 0.6 * numbers.one());
        let distance = numbers.among([0.0, radius - own, radius + own, radius]);
        balls.push((center + numbers.direction() * distance, own));
    }
    balls
}

/// More bounces than balls have surfaces.
fn bounces() -> Value {
    json!({"nbounces": 12})
}

/// Case 57: balls that bend no ray, and colour what is behind them once at each surface.
pub(super) fn unbent(numbers: &mut Numbers) -> Vec<Picture> {
    let eye = Eye::at(numbers.direction() * 20.0, 20.0, [15, 11]);
    let balls: Vec<_> = balls(numbers)
        .into_iter()
        .map(|(center, radius)| {
            let color = [(); 3].map(|()| 0.7 + 0.3 * numbers.one());
            (center, radius, DVec3::from(color))
        })
        .collect();
    let shape = |&(center, radius, color): &(DVec3, f64, DVec3)| {
        let color = color.to_array();
        let material = clear(json!({"kt": 1, "ior": 1, "transmissioncolor": color}));
        scenes::sphere(center, radius, material)
    };
    let shapes: Vec<Value> = balls.iter().map(shape).collect();
    let scene = scenes::with(scenes::scene(&eye, &[], &shapes), bounces());
    let shows = move |x, y, pixel| {
        let direction = eye.direction(x, y);
        let (mut ends, mut right) = (Vec::new(), DVec3::from(scenes::BACKGROUND));
        for &(center, radius, color) in &balls {
            let to = center - eye.location;
            let along = to.dot(direction);
            let square = radius * radius - (to - direction * along).length_squared();
            // Where a ray grazes a ball, it is in it on a short way or not at all.
            if square.abs() < LEAST_GAP {
                return None;
            }
            if square > 0.0 {
                ends.extend([along - square.sqrt(), along + square.sqrt()]);
                right *= color * color;
            }
        }
        are_apart(ends).then(|| is_near(pixel, right, LARGEST_ERROR))
    };
    vec![Picture::new(scene, shows).like_itself()]
}

/// Whether all of a ray's hits are at different places.
fn are_apart(mut ends: Vec<f64>) -> bool {
    ends.sort_by(f64::total_cmp);
    ends.windows(2).all(|pair| pair[1] - pair[0] > LEAST_GAP)
}

/// Case 57: a floor that is lit through such balls, and seen through them.
pub(super) fn unshadowed(numbers: &mut Numbers) -> Vec<Picture> {
    let eye = Eye::above(40.0, 13);
    let (floor, light) = (scenes::floor(50.0, scenes::white()), numbers.ball(1.0));
    let light = scenes::point_light(50.0, light + DVec3::new(1.0, 6.0, 2.0), "linear");
    let mut shapes = vec![floor];
    let bare = scenes::scene(&eye, std::slice::from_ref(&light), &shapes);
    let bare = scenes::by_brute_force(&numbers.effort, &bare);
    let ball = |(center, radius)| {
        scenes::sphere(center + DVec3::Y, radius, clear(json!({"kt": 1, "ior": 1})))
    };
    shapes.extend(balls(numbers).into_iter().map(ball));
    let scene = scenes::with(scenes::scene(&eye, &[light], &shapes), bounces());
    let shows = move |x, y, pixel| {
        let bare = bare.as_ref().ok()?.pixel(x, y)?;
        Some(is_near(pixel, DVec3::from(bare.map(f64::from)), 1e-4))
    };
    vec![Picture::new(scene, shows).like_itself()]
}

/// Case 58: panes across the view, and some in whose planes the eye is.
pub(super) fn panes(numbers: &mut Numbers) -> Vec<Picture> {
    const MOST: usize = 30;
    const HALF: f64 = 50.0;
    let eye = Eye::at(DVec3::Z * 9.0, 30.0, [9, 7]);
    // The heights at which planes cross the z axis, and their slopes.
    let (mut planes, mut share) = (Vec::new(), 1.0);
    let shapes: Vec<Value> = (0..=numbers.below(MOST))
        .map(|_| {
            let opacity = 0.12 * numbers.one();
            let aside = if numbers.once_in(6) {
                [DVec3::ZERO, DVec3::Z * HALF, numbers.among([DVec3::X, DVec3::Y]) * HALF]
            } else {
                let [height, a, b] = [4.0, 0.1, 0.1].map(|size| numbers.about(size));
                planes.push([height, a, b]);
                share *= 1.0 - opacity;
                let [u, v] = [DVec3::new(1.0, 0.0, a), DVec3::new(0.0, 1.0, b)];
                [DVec3::Z * height, u * HALF, v * HALF]
            };
            scenes::square(aside, clear(json!({"opacity": opacity})))
        })
        .collect();
    let more = json!({"nbounces": numbers.among([0, 5])});
    let scene = scenes::with(scenes::scene(&eye, &[], &shapes), more);
    let shows = move |x, y, pixel| {
        let d = eye.direction(x, y);
        let met = |&[height, a, b]: &[f64; 3]| (9.0 - height) / (a * d.x + b * d.y - d.z);
        let right = DVec3::from(scenes::BACKGROUND) * share;
        are_apart(planes.iter().map(met).collect()).then(|| is_near(pixel, right, LARGEST_ERROR))
    };
    vec![Picture::new(scene, shows).like_itself()]
}

/// Case 59: rays exactly through corners, edges and faces of a closed mesh, whose coordinates are
/// multiples of [`STEP`].
pub(super) fn shadow_rays(numbers: &mut Numbers) -> Outcome {
    let mesh = convex(1 + numbers.below(6) as i32, RADIUS, STEP);
    let points: Vec<DVec3> = mesh.positions.iter().map(|point| point.as_dvec3()).collect();
    let shape = scenes::mesh(&points, &mesh.triangles, clear(json!({"opacity": 0.5})));
    // The scene is moved to the camera: to where it is.
    let eye = Eye { look: DVec3::X, ..Eye::at(DVec3::ZERO, 40.0, [1, 1]) };
    let prepared = scenes::prepare_whole(&numbers.effort, &scenes::scene(&eye, &[], &[shape]));
    let all = prepared.map(|prepared| {
        let one = |_| {
            let [a, b, c] = mesh.triangle(numbers.below(mesh.triangles.len()));
            let target = numbers.among([a, (a + b) * 0.5, (a + b + (c + c)) * 0.25]);
            let inside = (numbers.ball(0.3 * RADIUS) / STEP).round() * STEP;
            let way = inside.as_vec3() - target;
            lost_twice(&prepared.scene, &Ray::new(target - way, way))
        };
        (0..100).map(one).sum()
    });
    Outcome::from(all)
}

const STEP: f64 = 1.0 / 64.0;
const RADIUS: f64 = 64.0;

/// Whether half of the light is lost where the ray enters, and half of the rest where it leaves.
fn lost_twice(scene: &PreparedScene, ray: &Ray) -> Outcome {
    let (mut traversal, mut hits) = (scene.accel.traversal(), Vec::new());
    let precision = scene.accel.geometry().precision;
    let mut look_ups = LookUps::default();
    let passed = with_precision!(precision, P =>
        scene.passed::<P>(ray, &mut hits, &mut traversal, &mut look_ups));
    let is_blocked = scene.accel.occluded(ray, &mut traversal);
    Outcome::of(passed == Vec3::splat(0.25) && !is_blocked, || {
        format!("{ray}: {passed} of the light passes {hits:?}, blocked: {is_blocked}")
    })
}

/// Case 60: balls of any material that emits nothing, in even white light from all sides.
pub(super) fn in_white_light(numbers: &mut Numbers) -> Vec<Picture> {
    let eye = Eye::at(numbers.direction() * 20.0, 20.0, [9, 7]);
    let shapes: Vec<Value> = balls(numbers)
        .into_iter()
        .map(|(center, radius)| {
            let kt = numbers.one();
            let material = json!({"kt": kt, "kr": 1.0 - kt, "ior": numbers.magnitude(0.1, 10.0),
                                  "opacity": numbers.among([0.5, 1.0]),
                                  "thin": numbers.once_in(4)});
            scenes::sphere(center, radius, clear(material))
        })
        .collect();
    let white = json!([1, 1, 1]);
    let more = json!({"nbounces": numbers.among([1, 3, 6]),
                      "scene": {"backgroundcolor": white,
                                "ambient": {"sky": white, "ground": white}}});
    let scene = scenes::with(scenes::scene(&eye, &[], &shapes), more);
    let shows = |_, _, pixel: [f32; 3]| {
        Some(pixel.iter().all(|&value| f64::from(value) <= 1.0 + LARGEST_ERROR))
    };
    vec![Picture::new(scene, shows).like_itself()]
}
