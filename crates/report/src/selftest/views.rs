//! Cameras with extreme parameters, and almost empty scenes.

use super::prelude::*;

/// Case 24: no shape, or one of each kind around the middle of the image, with a light and without.
pub(super) fn next_to_nothing(numbers: &mut Numbers) -> Vec<Picture> {
    let [a, b, c] = [(); 3].map(|()| numbers.direction() * 1.2);
    let center = (a + b + c) / 3.0;
    let size = [(); 2].map(|()| 1 + 2 * numbers.below(12) as u32);
    let eye = Eye { look: center, ..Eye::at(numbers.direction() * 4.0, 50.0, size) };
    let background = [(); 3].map(|()| numbers.one());
    let light = scenes::point_light(50.0, numbers.direction() * 9.0, "linear");
    let shiny = scenes::with(scenes::matte([0.9, 0.8, 0.7]), json!({"kr": 0.5}));
    let triangle = json!({"type": "triangle", "sides": "both", "material": shiny,
                          "points": [a.to_array(), b.to_array(), c.to_array()]});
    let shapes = [
        None,
        Some(triangle),
        Some(scenes::mesh(&[a, b, c], &[[0, 1, 2]], shiny.clone())),
        Some(scenes::sphere(center, 0.7, shiny.clone())),
        Some(scenes::plane([a, b, c, a + c - b], shiny)),
    ];
    let all = shapes.iter().flat_map(|shape| [false, true].map(|is_lit| (shape, is_lit)));
    let picture = |(shape, is_lit): (&Option<Value>, bool)| {
        let lights = if is_lit { std::slice::from_ref(&light) } else { &[] };
        let more = json!({"nbounces": numbers.among([0, 5]),
                          "scene": {"backgroundcolor": background}});
        let scene = scenes::with(scenes::scene(&eye, lights, shape.as_slice()), more);
        let (background, is_there) = (background.map(|c| c as f32), shape.is_some());
        let shows = move |x, y, pixel: [f32; 3]| {
            let is_background = pixel == background;
            let may_be_shape = is_there && !is_background && (is_lit || pixel == [0.0; 3]);
            let is_middle = [x, y] == size.map(|side| side / 2);
            Some(may_be_shape || is_background && !(is_there && is_middle))
        };
        Picture::new(scene, shows).like_itself()
    };
    all.map(picture).collect()
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
    let prepared = scenes::prepare(&numbers.effort, &scene).map(|prepared| {
        let is_warned = prepared.warnings.contains("camera.up");
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
    outcome.add(scenes::refused_at(&scene, "camera.look"));
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
    let axis = numbers.among(["x", "y", "smaller", "larger"]);
    let more = json!({"camera": {"fovaxis": axis, "antialias": numbers.among([1, 2])}});
    let scene = scenes::with(scenes::scene(&eye, &[], &[]), more);
    let context = || scene["camera"].to_string();
    let prepared = scenes::prepare(&numbers.effort, &scene).map(|prepared| {
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
pub(super) fn refused_angles(numbers: &mut Numbers) -> Outcome {
    let fov = [0.0, -1.0, 0.000_999, 179.001, 180.0, 1e9][numbers.index % 6];
    let eye = Eye { look: DVec3::X, ..Eye::at(DVec3::ZERO, fov, [3, 3]) };
    scenes::refused_at(&scenes::scene(&eye, &[], &[]), "camera.fov")
}

/// Case 29: a lens with aperture 0.
pub(super) fn closed_lens(numbers: &mut Numbers) -> Vec<Picture> {
    let eye = Eye::at(numbers.direction() * 5.0, 45.0, [20, 15]);
    let shapes = [
        scenes::sphere(DVec3::ZERO, 1.0, scenes::matte([0.9, 0.5, 0.1])),
        scenes::sphere(DVec3::new(1.5, 0.2, 0.3), 0.7, scenes::matte(scenes::BACKGROUND)),
    ];
    let light = scenes::point_light(50.0, numbers.direction() * 8.0, "linear");
    let antialias = json!({"camera": {"antialias": 1 + numbers.below(3)}});
    let pinhole = scenes::with(scenes::scene(&eye, &[light], &shapes), antialias);
    let lens = json!({"camera": {"type": "thinlens", "aperture": 0,
                                 "focal": numbers.magnitude(1e-6, 1e9)}});
    vec![Picture::same(scenes::with(pinhole.clone(), lens), &pinhole)]
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
    let (focal, sampling) =
        (numbers.magnitude(0.5, 20.0), numbers.among(["random", "jittered", "sobol"]));
    let more = json!({"camera": {"type": "thinlens", "aperture": 2.0 * LENS_RADIUS,
                                 "focal": focal, "sampling": sampling,
                                 "nsamplesx": LENS_POINTS, "nsamplesy": LENS_POINTS},
                      "scene": {"backgroundcolor": [1, 1, 1]}});
    let scene = scenes::with(scenes::scene(&eye, &[], &[shape]), more);
    // Whether a ray passes the shape; `None` near its edge.
    let passes = move |ray: &Ray| -> Option<bool> {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let off = match kind {
            0 => {
                let normal = aside.cross(DVec3::Z);
                let t = -o.dot(normal) / d.dot(normal);
                let place = o + d * t;
                t.min(half - place.z.abs()).min(half - place.dot(aside).abs())
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
    let camera = scenes::prepare(&effort, &scene).map(|p| p.scene.camera);
    let shows = move |x, y, [pixel, ..]: [f32; 3]| {
        let camera = camera.as_ref().ok()?;
        let ray = |sample| {
            let pixel = y * camera.size()[0] + x;
            camera.ray(x, y, &Stream { seed: effort.seed, pixel, sample, bounce: 0 })
        };
        let rays: Vec<Ray> = (0..LENS_POINTS * LENS_POINTS).map(ray).collect();
        // They start all over the lens, whose middle is the origin.
        let is_wide = rays.iter().any(|ray| f64::from(ray.origin.length()) > 0.5 * LENS_RADIUS);
        let passing: Vec<bool> = rays.iter().map(passes).collect::<Option<_>>()?;
        let share = passing.iter().filter(|passes| **passes).count() as f32 / rays.len() as f32;
        Some(is_wide && pixel == share)
    };
    vec![Picture::new(scene, shows)]
}
