//! `render`: a scene in, an image out.

use std::path::{Path, PathBuf};
use std::time::Instant;

mod frames;
mod goal;
mod outputs;
mod parts;
mod show;

use frames::FrameOptions;
use goal::Traced;
pub(crate) use outputs::OutputOptions;
use outputs::Outputs;
use parts::PartOptions;
pub(crate) use show::ShowOptions;
use show::{Reporter, Stage};

use super::common::{SceneOptions, SearchOptions, above_zero, crop, tell, to_json};
use super::interrupt::Interrupt;
use super::metadata::command;
use crate::choice::choice;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{check_differs, check_replaceable, replace_file, write_error};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::counters::Counters;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::probe::{self, Invalid};
use wavecrest_core::render::{RenderOptions, Rendered, TracerKind};
use wavecrest_core::tile::Tile;
use wavecrest_core::wavefront::DEFAULT_BATCH;
use wavecrest_image::farm::Shard;
use wavecrest_image::write::Transfer;
use wavecrest_report::estimate::Estimated;
use wavecrest_report::statistics::{Bvh, Columns, ImageSize, Memory, Statistics, Time, pass_map};
use wavecrest_scene::memory::{self, Estimate};
use wavecrest_scene::systems;

/// Renders a scene to an image.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct RenderArgs {
    /// The scene: JSON, glTF (.gltf, .glb), or a mesh alone (.ply, .obj)
    pub(crate) scene: PathBuf,
    /// The image to write: .ppm, .png, .exr or .pfm; for a shard, .part
    #[arg(value_name = "OUTPUT", required_unless_present = "output")]
    pub(crate) image: Option<PathBuf>,
    /// The image to write, named as an option
    #[arg(short, long, value_name = "OUTPUT", conflicts_with = "image")]
    pub(crate) output: Option<PathBuf>,
    /// How to trace; the image is the same
    #[arg(long, value_parser = choice::<TracerKind>(), default_value_t)]
    pub(crate) tracer: TracerKind,
    /// Render only this part of the image, in pixels from the top left
    #[arg(long, value_name = "X,Y,WIDTH,HEIGHT", value_parser = crop)]
    pub(crate) crop: Option<Tile>,
    /// Choose other random numbers
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Paths in a batch of the wavefront; the image is the same
    #[arg(long, value_name = "PATHS", default_value_t = DEFAULT_BATCH as u32,
          value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(crate) batch: u32,
    /// How the tree is searched
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    /// Write no image if a sample is not finite, but say which; without this it counts as black
    #[arg(long)]
    pub(crate) trap_invalid: bool,
    /// How linear colours become 8-bit levels (.ppm, .png) [default: linear for scenes in JSON, srgb for
    /// glTF files and meshes]
    #[arg(long, value_parser = choice::<Transfer>())]
    pub(crate) transfer: Option<Transfer>,
    /// What is written
    #[command(flatten)]
    pub(crate) outputs: OutputOptions,
    /// What is seen of it
    #[command(flatten)]
    pub(crate) show: ShowOptions,
    /// Choose sampler and samples for this error, the root mean square of linear values
    #[arg(long, value_name = "ERROR", value_parser = above_zero, conflicts_with_all = ["crop", "time_budget"])]
    pub(crate) target_error: Option<f64>,
    /// Choose sampler and samples for this many seconds from start to end
    #[arg(long, value_name = "SECONDS", value_parser = above_zero, conflicts_with = "crop")]
    pub(crate) time_budget: Option<f64>,
    /// Write statistics as JSON
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,
    /// What is kept, and which share is rendered
    #[command(flatten)]
    pub(crate) parts: PartOptions,
    /// Which frames of a camera that moves
    #[command(flatten)]
    pub(crate) frames: FrameOptions,
    /// What is read and how
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
}

impl RenderArgs {
    fn options(&self) -> RenderOptions {
        let batch = self.batch as usize;
        RenderOptions { tracer: self.tracer, crop: self.crop, seed: self.seed, batch }
    }

    fn output(&self) -> Result<&PathBuf> {
        self.output.as_ref().or(self.image.as_ref()).ok_or_else(|| {
            Error::new(ErrorKind::Usage, "no image to write is named")
                .remedy("name one, such as out.png")
        })
    }
}

/// Renders as the arguments say. Nothing is written over before the new image is whole.
///
/// # Errors
/// When the scene cannot be loaded or prepared, or the image cannot be written.
pub(crate) fn run(args: &RenderArgs) -> Result<()> {
    let output = args.output()?;
    let shard = args.parts.shard()?;
    if let Some(frames) = args.frames.frames {
        return frames::run(args, frames, shard);
    }
    args.parts.check(args, output)?;
    let outputs = Outputs::check(args, output, shard.is_some())?;
    if let Some(stats) = &args.stats {
        check_replaceable(stats)?;
        outputs.check_apart(stats)?;
        check_differs(stats, &args.scene, "the scene")?;
    }
    if let Some(log) = &args.show.log {
        outputs.check_apart(log)?;
        check_differs(log, &args.scene, "the scene")?;
    }
    let reporter = Reporter::begin(args)?;
    let done = args.scene_options.threads.run(|| run_here(args, &outputs, &reporter, shard));
    done.inspect_err(|error| reporter.failed(error))
}

/// Where a render can be seen, while it is made and afterwards, and what ends it early.
struct Seen<'a> {
    outputs: &'a Outputs<'a>,
    reporter: &'a Reporter,
    interrupt: &'a Interrupt,
}

fn run_here(
    args: &RenderArgs,
    outputs: &Outputs<'_>,
    reporter: &Reporter,
    shard: Option<Shard>,
) -> Result<()> {
    let start = Instant::now();
    let mut time = Time::default();
    reporter.started(args, &command(std::env::args_os()));
    reporter.stage(Stage::Load);
    let pixels = args.crop.map(|crop| crop.len() as u64);
    let options = &args.scene_options;
    let estimated = match &args.stats {
        Some(_) => Some(options.estimate(&args.scene, pixels, args.batch as usize)?),
        None => None,
    };
    let loaded = options.load(&args.scene)?;
    reporter.warnings(&loaded.warnings);
    outputs.made_of(loaded.encoding);
    let extracted = args.scene_options.extract(loaded)?;
    let preset = args.scene_options.bvh.unwrap_or_else(|| extracted.preset());
    let pixels = pixels.unwrap_or_else(|| extracted.pixels());
    let mut predicted = memory::estimate_extracted(&extracted, pixels, preset, args.batch as usize);
    predicted.film += args.parts.kept_bytes(pixels);
    time.load = start.elapsed().as_secs_f64();
    reporter.loaded(&extracted, time.load);
    reporter.stage(Stage::Build);
    let file = extracted.file().to_owned();
    let mut scene = timed(&mut time.build, || extracted.build(preset));
    let dropped = systems::warnings(scene.dropped, &file);
    args.scene_options.warn(&dropped);
    reporter.warnings(&dropped);
    reporter.built(args, &scene, preset, time.build);
    args.search.apply(&mut scene.accel);
    if let Some(frame) = args.frames.frame {
        frames::place(&mut scene, frame, &args.scene)?;
    }
    // Until here there was nothing to lose: a signal ended the process.
    let interrupt = &Interrupt::listen()?;
    let seen = &Seen { outputs, reporter, interrupt };
    if let Some(shard) = shard {
        return parts::write_shard(args, shard, &scene, seen);
    }
    let traced = timed(&mut time.trace, || goal::trace(args, &mut scene, preset, seen, start))?;
    let Traced { rendered, preset, goal, resumed } = traced;
    reporter.traced(&rendered, time.trace);
    if !rendered.finished {
        return Err(parts::interrupted(args, &scene, &rendered, seen));
    }
    let invalid = find_invalid(args, &scene, &rendered.counters)?;
    reporter.stage(Stage::Write);
    timed(&mut time.write, || outputs.write(&scene, &rendered))?;
    time.total = start.elapsed().as_secs_f64();
    time.passes = pass_map(&rendered.pass_seconds);
    reporter.wrote(outputs.paths(), &time);
    reporter.stage(Stage::Done);
    tell_invalid(args, &rendered.counters, invalid.as_ref());
    match &args.stats {
        Some(file) => {
            let mut statistics = statistics(args, &scene, preset, &rendered, time, predicted);
            (statistics.first_invalid, statistics.goal) = (invalid, goal);
            statistics.resumed = resumed;
            statistics.memory.predicted = estimated.map_or(0, |estimated| estimated.total());
            write_statistics(file, &statistics)
        }
        None => Ok(()),
    }
}

/// The first sample that was not finite.
///
/// # Errors
/// When there is one, and none is to be there.
fn find_invalid(
    args: &RenderArgs,
    scene: &PreparedScene,
    counters: &Counters,
) -> Result<Option<Invalid>> {
    let first = counters.first_invalid;
    let invalid = first.map(|sample| probe::name_invalid(scene, sample, args.seed));
    match invalid {
        Some(invalid) if args.trap_invalid => Err(trapped(args, &invalid)),
        invalid => Ok(invalid),
    }
}

fn tell_invalid(args: &RenderArgs, counters: &Counters, first: Option<&Invalid>) {
    if let (Some(first), false) = (first, args.scene_options.quiet) {
        let count = counters.invalid;
        tell(&format!(
            "warning: {count} samples were not finite and count as black: first {first}"
        ));
    }
}

fn trapped(args: &RenderArgs, invalid: &Invalid) -> Error {
    let Invalid { x, y, .. } = invalid;
    let scene = args.scene.display();
    Error::new(ErrorKind::Scene, "a sample is not finite")
        .in_file(&args.scene)
        .at(&invalid.shape)
        .value(invalid)
        .remedy(format!("look at it with: wavecrest probe {scene} --pixel {x},{y}"))
}

/// Runs `work` and notes its seconds.
fn timed<R>(seconds: &mut f64, work: impl FnOnce() -> R) -> R {
    let start = Instant::now();
    let result = work();
    *seconds = start.elapsed().as_secs_f64();
    result
}

fn statistics(
    args: &RenderArgs,
    scene: &PreparedScene,
    preset: Preset,
    rendered: &Rendered,
    time: Time,
    predicted: Estimate,
) -> Statistics {
    let counters = &rendered.counters;
    let pixels = rendered.film.pixels().len() as u64;
    let has_columns = args.tracer == TracerKind::Wavefront;
    Statistics {
        version: env!("CARGO_PKG_VERSION"),
        scene: args.scene.display().to_string(),
        tracer: args.tracer,
        threads: rayon::current_num_threads(),
        seed: args.seed,
        simd: args.search.simd,
        kernel: args.search.kernel,
        precision: args.scene_options.precision,
        image: ImageSize {
            width: rendered.film.width(),
            height: rendered.film.height(),
            samples_per_pixel: scene.camera.rays_per_pixel(),
        },
        rays: counters.into(),
        samples: counters.into(),
        estimated: Estimated::of(scene, pixels),
        tests: counters.into(),
        kernels: counters.into(),
        dropped: scene.dropped,
        invalid: counters.invalid,
        first_invalid: None,
        lights_at_surface: counters.lights_at_surface,
        time,
        memory: Memory { predicted: predicted.total(), peak: memory::peak() },
        columns: Columns {
            estimated: if has_columns { predicted.batches } else { 0 },
            held: rendered.columns,
        },
        bvh: Bvh::of(&scene.accel, preset),
        goal: None,
        resumed: 0.0,
        plan: scene.plan.clone(),
    }
}

fn write_statistics(file: &Path, statistics: &Statistics) -> Result<()> {
    use std::io::Write as _;
    let json = to_json(statistics)?;
    replace_file(file, |sink| sink.write_all(json.as_bytes()).map_err(|e| write_error(file, e)))
}
