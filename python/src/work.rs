//! Renders on a worker thread, while Python's own thread waits and checks for Ctrl-C.
//!
//! If a list cannot grow, Rust aborts the process, and with it the interpreter. So the memory that a
//! render needs is requested and freed before the input is read and before the tree is built: a
//! refusal is then an error.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use numpy::PyReadonlyArray2;
use pyo3::exceptions::{PyKeyError, PyRuntimeError};
use pyo3::prelude::*;
use rayon::ThreadPool;
use wavecrest_api::components::{CameraPath, View};
use wavecrest_api::glam::DMat4;
use wavecrest_api::hecs::{Entity, World};
use wavecrest_api::memory::{Estimate, check_room, estimate, estimate_extracted, film_bytes};
use wavecrest_api::{self as api, Watch};
use wavecrest_report::accuracy::pilot::budget::{Budget, Overhead, Pace, in_time};
use wavecrest_report::accuracy::pilot::measured;
use wavecrest_report::accuracy::pilot::target::reach;
use wavecrest_report::accuracy::setting::{Axis, Facts};

use super::arrays::{self, vectors};
use super::input::{self, Options};
use super::{Any, Error, exception};

/// The interval of checks for interrupts.
const INTERVAL: Duration = Duration::from_millis(50);

/// The largest number of threads, as for the command.
const MOST_THREADS: u16 = 4096;

/// The input to render.
pub(crate) enum Source {
    /// A scene file, a glTF file or a mesh.
    File(PathBuf),
    /// A scene as JSON, with paths relative to the current folder.
    Json(String),
    /// A mesh as arrays.
    Mesh(api::MeshData),
    /// A GLB file with a scene of trimesh, or with a mesh of it that has colours or a material.
    Glb(Vec<u8>),
}

impl Source {
    /// What is `given` of this kind: for a mesh as [`arrays::mesh`] takes it, with the `options` normals and colors.
    fn new((kind, given): (&str, &Any<'_>), options: &Options<'_>) -> PyResult<Self> {
        Ok(match kind {
            "file" => Self::File(given.extract()?),
            "json" => Self::Json(given.extract()?),
            "glb" => Self::Glb(given.extract()?),
            "mesh" => {
                let mut mesh = arrays::mesh(given.extract()?)?;
                let read = |_: &str, value: &Any<'_>| {
                    vectors(&value.extract::<PyReadonlyArray2<'_, f32>>()?)
                };
                let normals = options.get("normals", read)?;
                mesh.normals = normals.map(|values| api::Attribute { values, indices: None });
                mesh.colors = options.get("colors", read)?;
                Self::Mesh(mesh)
            }
            _ => return Err(PyKeyError::new_err(kind.to_owned())),
        })
    }
}

/// The input and options of a render.
pub(crate) struct Job {
    pub(crate) source: Source,
    pub(crate) options: api::LoadOptions,
    pub(crate) precision: api::Precision,
    pub(crate) seed: u64,
    /// The error for which samples are chosen.
    pub(crate) target_error: Option<f64>,
    /// The seconds within which to render, and when they begin.
    pub(crate) time_budget: Option<(f64, Instant)>,
    /// The place and the axes of the camera, instead of its own.
    pub(crate) pose: Option<DMat4>,
    pub(crate) layers: Vec<api::Layer>,
}

/// An image, the channels of its layers, and warnings.
pub(crate) type Done = (api::Film, Vec<api::Channel>, Vec<api::Warning>);

/// Ends a render early.
#[derive(Default)]
struct Cancel(AtomicBool);

impl Watch for Cancel {
    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// As [`Cancel`], and ends a render that is too slow.
struct Paced<'a>(&'a Cancel, &'a Pace<'a>);

impl Watch for Paced<'_> {
    fn progress(&self, done: u64, all: u64) {
        self.1.progress(done, all);
    }

    fn cancelled(&self) -> bool {
        self.0.cancelled() || self.1.is_late()
    }
}

impl Job {
    /// The arguments of wavecrest.render.
    pub(crate) fn new(source: (&str, &Any<'_>), given: &Options<'_>) -> PyResult<Self> {
        let what = "a whole number from 0 to 2^64 - 1";
        let seed = given.fitting("seed", what, |_| true)?.unwrap_or_default();
        let goal = |key| {
            let is_positive = |number: &f64| number.is_finite() && *number > 0.0;
            given.fitting(key, "a finite number above 0", is_positive)
        };
        let (target_error, seconds) = (goal("target_error")?, goal("time_budget")?);
        let time_budget = seconds.map(|seconds| (seconds, Instant::now()));
        let (options, pose) = given.loading()?;
        match (target_error, time_budget, options.antialias) {
            (Some(_), _, Some(_)) => Err("samples: leave it out, or target_error"),
            (_, Some(_), Some(_)) => Err("samples: leave it out, or time_budget"),
            (Some(_), Some(_), _) => Err("time_budget: leave it out, or target_error"),
            _ => Ok(()),
        }
        .map_err(Error::new_err)?;
        let mut layers = given.get("layers", input::all_named)?.unwrap_or_default();
        if options.lighting.background == Some(api::Background::Transparent) {
            layers.push(api::Layer::Alpha);
        }
        let precision = given.get("precision", input::named)?.unwrap_or_default();
        let source = Source::new(source, given)?;
        Ok(Self { source, options, precision, seed, target_error, time_budget, pose, layers })
    }

    /// What the input contains; `None` for text, and for a file that can be read only once.
    fn survey(&self) -> api::Result<Option<api::Survey>> {
        match &self.source {
            Source::File(path) if path.is_file() => {
                api::survey(path, &self.options, false).map(Some)
            }
            Source::Mesh(mesh) => api::survey_mesh(mesh, &self.options).map(Some),
            _ => Ok(None),
        }
    }

    fn run(self, cancel: &Cancel) -> api::Result<Done> {
        let rendering = api::RenderOptions { seed: self.seed, ..Default::default() };
        if let Some(survey) = self.survey()? {
            let images = [film_bytes(survey.size.map(u64::from).iter().product()), 0];
            let estimated = estimate(&survey, images, api::Preset::Fast, rendering.batch);
            check_room(estimated.total(), "the render")?;
        }
        let mut loaded = match self.source {
            Source::File(path) => api::load(&path, &self.options),
            Source::Json(json) => api::load_str(&json, Path::new("scene"), &self.options),
            Source::Mesh(mesh) => {
                api::load_mesh(mesh, Path::new("vertices and faces"), &self.options)
            }
            Source::Glb(bytes) => {
                let options = api::LoadOptions { like_meshes: true, ..self.options };
                api::load_gltf(bytes, Path::new("scene"), &options)
            }
        }?;
        if let Some(pose) = self.pose {
            place_camera(&mut loaded.world, pose);
        }
        let options = api::ExtractOptions { precision: self.precision, ..Default::default() };
        let extracted = api::extract(loaded.world, options)?;
        let (preset, file) = (extracted.preset(), extracted.file().to_owned());
        let estimated = estimate_extracted(&extracted, preset, rendering.batch);
        // These parts are in memory by now.
        let more = Estimate { geometry: 0, program: 0, loading: 0, ..estimated };
        check_room(more.total(), "the render")?;
        let mut scene = extracted.build(preset);
        loaded.warnings.extend(api::warnings(&scene, &file));
        let (rendered, warning) = match self.time_budget {
            Some(budget) => (trace_within(&mut scene, &rendering, budget, cancel)?, None),
            None => trace(&mut scene, preset, &rendering, self.target_error, &file, cancel)?,
        };
        loaded.warnings.extend(warning);
        let (layers, seed, invalid) = (&self.layers[..], self.seed, rendered.counters.invalid);
        let request = api::LayerRequest { layers, crop: None, seed, invalid };
        let channels = api::layers(&scene, &request, cancel)?.channels;
        Ok((rendered.film, channels, loaded.warnings))
    }
}

/// Renders `scene`, whose tree has `preset`, with its own samples or those for an error; the warning
/// says that it is not reached.
fn trace(
    scene: &mut api::PreparedScene,
    mut preset: api::Preset,
    rendering: &api::RenderOptions,
    target_error: Option<f64>,
    file: &Path,
    cancel: &Cancel,
) -> api::Result<(api::Rendered, Option<api::Warning>)> {
    let render = |scene: &api::PreparedScene| api::render(scene, rendering, cancel);
    if let Some(target) = target_error {
        let aim = (target, rendering.seed);
        let reached = reach(scene, Some(&mut preset), aim, cancel, |scene, _| {
            let rendered = render(scene)?;
            let found = measured(scene, &rendered, rendering.seed, cancel)?;
            Ok((rendered, found))
        })?;
        if let Some(reached) = reached {
            let warning = reached.unreached(target, file);
            return Ok((reached.rendered, warning));
        }
    }
    Ok((render(scene)?, None))
}

/// Renders `scene` with as many samples as fit into so many seconds from `start` on.
fn trace_within(
    scene: &mut api::PreparedScene,
    rendering: &api::RenderOptions,
    (seconds, start): (f64, Instant),
    cancel: &Cancel,
) -> api::Result<api::Rendered> {
    let clock = || start.elapsed().as_secs_f64();
    let pixels: f64 = scene.camera.size().map(f64::from).iter().product();
    let budget = Budget::new(&clock, seconds, pixels);
    let in_flight = (rendering.batch * rayon::current_num_threads()) as f64 / pixels;
    let overhead = Overhead { measuring: 0.0, in_flight };
    let (original, axis) = (scene.original(), Axis::of(&Facts::of(scene)));
    let (choice, rendered, _) = in_time(axis, &budget, overhead, |choice, pace| {
        scene.resample(&original, &choice.samples());
        let watch = Paced(cancel, pace);
        let rendered = api::render_in_order(scene, rendering, &watch, api::Order::Spread)?;
        let is_finished = rendered.finished;
        Ok((rendered, is_finished))
    })?;
    scene.resample(&original, &choice.samples());
    Ok(rendered)
}

/// Puts the camera at another place, where it stays.
fn place_camera(world: &mut World, pose: DMat4) {
    let mut cameras = Vec::new();
    for (entity, view) in world.query_mut::<(Entity, &mut View)>() {
        let [y, z, place] = [pose.y_axis, pose.z_axis, pose.w_axis].map(|axis| axis.truncate());
        (view.location, view.look, view.up) = (place, place - z.normalize_or_zero(), y);
        cameras.push(entity);
    }
    cameras.into_iter().for_each(|camera| drop(world.remove_one::<CameraPath>(camera)));
}

/// The threads of queries of rays, which stay. Those of a parent process do not run in one that was
/// forked from it, which gets its own.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The threads of queries, one for each core.
pub(crate) fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut known = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    match &*known {
        Some((owner, pool)) if *owner == process => Ok(Arc::clone(pool)),
        _ => {
            let pool = Arc::new(start(0)?);
            // Threads of another process cannot be told to end.
            std::mem::forget(known.replace((process, Arc::clone(&pool))));
            Ok(pool)
        }
    }
}

/// This number of threads, one for each core if 0.
fn start(threads: usize) -> PyResult<ThreadPool> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(cannot_start)
}

fn cannot_start(error: impl std::error::Error) -> PyErr {
    Error::new_err(format!("cannot start the threads: {error}"))
}

/// Does the job on the number of threads that is given, or else one for each core.
pub(crate) fn run(py: Python<'_>, job: Job, options: &Options<'_>) -> PyResult<Done> {
    let what = format!("a whole number from 1 to {MOST_THREADS}");
    let fits = |threads: &u16| (1..=MOST_THREADS).contains(threads);
    let threads = options.fitting("threads", &what, fits)?;
    let pool = start(threads.map_or(0, usize::from))?;
    let (cancel, waiting, finished) =
        (Cancel::default(), thread::current(), AtomicBool::new(false));
    thread::scope(|scope| {
        let work = || {
            let done = pool.install(|| job.run(&cancel));
            finished.store(true, Ordering::Release);
            waiting.unpark();
            done
        };
        let worker = thread::Builder::new().spawn_scoped(scope, work).map_err(cannot_start)?;
        let mut signal = Ok(());
        // A panic leaves `finished` as it is.
        while !(finished.load(Ordering::Acquire) || worker.is_finished()) {
            py.detach(|| thread::park_timeout(INTERVAL));
            signal = signal.and_then(|()| py.check_signals());
            cancel.0.store(signal.is_err(), Ordering::Relaxed);
        }
        let done = worker.join().map_err(|_| PyRuntimeError::new_err("the render panicked"))?;
        signal.and(done.map_err(exception))
    })
}
