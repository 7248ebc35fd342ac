//! Rendering: cuts an image into tiles, renders them and assembles the film.
//!
//! [`units`] defines tiles, [`work`] has the loop and chooses the tracer, and
//! [`Canvas`] collects finished tiles. Partial and resumed renders use the same three.

mod backdrop;
mod canvas;
pub mod units;
mod watch;
pub mod work;

use crate::counters::Counters;
use crate::film::Film;
use crate::kernels::Precision;
use crate::prepared::PreparedScene;
use crate::tile::Tile;
use crate::wavefront::DEFAULT_BATCH;
use backdrop::Backdrop;
use units::Grid;
use wavecrest_base::error::{Error, ErrorKind, Result};
use work::{RenderWork, Summed, Task, TaskList};

pub use backdrop::camera_rays;
pub use canvas::{Canvas, Painted};
pub use watch::{Progress, Watch};

wavecrest_base::choices! {
    /// The tracers.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum TracerKind {
        /// Batches of rays, pass by pass.
        #[default]
        Wavefront = "wavefront",
        /// One path at a time, depth first.
        Recursive = "recursive",
    }
}

/// Options of a render. Only `crop` and `seed` change the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderOptions {
    /// The tracer.
    pub tracer: TracerKind,
    /// The part of the image to render; all of it if `None`.
    pub crop: Option<Tile>,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Largest number of paths in a batch of the wavefront; a batch is never larger than the image,
    /// or than a tile of 1024 x 1024 pixels.
    pub batch: usize,
}

impl Default for RenderOptions {
    fn default() -> Self {
        let tracer = TracerKind::default();
        Self { tracer, crop: None, seed: 0, batch: DEFAULT_BATCH }
    }
}

/// The result of a render.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The image, or the requested part of it; black where it is not finished.
    pub film: Film,
    /// Whether the image is complete, and nothing was cancelled.
    pub finished: bool,
    /// The finished tiles, row by row.
    pub tiles: Vec<Tile>,
    /// The work done.
    pub counters: Counters,
    /// Bytes of the columns of all threads' batches.
    pub columns: u64,
    /// Seconds in each pass of the wavefront, summed over threads.
    pub pass_seconds: Vec<(&'static str, f64)>,
    /// Seconds from start to end.
    pub seconds: f64,
    /// The precision of its hits.
    pub precision: Precision,
}

/// Renders `scene` on the threads of the current rayon pool. `watch` receives progress, from any
/// thread; `&()` ignores it. If it cancels the render, the finished part is returned. The crate
/// `wavecrest-api` has an example.
///
/// # Errors
/// If the crop is not within the image, there is no memory for the film, an image cannot be
/// decoded, or the plan's table of passes is inconsistent.
pub fn render(
    scene: &PreparedScene,
    options: &RenderOptions,
    watch: &dyn Watch,
) -> Result<Rendered> {
    let grid = Grid::new(window(scene, options.crop)?, tile_edge(scene, options.batch));
    let samples = scene.camera.rays_per_pixel();
    let canvas = Canvas::new(grid, samples, watch)?;
    let task = |number| Task { tile: number as u32, samples: 0..samples, sums: None };
    let tasks = TaskList { grid, samples, count: grid.len() as usize, task: &task };
    let done = work::run(scene, options, &tasks, watch, &|summed| canvas.keep(summed))?;
    Ok(Rendered::new(canvas.finish(), done))
}

impl Rendered {
    /// The render with this film and this work.
    pub fn new(painted: Painted, work: RenderWork) -> Self {
        let Painted { film, tiles, pixels } = painted;
        let RenderWork { counters, columns, pass_seconds, seconds, precision } = work;
        let finished = pixels == film.pixels().len() as u64;
        Self { film, finished, tiles, counters, columns, pass_seconds, seconds, precision }
    }
}

/// The part of the image to render: `crop`, or all of it.
///
/// # Errors
/// If the crop has no pixels or is not within the image.
pub fn window(scene: &PreparedScene, crop: Option<Tile>) -> Result<Tile> {
    let [width, height] = scene.camera.size();
    let whole = Tile { x: 0, y: 0, width, height };
    let Some(crop) = crop else { return Ok(whole) };
    let end = |start: u32, length: u32| u64::from(start) + u64::from(length);
    let fits = !crop.is_empty()
        && end(crop.x, crop.width) <= u64::from(width)
        && end(crop.y, crop.height) <= u64::from(height);
    if fits {
        return Ok(crop);
    }
    let Tile { x, y, width: w, height: h } = crop;
    Err(Error::new(ErrorKind::Usage, "the crop must lie within the image")
        .value(format!("{x},{y},{w},{h}"))
        .remedy(format!("the image is {width} x {height}; give x,y,width,height")))
}

/// Range of the side of a tile in pixels.
const EDGES: [u32; 2] = [8, 1024];

/// The side of a tile in pixels: large enough to fill a batch, small enough to distribute an image
/// over threads. A tile that holds the whole image is as large as tiles get.
pub fn tile_edge(scene: &PreparedScene, batch: usize) -> u32 {
    let pixels = batch as u64 / u64::from(scene.camera.rays_per_pixel());
    let edge = pixels.isqrt().next_multiple_of(u64::from(EDGES[0])).min(u64::from(EDGES[1])) as u32;
    let [width, height] = scene.camera.size();
    // Checkpoints have tiles of the default batch, whatever the size of the image.
    let whole = width.max(height).next_multiple_of(EDGES[0]).max(DEFAULT_BATCH.isqrt() as u32);
    edge.min(whole).max(EDGES[0])
}

/// The capacity of a batch for which up to `batch` paths are requested: at most the samples of a tile.
fn batch_size(tasks: &TaskList<'_>, batch: usize) -> usize {
    let edge = u64::from(tasks.grid.edge);
    let paths = edge * edge * u64::from(tasks.samples);
    paths.min(batch as u64) as usize
}
