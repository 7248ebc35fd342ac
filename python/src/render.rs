//! Renders on a worker thread, while Python's own thread waits and checks for Ctrl-C.
//!
//! If a list cannot grow, Rust aborts the process, and with it the interpreter. So the memory that a
//! render needs is requested and freed once the input is read, before the tree is built: a refusal is
//! then an error.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::exceptions::{PyKeyError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use wavecrest_api::SceneOptions;
use wavecrest_api::components::{CameraPath, View};
use wavecrest_api::glam::DMat4;
use wavecrest_api::goal::{Goal, Job};
use wavecrest_api::hecs::{Entity, World};
use wavecrest_api::memory::check_room;
use wavecrest_api::session::Session;
use wavecrest_api::{self as api, Watch};

use super::arrays::Mesh;
use super::base::{Any, exception, start};
use super::input::{self, Options};
use super::shapes::tree_bytes;

/// The interval of checks for interrupts.
const INTERVAL: Duration = Duration::from_millis(50);

/// The input to render.
enum Source {
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
    fn new(kind: &str, given: &Any<'_>) -> PyResult<Self> {
        Ok(match kind {
            "file" => Self::File(given.extract()?),
            "json" => Self::Json(given.extract()?),
            "glb" => Self::Glb(given.extract()?),
            "mesh" => Self::Mesh(given.extract::<Mesh<'_>>()?.data()?),
            _ => return Err(PyKeyError::new_err(kind.to_owned())),
        })
    }

    fn load(self, options: api::LoadOptions) -> api::Result<api::LoadedScene> {
        match self {
            Self::File(path) => api::load(&path, &options),
            Self::Json(json) => api::load_str(&json, Path::new("scene"), &options),
            Self::Mesh(mesh) => api::load_mesh(mesh, Path::new("vertices and faces"), &options),
            Self::Glb(bytes) => {
                let options = api::LoadOptions { like_meshes: true, ..options };
                api::load_gltf(bytes, Path::new("scene"), &options)
            }
        }
    }
}

/// The input and options of a render.
struct Task {
    source: Source,
    options: api::LoadOptions,
    precision: api::Precision,
    /// What becomes of the light.
    develop: api::Develop,
    rendering: api::RenderOptions,
    /// By what the samples of a pixel are chosen, unless they are those of the scene.
    goal: Option<Goal>,
    /// The place and the axes of the camera, instead of its own.
    pose: Option<DMat4>,
    layers: Vec<api::Layer>,
}

/// An image, the channels of its layers, and warnings.
type Image = (api::Film, Vec<api::Channel>, Vec<api::Warning>);

/// Ends a render on an interrupt.
struct Until<'a>(&'a AtomicBool);

impl Watch for Until<'_> {
    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

impl Task {
    /// The arguments of wavecrest.render.
    fn new(kind: &str, source: &Any<'_>, given: &Options<'_>) -> PyResult<Self> {
        let start = Instant::now();
        let options = given.loading()?;
        let pose = given.get::<[[f64; 4]; 4]>("pose")?;
        let pose = pose.map(|rows| DMat4::from_cols_array_2d(&rows).transpose());
        let error = given.get("target_error")?;
        let seconds: Option<f64> = given.get("time_budget")?;
        let samples = given.get("samples")?;
        let goal = Goal { error, seconds: seconds.map(|seconds| (seconds, start)), samples };
        let goal = Some(goal).filter(|_| error.or(seconds).is_some());
        let layers: Vec<String> = given.get("layers")?.unwrap_or_default();
        let layers = layers.iter().map(|name| input::named("layers", name));
        let mut layers = layers.collect::<PyResult<Vec<_>>>()?;
        if options.lighting.background == Some(api::Background::Transparent) {
            layers.push(api::Layer::Alpha);
        }
        let precision = given.named("precision")?.unwrap_or_default();
        let develop = api::Develop {
            exposure: given.get("exposure")?.unwrap_or_default(),
            tone: given.named("tone")?.unwrap_or_default(),
        };
        let source = Source::new(kind, source)?;
        let seed = given.get("seed")?.unwrap_or_default();
        let rendering = api::RenderOptions { seed, ..Default::default() };
        Ok(Self { source, options, precision, develop, rendering, goal, pose, layers })
    }

    fn run(self, cancel: &AtomicBool) -> api::Result<Image> {
        let Self { source, options, precision, develop, rendering, goal, pose, layers } = self;
        let mut loaded = source.load(options)?;
        if let Some(pose) = pose {
            place_camera(&mut loaded.world, pose);
        }
        let exposure = develop.factor();
        let options = SceneOptions { precision, exposure, ..SceneOptions::default() };
        let is_developed = develop != api::Develop::default();
        let mut session = Session::of(loaded, &options, |extracted| {
            let pixels: u64 = extracted.scene().camera.size().map(u64::from).iter().product();
            let film = pixels * size_of::<[f32; 3]>() as u64 * (1 + u64::from(is_developed));
            check_room(tree_bytes(extracted.geometry().held()) + film, "the render")
        })?;
        let until = &Until(cancel);
        let seed = rendering.seed;
        let scene = &mut session.scene;
        let channels =
            |scene: &api::PreparedScene, invalid, crop| -> api::Result<Vec<api::Channel>> {
                let request = api::LayerRequest { layers: &layers, crop, seed, invalid };
                Ok(api::layers(scene, &request, until)?.channels)
            };
        let rendered = match goal {
            None => api::render(scene, &rendering, until)?,
            Some(goal) => {
                let ending = |scene: &api::PreparedScene, film: &api::Film, height| {
                    let (start, y) = (Instant::now(), (film.height() - height) / 2);
                    channels(scene, 0, Some(api::Tile { x: 0, y, width: film.width(), height }))?;
                    Ok([start.elapsed().as_secs_f64(), 0.0])
                };
                let passes = Goal::passes(scene, rendering, Default::default())?;
                let job = Job { ending: &ending, ..Job::new(until) };
                let reached = goal.render(scene, &passes, &job)?;
                session.warnings.extend(goal.unreached(&reached, &session.file));
                reached.rendered
            }
        };
        let channels = channels(scene, rendered.counters.invalid, None)?;
        let film = if is_developed {
            let alpha = channels.iter().find_map(|channel| match &channel.values {
                api::Values::Floats(all) if channel.name == api::Layer::Alpha.channels()[0] => {
                    Some(&all[..])
                }
                _ => None,
            });
            develop.film(&rendered.film, alpha)
        } else {
            rendered.film
        };
        Ok((film, channels, session.warnings))
    }
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

/// Does the job on the number of threads that is given, or else one for each core.
fn wait_for(py: Python<'_>, job: Task, options: &Options<'_>) -> PyResult<Image> {
    let pool = start(options.get("threads")?.unwrap_or(0))?;
    let cancel = Arc::new(AtomicBool::new(false));
    let (sender, mut image) = channel();
    let is_cancelled = Arc::clone(&cancel);
    pool.spawn(move || drop(sender.send(job.run(&is_cancelled))));
    let mut signal = Ok(());
    loop {
        let waiting = &mut image;
        match py.detach(move || waiting.recv_timeout(INTERVAL)) {
            Ok(image) => return signal.and(image.map_err(exception)),
            Err(RecvTimeoutError::Timeout) => signal = signal.and_then(|()| py.check_signals()),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the render panicked"));
            }
        }
        cancel.store(signal.is_err(), Ordering::Relaxed);
    }
}

/// An image, (height, width, 3), the names of layers, each with its channels, (height, width), and warnings.
type Arrays<'py> = (Any<'py>, Vec<(&'static str, Vec<Any<'py>>)>, Vec<String>);

/// Renders the source, of a kind as in [`Source`], with the arguments of wavecrest.render by name.
#[pyfunction]
pub(crate) fn render<'py>(
    py: Python<'py>,
    kind: &str,
    source: &Any<'py>,
    options: Bound<'py, PyDict>,
) -> PyResult<Arrays<'py>> {
    let options = Options(options);
    let job = Task::new(kind, source, &options)?;
    let layers = job.layers.clone();
    let (film, channels, warnings) = wait_for(py, job, &options)?;
    let size = [film.height(), film.width()].map(|side| side as usize);
    let image = film.into_pixels().into_flattened().into_pyarray(py);
    let image = image.reshape([size[0], size[1], 3])?.into_any();
    let mut channels = channels.into_iter().map(|channel| match channel.values {
        api::Values::Floats(all) => Ok(all.into_pyarray(py).reshape(size)?.into_any()),
        api::Values::Integers(all) => Ok(all.into_pyarray(py).reshape(size)?.into_any()),
    });
    let layers = api::Layer::ALL.into_iter().filter(|layer| layers.contains(layer)).map(|layer| {
        let own: PyResult<_> = channels.by_ref().take(layer.channels().len()).collect();
        Ok((layer.name(), own?))
    });
    let warnings = warnings.iter().map(ToString::to_string).collect();
    Ok((image, layers.collect::<PyResult<_>>()?, warnings))
}
