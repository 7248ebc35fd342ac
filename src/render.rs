//! One render: the outer loop over tiles, and the one place where the tracer is chosen.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rayon::prelude::*;

use crate::counters::Counters;
use crate::error::{Error, ErrorKind, Result};
use crate::image::Film;
use crate::kernels::precision::Arithmetic;
use crate::plan::schedule::Flaw;
use crate::prepared::PreparedScene;
use crate::recursive::Recursive;
use crate::tile::{Tile, TraceSettings, Tracer};
use crate::variant::{self, Effects, Work};
use crate::wavefront::{DEFAULT_BATCH, Wavefront};

/// The tracers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum TracerKind {
    /// Batches of rays, pass by pass.
    #[default]
    Wavefront,
    /// Path by path, depth first.
    Recursive,
}

/// How to render. No choice here changes the image but `crop` and `seed`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderOptions {
    /// Which tracer.
    pub tracer: TracerKind,
    /// The part of the image to render; all of it if `None`.
    pub crop: Option<Tile>,
    /// Chooses the random numbers.
    pub seed: u64,
    /// Number of paths in a batch of the wavefront, at most: a batch is no larger than a tile of
    /// 64 x 64 pixels.
    pub batch: usize,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self { tracer: TracerKind::default(), crop: None, seed: 0, batch: DEFAULT_BATCH }
    }
}

/// The result of a render.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The image, or the part that was asked for.
    pub film: Film,
    /// The work done.
    pub counters: Counters,
    /// Bytes of the columns of all threads' batches.
    pub columns: u64,
    /// Seconds in each pass, summed over threads.
    pub pass_seconds: Vec<(&'static str, f64)>,
    /// Seconds from start to end.
    pub seconds: f64,
}

/// Renders `scene` on the threads of the current rayon pool. `progress` is told the number of
/// pixels done and of all pixels, from any thread.
///
/// ```
/// use wavecrest::{render, scene, systems, accel::build::Preset};
/// # fn main() -> wavecrest::error::Result<()> {
/// let json = r#"{
///     "nbounces": 0,
///     "camera": {"type": "pinhole", "width": 32, "height": 24, "fov": 60,
///                "location": [0, 0, 5], "look": [0, 0, 0]},
///     "scene": {
///         "backgroundcolor": [0, 0, 0],
///         "lightsources": [{"type": "pointlight", "intensity": 40, "position": [2, 3, 5],
///                           "color": [1, 1, 1]}],
///         "shapes": [{"type": "sphere", "center": [0, 0, 0], "radius": 1,
///                     "material": {"ks": 0.2, "kd": 0.8, "specularexponent": 20,
///                                  "diffusecolor": [1, 0, 0]}}]
///     }
/// }"#;
/// let mut loaded = scene::load::load_str(json, "ball.json".as_ref(), &Default::default())?;
/// let (prepared, _) = systems::prepare(&mut loaded.world, Preset::Fast)?;
/// let image = render::render(&prepared, &Default::default(), &|_, _| {})?;
/// let [red, green, _] = image.film.pixel(16, 12).unwrap();
/// assert!(red > 0.1 && green < red);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// When the crop is not within the image, there is no memory for the film, or the table that the plan was
/// made by does not hang together.
pub fn render(
    scene: &PreparedScene,
    options: &RenderOptions,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Rendered> {
    let schedule = scene.plan.schedule();
    if let Some(flaw) = schedule.flaw() {
        return Err(refused(flaw));
    }
    let make = variant::choose(scene.accel.geometry.precision, schedule, options.tracer);
    let start = Instant::now();
    let window = window(scene, options.crop)?;
    let film = Mutex::new(Film::new(window.width, window.height)?);
    let edge = tile_edge(scene, options.batch);
    let settings = TraceSettings { seed: options.seed, batch: batch_size(scene, options.batch) };
    // One worker a thread, made before the first ray.
    let threads = rayon::current_num_threads();
    let worker = || {
        let sums = vec![[0.0; 3]; edge as usize * edge as usize];
        Mutex::new(Worker { tracer: make(scene, &settings), sums })
    };
    let workers: Vec<_> = (0..threads).map(|_| worker()).collect();
    let all = window.len() as u64;
    let done = AtomicU64::new(0);
    tiles(&window, edge).par_iter().for_each(|tile| {
        let index = rayon::current_thread_index().unwrap_or(0) % threads;
        let mut worker = workers[index].lock().unwrap_or_else(PoisonError::into_inner);
        let Worker { tracer, sums } = &mut *worker;
        let sums = &mut sums[..tile.len()];
        sums.fill([0.0; 3]);
        tracer.render(scene, tile, sums);
        let mut film = film.lock().unwrap_or_else(PoisonError::into_inner);
        store(&mut film, &window, tile, sums, scene.camera.rays_per_pixel());
        drop(film);
        let pixels = tile.len() as u64;
        progress(done.fetch_add(pixels, Ordering::Relaxed) + pixels, all);
    });
    let film = film.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(gather(film, workers, start))
}

/// A tracer, and the sums of the tile in its hands.
struct Worker {
    tracer: Box<dyn Tracer>,
    sums: Vec<[f64; 3]>,
}

/// Makes a tracer of the variant chosen.
type Make = fn(&PreparedScene, &TraceSettings) -> Box<dyn Tracer>;

impl Work for TracerKind {
    type Output = Make;

    fn with<P: Arithmetic, E: Effects>(self) -> Make {
        match self {
            Self::Wavefront => make::<Wavefront<P, E>>,
            Self::Recursive => make::<Recursive<P, E>>,
        }
    }
}

fn make<T: Tracer + 'static>(scene: &PreparedScene, settings: &TraceSettings) -> Box<dyn Tracer> {
    Box::new(T::new(scene, settings))
}

/// A table of passes that does not hang together would give a wrong image.
fn refused(flaw: Flaw) -> Error {
    let Flaw { step, column } = flaw;
    let message = format!("the plan leaves {} without a writer or a reader", column.name());
    Error::new(ErrorKind::Usage, message)
        .at(format!("{step:?}"))
        .remedy("mend the table of passes, or use plan::schedule::PASSES")
}

/// Adds up what the tracers counted.
fn gather(film: Film, workers: Vec<Mutex<Worker>>, start: Instant) -> Rendered {
    let mut counters = Counters::default();
    let mut pass_seconds: Vec<(&'static str, f64)> = Vec::new();
    let mut columns = 0;
    for worker in workers {
        let Worker { tracer, .. } = worker.into_inner().unwrap_or_else(PoisonError::into_inner);
        counters += tracer.counters();
        columns += tracer.bytes();
        for (index, (name, seconds)) in tracer.pass_seconds().into_iter().enumerate() {
            match pass_seconds.get_mut(index) {
                Some(sum) => sum.1 += seconds,
                None => pass_seconds.push((name, seconds)),
            }
        }
    }
    Rendered { film, counters, columns, pass_seconds, seconds: start.elapsed().as_secs_f64() }
}

/// The part of the image to render.
fn window(scene: &PreparedScene, crop: Option<Tile>) -> Result<Tile> {
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
    Err(Error::new(ErrorKind::Usage, "the crop must have pixels and lie within the image")
        .value(format!("{x},{y},{w},{h}"))
        .remedy(format!("the image is {width} x {height}; give x,y,width,height")))
}

/// The side of a tile: one that fills a batch, but small enough to share an image among threads.
fn tile_edge(scene: &PreparedScene, batch: usize) -> u32 {
    let pixels = batch as u64 / u64::from(scene.camera.rays_per_pixel());
    let edge = pixels.isqrt().next_multiple_of(8);
    edge.clamp(8, 64) as u32
}

/// The number of paths that a batch can hold when up to `batch` are asked for: no more than a tile
/// has.
pub fn batch_size(scene: &PreparedScene, batch: usize) -> usize {
    let edge = u64::from(tile_edge(scene, batch));
    let paths = edge * edge * u64::from(scene.camera.rays_per_pixel());
    paths.min(batch as u64) as usize
}

/// `window` cut into squares, row by row.
fn tiles(window: &Tile, edge: u32) -> Vec<Tile> {
    let starts = |from: u32, length: u32| (0..length.div_ceil(edge)).map(move |i| from + i * edge);
    let (right, bottom) = (window.x + window.width, window.y + window.height);
    starts(window.y, window.height)
        .flat_map(|y| starts(window.x, window.width).map(move |x| (x, y)))
        .map(|(x, y)| Tile { x, y, width: edge.min(right - x), height: edge.min(bottom - y) })
        .collect()
}

/// Divides the sums by the number of samples and puts them where they belong.
fn store(film: &mut Film, window: &Tile, tile: &Tile, sums: &[[f64; 3]], samples: u32) {
    for (index, sum) in sums.iter().enumerate() {
        let (x, y) = tile.pixel(index as u32);
        let mean = sum.map(|s| (s / f64::from(samples)) as f32);
        if let Some(pixel) = film.pixel_mut(x - window.x, y - window.y) {
            *pixel = mean;
        }
    }
}
