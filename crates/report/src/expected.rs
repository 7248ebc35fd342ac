//! What a render will do and how long it will take, as a pilot of some of its pixels says.

use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use crate::statistics::{Rays, Samples};
use wavecrest_base::error::Result;
use wavecrest_core::counters::Counters;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::units::Blocks;
use wavecrest_core::render::{RenderOptions, batch_size, work};
use wavecrest_core::tile::{Tile, TraceSettings, Unit};

/// The pilot's tiles: as many in a row as in a column, and so many pixels wide and high at most.
const TILES: u32 = 8;
const EDGE: u32 = 8;

/// Paths of the pilot, at most, where a pixel has more than one.
const MOST_PATHS: u64 = 1 << 15;

/// What is expected of a render.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Expected {
    /// Pixels that the pilot looked at.
    pub pixels: u64,
    /// Rays by kind. Camera rays are exact.
    pub rays: Rays,
    /// Samples by kind. Those on the lens are exact.
    pub samples: Samples,
    /// Seconds of tracing, on the threads of the current pool.
    pub seconds: f64,
}

impl Expected {
    /// Of a render of all of `scene`: tiles in an even grid are rendered, and what they count is taken to be so
    /// everywhere. Their image is that part of the whole, so that the estimate is the same in every run but for
    /// the seconds.
    ///
    /// # Errors
    /// When an image cannot be decoded.
    pub fn of(scene: &PreparedScene, options: &RenderOptions) -> Result<Self> {
        let [width, height] = scene.camera.size();
        let tiles: Vec<Tile> = (0..TILES * TILES)
            .map(|cell| {
                let (x, length_x) = middle(width, cell % TILES);
                let (y, length_y) = middle(height, cell / TILES);
                Tile { x, y, width: length_x, height: length_y }
            })
            .filter(|tile| !tile.is_empty())
            .collect();
        let pixels: u64 = tiles.iter().map(|tile| tile.len() as u64).sum();
        let samples = Blocks::new(scene.camera.rays_per_pixel()).longest();
        let samples = samples.min((MOST_PATHS / pixels).max(1) as u32);
        // Once for what is done at the first look: images are decoded, and the tree comes into the caches.
        trace(scene, options, &tiles, samples);
        scene.appearance.check()?;
        let (counters, seconds) = trace(scene, options, &tiles, samples);
        let primary =
            u64::from(width) * u64::from(height) * u64::from(scene.camera.rays_per_pixel());
        let scale = primary as f64 / counters.primary_rays as f64;
        let all = |count: u64| (count as f64 * scale).round() as u64;
        let (rays, found) = (Rays::from(&counters), Samples::from(&counters));
        Ok(Self {
            pixels,
            rays: Rays { primary, secondary: all(rays.secondary), shadow: all(rays.shadow) },
            samples: Samples {
                lens: if scene.camera.has_lens() { primary } else { 0 },
                light: all(found.light),
                colors: all(found.colors),
                texels: all(found.texels),
                footprints: all(found.footprints),
            },
            seconds: seconds * scale / rayon::current_num_threads() as f64,
        })
    }
}

/// Where in its part of a side a tile begins, and how long it is there: in the middle.
fn middle(side: u32, part: u32) -> (u32, u32) {
    let edge = |part: u32| (u64::from(side) * u64::from(part) / u64::from(TILES)) as u32;
    let (start, end) = (edge(part), edge(part + 1));
    let length = (end - start).min(EDGE);
    (start + (end - start - length) / 2, length)
}

/// Renders so many `samples` of each pixel of the tiles. What is counted, and seconds, added up over threads.
fn trace(
    scene: &PreparedScene,
    options: &RenderOptions,
    tiles: &[Tile],
    samples: u32,
) -> (Counters, f64) {
    let batch = batch_size(scene, options.batch);
    let settings = TraceSettings { seed: options.seed, batch };
    let one = |tile: &Tile| {
        let mut tracer = work::tracer(scene, options.tracer, &settings);
        let start = Instant::now();
        let mut sums = vec![[0.0; 3]; tile.len()];
        tracer.render(scene, &Unit { tile: *tile, samples: 0..samples }, &mut sums);
        (tracer.counters(), start.elapsed().as_secs_f64())
    };
    let add = |(mut counters, seconds): (Counters, f64), (more, longer): (Counters, f64)| {
        counters += more;
        (counters, seconds + longer)
    };
    tiles.par_iter().map(one).reduce(|| (Counters::default(), 0.0), add)
}
