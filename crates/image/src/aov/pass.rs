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
const TILE_EDGE: u32 = 64;

/// Rays that are traced together, at most.
const BATCH_RAYS: usize = 4096;

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

/// The camera rays of a window.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a> {
    pub(super) scene: &'a PreparedScene,
    pub(super) window: Tile,
    /// The seed of the render.
    pub(super) seed: u64,
    pub(super) names: &'a Names<'a>,
}

/// Takes the number of a pixel within the window, and what its samples met.
type Put<'a> = dyn FnMut(usize, &Sums) + 'a;

impl Pass<'_> {
    /// Follows the rays, and hands `put` what those of each pixel met.
    pub(super) fn run(&self, put: &mut Put<'_>) {
        let window = &self.window;
        let precision = self.scene.accel.geometry().precision;
        let follow = |tile: &Tile| with_precision!(precision, P => self.follow::<P>(tile));
        for y in (0..window.height).step_by(TILE_EDGE as usize) {
            let tiles: Vec<Tile> = band(window, y).collect();
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

    /// What the samples of the tile's pixels meet.
    fn follow<P: Arithmetic>(&self, tile: &Tile) -> Vec<Sums> {
        let mut sums = vec![Sums::default(); tile.len()];
        let mut traversal = self.scene.accel.traversal();
        let (mut rays, mut hits) = (Vec::new(), Vec::new());
        let samples = u64::from(self.scene.camera.rays_per_pixel());
        let all = tile.len() as u64 * samples;
        for first in (0..all).step_by(BATCH_RAYS) {
            let paths = first..all.min(first + BATCH_RAYS as u64);
            rays.clear();
            rays.extend(paths.clone().map(|path| self.camera_ray(tile, path)));
            hits.clear();
            hits.resize(rays.len(), Hit::MISS);
            self.scene.accel.search::<P>().closest_of(&rays[..], &mut hits, &mut traversal);
            for (path, (ray, hit)) in paths.zip(rays.iter().zip(&hits)) {
                let is_first = path % samples == 0;
                self.add::<P>(ray, hit, is_first, &mut sums[(path / samples) as usize]);
            }
        }
        sums
    }

    /// The ray of a path: the samples of a pixel follow each other.
    fn camera_ray(&self, tile: &Tile, path: u64) -> Ray {
        let camera = &self.scene.camera;
        let samples = u64::from(camera.rays_per_pixel());
        let (x, y) = tile.pixel((path / samples) as u32);
        let (pixel, sample) = (y * camera.size()[0] + x, (path % samples) as u32);
        camera.ray(x, y, &Stream { seed: self.seed, pixel, sample, bounce: 0 })
    }

    /// Adds what a ray met to the sums of its pixel; `is_first` is that of the pixel's first sample.
    fn add<P: Arithmetic>(&self, ray: &Ray, hit: &Hit, is_first: bool, sums: &mut Sums) {
        if hit.is_miss() {
            return;
        }
        let scene = self.scene;
        let [_, _, forward] = scene.camera.basis();
        let differential = || scene.camera.differential(ray.direction);
        let met = scene.interaction::<P>(ray, hit, &differential, &mut LookUps::default());
        let (point, normal, albedo) = match met {
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
            let shape = scene.appearance.shape_of(hit.primitive);
            (sums.object, sums.material) = self.names.numbers(shape);
        }
    }
}

/// The tiles of the rows from `y` on, within `window`.
fn band(window: &Tile, y: u32) -> impl Iterator<Item = Tile> + use<> {
    let window = *window;
    let height = TILE_EDGE.min(window.height - y);
    (0..window.width).step_by(TILE_EDGE as usize).map(move |x| Tile {
        x: window.x + x,
        y: window.y + y,
        width: TILE_EDGE.min(window.width - x),
        height,
    })
}

/// The normal on the side that the ray comes from.
fn towards(ray: &Ray, normal: Vec3) -> Vec3 {
    if dot(ray.direction, normal) > 0.0 { -normal } else { normal }
}

fn add_to(sum: &mut [f64; 3], value: [f64; 3]) {
    sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value);
}
