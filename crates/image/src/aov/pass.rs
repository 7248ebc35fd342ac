//! The pass over camera rays.
//!
//! Bands of rows are taken one after the other, each tile by tile on all threads, so that what is held besides the
//! channels is small. The samples of a pixel are added in their order.

use glam::Vec3;
use rayon::prelude::*;

use super::names::Names;
use wavecrest_core::accel::Hit;
use wavecrest_core::kernels::precision::Arithmetic;
use wavecrest_core::math::float::dot;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::prepared::{Interaction, LookUps, PreparedScene};
use wavecrest_core::tile::Tile;
use wavecrest_core::with_precision;

/// The side of a tile in pixels: rays that go together meet the same things.
const EDGE: u32 = 64;

/// The most rays that are traced together.
const MOST_RAYS: usize = 4096;

/// What the samples of a pixel met.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// How many samples hit something.
    pub(super) hits: u32,
    /// Of these, the sums.
    pub(super) depth: f64,
    pub(super) normal: [f64; 3],
    pub(super) albedo: [f64; 3],
    pub(super) position: [f64; 3],
    /// Of the first sample; 0 for nothing.
    pub(super) object: u32,
    pub(super) material: u32,
}

/// Follows the camera rays of `window`; `put` gets each pixel's number within it and what was met.
pub(super) fn run(
    scene: &PreparedScene,
    window: &Tile,
    seed: u64,
    names: &Names<'_>,
    put: &mut dyn FnMut(usize, &Sums),
) {
    for y in (0..window.height).step_by(EDGE as usize) {
        let tiles: Vec<Tile> = band(window, y).collect();
        let precision = scene.accel.geometry().precision;
        let follow =
            |tile: &Tile| with_precision!(precision, P => follow::<P>(scene, tile, seed, names));
        let found: Vec<Vec<Sums>> = tiles.par_iter().map(follow).collect();
        for (tile, pixels) in tiles.iter().zip(&found) {
            for (index, sums) in pixels.iter().enumerate() {
                let (x, y) = tile.pixel(index as u32);
                let row = (y - window.y) as usize * window.width as usize;
                put(row + (x - window.x) as usize, sums);
            }
        }
    }
}

/// The tiles of the rows from `y` on, within `window`.
fn band(window: &Tile, y: u32) -> impl Iterator<Item = Tile> + use<> {
    let window = *window;
    let height = EDGE.min(window.height - y);
    (0..window.width).step_by(EDGE as usize).map(move |x| Tile {
        x: window.x + x,
        y: window.y + y,
        width: EDGE.min(window.width - x),
        height,
    })
}

/// What the samples of the tile's pixels meet.
fn follow<P: Arithmetic>(
    scene: &PreparedScene,
    tile: &Tile,
    seed: u64,
    names: &Names<'_>,
) -> Vec<Sums> {
    let camera = &scene.camera;
    let (samples, width) = (u64::from(camera.rays_per_pixel()), camera.size()[0]);
    let mut sums = vec![Sums::default(); tile.len()];
    let mut traversal = scene.accel.traversal();
    let (mut rays, mut hits) = (Vec::new(), Vec::new());
    let paths = tile.len() as u64 * samples;
    for first in (0..paths).step_by(MOST_RAYS) {
        let some = first..paths.min(first + MOST_RAYS as u64);
        rays.clear();
        rays.extend(some.clone().map(|path| {
            let (x, y) = tile.pixel((path / samples) as u32);
            let sample = (path % samples) as u32;
            camera.ray(x, y, &Stream { seed, pixel: y * width + x, sample, bounce: 0 })
        }));
        hits.clear();
        hits.resize(rays.len(), Hit::MISS);
        scene.accel.search::<P>().closest_of(&rays[..], &mut hits, &mut traversal);
        for (path, (ray, hit)) in some.zip(rays.iter().zip(&hits)) {
            let is_first = path % samples == 0;
            if !hit.is_miss() {
                add::<P>(scene, (ray, hit), names, is_first, &mut sums[(path / samples) as usize]);
            }
        }
    }
    sums
}

fn add<P: Arithmetic>(
    scene: &PreparedScene,
    (ray, hit): (&Ray, &Hit),
    names: &Names<'_>,
    is_first: bool,
    sums: &mut Sums,
) {
    let [_, _, forward] = scene.camera.basis();
    let differential = || scene.camera.differential(ray.direction);
    let arrival = scene.interaction::<P>(ray, hit, differential, &mut LookUps::default());
    let (point, normal, albedo) = match arrival {
        Interaction::Nothing => return,
        Interaction::Surface(at) => {
            (at.point.into(), Vec3::from(at.shading_normal), Vec3::from(at.color))
        }
        Interaction::Light(color) => {
            let surface = scene.surface::<P>(ray, hit);
            (Vec3::from(surface.point), towards(ray, surface.normal.into()), color)
        }
    };
    sums.hits += 1;
    sums.depth += f64::from(hit.t) * f64::from(dot(ray.direction, forward));
    add_to(&mut sums.normal, normal.to_array().map(f64::from));
    add_to(&mut sums.albedo, albedo.to_array().map(f64::from));
    add_to(&mut sums.position, (point.as_dvec3() + scene.origin).to_array());
    if is_first {
        (sums.object, sums.material) = names.numbers(scene.appearance.shape_of(hit.primitive));
    }
}

/// The normal on the side that the ray comes from.
fn towards(ray: &Ray, normal: Vec3) -> Vec3 {
    if dot(ray.direction, normal) > 0.0 { -normal } else { normal }
}

fn add_to(sum: &mut [f64; 3], value: [f64; 3]) {
    sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value);
}
