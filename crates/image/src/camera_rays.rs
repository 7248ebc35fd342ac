//! A pass over the camera rays of a render, the same to the last bit: see [`Sight`](wavecrest_core::wavefront::Sight).
//!
//! Bands of rows are processed in turn, each tile by tile on all threads, so that little memory is
//! needed beyond the result. The samples of a pixel are gathered in order.

use wavecrest_base::parallel;
use wavecrest_core::math::float::dot;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::Watch;
use wavecrest_core::render::units::Grid;
use wavecrest_core::tile::{Tile, Unit};
use wavecrest_core::wavefront::{Seen, sight};

/// The side of a tile in pixels: its rays are coherent.
const TILE_EDGE: u32 = 64;

/// What the camera rays of a pixel show, summed over its samples.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HitSums {
    /// Number of samples that show something. The other sums are over these.
    pub(crate) hits: u32,
    /// The share of the background that arrives straight, of all samples: the mean of red, green and blue.
    pub(crate) passed: f64,
    /// Distances along the view axis.
    pub(crate) depth: f64,
    pub(crate) normal: [f64; 3],
    /// The colours that the caller gives hits.
    pub(crate) color: [f64; 3],
    /// Points in the space of the scene.
    pub(crate) position: [f64; 3],
    /// The number of the shape that the first sample shows, from 1; 0 for nothing.
    pub(crate) shape: u32,
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
    /// Sums what the rays show, which have the colours that `color` gives them, and calls `put` as
    /// [`CameraRays::run`] does.
    pub(crate) fn sum(
        &self,
        color: impl Fn(&Seen) -> [f32; 3] + Sync,
        put: &mut dyn FnMut(usize, &HitSums),
    ) {
        let scene = self.scene;
        let [_, _, forward] = scene.camera.basis();
        let add = |sums: &mut HitSums, seen: &Seen, is_first: bool| {
            sums.passed += seen.passed;
            if seen.hit.is_miss() {
                return;
            }
            sums.hits += 1;
            sums.depth += f64::from(seen.hit.t) * f64::from(dot(seen.ray.direction, forward));
            add_to(&mut sums.normal, seen.normal.to_array().map(f64::from));
            add_to(&mut sums.color, color(seen).map(f64::from));
            add_to(&mut sums.position, (seen.point.as_dvec3() + scene.origin).to_array());
            if is_first {
                sums.shape = scene.appearance.shape_of(seen.hit.primitive) as u32 + 1;
            }
        };
        self.run(true, &add, put);
    }

    /// Passes what each ray shows, and whether it is the pixel's first, to `add`, with the sums of its pixel; then
    /// calls `put` with the number of each pixel within the window and its sums. Rays that are not followed `through`
    /// what they meet show only what they meet first.
    pub(crate) fn run<S: Clone + Default + Send>(
        &self,
        through: bool,
        add: &(impl Fn(&mut S, &Seen, bool) + Sync),
        put: &mut dyn FnMut(usize, &S),
    ) {
        let Self { scene, window, seed, watch } = self;
        let samples = scene.camera.rays_per_pixel();
        for y in (0..window.height).step_by(TILE_EDGE as usize) {
            let height = TILE_EDGE.min(window.height - y);
            let band = Grid::new(Tile { y: window.y + y, height, ..*window }, TILE_EDGE);
            let tile =
                |number: u32| (band.tile(number), vec![S::default(); band.tile(number).len()]);
            let mut tiles: Vec<(Tile, Vec<S>)> = (0..band.len()).map(tile).collect();
            let worker = || sight(scene, *seed);
            parallel::with_state(tiles.iter_mut(), worker, |sight, (tile, sums)| {
                if watch.cancelled() {
                    return;
                }
                let unit = Unit { tile: *tile, samples: 0..samples };
                let mut before = vec![0_u32; sums.len()];
                sight.look(scene, &unit, through, &mut |pixel, seen| {
                    add(&mut sums[pixel], seen, before[pixel] == 0);
                    before[pixel] += 1;
                });
            });
            for (tile, pixels) in &tiles {
                for (index, sums) in pixels.iter().enumerate() {
                    let (x, y) = tile.pixel(index as u32);
                    let row = (y - window.y) as usize * window.width as usize;
                    put(row + (x - window.x) as usize, sums);
                }
            }
        }
    }
}

fn add_to(sum: &mut [f64; 3], value: [f64; 3]) {
    sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value);
}
