//! The work of a render before its first ray: bounds on it; and the work and time to expect, from a pilot of some of its
//! pixels.

use std::time::Instant;

use rayon::prelude::*;
use serde::ser::Error as _;
use serde::{Serialize, Serializer};
use serde_json::Value;

use crate::statistics::{Rays, Samples};
use wavecrest_base::error::Result;
use wavecrest_core::counters::Counters;
use wavecrest_core::kernels::texture::Filter;
use wavecrest_core::prepared::{Class, PreparedScene};
use wavecrest_core::render::units::Blocks;
use wavecrest_core::render::{RenderOptions, batch_size, camera_rays, work};
use wavecrest_core::tile::{Tile, Timed, TraceSettings, Unit};

/// Upper bounds on the counts of a render; they are 0 only for work that cannot occur. Where surfaces
/// let light through there is no bound on the rays that go on from them: [`u64::MAX`] stands for it, and `null` in JSON.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Estimated {
    /// Rays by kind.
    #[serde(serialize_with = "bounds")]
    pub rays: Rays,
    /// Samples by kind.
    #[serde(serialize_with = "bounds")]
    pub samples: Samples,
}

/// Writes counts, and `null` where there is no bound.
fn bounds<T: Serialize, S: Serializer>(
    counts: &T,
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    let mut counts = serde_json::to_value(counts).map_err(S::Error::custom)?;
    for count in counts.as_object_mut().into_iter().flat_map(|counts| counts.values_mut()) {
        if *count == u64::MAX {
            *count = Value::Null;
        }
    }
    counts.serialize(serializer)
}

impl Estimated {
    /// The bounds for a render of this number of `pixels` of `scene`: every camera ray is traced and meets
    /// mirrors up to the largest number of bounces, every hit samples all lights, and every hit is
    /// on the shape whose textures read the most texels.
    pub fn of(scene: &PreparedScene, pixels: u64) -> Self {
        let primary = pixels * u64::from(scene.camera.rays_per_pixel());
        let secondary = match scene.plan.schedule().has_transmission() {
            true => u64::MAX,
            false => primary.saturating_mul(u64::from(scene.bounces)),
        };
        let hits = primary.saturating_add(secondary);
        let points = |sampled_alone: bool| -> u64 {
            let lights = scene.lights.iter().filter(|l| !sampled_alone || l.is_sampled());
            lights.map(|light| u64::from(light.samples())).sum()
        };
        let most = |count: fn(Filter) -> u64| -> u64 {
            let of = |class: &Class| {
                let textures = class.maps.iter().filter_map(|map| map.texture.as_ref());
                textures.map(|texture| count(texture.filter)).sum()
            };
            scene.appearance.classes.iter().map(of).max().unwrap_or(0)
        };
        let texels = most(|filter| filter.texels() * filter.levels());
        let spreads = most(|filter| u64::from(filter == Filter::Trilinear));
        let is_colored = scene.appearance.shapes.iter().any(|shape| shape.colored);
        let colors = if is_colored { hits } else { 0 };
        let carried = if scene.carries_differentials() { secondary } else { 0 };
        let footprints = hits.saturating_mul(spreads).saturating_add(carried);
        let shadow = hits.saturating_mul(points(false));
        let light = hits.saturating_mul(points(true));
        let lens = if scene.camera.has_lens() { primary } else { 0 };
        Self {
            rays: Rays { primary, secondary, shadow },
            samples: Samples {
                lens,
                light,
                colors,
                texels: hits.saturating_mul(texels),
                footprints,
            },
        }
    }
}

/// The pilot's tiles: their number in each row and column, and their largest side in pixels.
const TILES: u32 = 8;
const EDGE: u32 = 8;

/// Largest number of paths of the pilot, if a pixel has more than one.
const MOST_PATHS: u64 = 1 << 15;

/// Every so many rows of pixels show which chunks of a tree rays build.
const ROWS_APART: usize = 8;

/// The expectation for a render.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Expected {
    /// Pixels of the pilot.
    pub pixels: u64,
    /// Rays by kind. Camera rays are exact.
    pub rays: Rays,
    /// Samples by kind. Those on the lens are exact.
    pub samples: Samples,
    /// Seconds of tracing, on the threads of the current pool.
    pub seconds: f64,
    /// The share of these in which hits on surfaces with maps, or that let light through, are shaded.
    pub maps: f64,
    /// Seconds in which rays build chunks of trees, on the same threads.
    pub building: f64,
}

impl Expected {
    /// The expectation for a render of all of `scene`: tiles in an even grid are rendered, and
    /// their counts extrapolated. Their pixels are those of the whole image, so the estimate is the
    /// same in every run except for the seconds.
    ///
    /// # Errors
    /// If an image cannot be decoded.
    pub fn of(scene: &PreparedScene, options: &RenderOptions) -> Result<Self> {
        let [width, height] = scene.camera.size();
        let tiles = tiles([width, height], TILES, EDGE, |room| room / 2);
        let pixels: u64 = tiles.iter().map(|tile| tile.len() as u64).sum();
        let samples = Blocks::new(scene.camera.rays_per_pixel()).longest();
        let samples = samples.min((MOST_PATHS / pixels).max(1) as u32);
        let rows = (0..height).step_by(ROWS_APART).map(|y| Tile { x: 0, y, width, height: 1 });
        let rows: Vec<_> = rows.filter(|_| scene.accel.chunks().is_some()).collect();
        scene.appearance.decode()?;
        let (of_rows, [first, _]) = trace(scene, options, &rows, 1);
        // Another run warms the caches.
        trace(scene, options, &tiles, samples);
        scene.appearance.check()?;
        let (counters, [seconds, maps]) = trace(scene, options, &tiles, samples);
        let paths = u64::from(width) * u64::from(height) * u64::from(scene.camera.rays_per_pixel());
        let scale = paths as f64 / counters.primary_rays as f64;
        let threads = rayon::current_num_threads() as f64;
        let usual = seconds * of_rows.primary_rays as f64 / counters.primary_rays as f64;
        let primary = camera_rays(scene, options)?;
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
            seconds: seconds * scale / threads,
            maps: maps / seconds,
            building: (first - usual).max(0.0) / threads,
        })
    }
}

/// A tile in each part of an image, with up to `most` parts along a side and `edge` pixels along
/// that of a tile; `place` says how many of the pixels that a tile leaves come before it.
pub(crate) fn tiles(
    [width, height]: [u32; 2],
    most: u32,
    edge: u32,
    mut place: impl FnMut(u32) -> u32,
) -> Vec<Tile> {
    let parts = |side: u32| side.div_ceil(edge).clamp(1, most);
    let (columns, rows) = (parts(width), parts(height));
    let mut within = |side: u32, part: u32, parts: u32| {
        let bound = |part: u32| (u64::from(side) * u64::from(part) / u64::from(parts)) as u32;
        let (start, end) = (bound(part), bound(part + 1));
        let length = edge.min(end - start);
        (start + place(end - start - length), length)
    };
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let tile = |(column, row)| {
        let (x, width) = within(width, column, columns);
        let (y, height) = within(height, row, rows);
        Tile { x, y, width, height }
    };
    cells.map(tile).collect()
}

/// Renders `samples` samples of each pixel of the tiles. Returns counts, and seconds summed over
/// threads: all, and those in which hits on surfaces with maps are shaded.
fn trace(
    scene: &PreparedScene,
    options: &RenderOptions,
    tiles: &[Tile],
    samples: u32,
) -> (Counters, [f64; 2]) {
    let batch = batch_size(scene, options.batch);
    let settings = TraceSettings { seed: options.seed, batch, time_passes: false };
    let one = |tile: &Tile| {
        let mut tracer = work::tracer(scene, options.tracer, &settings);
        let start = Instant::now();
        let mut sums = vec![[0.0; 3]; tile.len()];
        tracer.render(scene, &Unit { tile: *tile, samples: 0..samples }, &mut sums, &|| false);
        let seconds = start.elapsed().as_secs_f64();
        let maps = tracer.pass_seconds().get(Timed::Maps as usize).map_or(0.0, |(_, maps)| *maps);
        (tracer.counters(), [seconds, maps])
    };
    let add = |(mut counters, [a, b]): (Counters, [f64; 2]), (more, [c, d]): (_, [f64; 2])| {
        counters += more;
        (counters, [a + c, b + d])
    };
    tiles.par_iter().map(one).reduce(|| (Counters::default(), [0.0; 2]), add)
}
