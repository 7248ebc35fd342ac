//! Cameras with extreme parameters, and almost empty scenes.

use std::sync::Arc;

use super::prelude::*;
use super::scenes::BACKGROUND;
use wavecrest_core::math::random::Stream;

/// Case 24: no shape, or one of each kind, with a light and without.
pub(super) fn next_to_nothing(numbers: &mut Numbers) -> Vec<Picture> {
    let eye =
        Eye::at(numbers.direction() * 4.0, 50.0, [(); 2].map(|()| 1 + numbers.below(24) as u32));
    let background = [(); 3].map(|()| numbers.one());
    let light = scenes::point_light(50.0, numbers.direction() * 9.0, "linear");
    let [a, b, c] = [(); 3].map(|()| numbers.direction() * 1.2);
    let mut shiny = scenes::matte([0.9, 0.8, 0.7]);
    shiny["kr"] = json!(0.5);
    let triangle = json!({"type": "triangle", "sides": "both", "material": shiny,
                          "points": [a.to_array(), b.to_array(), c.to_array()]});
    let shapes = [
        None,
        Some(triangle),
        Some(scenes::mesh(&[a, b, c].map(|p| p.as_vec3()), &[[0, 1, 2]], shiny.clone())),
        Some(scenes::sphere(a * 0.5, 0.7, shiny.clone())),
        Some(scenes::plane([a, b, c, a + c - b], shiny)),
    ];
    let all = shapes.into_iter().flat_map(|shape| [false, true].map(|lit| (shape.clone(), lit)));
    let picture = |(shape, is_lit): (Option<Value>, bool)| {
        let lights = if is_lit { std::slice::from_ref(&light) } else { &[] };
        let mut scene = scenes::scene(&eye, lights, shape.as_slice());
        scene["nbounces"] = json!([0, 5][numbers.below(2)]);
        scene["scene"]["backgroundcolor"] = json!(background);
        let right = background.map(|c| c as f32);
        let shows = move |x, y, pixel: [f32; 3]| {
            let is_seen = sees(shape.as_ref(), eye.location, eye.direction(x, y))?;
            Some(if is_seen {
                pixel != right && (is_lit || pixel == [0.0; 3])
            } else {
                pixel == right
            })
        };
        Picture { presets: &Preset::ALL, ..Picture::new(scene, shows) }
    };
    all.map(picture).collect()
}

/// Whether the ray meets the shape, in double precision; `None` beside its edge.
fn sees(shape: Option<&Value>, origin: DVec3, direction: DVec3) -> Option<bool> {
    const EDGE: f64 = 1e-4;
    let Some(shape) = shape else { return Some(false) };
    let vector = |value: &Value| {
        DVec3::from([0, 1, 2].map(|i| value[i].as_f64().unwrap_or(f64::NAN))) - origin
    };
    if let Some(radius) = shape["radius"].as_f64() {
        let beside = vector(&shape["center"]).cross(direction).length() - radius;
        return (beside.abs() > EDGE).then_some(beside < 0.0);
    }
    let points: Vec<DVec3> = shape["points"].as_array()?.iter().map(vector).collect();
    // The ray passes every edge on the same side.
    let sides = (0..points.len()).map(|i| {
        let (p, q) = (points[i], points[(i + 1) % points.len()]);
        p.cross(q).dot(direction) / (q - p).length()
    });
    let sides: Vec<f64> = sides.collect();
    let is_doubtful = sides.iter().any(|s| s.abs() < EDGE);
    let is_inside = sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0);
    (!is_doubtful).then_some(is_inside)
}

/// The largest error of a unit vector's length, and of a right angle's cosine: 4 ulp of 1.
const LARGEST_ERROR: f64 = 4.0 * f32::EPSILON as f64;

/// Case 27.
pub(super) fn upright(numbers: &mut Numbers) -> Outcome {
    let location = numbers.direction() * numbers.magnitude(1e-3, 1e6);
    let axis = DVec3::AXES[numbers.below(3)] * numbers.sign();
    let along = [axis, numbers.direction()][numbers.below(2)];
    let look = location + along * numbers.magnitude(1e-3, 1e6);
    // The rounded sum in the file, not the intended value.
    let view = look - location;
    let off = numbers.among([0.0, 1e-7, 1e-5, 1.0]);
    let aside = view.normalize().cross(numbers.direction()).normalize();
    let up = (view.normalize() + aside * off) * numbers.sign() * numbers.magnitude(1e-3, 1e3);
    let eye = Eye { location, look, up, fov: 40.0, size: [4, 3] };
    let scene = scenes::scene(&eye, &[], &[]);
    let prepared = scenes::prepare(&numbers.effort, &scene, Preset::VeryFast).map(|prepared| {
        let is_warned = prepared.warns("camera.up");
        let basis = prepared.scene.camera.basis().map(|v| v.as_dvec3());
        let pairs = (0..9).map(|i| (basis[i / 3].dot(basis[i % 3]), i / 3 == i % 3));
        let error =
            |(product, is_same): (f64, bool)| (product - f64::from(u8::from(is_same))).abs();
        let error = pairs.map(error).fold(0.0, f64::max);
        let is_right = is_warned == (off < 1e-6) && error <= LARGEST_ERROR;
        Outcome::of(is_right, || format!("warned: {is_warned}, the axes are off by {error:e}"))
    });
    let mut outcome = Outcome::from(prepared);
    // And a camera that looks at its own position.
    let scene = scenes::scene(&Eye { look: location, ..eye }, &[], &[]);
    outcome.add(Refusal::at(&scene, "camera.look").tried(&numbers.effort));
    outcome.with_context(|| format!("location {location}, look {look}, up {up}"))
}

/// Case 28: rays of some pixels.
pub(super) fn angles(numbers: &mut Numbers) -> Outcome {
    let any = numbers.magnitude(0.001, 179.0).clamp(0.001, 179.0);
    let fov = numbers.among([0.001, 179.0, any, any]);
    let mut size = [1, numbers.among([1, 2, 7, 100, 65_536])];
    size.rotate_left(numbers.below(2));
    let (look, up) = (numbers.direction(), numbers.direction());
    let eye = Eye { location: DVec3::ZERO, look, up, fov, size };
    let mut scene = scenes::scene(&eye, &[], &[]);
    scene["camera"]["fovaxis"] = json!(numbers.among(["x", "y", "smaller", "larger"]));
    scene["camera"]["antialias"] = json!(numbers.among([1, 2]));
    let context = || scene["camera"].to_string();
    let prepared = scenes::prepare(&numbers.effort, &scene, Preset::VeryFast).map(|prepared| {
        let one = |_| {
            let [x, y] = size.map(|side| numbers.below(side as usize) as u32);
            let stream = Stream { seed: numbers.effort.seed, pixel: 0, sample: 0, bounce: 0 };
            let ray = prepared.scene.camera.ray(x, y, &stream);
            let error = (ray.direction.as_dvec3().length() - 1.0).abs();
            let is_right = ray.is_valid() && error < LARGEST_ERROR;
            Outcome::of(is_right, || format!("pixel ({x}, {y}) has the ray {ray}"))
        };
        (0..100).map(one).sum()
    });
    Outcome::from(prepared).with_context(context)
}

/// Images of case 28.
pub(super) const THIN: usize = 12;

/// Case 28: an image one pixel wide or high, the same to the last bit in every way of rendering.
pub(super) fn thin_images(numbers: &mut Numbers) -> Vec<Picture> {
    let size = [[1, 33], [33, 1], [1, 1]][numbers.index % 3];
    let fov = [0.001, 1.0, 90.0, 179.0][numbers.index / 3];
    let eye = Eye::at(DVec3::Z * 4.0, fov, size);
    let shape = scenes::sphere(DVec3::ZERO, 1.5, scenes::white());
    let light = scenes::point_light(50.0, DVec3::new(3.0, 4.0, 5.0), "linear");
    let scene = scenes::scene(&eye, &[light], &[shape]);
    vec![Picture::new(scene, |_, _, _| None).like_itself()]
}

/// Case 28: invalid angles of view.
pub(super) fn refused_angles(numbers: &mut Numbers) -> Refusal {
    let fov = [0.0, -1.0, 0.000_999, 179.001, 180.0, 1e9][numbers.index % 6];
    let eye = Eye { look: DVec3::X, ..Eye::at(DVec3::ZERO, fov, [3, 3]) };
    Refusal::at(&scenes::scene(&eye, &[], &[]), "camera.fov")
}

/// Case 29: a lens with aperture 0.
pub(super) fn closed_lens(numbers: &mut Numbers) -> Vec<Picture> {
    let eye = Eye::at(numbers.direction() * 5.0, 45.0, [20, 15]);
    let shapes = [
        scenes::sphere(DVec3::ZERO, 1.0, scenes::matte([0.9, 0.5, 0.1])),
        scenes::sphere(DVec3::new(1.5, 0.2, 0.3), 0.7, scenes::matte(BACKGROUND)),
    ];
    let light = scenes::point_light(50.0, numbers.direction() * 8.0, "linear");
    let mut pinhole = scenes::scene(&eye, &[light], &shapes);
    pinhole["camera"]["antialias"] = json!(1 + numbers.below(3));
    let mut closed = pinhole.clone();
    closed["camera"]["type"] = json!("thinlens");
    closed["camera"]["aperture"] = json!(0);
    closed["camera"]["focal"] = json!(numbers.magnitude(1e-6, 1e9));
    vec![Picture::same(closed, &pinhole)]
}

/// Points of the lens of case 54 along each side of their grid, and its radius.
const LENS_POINTS: u32 = 8;
const LENS_RADIUS: f64 = 1.0;

/// Case 54: a wall along the view axis, a wall across it in the plane of the lens, or a sphere,
/// through the middle of the lens. Black is seen by those rays of the lens that meet it, which
/// start on both sides of it, and white by all others.
pub(super) fn cut_lens(numbers: &mut Numbers) -> Vec<Picture> {
    let eye = Eye { location: DVec3::ZERO, look: DVec3::Z, ..Eye::at(DVec3::ZERO, 40.0, [15, 11]) };
    let radius = 0.3 + 0.5 * numbers.one();
    let black = scenes::matte([0.0; 3]);
    // No lens point is exactly on the slanted wall; the last shape is met far from the lens.
    let (aside, half) = (DVec3::new(1.0, numbers.about(1.0), 0.0).normalize(), 50.0);
    let wall = [DVec3::ZERO, aside * half, DVec3::Z * half];
    let across = [DVec3::Z * 0.1, DVec3::X * radius, DVec3::Y * radius];
    let kind = numbers.index % 3;
    let shape = match kind {
        0 => scenes::square(wall, black),
        1 => scenes::square(across, black),
        _ => scenes::sphere(DVec3::ZERO, radius, black),
    };
    let mut scene = scenes::scene(&eye, &[], &[shape]);
    let camera = &mut scene["camera"];
    camera["type"] = json!("thinlens");
    camera["aperture"] = json!(2.0 * LENS_RADIUS);
    camera["focal"] = json!(numbers.magnitude(0.5, 20.0));
    camera["sampling"] = json!(numbers.among(["random", "jittered", "sobol"]));
    camera["nsamplesx"] = json!(LENS_POINTS);
    camera["nsamplesy"] = json!(LENS_POINTS);
    scene["scene"]["backgroundcolor"] = json!([1, 1, 1]);
    // Whether a ray passes the shape; `None` near its edge.
    let passes = move |ray: &Ray| -> Option<bool> {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let off = match kind {
            0 => {
                let normal = aside.cross(DVec3::Z);
                let place = o - d * (o.dot(normal) / d.dot(normal));
                let inside = (half - place.z.abs()).min(half - place.dot(aside).abs());
                let before = -o.dot(normal) / d.dot(normal);
                inside.min(before)
            }
            1 => {
                let place = o + d * ((0.1 - o.z) / d.z);
                radius - place.x.abs().max(place.y.abs())
            }
            // From inside a sphere every ray meets it.
            _ if o.length() < radius => radius - o.length(),
            _ if o.dot(d) >= 0.0 => radius - o.length(),
            _ => radius - o.cross(d).length(),
        };
        (off.abs() > 1e-5).then_some(off < 0.0)
    };
    let effort = numbers.effort;
    let camera = scenes::prepare(&effort, &scene, Preset::VeryFast).map(|p| p.scene.camera);
    let camera = Arc::new(camera);
    let shows = move |x, y, [pixel, ..]: [f32; 3]| {
        let camera = camera.as_ref().as_ref().ok()?;
        let rays = LENS_POINTS * LENS_POINTS;
        let ray = |sample| {
            let pixel = y * camera.size()[0] + x;
            camera.ray(x, y, &Stream { seed: effort.seed, pixel, sample, bounce: 0 })
        };
        let rays_of_pixel: Vec<Ray> = (0..rays).map(ray).collect();
        // They start all over the lens, whose middle is the origin.
        let from_middle = |ray: &Ray| f64::from(ray.origin.length()) / LENS_RADIUS;
        if rays_of_pixel.iter().map(from_middle).fold(0.0, f64::max) < 0.5 {
            return Some(false);
        }
        let passing: Vec<bool> = rays_of_pixel.iter().map(passes).collect::<Option<_>>()?;
        let share = passing.iter().filter(|passes| **passes).count() as f32 / rays as f32;
        Some(pixel == share)
    };
    vec![Picture::new(scene, shows)]
}
