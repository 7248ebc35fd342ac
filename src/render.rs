//! `render`: renders a scene to an image.

mod args;
mod frames;
mod goal;
mod look;
mod outputs;
mod parts;
mod ready;
mod rows;
mod show;
mod sides;
mod summary;

use std::time::Instant;

pub(crate) use args::RenderArgs;
use outputs::Outputs;
use ready::{Ready, timed};
use show::Rendering;
use summary::Totals;

use super::common::tell_error;
use super::interrupt;
use super::progress::{Display, Stage};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_image::farm::Shard;
use wavecrest_report::statistics::pass_map;

/// Renders each scene. Nothing is overwritten before the new image is complete.
///
/// # Errors
/// If a scene cannot be loaded or prepared, or an image cannot be written; after the others, unless a signal ended it.
pub(crate) fn run(args: &RenderArgs) -> Result<()> {
    let all = args.each()?;
    let [scenes @ .., last] = &all[..] else { return Ok(()) };
    let mut failed = 0;
    for scene in scenes {
        if let Err(error) = run_one(scene) {
            if let ErrorKind::Interrupted(_) = error.kind() {
                return Err(error);
            }
            tell_error(&error);
            failed += 1;
        }
    }
    match (run_one(last), failed) {
        (Ok(()), 1..) => {
            let message = format!("{failed} of {} scenes were not rendered", all.len());
            Err(Error::new(ErrorKind::Scene, message))
        }
        (done, _) => done,
    }
}

/// Renders one scene.
fn run_one(args: &RenderArgs) -> Result<()> {
    args.search.check(args.scene_options.precision)?;
    let args = &look::without_ground(args.clone());
    let output = args.output()?;
    let shard = args.shard()?;
    if let Some(frames) = args.frames.clone() {
        return frames::run(args, frames, shard);
    }
    if sides::run(args, shard)? {
        return Ok(());
    }
    parts::check(args, output)?;
    look::check(args)?;
    let outputs = Outputs::check(args, args.paths()?, shard.is_some())?;
    watched(args, |progress| one(args, &outputs, progress, shard))
}

/// Runs `work` on the requested threads, with its progress shown.
fn watched(args: &RenderArgs, work: impl FnOnce(&Display) -> Result<()> + Send) -> Result<()> {
    let progress = Display::new(args.progress, args.scene_options.quiet);
    args.number.inspect(|&[number, all]| progress.frame(number, all));
    args.scene_options.threads.run(|| work(&progress))
}

/// Renders one image, or a shard of it.
fn one(
    args: &RenderArgs,
    outputs: &Outputs<'_>,
    progress: &Display,
    shard: Option<Shard>,
) -> Result<()> {
    let start = Instant::now();
    let mut ready = Ready::prepare(args, &outputs.all(), progress, start)?;
    outputs.made_of(ready.encoding);
    if let Some(frame) = args.frame {
        frames::place(&mut ready.scene, frame, &args.scene)?;
    }
    // Until here there was nothing to lose: a signal ended the process.
    interrupt::record();
    let rendering = &Rendering { args, outputs, progress };
    let mut summary = Totals::since(start);
    if let Some(shard) = shard {
        let (counters, seconds) = parts::write_shard(rendering, shard, &ready.scene)?;
        summary.add(&counters, seconds);
        summary.print(args, &outputs.name(), &format!("shard {shard}"));
        return Ok(());
    }
    let Ready { scene, time, preset, .. } = &mut ready;
    let traced = timed(&mut time.trace, || goal::trace(rendering, scene, *preset, start))?;
    let (scene, time, rendered) = (&ready.scene, &mut ready.time, &traced.rendered);
    let counters = &rendered.counters;
    if !rendered.finished {
        return Err(parts::interrupted(rendering, scene, rendered));
    }
    args.scene_options.check_taken(&args.scene)?;
    let invalid = parts::find_invalid(args, scene, counters)?;
    progress.stage(Stage::Write);
    timed(&mut time.write, || outputs.write(scene, rendered))?;
    time.total = start.elapsed().as_secs_f64();
    time.passes = pass_map(&rendered.pass_seconds);
    progress.stage(Stage::Done);
    parts::report_invalid(counters, invalid.as_ref());
    summary.add(counters, time.trace);
    let [width, height] = [rendered.film.width(), rendered.film.height()];
    summary.print(args, &outputs.name(), &format!("{width}x{height}"));
    match &args.stats {
        Some(file) => summary::write_statistics(file, args, &ready, &traced, invalid),
        None => Ok(()),
    }
}
