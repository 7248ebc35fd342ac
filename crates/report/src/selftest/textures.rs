//! Look-ups at the edges of images and far outside, at grazing angles, and of texels that are no
//! numbers; normal maps, and vertex colours.

use tempfile::TempPath;

use super::prelude::*;
use wavecrest_core::film::Film;
use wavecrest_core::kernels::texture::{Filter, Image, Texels, Wrap, sphere_uv};
use wavecrest_image::write::{Transfer, write};

/// Neighbouring texels, including the first and the last, differ by at most a step.
const STEP: f32 = 1.0 / 64.0;

/// An image whose values rise and fall along x (red) and along y (green), a step a texel, and the
/// step.
fn some_waves(numbers: &mut Numbers) -> (Image, f32) {
    let [width, height] = numbers.among([[1, 1], [2, 2], [3, 5], [7, 1], [64, 48], [1, 100]]);
    let wave = |i: u32, count: u32| i.min(count - i);
    let each = (0..width * height).map(|i| [wave(i % width, width), wave(i / width, height)]);
    let (texels, step) = if numbers.once_in(2) {
        (Texels::Bytes(each.map(|[x, y]| [x as u8, y as u8, 0, 0]).collect()), 1.0 / 255.0)
    } else {
        let texel = |[x, y]: [u32; 2]| [x as f32 * STEP, y as f32 * STEP, 0.0];
        (Texels::Floats(each.map(texel).collect()), STEP)
    };
    (Image::new(width, height, texels), step)
}

/// A coordinate: an edge, next to one, far outside, or with random bits.
fn coordinate(numbers: &mut Numbers) -> f32 {
    let whole = numbers.sign() * numbers.magnitude(1.0, 1e6).round();
    match numbers.below(8) {
        0 => numbers.among([0.0, -0.0, 1.0, 0.5]),
        1 => numbers.among([-f32::EPSILON, -1e-30, f32::from_bits(1), 1.0_f32.next_down()]),
        2 => whole as f32,
        3 => (whole as f32).next_up(),
        4 => (whole as f32).next_down(),
        5 => (whole + numbers.one()) as f32,
        6 => f32::from_bits(numbers.bits()),
        _ => numbers.one() as f32,
    }
}

/// The texels of `count` along one axis around a place, which is 0 at the start of the image and 1 at
/// its end, with their weights.
fn around(place: f64, count: u32, filter: Filter, wrap: Wrap) -> [(usize, f64); 2] {
    let (at, count) = (place * f64::from(count), i64::from(count));
    let texel = |i: f64| match wrap {
        Wrap::Repeat => (i as i64).rem_euclid(count) as usize,
        Wrap::Clamp | Wrap::Mirror => (i as i64).clamp(0, count - 1) as usize,
    };
    if filter == Filter::Nearest {
        return [(texel(at.floor()), 1.0), (0, 0.0)];
    }
    let first = (at - 0.5).floor();
    let between = at - 0.5 - first;
    [(texel(first), 1.0 - between), (texel(first + 1.0), between)]
}

/// The value of a wave along one axis of `count` texels, in double precision, in which a
/// coordinate's fraction is exact.
fn value(coordinate: f32, count: u32, filter: Filter, wrap: Wrap) -> f64 {
    let exact = if coordinate.is_finite() { f64::from(coordinate) } else { 0.0 };
    let place = match wrap {
        Wrap::Repeat => exact - exact.floor(),
        Wrap::Clamp => exact.clamp(0.0, 1.0),
        Wrap::Mirror => 1.0 - (exact.rem_euclid(2.0) - 1.0).abs(),
    };
    let texels = around(place, count, filter, wrap);
    texels.map(|(i, weight)| weight * i.min(count as usize - i) as f64).iter().sum()
}

/// Case 30: a look-up is within a texel of the exact one.
pub(super) fn look_ups(numbers: &mut Numbers) -> Outcome {
    let (image, step) = some_waves(numbers);
    let filter = numbers.among([Filter::Nearest, Filter::Bilinear]);
    let wrap = numbers.among([Wrap::Repeat, Wrap::Clamp, Wrap::Mirror]);
    let uv = Vec2::new(coordinate(numbers), coordinate(numbers));
    let found = image.look_up(uv, filter, wrap) / step;
    // Rows start at the top, where v is 1.
    let (right, down) = (value(uv.x, image.width, filter, wrap), 1.0 - uv.y);
    let right = [right, value(down, image.height, filter, wrap)];
    let is_right = right.iter().zip(found.to_array()).all(|(right, found)| {
        // At 1 the image ends and restarts: the texel on either side is right.
        (right - f64::from(found)).abs() <= 1.001
    });
    Outcome::of(is_right, || {
        let (width, height) = (image.width, image.height);
        format!(
            "{uv} of {width} x {height}, {filter:?}, {wrap:?}: {found} and not {right:?} texels"
        )
    })
}

/// Case 30: two neighbouring look-ups on both sides of the seam of an image, or of a sphere's map.
pub(super) fn across_seams(numbers: &mut Numbers) -> Outcome {
    let (image, step) = some_waves(numbers);
    let filter = numbers.among([Filter::Nearest, Filter::Bilinear]);
    let [p, q] = match numbers.below(3) {
        // Where the image repeats, a number and the adjacent one.
        0 => {
            let (u, v) = (numbers.magnitude(1.0, 1e3).round() as f32, numbers.one() as f32);
            [u.next_down(), u].map(|u| Vec2::new(u, v))
        }
        // Behind the sphere, on both sides of the seam.
        1 => {
            let (height, aside) = (numbers.about(0.9), numbers.magnitude(1e-30, 1e-7));
            let back = -(1.0 - height * height).sqrt();
            [-aside, aside].map(|x| sphere_uv(DVec3::new(x, height, back).as_vec3()))
        }
        // At the poles every u is the same place: only v counts.
        _ => {
            let pole = numbers.among([1.0, -1.0]);
            [(); 2].map(|()| {
                let x = numbers.magnitude(1e-40, 1e-9) as f32;
                Vec2::new(0.25, sphere_uv(Vec3::new(x, pole, -x)).y)
            })
        }
    };
    let [a, b] = [p, q].map(|uv| image.look_up(uv, filter, Wrap::Repeat) / step);
    // A thousandth of a texel for the rounding of the coordinates.
    let is_right = (a - b).abs().max_element() <= 1.001;
    Outcome::of(is_right, || format!("{p} and {q}, {filter:?}: {a} and {b} texels"))
}

/// The path of an image file with these texels, in linear floats, and the file, which is removed when
/// it is dropped.
fn file(side: u32, texels: Vec<[f32; 3]>) -> (String, Option<TempPath>) {
    let written = || {
        let file = tempfile::Builder::new().suffix(".exr").tempfile().ok()?.into_temp_path();
        let film = Film::from_pixels(side, side, texels).ok()?;
        write(&film, &file, Transfer::Linear).ok().map(|_| file)
    };
    let file = written();
    // Without a file the scene is refused, which is a failure.
    (file.as_ref().map_or("none.exr".to_owned(), |file| file.display().to_string()), file)
}

/// A shape that shows only its colour, without shading.
fn shown(eye: &Eye, shape: Value) -> Value {
    // No power, but an ambient part.
    let light = scenes::point_light(0.0, DVec3::Y, "none");
    scenes::with(scenes::scene(eye, &[light], &[shape]), json!({"scene": {"ambient": 1}}))
}

/// Case 50: a normal map that turns normals anywhere, also below the surface. Light from above is
/// reflected as by a surface with that normal, light from below not at all, and a mirror shows what
/// is above it.
pub(super) fn turned_normals(numbers: &mut Numbers) -> Vec<Picture> {
    const KR: f64 = 0.5;
    let (normal, to_light) = (numbers.direction(), numbers.direction());
    let eye = Eye { look: numbers.ball(2.0).with_y(0.0), ..Eye::above(30.0, 9) };
    // Along z, along x, and up.
    let texel = [normal.z, normal.x, normal.y].map(|x| (0.5 * x + 0.5) as f32);
    let mirror = scenes::with(scenes::white(), json!({"kd": 0, "kr": KR}));
    let mapped = |material| {
        let (path, file) = file(1, vec![texel]);
        let map = json!({"normalmap": {"file": path}});
        (scenes::with(scenes::floor(100.0, material), map), file)
    };
    let (shape, file) = mapped(scenes::white());
    let light = json!({"type": "directionallight", "intensity": 1, "color": [1, 1, 1],
                       "direction": (-to_light).to_array()});
    let reflected = 0.8 * normal.dot(to_light).max(0.0);
    let right = if to_light.y > 0.0 { reflected } else { 0.0 };
    let lit = Picture::new(scenes::scene(&eye, &[light], &[shape]), move |_, _, [pixel, ..]| {
        let _kept = &file;
        Some((f64::from(pixel) - right).abs() < 1e-5)
    });
    let (shape, file) = mapped(mirror);
    // Red below, green all around.
    let glowing = |color| scenes::with(scenes::white(), json!({"emission": color}));
    let below = [-DVec3::Y, DVec3::X * 1e4, DVec3::Z * 1e4];
    let below = scenes::square(below, glowing([1.0, 0.0, 0.0]));
    let around = scenes::sphere(DVec3::ZERO, 1e3, glowing([0.0, 1.0, 0.0]));
    let scene = scenes::scene(&eye, &[], &[shape, below, around]);
    let scene = scenes::with(scene, json!({"nbounces": 1}));
    let mirrored = Picture::new(scene, move |_, _, pixel| {
        let _kept = &file;
        Some(pixel == [0.0, KR as f32, 0.0])
    });
    vec![lit, mirrored]
}

/// Case 52: the level of detail of a footprint of any size, and the colour there.
pub(super) fn footprints(numbers: &mut Numbers) -> Outcome {
    let (mut image, step) = some_waves(numbers);
    image.build_pyramid();
    let extreme = [0.0, f32::INFINITY, f32::NAN, f32::MAX, f32::MIN_POSITIVE];
    let mut part = || {
        let any = (numbers.sign() * numbers.magnitude(1e-38, 1e38)) as f32;
        if numbers.once_in(8) { numbers.among(extreme) } else { any }
    };
    let sides = [(); 2].map(|()| Vec2::new(part(), part()));
    let size = [image.width, image.height].map(f64::from);
    let length = |side: Vec2| (f64::from(side.x) * size[0]).hypot(f64::from(side.y) * size[1]);
    let [a, b] = sides.map(length);
    let coarsest = f64::from(image.coarsest());
    let is_finite = sides.iter().all(|side| side.is_finite());
    let right = if is_finite { libm::log2(a.max(b)).clamp(0.0, coarsest) } else { coarsest };
    let level = image.level(&sides);
    let uv = Vec2::new(coordinate(numbers), coordinate(numbers));
    let (color, _) = image.look_up_at(uv, level, Wrap::Repeat);
    let most = step * image.width.max(image.height) as f32;
    let is_right = (f64::from(level) - right).abs() <= 1e-5
        && color.min_element() >= 0.0
        && color.max_element() <= most;
    Outcome::of(is_right, || format!("level {level} and not {right} of {sides:?}: {color}"))
}

/// Case 52: a floor seen at grazing angles, on which an image is repeated so often that the footprint
/// of every pixel is larger than the image: it shows the mean of all texels.
pub(super) fn grazing(numbers: &mut Numbers) -> Vec<Picture> {
    const TEXELS: u32 = 16;
    const HALF: f64 = 1000.0;
    /// The largest error of a mean: texels of coarse levels share an exponent.
    const OFF: f32 = 0.01;
    let count = TEXELS * TEXELS;
    let texels: Vec<[f32; 3]> = (0..count).map(|_| [numbers.below(2) as f32; 3]).collect();
    let mean = texels.iter().map(|texel| texel[0]).sum::<f32>() / count as f32;
    let height = numbers.magnitude(1e-2, 10.0);
    let location = DVec3::Y * height;
    let turn = numbers.direction().with_y(0.0).normalize();
    let look = location + turn - DVec3::Y * numbers.magnitude(1e-3, 0.1);
    let eye = Eye { location, look, up: DVec3::Y, fov: 5.0, size: [16, 48] };
    let (path, file) = file(TEXELS, texels);
    // No ray is steeper than 14 degrees, so a pixel sees at least 0.02 heights across.
    let repeats = 2.0 * HALF / (0.02 * height) * numbers.magnitude(1.0, 100.0);
    let texture = json!({"texture": path, "filter": "trilinear",
                         "uvtransform": [[repeats, 0, 0], [0, repeats, 0]]});
    let shape = scenes::with(scenes::floor(HALF, scenes::white()), texture);
    let shows = move |x, y, [pixel, ..]: [f32; 3]| {
        let _kept = &file;
        let direction = eye.direction(x, y);
        let is_seen =
            direction.y < 0.0 && eye.on_floor(direction).abs().max_element() < 0.99 * HALF;
        is_seen.then_some((pixel - mean).abs() <= OFF)
    };
    vec![Picture::new(shown(&eye, shape), shows)]
}

/// Case 53: channels that are NaN or infinite count as 0, and nothing else changes.
pub(super) fn no_numbers(numbers: &mut Numbers) -> Vec<Picture> {
    const SIDE: u32 = 8;
    const HALF: f64 = 2.0;
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let mut channel = || {
        let any = numbers.one() as f32;
        if numbers.once_in(8) { numbers.among(bad) } else { any }
    };
    let texels: Vec<[f32; 3]> = (0..SIDE * SIDE).map(|_| [(); 3].map(|()| channel())).collect();
    // The centre of no pixel is near the edge of a texel, or of the floor.
    let eye = Eye::above(50.0, 24);
    let picture = |(name, filter): (&str, Filter)| {
        let (path, file) = file(SIDE, texels.clone());
        let texture = json!({"texture": path, "filter": name, "wrap": "clamp"});
        let shape = scenes::with(scenes::floor(HALF, scenes::white()), texture);
        let texels = texels.clone();
        let shows = move |x: u32, y: u32, pixel: [f32; 3]| {
            let _kept = &file;
            let place = eye.on_floor(eye.direction(x, y)) / HALF;
            let [columns, rows] =
                [place.z, -place.x].map(|x| around(0.5 * x + 0.5, SIDE, filter, Wrap::Clamp));
            let mut right = DVec3::ZERO;
            for (row, p) in rows {
                for (column, q) in columns {
                    let texel = texels[row * SIDE as usize + column];
                    let texel = texel.map(|x| if x.is_finite() { x } else { 0.0 });
                    right += Vec3::from(texel).as_dvec3() * (p * q);
                }
            }
            let off = (Vec3::from(pixel).as_dvec3() - right).abs().max_element();
            (place.abs().max_element() < 1.0).then_some(off < 1e-5)
        };
        Picture::new(shown(&eye, shape), shows)
    };
    [("nearest", Filter::Nearest), ("bilinear", Filter::Bilinear)].map(picture).into()
}

/// Triangles of the fan of case 46.
const TRIANGLES: usize = 12;

/// Case 46: a fan in the plane y = 0 around the origin, seen by the centre pixel.
pub(super) fn vertex_colors(numbers: &mut Numbers) -> Vec<Picture> {
    /// Largest error of interpolation, relative to the largest colour of the triangle: the point
    /// and the weights have single precision.
    const LARGEST_ERROR: f64 = 1e-5;
    let eye = Eye::above(60.0, numbers.effort.either(25, 65));
    let around = |i: usize| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * i as f64 / TRIANGLES as f64);
        // Exact in the file and in single precision.
        DVec3::new(2.0 * sin, 0.0, 2.0 * cos).as_vec3().as_dvec3()
    };
    let points: Vec<DVec3> =
        std::iter::once(DVec3::ZERO).chain((0..TRIANGLES).map(around)).collect();
    let colors: Vec<f32> = points
        .iter()
        .map(|_| {
            let most = numbers.among([1.0, 1e12]);
            numbers.magnitude(1e-3, most) as f32
        })
        .collect();
    let corners = |i: usize| [0, 1 + i, 1 + (i + 1) % TRIANGLES];
    let fan: Vec<[u32; 3]> = (0..TRIANGLES).map(|i| corners(i).map(|v| v as u32)).collect();
    let mut mesh = scenes::mesh(&points, &fan, scenes::white());
    mesh["colors"] = json!(colors.iter().map(|&c| [c; 3]).collect::<Vec<_>>());
    let shows = move |x, y, [pixel, ..]: [f32; 3]| {
        let hit = eye.on_floor(eye.direction(x, y));
        // On an edge any of its triangles is right.
        let known = (0..TRIANGLES).filter_map(|i| {
            let [a, b, c] = corners(i).map(|corner| points[corner]);
            let area = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).y;
            let weights = [area(hit, b, c), area(a, hit, c), area(a, b, hit)];
            let weights = weights.map(|weight| weight / area(a, b, c));
            let of_corners = corners(i).map(|corner| f64::from(colors[corner]));
            let mixed = weights.iter().zip(of_corners).map(|(w, c)| w * c).sum::<f64>();
            let off = LARGEST_ERROR * of_corners.into_iter().fold(0.0, f64::max);
            let is_right = (f64::from(pixel) - mixed).abs() <= off;
            weights.iter().all(|weight| *weight > -1e-6).then_some(is_right)
        });
        known.reduce(|a, b| a || b)
    };
    vec![Picture::new(shown(&eye, mesh), shows)]
}
