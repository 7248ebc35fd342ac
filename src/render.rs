//! `render`: renders a scene to an image.

mod args;
mod frames;
mod goal;
mod held;
mod invalid;
mod look;
mod outputs;
mod parts;
mod show;
mod sides;
mod statistics;
mod summary;

use std::time::Instant;

pub(crate) use args::RenderArgs;
use goal::Traced;
use outputs::Outputs;
use show::stage::Stage;
use show::{Reporter, Seen};
use statistics::Finished;
use summary::Summary;

use super::common::warn;
use super::interrupt::Interrupt;
use super::metadata::command;
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_image::farm::Shard;
use wavecrest_report::statistics::{Time, pass_map};
use wavecrest_scene::memory::Estimate;
use wavecrest_scene::systems::{self, Extracted};

/// Runs the render. Nothing is overwritten before the new image is complete.
///
/// # Errors
/// If the scene cannot be loaded or prepared, or the image cannot be written.
pub(crate) fn run(args: &RenderArgs) -> Result<()> {
    args.search.check(args.scene_options.precision)?;
    let args = &look::without_ground(args.clone());
    let output = args.output()?;
    let shard = args.parts.shard()?;
    if let Some(frames) = args.frames.frames {
        return frames::run(args, frames, shard);
    }
    if sides::run(args, shard)? {
        return Ok(());
    }
    parts::check(args, output)?;
    look::check(args)?;
    let outputs = Outputs::check(args, output, shard.is_some())?;
    let reporter = Reporter::begin(args)?;
    let done = args.scene_options.threads.run(|| Run::new(args, &outputs, &reporter).all(shard));
    done.inspect_err(|error| reporter.failed(error))
}

/// A render in progress.
struct Run<'a> {
    args: &'a RenderArgs,
    outputs: &'a Outputs<'a>,
    reporter: &'a Reporter,
    start: Instant,
    /// The seconds of its stages so far.
    time: Time,
}

/// A loaded scene without a tree.
struct Loaded {
    extracted: Extracted,
    /// The preset of its tree.
    preset: Preset,
    /// The estimated memory before it was read, for the statistics.
    estimated: Option<Estimate>,
    /// The current memory estimate.
    predicted: Estimate,
}

impl<'a> Run<'a> {
    fn new(args: &'a RenderArgs, outputs: &'a Outputs<'a>, reporter: &'a Reporter) -> Self {
        Self { args, outputs, reporter, start: Instant::now(), time: Time::default() }
    }

    /// Runs all stages, for the image or for a shard of it.
    fn all(mut self, shard: Option<Shard>) -> Result<()> {
        self.reporter.started(self.args, &command(std::env::args_os()));
        let Loaded { extracted, preset, estimated, predicted } = self.load()?;
        let mut scene = self.build(extracted, preset)?;
        if let Some(frame) = self.args.frames.frame {
            frames::place(&mut scene, frame, &self.args.scene)?;
        }
        // Until here there was nothing to lose: a signal ended the process.
        let interrupt = &Interrupt::listen()?;
        let seen = &Seen { outputs: self.outputs, reporter: self.reporter, interrupt };
        if let Some(shard) = shard {
            let summary = Summary::since(self.start);
            return parts::write_shard(self.args, shard, &scene, seen, summary);
        }
        let traced = self.trace(&mut scene, preset, seen)?;
        let counters = &traced.rendered.counters;
        let invalid = invalid::find(self.args, &scene, counters)?;
        self.write(&scene, &traced)?;
        invalid::report(counters, invalid.as_ref());
        let mut summary = Summary::since(self.start);
        summary.add(counters, self.time.trace);
        let (film, outputs) = (&traced.rendered.film, self.outputs);
        summary.print(self.args, &outputs.name(), &format!("{}x{}", film.width(), film.height()));
        let Some(file) = &self.args.stats else { return Ok(()) };
        let time = self.time;
        let finished = Finished { scene: &scene, traced, invalid, time, estimated, predicted };
        statistics::write(file, self.args, finished)
    }

    fn load(&mut self) -> Result<Loaded> {
        let (args, options) = (self.args, &self.args.scene_options);
        self.reporter.stage(Stage::Load);
        let extent = args.extent();
        let estimated =
            args.stats.as_ref().map(|_| options.estimate(&args.scene, extent)).transpose()?;
        let loaded = options.load(&args.scene, extent, &self.outputs.all())?;
        self.reporter.warnings(&loaded.warnings);
        self.outputs.made_of(loaded.encoding);
        let extracted = look::extract(args, loaded)?;
        let preset = options.bvh.unwrap_or_else(|| extracted.preset());
        let predicted = extent.estimate(&extracted, preset);
        self.time.load = self.start.elapsed().as_secs_f64();
        self.reporter.loaded(&extracted, self.time.load);
        Ok(Loaded { extracted, preset, estimated, predicted })
    }

    fn build(&mut self, extracted: Extracted, preset: Preset) -> Result<PreparedScene> {
        self.reporter.stage(Stage::Build);
        let file = extracted.file().to_owned();
        let options = &self.args.scene_options;
        let mut scene = timed(&mut self.time.build, || options.build(extracted, preset))?;
        let dropped = systems::warnings(&scene, &file);
        warn(&dropped);
        self.reporter.warnings(&dropped);
        self.reporter.built(self.args, &scene, preset, self.time.build);
        self.args.search.apply(&mut scene.accel);
        Ok(scene)
    }

    /// Traces the image.
    ///
    /// # Errors
    /// If a signal ended the render early.
    fn trace(
        &mut self,
        scene: &mut PreparedScene,
        preset: Preset,
        seen: &Seen<'_>,
    ) -> Result<Traced> {
        let (args, start) = (self.args, self.start);
        let trace = || goal::trace(args, scene, preset, seen, start);
        let traced = timed(&mut self.time.trace, trace)?;
        self.reporter.traced(&traced.rendered, scene, self.time.trace);
        if traced.rendered.finished {
            args.scene_options.check_taken(&args.scene)?;
            return Ok(traced);
        }
        Err(parts::interrupted(args, scene, &traced.rendered, seen))
    }

    fn write(&mut self, scene: &PreparedScene, traced: &Traced) -> Result<()> {
        self.reporter.stage(Stage::Write);
        timed(&mut self.time.write, || self.outputs.write(scene, &traced.rendered))?;
        self.time.total = self.start.elapsed().as_secs_f64();
        self.time.passes = pass_map(&traced.rendered.pass_seconds);
        self.reporter.wrote(self.outputs.paths(), &self.time);
        self.reporter.stage(Stage::Done);
        Ok(())
    }
}

/// Runs `work` and records its seconds.
fn timed<R>(seconds: &mut f64, work: impl FnOnce() -> R) -> R {
    let start = Instant::now();
    let result = work();
    *seconds = start.elapsed().as_secs_f64();
    result
}
