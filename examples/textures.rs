//! Paints the textures of the scenes in `textures/`.
//!
//! `cargo run -p wavecrest-scene --example textures [FOLDER]` writes them again with the same
//! bytes: every colour is a formula of the position in the image. Edges are antialiased by the
//! signed distance to them, in pixels. Positions are in pixels from the top left; textures are
//! stored without a transfer curve.

use std::path::{Path, PathBuf};

use glam::{Vec2, Vec3, vec2, vec3};
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_image::write::{Transfer, write};

fn main() -> Result<()> {
    let folder =
        std::env::args_os().nth(1).map_or_else(|| PathBuf::from("textures"), PathBuf::from);
    paint(&folder, "checker", 256, 256, checker)?;
    paint(&folder, "bricks", 256, 256, bricks)?;
    paint(&folder, "picture", 512, 384, picture)?;
    paint(&folder, "uvgrid", 256, 256, uvgrid)?;
    paint(&folder, "globe", 512, 256, globe)
}

fn paint(
    folder: &Path,
    name: &str,
    width: u32,
    height: u32,
    color: fn(Vec2) -> Vec3,
) -> Result<()> {
    let mut film = Film::new(width, height)?;
    for (y, row) in film.rows_mut().enumerate() {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = color(vec2(x as f32 + 0.5, y as f32 + 0.5)).to_array();
        }
    }
    write(&film, &folder.join(name).with_extension("png"), Transfer::Linear)
}

// Tools: coverage, shapes as signed distances (negative inside), noise, letters.

/// The coverage of a pixel by a shape whose edge is `distance` pixels from its centre.
fn cover(distance: f32) -> f32 {
    (0.5 - distance).clamp(0.0, 1.0)
}

/// Blends `over` onto `under` by `amount`.
fn lay(under: &mut Vec3, over: Vec3, amount: f32) {
    *under = under.lerp(over, amount);
}

fn smooth(from: f32, to: f32, value: f32) -> f32 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn disk(p: Vec2, center: Vec2, radius: f32) -> f32 {
    p.distance(center) - radius
}

/// A line from `a` to `b` with round ends.
fn stroke(p: Vec2, a: Vec2, b: Vec2, half_width: f32) -> f32 {
    let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a.lerp(b, along)) - half_width
}

/// A rectangle with round corners.
fn slab(p: Vec2, center: Vec2, half: Vec2, round: f32) -> f32 {
    let q = (p - center).abs() - half + round;
    q.max(Vec2::ZERO).length() + q.max_element().min(0.0) - round
}

/// A convex polygon, its corners clockwise as seen in the image.
fn polygon(p: Vec2, corners: &[Vec2]) -> f32 {
    let next = corners.iter().cycle().skip(1);
    let sides = corners.iter().zip(next).map(|(&a, &b)| (p - a).dot((a - b).perp().normalize()));
    sides.fold(f32::NEG_INFINITY, f32::max)
}

/// The ground below the curve `height`; the distance uses its slope from half a pixel to each side.
fn ground(p: Vec2, height: impl Fn(f32) -> f32) -> f32 {
    let slope = height(p.x + 0.5) - height(p.x - 0.5);
    (height(p.x) - p.y) / (1.0 + slope * slope).sqrt()
}

/// A hash of three integers as a number from 0 to 1.
fn scatter(x: i32, y: i32, z: i32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x9e37_79b1)
        ^ (y as u32).wrapping_mul(0x85eb_ca77)
        ^ (z as u32).wrapping_mul(0xc2b2_ae3d);
    for _ in 0..2 {
        h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    }
    ((h ^ (h >> 16)) >> 8) as f32 / 16_777_216.0
}

/// Smooth noise from 0 to 1 with a grain of one unit. It repeats if `period` is above 0.
fn noise(p: Vec3, period: i32) -> f32 {
    let base = p.floor();
    let t = p - base;
    let t = t * t * (3.0 - 2.0 * t);
    let wrap = |c: i32| if period > 0 { c.rem_euclid(period) } else { c };
    let mut sum = 0.0;
    for corner in 0..8 {
        let step = vec3((corner & 1) as f32, (corner >> 1 & 1) as f32, (corner >> 2) as f32);
        let weight = (step * t + (1.0 - step) * (1.0 - t)).element_product();
        let cell = (base + step).as_ivec3();
        sum += weight * scatter(wrap(cell.x), wrap(cell.y), wrap(cell.z));
    }
    sum
}

/// Noise of several grains, each half the last.
fn clouds(p: Vec3, octaves: i32) -> f32 {
    let octave =
        |i: i32| noise(p * libm::exp2f(i as f32) + 17.0 * i as f32, 0) * libm::exp2f(-i as f32);
    (0..octaves).map(octave).sum::<f32>() / (2.0 - libm::exp2f(1.0 - octaves as f32))
}

/// The strokes of a letter: lines through points of a grid of 3 columns and 5 rows, each point
/// written as its column and row from the top left.
fn strokes(letter: char) -> &'static [&'static str] {
    match letter {
        'A' => &["04 01 10 21 24", "02 22"],
        'B' => &["12 02 04 14 23 12 21 10 00 02"],
        'C' => &["20 10 01 03 14 24"],
        'D' => &["00 04 14 23 21 10 00"],
        'E' => &["20 00 04 24", "02 12"],
        'F' => &["20 00 04", "02 12"],
        'G' => &["20 10 01 03 14 24 22 12"],
        'H' => &["00 04", "20 24", "02 22"],
        '1' => &["01 10 14", "04 24"],
        '2' => &["00 20 22 02 04 24"],
        '3' => &["00 20 24 04", "02 22"],
        '4' => &["00 02 22", "20 24"],
        '5' => &["20 00 02 22 24 04"],
        '6' => &["20 00 04 24 22 02"],
        '7' => &["00 20 14"],
        '8' => &["00 20 24 04 00", "02 22"],
        _ => &[],
    }
}

/// The distance to a letter whose grid has its top left at `corner` and steps of `step` pixels.
fn letter(p: Vec2, letter: char, corner: Vec2, step: f32, half_width: f32) -> f32 {
    let point = |word: &str| match word.as_bytes() {
        &[x, y] => corner + step * vec2(f32::from(x - b'0'), f32::from(y - b'0')),
        _ => corner,
    };
    let mut nearest = f32::INFINITY;
    for line in strokes(letter) {
        let points: Vec<Vec2> = line.split(' ').map(point).collect();
        for ends in points.windows(2) {
            nearest = nearest.min(stroke(p, ends[0], ends[1], half_width));
        }
    }
    nearest
}

// The images.

/// Eight by eight cells in two warm colours, the top left one light.
fn checker(p: Vec2) -> Vec3 {
    let cell = (p / 32.0).floor();
    if (cell.x + cell.y) % 2.0 == 0.0 { vec3(0.93, 0.88, 0.79) } else { vec3(0.47, 0.33, 0.26) }
}

/// Eight courses of four bricks, every other course shifted by half a brick. The edges match.
fn bricks(p: Vec2) -> Vec3 {
    let (half, course) = (vec2(32.0, 16.0), (p.y / 32.0).floor());
    let along = p.x + 32.0 * (course % 2.0);
    let column = (along / 64.0).floor();
    let center = vec2(64.0 * column + 32.0, 32.0 * course + 16.0);
    let local = vec2(along, p.y);
    let number = (column as i32).rem_euclid(4);
    let grain = noise(vec3(p.x, p.y, 0.0) / 2.0, 128);
    let stain = noise(vec3(p.x, p.y, 9.0) / 16.0, 16);

    let mut color = vec3(0.70, 0.66, 0.60) * (0.86 + 0.16 * grain);
    let wobble = 1.6 * (noise(vec3(p.x, p.y, 5.0) / 8.0, 32) - 0.5);
    let edge = slab(local, center, half - 2.6, 3.5) + wobble;
    // The mortar lies deeper: shade falls on it from the brick above and to the left.
    let shade = slab(local - vec2(1.5, 2.0), center, half - 2.6, 3.5) + wobble;
    color *= 1.0 - 0.45 * cover(shade);
    lay(
        &mut color,
        brick(number, course as i32) * (0.80 + 0.2 * grain + 0.24 * stain),
        cover(edge),
    );
    // Light catches the upper edge of a brick and leaves the lower one.
    let rim = cover(edge) * (1.0 - smooth(0.0, 3.5, -edge));
    color * (1.0 + 0.16 * rim * (center.y - p.y).signum())
}

fn brick(column: i32, course: i32) -> Vec3 {
    let dark = scatter(column, course, 1);
    let burnt = if scatter(column, course, 2) > 0.86 { 0.62 } else { 1.0 };
    vec3(0.50, 0.19, 0.13).lerp(vec3(0.74, 0.35, 0.23), dark) * burnt
}

/// u as red from left to right, v as green from the bottom up, in eight by eight cells named as on
/// a chessboard: A1 at the bottom left.
fn uvgrid(p: Vec2) -> Vec3 {
    let (u, v) = (p.x / 256.0, 1.0 - p.y / 256.0);
    let cell = (p / 32.0).floor();
    let mut color = vec3(u, v, 0.25);
    if (cell.x + cell.y) % 2.0 == 0.0 {
        color = color * 0.86 + 0.07;
    }
    // One ink for a cell, chosen at its centre.
    let middle = (cell + 0.5) / 8.0;
    let dark = 0.30 * middle.x + 0.59 * (1.0 - middle.y) < 0.42;
    let ink = if dark { vec3(1.0, 1.0, 0.95) } else { vec3(0.06, 0.06, 0.12) };

    let from_line = |step: f32| (p - (p / step).round() * step).abs().min_element();
    lay(&mut color, ink, 0.20 * cover(from_line(8.0) - 0.2));
    lay(&mut color, ink, 0.55 * cover(from_line(32.0) - 0.5));
    lay(&mut color, ink, 0.80 * cover(from_line(128.0) - 1.0));

    let corner = cell * 32.0;
    let column = char::from(b'A' + cell.x as u8);
    let row = char::from(b'8' - cell.y as u8);
    let names = letter(p, column, corner + vec2(7.5, 9.0), 3.5, 0.9).min(letter(
        p,
        row,
        corner + vec2(17.5, 9.0),
        3.5,
        0.9,
    ));
    lay(&mut color, ink, cover(names));
    color
}

/// A framed landscape: mountains and a sun over a lake, a tree at the left, and a boat whose sail
/// has an F, so that a rotated or mirrored image is recognisable.
fn picture(p: Vec2) -> Vec3 {
    const SHORE: f32 = 222.0;
    let mut color = above_water(p);
    if p.y > SHORE - 0.5 {
        lay(&mut color, water(p, SHORE), cover(SHORE - p.y));
    }
    bank(&mut color, p);
    boat(&mut color, p, vec2(318.0, 284.0));
    tree(&mut color, p, vec2(86.0, 322.0));
    frame(&mut color, p);
    color
}

fn above_water(p: Vec2) -> Vec3 {
    let sun = vec2(372.0, 122.0);
    let high = smooth(235.0, 20.0, p.y);
    let mut color = vec3(1.0, 0.80, 0.58).lerp(vec3(0.22, 0.47, 0.80), high);
    let glow = libm::expf(-disk(p, sun, 30.0).max(0.0) / 42.0);
    lay(&mut color, vec3(1.0, 0.88, 0.60), 0.75 * glow);
    lay(&mut color, vec3(1.0, 0.97, 0.80), cover(disk(p, sun, 30.0)));
    let puff = clouds(vec3(p.x / 90.0, p.y / 26.0, 3.0), 5) - 0.08 * high;
    lay(&mut color, vec3(1.0, 0.96, 0.92), 0.85 * smooth(0.50, 0.72, puff));

    let jag = |x: f32, grain: f32| clouds(vec3(x / grain, 0.5, 8.0), 5) - 0.5;
    let peaks = |x: f32| {
        let tents = (84.0 + 0.78 * (x - 168.0).abs()).min(122.0 + 0.66 * (x - 262.0).abs());
        tents.min(212.0) + 26.0 * jag(x, 34.0)
    };
    let rock = vec3(0.45, 0.47, 0.60) + 0.20 * (clouds(p.extend(0.0) / 14.0, 3) - 0.5);
    let snow_line = 138.0 + 44.0 * jag(p.x + 0.4 * p.y, 15.0);
    let peak = rock.lerp(vec3(0.97, 0.96, 0.99), cover(p.y - snow_line));
    lay(&mut color, peak, cover(ground(p, peaks)));
    let hills = |x: f32| 190.0 - 17.0 * libm::sinf(x / 52.0 + 2.4) + 7.0 * libm::sinf(x / 21.0);
    lay(&mut color, vec3(0.35, 0.53, 0.44), cover(ground(p, hills)));
    let woods = |x: f32| 203.0 + 11.0 * libm::sinf(x / 70.0 - 0.7) + 16.0 * jag(x, 7.0);
    let leaves = vec3(0.16, 0.36, 0.24) + 0.10 * (clouds(p.extend(4.0) / 6.0, 2) - 0.5);
    lay(&mut color, leaves, cover(ground(p, woods)));
    color
}

/// The reflection of everything above the shore, drawn out by ripples that grow towards the viewer.
fn water(p: Vec2, shore: f32) -> Vec3 {
    let depth = p.y - shore;
    let wave = clouds(vec3(p.x / 60.0, depth / (2.0 + depth / 16.0), 6.0), 3) - 0.5;
    let mirrored = vec2(p.x + wave * (4.0 + 0.22 * depth), shore - 1.2 * depth + 9.0 * wave);
    let mut color = above_water(mirrored) * vec3(0.72, 0.80, 0.88);
    lay(&mut color, vec3(0.06, 0.27, 0.42), 0.18 + 0.40 * smooth(0.0, 140.0, depth));
    // The sun's path: glints that spread as they come nearer.
    let off = (p.x - 372.0).abs() / (16.0 + 0.30 * depth);
    let glint = smooth(0.02, 0.10, wave - 0.10 * off) * libm::expf(-off * off);
    color.lerp(vec3(1.0, 0.91, 0.66), 0.85 * glint)
}

fn bank(color: &mut Vec3, p: Vec2) {
    let edge = |x: f32| 310.0 + 0.00085 * x * x + 3.0 * libm::sinf(x / 17.0);
    let grass = clouds(vec3(p.x / 3.0, p.y / 9.0, 2.0), 3);
    let lit = vec3(0.36, 0.56, 0.20).lerp(vec3(0.20, 0.38, 0.15), smooth(320.0, 372.0, p.y));
    lay(color, vec3(0.72, 0.62, 0.44), cover(ground(p, |x| edge(x) - 5.0)));
    lay(color, lit * (0.78 + 0.44 * grass), cover(ground(p, edge)));
}

fn boat(color: &mut Vec3, p: Vec2, at: Vec2) {
    let q = p - at;
    let shadow = (q - vec2(2.0, 13.0)) * vec2(0.16, 1.0);
    lay(color, vec3(0.04, 0.16, 0.26), 0.5 * smooth(11.0, 4.0, shadow.length()));
    lay(color, vec3(0.30, 0.20, 0.14), cover(stroke(q, vec2(0.0, 4.0), vec2(0.0, -98.0), 1.4)));
    let main = polygon(q, &[vec2(4.0, -92.0), vec2(62.0, -8.0), vec2(4.0, -8.0)]);
    lay(color, vec3(0.98, 0.96, 0.90) - 0.0016 * (q.y + 92.0), cover(main));
    let jib = polygon(q, &[vec2(-4.0, -84.0), vec2(-4.0, -8.0), vec2(-40.0, -8.0)]);
    lay(color, vec3(0.93, 0.52, 0.20), cover(jib));
    let name = letter(q, 'F', vec2(11.0, -45.0), 7.5, 2.4);
    lay(color, vec3(0.13, 0.22, 0.50), cover(name));
    let pennant = polygon(q, &[vec2(1.0, -99.0), vec2(27.0, -94.0), vec2(1.0, -88.0)]);
    lay(color, vec3(0.86, 0.14, 0.16), cover(pennant));
    let hull = [vec2(-50.0, -3.0), vec2(66.0, -3.0), vec2(50.0, 13.0), vec2(-36.0, 13.0)];
    lay(color, vec3(0.66, 0.15, 0.14), cover(polygon(q, &hull)));
    let stripe = polygon(q, &hull).max((q.y - 1.0).abs() - 1.5);
    lay(color, vec3(0.98, 0.94, 0.86), cover(stripe));
}

fn tree(color: &mut Vec3, p: Vec2, at: Vec2) {
    let q = p - at;
    let trunk = stroke(q, vec2(0.0, 6.0), vec2(3.0, -62.0), 5.0 + 0.05 * q.y);
    lay(color, vec3(0.32, 0.22, 0.15), cover(trunk));
    let rough = 7.0 * (clouds(p.extend(1.0) / 7.0, 3) - 0.5);
    for (x, y, radius) in
        [(-22.0, -74.0, 24.0), (26.0, -78.0, 22.0), (2.0, -102.0, 29.0), (4.0, -70.0, 21.0)]
    {
        let center = vec2(x, y);
        // Light comes from the sun, at the right.
        let toward = (q - center).dot(vec2(0.8, -0.6)) / radius;
        let green = vec3(0.15, 0.34, 0.13).lerp(vec3(0.46, 0.62, 0.20), smooth(-0.9, 1.1, toward));
        lay(color, green * (1.0 + 0.05 * rough), cover(disk(q, center, radius) + rough));
    }
}

/// A wooden frame lit from the top left, with a gilt edge and a red stud at the top left.
fn frame(color: &mut Vec3, p: Vec2) {
    const WIDTH: f32 = 24.0;
    let size = vec2(512.0, 384.0);
    let to_edge = [p.y, p.x, size.y - p.y, size.x - p.x];
    let nearest = to_edge.into_iter().fold(f32::INFINITY, f32::min);
    let side = to_edge.into_iter().position(|d| d == nearest).unwrap_or(0);
    let along = if side % 2 == 0 { p.x } else { p.y };
    let grain = clouds(vec3(along / 46.0, nearest / 2.2, side as f32 * 5.0), 3);
    let bevel = [1.16, 1.02, 0.74, 0.86][side] + 0.22 * libm::cosf(nearest / WIDTH * 3.1);
    let wood = vec3(0.47, 0.29, 0.17) * bevel * (0.72 + 0.5 * grain);
    // The frame's shadow on the picture.
    *color *= 1.0 - 0.45 * smooth(WIDTH + 8.0, WIDTH, p.x.min(p.y));
    lay(color, wood, cover(nearest - WIDTH));
    let gilt = vec3(0.90, 0.73, 0.36) * [0.80, 0.90, 1.14, 1.05][side];
    lay(color, gilt, cover((nearest - WIDTH + 2.5).abs() - 2.0));
    lay(color, vec3(0.16, 0.09, 0.05), cover((nearest - WIDTH + 5.5).abs() - 0.6));
    let stud = vec2(11.0, 11.0);
    lay(color, vec3(0.30, 0.04, 0.05), cover(disk(p, stud, 7.0)));
    lay(color, vec3(0.90, 0.16, 0.15), cover(disk(p, stud, 5.8)));
    lay(color, vec3(1.0, 0.75, 0.70), 0.8 * cover(disk(p, stud - 2.0, 1.6)));
}

/// An imaginary world in longitude and latitude, with a meridian and a parallel every 15 degrees,
/// the equator in red and the first meridian in gold.
fn globe(p: Vec2) -> Vec3 {
    let latitude = 90.0 - p.y * 180.0 / 256.0;
    let height = terrain(p);
    let color = if height < 0.0 { sea(height, latitude) } else { land(p, height, latitude) };
    // The change of height from pixel to pixel gives the distance from the coast.
    let slope = vec2(terrain(p + Vec2::X) - height, terrain(p + Vec2::Y) - height).length();
    let coast = (height / slope.max(1e-6)).abs() - 0.5;
    let mut color = color.lerp(vec3(0.10, 0.17, 0.20), 0.7 * cover(coast - 0.4));

    let ice = latitude.abs() + 16.0 * (clouds(on_sphere(p) * 5.0 + 30.0, 4) - 0.5);
    lay(&mut color, vec3(0.95, 0.97, 0.99), smooth(71.0, 73.0, ice));
    let ink = vec3(0.05, 0.09, 0.16);
    let step = 512.0 / 24.0;
    let q = p - vec2(256.0, 128.0);
    let from_line = (q - (q / step).round() * step).abs().min_element();
    lay(&mut color, ink, 0.34 * cover(from_line - 0.2));
    lay(&mut color, vec3(0.85, 0.16, 0.12), cover(q.y.abs() - 1.0));
    lay(&mut color, vec3(0.98, 0.79, 0.22), cover(q.x.abs() - 1.0));
    color
}

/// The position on a unit sphere, so that the map's left and right edges meet and its poles are
/// points.
fn on_sphere(p: Vec2) -> Vec3 {
    let (around, up) = (p.x * std::f32::consts::TAU / 512.0, p.y * std::f32::consts::PI / 256.0);
    let ring = libm::sinf(up);
    vec3(ring * libm::sinf(around), libm::cosf(up), ring * libm::cosf(around))
}

/// Above 0 on land.
fn terrain(p: Vec2) -> f32 {
    let place = on_sphere(p);
    clouds(place * 1.9 + vec3(4.3, 7.1, 2.6), 6) - 0.565 + 0.03 * place.y
}

fn sea(height: f32, latitude: f32) -> Vec3 {
    let shallow = smooth(-0.16, 0.0, height);
    let color = vec3(0.05, 0.19, 0.42).lerp(vec3(0.25, 0.56, 0.72), shallow * shallow);
    color * (1.0 - 0.0015 * latitude.abs())
}

fn land(p: Vec2, height: f32, latitude: f32) -> Vec3 {
    let wet = clouds(on_sphere(p) * 4.0 + 11.0, 4);
    // Desert near the tropics, forest at the equator and in the middle latitudes, then tundra.
    let drift = latitude.abs() + 36.0 * (wet - 0.5);
    let dry = smooth(13.0, 3.0, (drift - 21.0).abs());
    let mut color = vec3(0.24, 0.47, 0.19).lerp(vec3(0.40, 0.56, 0.24), wet);
    lay(&mut color, vec3(0.85, 0.74, 0.48), dry);
    lay(&mut color, vec3(0.56, 0.55, 0.44), smooth(50.0, 66.0, drift));
    lay(&mut color, vec3(0.48, 0.38, 0.29), 0.8 * smooth(0.09, 0.18, height));
    color
}
