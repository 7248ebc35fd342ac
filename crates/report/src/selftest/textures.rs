//! Texture look-ups at the edges of images and far outside.

use glam::{DVec3, Vec2, Vec3};

use super::case::{Effort, Outcome};
use super::ways::{Numbers, in_blocks};
use wavecrest_core::kernels::texture::{Filter, Image, Texels, Wrap, sphere_uv};

/// Neighbouring texels, including the first and the last, differ by at most a step.
const STEP: f32 = 1.0 / 64.0;

/// An image whose values rise and fall along x (red) and along y (green), a step a texel.
fn waves(width: u32, height: u32, is_bytes: bool) -> Image {
    let wave = |i: u32, count: u32| i.min(count - i);
    let each = (0..width * height).map(|i| [wave(i % width, width), wave(i / width, height)]);
    let texels = if is_bytes {
        // A step is one of 255.
        Texels::Bytes(each.map(|[x, y]| [x as u8, y as u8, 0, 0]).collect())
    } else {
        Texels::Floats(each.map(|[x, y]| [x as f32 * STEP, y as f32 * STEP, 0.0]).collect())
    };
    Image::new(width, height, texels)
}

/// A coordinate: an edge, next to one, far outside, or with random bits.
fn coordinate(numbers: &mut Numbers) -> f32 {
    let whole = |numbers: &mut Numbers| numbers.sign() * numbers.magnitude(1.0, 1e6).round();
    match numbers.below(8) {
        0 => [0.0, -0.0, 1.0, 0.5][numbers.below(4)],
        1 => [-f32::EPSILON, -1e-30, f32::from_bits(1), 1.0_f32.next_down()][numbers.below(4)],
        2 => whole(numbers) as f32,
        3 => (whole(numbers) as f32).next_up(),
        4 => (whole(numbers) as f32).next_down(),
        5 => (whole(numbers) + numbers.one()) as f32,
        6 => f32::from_bits((numbers.one() * 4_294_967_296.0) as u32),
        _ => numbers.one() as f32,
    }
}

/// The value along one axis of `count` texels, in double precision, in which a coordinate's
/// fraction is exact: of the nearest texel, or of the two around it.
fn value(coordinate: f32, count: u32, filter: Filter, wrap: Wrap) -> f64 {
    let exact = if coordinate.is_finite() { f64::from(coordinate) } else { 0.0 };
    let fraction = match wrap {
        Wrap::Repeat => exact - exact.floor(),
        Wrap::Clamp => exact.clamp(0.0, 1.0),
        Wrap::Mirror => 1.0 - (exact.rem_euclid(2.0) - 1.0).abs(),
    };
    let at = fraction * f64::from(count);
    let texel = |i: i64| {
        let i = match wrap {
            Wrap::Repeat => i.rem_euclid(i64::from(count)),
            Wrap::Clamp | Wrap::Mirror => i.clamp(0, i64::from(count) - 1),
        };
        i.min(i64::from(count) - i) as f64
    };
    match filter {
        Filter::Nearest => texel(at.floor() as i64),
        Filter::Bilinear | Filter::Trilinear => {
            let first = (at - 0.5).floor();
            let between = at - 0.5 - first;
            let first = first as i64;
            texel(first) * (1.0 - between) + texel(first + 1) * between
        }
    }
}

/// Case 30.
pub(super) fn look_ups(effort: &Effort) -> Outcome {
    let images: Vec<Image> = [[1, 1], [2, 2], [3, 5], [7, 1], [64, 48], [1, 100]]
        .into_iter()
        .flat_map(|[w, h]| [waves(w, h, false), waves(w, h, true)])
        .collect();
    in_blocks(effort.of(10_000_000), |n| {
        let mut numbers = Numbers::new(effort, 30, n);
        let image = &images[numbers.below(images.len())];
        let filter = [Filter::Nearest, Filter::Bilinear][numbers.below(2)];
        let wrap = [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror][numbers.below(3)];
        Outcome::one(if numbers.below(4) == 0 {
            across_a_seam(&mut numbers, image, filter)
        } else {
            look_up(&mut numbers, image, filter, wrap)
        })
    })
}

fn step(image: &Image) -> f32 {
    match image.texels {
        Texels::Bytes(_) | Texels::Levels(..) => 1.0 / 255.0,
        Texels::Floats(_) => STEP,
    }
}

/// The error of a look-up, which must be within a texel of the exact one.
fn look_up(numbers: &mut Numbers, image: &Image, filter: Filter, wrap: Wrap) -> Option<String> {
    let uv = Vec2::new(coordinate(numbers), coordinate(numbers));
    let found = image.look_up(uv, filter, wrap) / step(image);
    // Rows start at the top, where v is 1.
    let down = 1.0 - uv.y;
    let right = [value(uv.x, image.width, filter, wrap), value(down, image.height, filter, wrap)];
    let is_right = right.iter().zip(found.to_array()).all(|(right, found)| {
        // At 1 the image ends and restarts: the texel on either side is right.
        (right - f64::from(found)).abs() <= 1.001
    });
    (!is_right).then(|| {
        let (width, height) = (image.width, image.height);
        format!(
            "{uv} of {width} x {height}, {filter:?}, {wrap:?}: {found} and not {right:?} texels"
        )
    })
}

/// The error of two neighbouring look-ups on both sides of the seam of an image, or of a sphere's
/// map.
fn across_a_seam(numbers: &mut Numbers, image: &Image, filter: Filter) -> Option<String> {
    let [p, q] = match numbers.below(3) {
        // Where the image repeats, a number and the adjacent one.
        0 => {
            let u = numbers.magnitude(1.0, 1e3).round() as f32;
            let v = numbers.one() as f32;
            [Vec2::new(u.next_down(), v), Vec2::new(u, v)]
        }
        // Behind the sphere, on both sides of the seam.
        1 => {
            let (height, aside) = (numbers.one() * 1.8 - 0.9, numbers.magnitude(1e-30, 1e-7));
            let back = -(1.0 - height * height).sqrt();
            [-aside, aside].map(|x| sphere_uv(DVec3::new(x, height, back).as_vec3()))
        }
        // At the poles every u is the same place: only v counts.
        _ => {
            let pole = [1.0, -1.0][numbers.below(2)];
            let mut near = || {
                let x = numbers.magnitude(1e-40, 1e-9) as f32;
                let v = sphere_uv(Vec3::new(x, pole, -x)).y;
                Vec2::new(0.25, v)
            };
            [near(), near()]
        }
    };
    let [a, b] = [p, q].map(|uv| image.look_up(uv, filter, Wrap::Repeat) / step(image));
    // A thousandth of a texel for the rounding of the coordinates.
    let is_right = (a - b).abs().max_element() <= 1.001;
    (!is_right).then(|| format!("{p} and {q}, {filter:?}: {a} and {b} texels"))
}
