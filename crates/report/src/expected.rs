//! The work and time of a render to expect, from a pilot of some of its pixels.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rand::RngExt;
use serde::Serialize;

use crate::measure::processor_seconds;
use crate::summary::generator;
use wavecrest_base::error::Result;
use wavecrest_base::parallel;
use wavecrest_core::counters::{Counters, RayCounts, SampleCounts};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::units::{Grid, spread};
use wavecrest_core::render::work::{self, RenderWork, Task, TaskList};
use wavecrest_core::render::{RenderOptions, TracerKind, Watch, camera_rays, tile_edge, window};
use wavecrest_core::tile::{Tile, TimedPass, Unit};

/// The sides of a grid of pixels that tells how many rays a path has, and, at least and at most, of the pilot's own, which
/// has about so many rays.
const FEW: u32 = 12;
const SIDES: [u32; 2] = [20, 128];
const RAYS: f64 = (1 << 17) as f64;

/// The seconds of work of each thread after which the render that is timed ends.
const TIMED: f64 = 0.05;

/// Rays of smaller batches are slower.
const LEAST_BATCH: usize = 64;

/// The expectation for a render.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Expected {
    /// Pixels of the pilot.
    pub pixels: u64,
    /// Rays by kind. Camera rays are exact.
    pub rays: RayCounts,
    /// Samples by kind. Those on the lens are exact.
    pub samples: SampleCounts,
    /// Seconds of tracing, on the threads of the current pool.
    pub seconds: f64,
    /// The share of these in which hits on surfaces with maps, or that let light through, are shaded.
    pub maps: f64,
    /// Seconds in which rays build chunks of trees and decode images, on the same threads.
    pub building: f64,
    /// Bytes of the columns of all threads' batches.
    pub columns: u64,
}

impl Expected {
    /// The expectation for a render of all of `scene`. One path is followed to its end from a pixel in each part of the
    /// image, and the counts are extrapolated: they are the same in every run. Then the render itself runs for a
    /// moment, in tiles all over the image; the time of its rays is that of all.
    ///
    /// # Errors
    /// If an image cannot be decoded.
    pub fn of(scene: &PreparedScene, options: &RenderOptions) -> Result<Self> {
        let rays = |counters: &Counters| counters.rays.all() as f64;
        let (few, first) = count(scene, options, FEW);
        let side = f64::from(FEW) * (RAYS / rays(&few)).sqrt();
        let side = (side as u32).clamp(SIDES[0], SIDES[1]);
        let (counters, more) = count(scene, options, side);
        scene.appearance.check()?;
        let mut building = 0.0;
        if scene.accel.chunks().is_some() || !scene.appearance.images.is_empty() {
            // The same once more builds nothing.
            let again = count(scene, options, side).1;
            building = (first + more - again * (1.0 + rays(&few) / rays(&counters))).max(0.0);
        }
        let paths = scene.camera_rays();
        let scale = paths as f64 / counters.rays.primary as f64;
        let all = |count: u64| (count as f64 * scale).round() as u64;
        let primary = camera_rays(scene, options)?;
        let (found, samples) = (counters.rays, counters.samples);
        let rays =
            RayCounts { primary, secondary: all(found.secondary), shadow: all(found.shadow) };
        // Few tiles with many rays each would not be all over the image.
        let most = (RAYS / 2.0 * paths as f64 / rays.all() as f64) as usize;
        let batch = most.max(LEAST_BATCH).min(options.batch);
        let larger = (options.batch / batch) as u64;
        let options = RenderOptions { batch, ..*options };
        let share = |done: &Counters| (1 + done.rays.all()) as f64 / (1 + rays.all()) as f64;
        let (seconds, moment) = timed(scene, &options, TIMED, share)?;
        let of_passes: f64 = moment.pass_seconds.iter().map(|(_, seconds)| seconds).sum();
        let maps = moment.pass_seconds.get(TimedPass::Maps as usize).map_or(0.0, |(_, maps)| *maps);
        Ok(Self {
            pixels: counters.rays.primary,
            rays,
            samples: SampleCounts {
                lens: if scene.camera.has_lens() { primary } else { 0 },
                light: all(samples.light),
                colors: all(samples.colors),
                texels: all(samples.texels),
                footprints: all(samples.footprints),
                ..samples
            },
            seconds,
            maps: if of_passes > 0.0 { maps / of_passes } else { 0.0 },
            building,
            columns: moment.columns * larger,
        })
    }
}

/// The seconds of a render, from its first moment, which is the second, in which threads work for so many `seconds`:
/// `share` is the part of the work that is done then. Other programs that use the processors are expected to go on.
fn timed(
    scene: &PreparedScene,
    options: &RenderOptions,
    seconds: f64,
    share: impl Fn(&Counters) -> f64,
) -> Result<(f64, RenderWork)> {
    let until = Until(seconds, Instant::now(), Mutex::default());
    let grid = Grid::new(window(scene, options.crop)?, tile_edge(scene, options.batch));
    let (samples, step) = (scene.camera.rays_per_pixel(), u64::from(spread(grid.len())));
    let tile = |number: usize| (number as u64 * step % u64::from(grid.len())) as u32;
    let task = |number| Task { tile: tile(number), samples: 0..samples, sums: None };
    let tasks = TaskList { grid, samples, count: grid.len() as usize, task: &task };
    let finished = AtomicU32::new(0);
    let moment = work::run(scene, options, &tasks, &until, &|summed| {
        finished.fetch_add(u32::from(summed.samples == samples), Ordering::Relaxed);
    })?;
    let is_finished = finished.into_inner() == grid.len();
    let share = if is_finished { 1.0 } else { share(&moment.counters) };
    Ok((moment.seconds / share, moment))
}

/// Ends a render on each thread when that has worked for so many seconds since it began, by its own clock: while other
/// programs use the processors, it stands still. Where the system has none, it is the one from the start.
struct Until(f64, Instant, Mutex<BTreeMap<Option<usize>, f64>>);

impl Watch for Until {
    fn cancelled(&self) -> bool {
        let Self(seconds, start, begun) = self;
        let now = processor_seconds(true).unwrap_or_else(|| start.elapsed().as_secs_f64());
        let mut begun = begun.lock().unwrap_or_else(PoisonError::into_inner);
        now - *begun.entry(rayon::current_thread_index()).or_insert(now) > *seconds
    }
}

/// The work of one path from a pixel in each part of the image, of which a row or a column has up to `side`, and its
/// seconds.
fn count(scene: &PreparedScene, options: &RenderOptions, side: u32) -> (Counters, f64) {
    let start = Instant::now();
    let samples = u64::from(scene.camera.rays_per_pixel());
    let step = u64::from(spread(scene.camera.rays_per_pixel()));
    let path = |(number, tile)| {
        let sample = (number * step % samples) as u32;
        Unit { tile, samples: sample..sample + 1 }
    };
    let pixels = tiles(scene.camera.size(), side, 1, options.seed);
    let paths: Vec<Unit> = (0..).zip(pixels).map(path).collect();
    // Single paths are what this tracer is for; it counts the same.
    let options = RenderOptions { tracer: TracerKind::Recursive, ..*options };
    let tracer = || work::tracer(scene, &options);
    let tracers = parallel::with_state(paths.iter(), tracer, |tracer, path| {
        tracer.render(scene, path, &mut [[0.0; 3]], &|| false);
    });
    let mut counters = Counters::default();
    tracers.iter().for_each(|tracer| counters += tracer.counters());
    (counters, start.elapsed().as_secs_f64())
}

/// A tile in each part of an image, with up to `most` parts along a side and `edge` pixels along
/// that of a tile, at a random place that follows from `seed`.
fn tiles([width, height]: [u32; 2], most: u32, edge: u32, seed: u64) -> Vec<Tile> {
    let mut random = generator(seed);
    let parts = |side: u32| side.div_ceil(edge).clamp(1, most);
    let (columns, rows) = (parts(width), parts(height));
    let mut within = |side: u32, part: u32, parts: u32| {
        let bound = |part: u32| (u64::from(side) * u64::from(part) / u64::from(parts)) as u32;
        let (start, end) = (bound(part), bound(part + 1));
        let length = edge.min(end - start);
        (start + random.random_range(0..=(end - start - length) as usize) as u32, length)
    };
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let tile = |(column, row)| {
        let (x, width) = within(width, column, columns);
        let (y, height) = within(height, row, rows);
        Tile { x, y, width, height }
    };
    cells.map(tile).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn only_the_work_of_a_thread_ends_a_moment() {
        let until = Until(0.02, Instant::now(), Mutex::default());
        assert!(!until.cancelled());
        std::thread::sleep(std::time::Duration::from_millis(50));
        assert!(!until.cancelled());
        while !until.cancelled() {}
    }
}
