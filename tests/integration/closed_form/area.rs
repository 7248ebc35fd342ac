//! Area lights: their average against a fine sum over their points, and how they are seen.

use glam::DVec3;
use serde_json::{Value, json};

use super::{Eye, Lamp, Phong, times};
use crate::support::{
    assert_near, folder, image, image_of, matte, pixel, prepare, scene, sphere, wall, with,
};

const EYE: Eye = Eye { size: [5, 5], fov: 30.0, distance: 5.0 };
const WALL: Phong = Phong { ks: 0.0, kd: 0.8, exponent: 1.0, color: [0.9, 0.5, 0.25] };
const COLOR: [f64; 3] = [1.0, 0.75, 0.5];
const AMBIENT: f64 = 0.08;

/// A parallelogram above the wall and out of the picture: near enough that its points differ.
const CORNER: DVec3 = DVec3::new(-1.0, 2.0, 0.5);
const EDGES: [DVec3; 2] = [DVec3::new(2.5, 0.0, 0.5), DVec3::new(0.0, 1.0, 1.5)];

fn light(sampling: &str, samples: u32, shape: Value) -> Value {
    json!({"type": "arealight", "intensity": 20.0, "color": COLOR, "sampling": sampling,
           "samples": samples, "shape": shape})
}

fn quad() -> Value {
    let [a, b] = EDGES;
    let corners = [CORNER, CORNER + b, CORNER + a + b, CORNER + a].map(|p| p.to_array());
    json!({"type": "plane", "points": corners})
}

fn triangle() -> Value {
    let [a, b] = EDGES;
    let corners = [CORNER, CORNER + b, CORNER + a].map(|p| p.to_array());
    json!({"type": "triangle", "points": corners})
}

/// A disk that faces the wall, with two of its radii.
const RADII: [DVec3; 2] = [DVec3::new(0.8, 0.0, 0.0), DVec3::new(0.0, 0.64, 0.48)];

fn disk() -> Value {
    let normal = RADII[1].cross(RADII[0]).to_array();
    json!({"type": "disk", "center": CORNER.to_array(), "radius": 0.8, "normal": normal})
}

/// Shapes of lights, each with points spread evenly over it.
fn shapes() -> [(Value, Vec<DVec3>); 3] {
    const N: usize = 120;
    let middle = |i: usize| (i as f64 + 0.5) / N as f64;
    let square = || (0..N * N).map(|i| (middle(i % N), middle(i / N)));
    let at = |(u, v)| CORNER + EDGES[0] * u + EDGES[1] * v;
    let of_disk = square().map(|(u, v)| (2.0 * u - 1.0, 2.0 * v - 1.0));
    let of_disk = of_disk.filter(|(x, y)| x * x + y * y < 1.0);
    [
        (quad(), square().map(at).collect()),
        (triangle(), square().filter(|(u, v)| u + v < 1.0).map(at).collect()),
        (disk(), of_disk.map(|(x, y)| CORNER + RADII[0] * x + RADII[1] * y).collect()),
    ]
}

/// Mean and variance, in red, of what the wall at `point` reflects of one random point.
fn moments(point: DVec3, points: &[DVec3]) -> (f64, f64) {
    let red = |&position: &DVec3| {
        let lamp = Lamp { position, intensity: 20.0, color: COLOR, falloff: "linear" };
        // Without a highlight the direction of the view plays no part.
        lamp.reflected(WALL, point, DVec3::Z, DVec3::Z)[0]
    };
    let n = points.len() as f64;
    let mean = points.iter().map(red).sum::<f64>() / n;
    (mean, points.iter().map(|p| (red(p) - mean).powi(2)).sum::<f64>() / n)
}

/// Number of renders, each with random numbers of its own.
const SEEDS: u64 = 40;

/// The red of every pixel in every render.
fn reds(light: Value) -> Vec<Vec<f64>> {
    let prepared = prepare(&scene(0, &EYE.json(), &[light], &[wall(50.0, 0.0, WALL.json())]));
    (0..SEEDS)
        .map(|seed| {
            let film = image_of(&prepared, seed);
            film.pixels().iter().map(|p| f64::from(p[0])).collect()
        })
        .collect()
}

/// Checks the mean over seeds of each pixel, and returns the mean square error in units of the
/// variance that independent points would have.
fn check_average(light: Value, count: u32, points: &[DVec3]) -> f64 {
    let renders = reds(light);
    let mut squares = 0.0;
    for pixel in 0..25_u32 {
        let (mean, variance) = moments(EYE.on_wall(pixel % 5, pixel / 5, 0.0), points);
        let expected = mean + AMBIENT * WALL.color[0];
        let one = variance / f64::from(count);
        let values = renders.iter().map(|render| render[pixel as usize]);
        let found = values.clone().sum::<f64>() / SEEDS as f64;
        // Five standard errors: over all pixels and lights one run in ten thousand goes beyond.
        // Seeds are fixed, so that a run that passes once passes always.
        let bound = 5.0 * (one / SEEDS as f64).sqrt() + 1e-5;
        assert!((found - expected).abs() < bound, "pixel {pixel}: {found}, not {expected}");
        squares += values.map(|v| (v - expected).powi(2)).sum::<f64>() / one;
    }
    squares / (25.0 * SEEDS as f64)
}

#[test]
fn random_points_average_to_the_integral_with_the_noise_of_independent_ones() {
    for (shape, points) in shapes() {
        let noise = check_average(light("random", 16, shape), 16, &points);
        // A sum of 1000 squares of unit variance: its mean is 1 within five times 0.045.
        assert!((noise - 1.0).abs() < 0.23, "{noise}");
    }
}

#[test]
fn jittered_points_average_to_the_integral_with_less_noise() {
    for (shape, points) in shapes() {
        let noise = check_average(light("jittered", 4, shape), 16, &points);
        assert!(noise < 0.5, "{noise}");
    }
}

#[test]
fn a_light_of_triangles_from_a_file_averages_as_its_shape_does() {
    let folder = folder();
    let [a, b] = EDGES;
    let corners = [CORNER, CORNER + a, CORNER + a + b, CORNER + b];
    let line = |p: &DVec3| format!("v {} {} {}\n", p.x, p.y, p.z);
    let text = corners.iter().map(line).collect::<String>() + "f 1 2 3 4\n";
    let file = folder.path().join("light.obj");
    std::fs::write(&file, text).expect("a file");
    let mesh = json!({"type": "trimesh", "file": file});
    check_average(light("random", 16, mesh), 16, &shapes()[0].1);
}

#[test]
fn a_small_round_light_acts_as_a_point() {
    let position = DVec3::new(1.0, 2.0, 3.0);
    let shape = json!({"type": "sphere", "center": position.to_array(), "radius": 1e-4});
    let film = image(&scene(
        0,
        &EYE.json(),
        &[light("random", 2, shape)],
        &[wall(50.0, 0.0, WALL.json())],
    ));
    let lamp = Lamp { position, intensity: 20.0, color: COLOR, falloff: "linear" };
    let lit = lamp.reflected(WALL, DVec3::ZERO, DVec3::Z, DVec3::Z);
    let expected = super::plus(lit, times(WALL.color, AMBIENT));
    assert_near(pixel(&film, 2, 2), expected, 1e-3, "the middle");
}

/// A light in the middle of the picture, over a wall that mirrors.
fn seen(kr: f64, bounces: u32) -> Value {
    let square = wall(0.2, 2.0, matte(0.0, [0.0; 3]));
    // Behind the eye, where only a mirror shows it.
    let behind = sphere([0.0, 0.0, 9.0], 2.0, matte(0.0, [0.0; 3]));
    let lights = [light("random", 1, square), light("random", 1, behind)];
    let mirror = wall(50.0, 0.0, with(matte(0.0, [0.0; 3]), "kr", kr));
    scene(bounces, &Eye { size: [25, 25], ..EYE }.json(), &lights, &[mirror])
}

#[test]
fn a_primary_ray_that_meets_a_light_returns_its_colour() {
    let film = image(&seen(0.0, 0));
    assert_near(pixel(&film, 12, 12), COLOR, 0.0, "the light");
    assert_near(pixel(&film, 8, 12), [0.0; 3], 0.0, "the black wall beside it");
}

#[test]
fn a_mirror_shows_the_colour_of_a_light() {
    // Beside the small light: that ray comes back past it, to the ball behind the eye.
    let film = image(&seen(0.5, 1));
    assert_near(pixel(&film, 8, 12), times(COLOR, 0.5), 1e-7, "the ball in the mirror");
    assert_near(pixel(&image(&seen(0.5, 0)), 8, 12), [0.0; 3], 0.0, "no bounces, no ball");
}

#[test]
fn the_shape_of_a_light_casts_no_shadow() {
    let position = DVec3::new(2.0, 4.0, 3.0);
    let lamp = Lamp { position, intensity: 9.0, color: [1.0; 3], falloff: "none" };
    // A dark light half way between the lamp and the middle of the wall.
    let ball = |radius: f64| sphere([1.0, 2.0, 1.5], radius, matte(0.0, [0.0; 3]));
    let dark = with(light("random", 1, ball(0.5)), "intensity", 0.0);
    let shapes = [wall(50.0, 0.0, WALL.json()), ball(0.4)];
    let middle =
        |lights: &[Value], shapes| pixel(&image(&scene(0, &EYE.json(), lights, shapes)), 2, 2);
    let lit = lamp.reflected(WALL, DVec3::ZERO, DVec3::Z, DVec3::Z);
    let shadow = times(WALL.color, 2.0 * AMBIENT);
    let lights = [lamp.json(), dark];
    assert_near(middle(&lights, &shapes[..1]), super::plus(lit, shadow), 1e-5, "behind the light");
    assert_near(middle(&lights, &shapes), shadow, 1e-7, "behind a ball within it");
}
