//! Choices that must not change an image: BVH preset, tracer, batch size, kernel, instruction
//! level, threads. Each is tested, and must change the error by exactly 0.

use super::reference::Reference;
use super::setting::{Setting, Structure};
use super::store::{NeutralRecord, Record, Store, all};
use super::subject::Subject;
use super::sweep::Progress;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::math::simd::Level;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, TracerKind, render};
use wavecrest_core::wavefront::DEFAULT_BATCH;
use wavecrest_image::compare::compare;

/// A choice to test.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Knob {
    Preset(Preset),
    Tracer(TracerKind),
    Batch(usize),
    Kernel(KernelChoice),
    Level(Level),
    Threads(usize),
}

/// Largest number of primitives for which brute force is tested.
const MOST_BRUTE: u64 = 1000;

impl Knob {
    /// All choices for a scene with this number of primitives.
    fn all(primitives: u64) -> Vec<Self> {
        let presets =
            Preset::ALL.into_iter().filter(|&p| p != Preset::Brute || primitives <= MOST_BRUTE);
        let batches = [DEFAULT_BATCH / 8, DEFAULT_BATCH / 2 + 1, 4 * DEFAULT_BATCH];
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let mut threads = vec![1, 2, 3, cores];
        threads.sort_unstable();
        threads.dedup();
        let mut all: Vec<Self> = presets.map(Self::Preset).collect();
        all.extend([TracerKind::Wavefront, TracerKind::Recursive].map(Self::Tracer));
        all.extend(batches.map(Self::Batch));
        all.extend(KernelChoice::ALL.map(Self::Kernel));
        all.extend(Level::available().iter().copied().map(Self::Level));
        all.extend(threads.into_iter().map(Self::Threads));
        all
    }

    /// Its name and value.
    fn words(self) -> (&'static str, String) {
        match self {
            Self::Preset(preset) => ("BVH preset", preset.name().to_owned()),
            Self::Tracer(TracerKind::Wavefront) => ("tracer", "wavefront".to_owned()),
            Self::Tracer(TracerKind::Recursive) => ("tracer", "recursive".to_owned()),
            Self::Batch(paths) => ("batch", paths.to_string()),
            Self::Kernel(kernel) => ("kernel", kernel.name().to_owned()),
            Self::Level(level) => ("instructions", level.name().to_owned()),
            Self::Threads(threads) => ("threads", threads.to_string()),
        }
    }
}

/// Tests every choice on the scene, unless done already.
///
/// # Errors
/// If the scene can no longer be rendered, or a record cannot be written.
pub fn run(
    subject: &mut Subject,
    reference: Option<&Reference>,
    store: &mut Store,
    progress: &dyn Progress,
) -> Result<()> {
    let Some(reference) = reference else { return Ok(()) };
    let name = subject.name();
    let knobs = Knob::all(subject.primitives());
    progress.stage(&format!("{name}: settings that must not change the image"), knobs.len() as u64);
    let usual = subject.render(&Setting::default(), &RenderOptions::default())?;
    let usual_error = compare(&usual.film, &reference.film)?.rmse;
    for knob in knobs {
        let (what, value) = knob.words();
        let is_it = |n: &NeutralRecord| n.scene == name && n.knob == what && n.value == value;
        if !all(&store.records).any(is_it) {
            let rendered = turned(subject, knob)?;
            let error = compare(&rendered.film, &reference.film)?.rmse;
            store.add(Record::Neutral(NeutralRecord {
                scene: name.clone(),
                knob: what.to_owned(),
                value,
                seconds: rendered.seconds,
                error_change: error - usual_error,
                equal: rendered.film.same_bits(&usual.film),
            }))?;
        }
        progress.step();
    }
    Ok(())
}

/// The scene rendered with one choice changed.
fn turned(subject: &mut Subject, knob: Knob) -> Result<Rendered> {
    let structure = Structure::default();
    let mut options = RenderOptions::default();
    if let Knob::Preset(preset) = knob {
        return render(&subject.build(&structure, preset)?.scene, &options, &());
    }
    let prepared = subject.prepare(&structure)?;
    prepared.scene.resample(&prepared.original, &Setting::default().samples);
    let scene = &mut prepared.scene;
    let (kernel, level) = (scene.accel.kernel, scene.accel.level);
    match knob {
        Knob::Tracer(tracer) => options.tracer = tracer,
        Knob::Batch(batch) => options.batch = batch,
        Knob::Kernel(kernel) => scene.accel.kernel = kernel,
        Knob::Level(level) => {
            if let Some(token) = level.token() {
                scene.accel.level = token;
            }
        }
        Knob::Threads(threads) => return on_threads(threads, scene, &options),
        Knob::Preset(_) => {}
    }
    let rendered = render(scene, &options, &());
    (scene.accel.kernel, scene.accel.level) = (kernel, level);
    rendered
}

fn on_threads(threads: usize, scene: &PreparedScene, options: &RenderOptions) -> Result<Rendered> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| {
        Error::new(ErrorKind::Usage, format!("cannot start {threads} threads: {e}"))
    })?;
    pool.install(|| render(scene, options, &()))
}
