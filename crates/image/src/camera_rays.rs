//! A pass over the camera rays of a render, the same to the last bit and through the same kernels.
//!
//! Bands of rows are processed in turn, each tile by tile on all threads, so that little memory is
//! needed beyond the result. The samples of a pixel are gathered in order.

use rayon::prelude::*;

use wavecrest_core::accel::Hit;
use wavecrest_core::kernels::precision::Arithmetic;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::Watch;
use wavecrest_core::render::units::Grid;
use wavecrest_core::tile::Tile;
use wavecrest_core::with_precision;

/// The side of a tile in pixels: its rays are coherent.
const TILE_EDGE: u32 = 64;

/// Largest number of rays traced together.
const BATCH_RAYS: usize = 4096;

/// Gathers the samples of a pixel.
pub(crate) trait Gather: Sync {
    /// The state of a pixel.
    type Sums: Clone + Default + Send;

    /// Adds the hit of a ray; `is_first` for the pixel's first sample.
    fn add<P: Arithmetic>(&self, ray: &Ray, hit: &Hit, is_first: bool, sums: &mut Self::Sums);
}

/// The camera rays of a window.
#[derive(Clone, Copy)]
pub(crate) struct CameraRays<'a> {
    pub(crate) scene: &'a PreparedScene,
    pub(crate) window: Tile,
    /// The seed of the render.
    pub(crate) seed: u64,
    /// Ends the pass early.
    pub(crate) watch: &'a dyn Watch,
}

impl CameraRays<'_> {
    /// Traces the rays, and calls `put` with the number of each pixel within the window and its
    /// sums.
    pub(crate) fn run<G: Gather>(&self, gather: &G, put: &mut dyn FnMut(usize, &G::Sums)) {
        let window = &self.window;
        let precision = self.scene.accel.geometry().precision;
        let follow =
            |tile: &Tile| with_precision!(precision, P => self.follow::<P, G>(tile, gather));
        for y in (0..window.height).step_by(TILE_EDGE as usize) {
            let height = TILE_EDGE.min(window.height - y);
            let band = Grid::new(Tile { y: window.y + y, height, ..*window }, TILE_EDGE);
            let tiles: Vec<Tile> = (0..band.len()).map(|number| band.tile(number)).collect();
            let found: Vec<Vec<G::Sums>> = tiles.par_iter().map(follow).collect();
            for (tile, pixels) in tiles.iter().zip(&found) {
                for (index, sums) in pixels.iter().enumerate() {
                    let (x, y) = tile.pixel(index as u32);
                    let row = (y - window.y) as usize * window.width as usize;
                    put(row + (x - window.x) as usize, sums);
                }
            }
        }
    }

    /// The sums of the tile's pixels.
    fn follow<P: Arithmetic, G: Gather>(&self, tile: &Tile, gather: &G) -> Vec<G::Sums> {
        let mut sums = vec![G::Sums::default(); tile.len()];
        let mut traversal = self.scene.accel.traversal();
        let (mut rays, mut hits) = (Vec::new(), Vec::new());
        let samples = u64::from(self.scene.camera.rays_per_pixel());
        let all = tile.len() as u64 * samples;
        for first in (0..all).step_by(BATCH_RAYS) {
            if self.watch.cancelled() {
                break;
            }
            let paths = first..all.min(first + BATCH_RAYS as u64);
            rays.clear();
            rays.extend(paths.clone().map(|path| self.camera_ray(tile, path)));
            hits.clear();
            hits.resize(rays.len(), Hit::MISS);
            self.scene.accel.search::<P>().closest_of(&rays[..], &mut hits, &mut traversal);
            for (path, (ray, hit)) in paths.zip(rays.iter().zip(&hits)) {
                let is_first = path % samples == 0;
                gather.add::<P>(ray, hit, is_first, &mut sums[(path / samples) as usize]);
            }
        }
        sums
    }

    /// The ray of a path: the samples of a pixel are consecutive.
    fn camera_ray(&self, tile: &Tile, path: u64) -> Ray {
        let camera = &self.scene.camera;
        let samples = u64::from(camera.rays_per_pixel());
        let (x, y) = tile.pixel((path / samples) as u32);
        let (pixel, sample) = (y * camera.size()[0] + x, (path % samples) as u32);
        camera.ray(x, y, &Stream { seed: self.seed, pixel, sample, bounce: 0 })
    }
}
