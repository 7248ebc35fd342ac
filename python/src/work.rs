//! Renders on a worker thread, while Python's own thread waits and checks for Ctrl-C.
//!
//! If a list cannot grow, Rust aborts the process, and with it the interpreter. So the memory that a
//! render needs is requested and freed before the input is read and before the tree is built: a
//! refusal is then an error.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPool;
use wavecrest_api::components::{CameraPath, View};
use wavecrest_api::glam::DMat4;
use wavecrest_api::hecs::{Entity, World};
use wavecrest_api::memory::{Estimate, check_room, estimate, estimate_extracted, film_bytes};
use wavecrest_api::{self as api, Watch};
use wavecrest_report::accuracy::pilot::measured;
use wavecrest_report::accuracy::pilot::target::reach;

use super::input::{self, Argument};
use super::source::Source;
use super::{Error, exception};

/// The interval of checks for interrupts.
const INTERVAL: Duration = Duration::from_millis(50);

/// The largest number of threads, as for the command.
const MOST_THREADS: u16 = 4096;

/// The input and options of a render.
pub(crate) struct Job {
    pub(crate) source: Source,
    pub(crate) options: api::LoadOptions,
    pub(crate) precision: api::Precision,
    pub(crate) seed: u64,
    /// The error for which samples are chosen.
    pub(crate) target_error: Option<f64>,
    /// The place and the axes of the camera, instead of its own.
    pub(crate) pose: Option<DMat4>,
    pub(crate) layers: Vec<api::Layer>,
}

/// An image with its warnings.
pub(crate) struct Done {
    pub(crate) film: api::Film,
    pub(crate) channels: Vec<api::Channel>,
    pub(crate) warnings: Vec<api::Warning>,
}

/// Ends a render early.
#[derive(Default)]
struct Cancel(AtomicBool);

impl Watch for Cancel {
    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

impl Job {
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
        let (rendered, warning) =
            trace(&mut scene, preset, &rendering, self.target_error, &file, cancel)?;
        loaded.warnings.extend(warning);
        let (layers, seed, invalid) = (&self.layers[..], self.seed, rendered.counters.invalid);
        let request = api::LayerRequest { layers, crop: None, seed, invalid };
        let channels = api::layers(&scene, &request, cancel)?.channels;
        Ok(Done { film: rendered.film, channels, warnings: loaded.warnings })
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

/// The number of threads.
pub(crate) fn threads(argument: Argument<'_, '_>) -> PyResult<Option<u16>> {
    let what = format!("a whole number from 1 to {MOST_THREADS}");
    input::fitting(argument, &what, |threads| (1..=MOST_THREADS).contains(threads))
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
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| cannot_start(&error))
}

fn cannot_start(error: &dyn std::error::Error) -> PyErr {
    Error::new_err(format!("cannot start the threads: {error}"))
}

/// Does the job on this number of threads, one for each core if `None`.
pub(crate) fn run(py: Python<'_>, job: Job, threads: Option<u16>) -> PyResult<Done> {
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
        let worker = thread::Builder::new().spawn_scoped(scope, work);
        let worker = worker.map_err(|error| cannot_start(&error))?;
        let mut signal = Ok(());
        // A panic leaves `finished` as it is.
        while !(finished.load(Ordering::Acquire) || worker.is_finished()) {
            py.detach(|| thread::park_timeout(INTERVAL));
            signal = signal.and_then(|()| py.check_signals());
            cancel.0.store(signal.is_err(), Ordering::Relaxed);
        }
        let done = worker.join().map_err(|_| PyRuntimeError::new_err("the render panicked"))?;
        signal.and(done.map_err(|error| exception(&error)))
    })
}
