//! Several views of a file: a turntable as an animation, or a sheet.

use super::args::{Given, RenderArgs, refuse};
use super::frames::{self, Sequence};
use super::outputs::{Outputs, animated};
use super::rows::Rows;
use super::watched;
use crate::progress::{Display, Stage};
use wavecrest_base::error::Result;
use wavecrest_core::render::Rendered;
use wavecrest_image::animation::{Animated, Animation};
use wavecrest_image::farm::Shard;
use wavecrest_scene::load::framing::Sheet;

/// Renders several views if requested; returns whether they are.
///
/// # Errors
/// If an option does not fit, or an image cannot be rendered or written.
pub(super) fn run(args: &RenderArgs, shard: Option<Shard>) -> Result<bool> {
    if args.frame.is_some() {
        return Ok(false);
    }
    let input = &args.scene_options.input;
    let output = args.output()?;
    if let Some(sheet) = &args.sheet {
        refuse("--sheet", output, &[of_frame(args), of_image(args, shard)].concat())?;
        let outputs = Outputs::check(args, args.paths()?, false)?;
        watched(args, |progress| draw_sheet(args, sheet, &outputs, progress))?;
        return Ok(true);
    }
    let Some(count) = input.turntable else { return Ok(false) };
    match animated(output) {
        None => {
            refuse("--turntable", output, &of_frame(args))?;
            frames::run(args, 1..=count, shard)?;
        }
        Some(format) => {
            refuse("--turntable", output, &[of_frame(args), of_image(args, shard)].concat())?;
            let outputs = Outputs::of_one(args, output)?;
            watched(args, |progress| animate(args, count, &outputs, format, progress))?;
        }
    }
    Ok(true)
}

/// Options that belong to one image, not to frames.
fn of_frame(args: &RenderArgs) -> Vec<Given> {
    vec![
        ("--checkpoint", args.checkpoint.is_some()),
        ("--stats", args.stats.is_some()),
        ("--save-every", args.save_every.is_some()),
        ("--target-error", args.target_error.is_some()),
        ("--time-budget", args.time_budget.is_some()),
    ]
}

/// Options that belong to image files of one view.
fn of_image(args: &RenderArgs, shard: Option<Shard>) -> Vec<Given> {
    vec![
        ("--shard", shard.is_some()),
        ("--also", !args.also.is_empty()),
        ("--aov", args.aov.is_some()),
    ]
}

/// Renders a turntable as one file.
fn animate(
    args: &RenderArgs,
    count: u32,
    outputs: &Outputs<'_>,
    format: Animated,
    progress: &Display,
) -> Result<()> {
    let output = outputs.first();
    let mut sequence = Sequence::prepare(args, &outputs.all(), count as usize, progress)?;
    outputs.made_of(sequence.ready.encoding);
    let size =
        args.crop.map_or(sequence.ready.scene.camera.size(), |crop| [crop.width, crop.height]);
    let entries = outputs.entries(&sequence.ready.scene)?;
    let transfer = outputs.transfer();
    let animation =
        Animation { path: output, format, size, frames: count, transfer, entries: &entries };
    // Errors of a frame are not about the file.
    let mut failed = None;
    let mut film = |frame| {
        let rendered = sequence.frame(frame + 1, outputs);
        rendered.map(|one| one.film).inspect_err(|error| failed = Some(error.clone()))
    };
    animation.write(&mut film).map_err(|error| failed.unwrap_or(error))?;
    progress.stage(Stage::Done);
    sequence.finish(args, &output.display().to_string(), size);
    Ok(())
}

/// Renders every side as an image of its own, with lights of its own, and arranges them.
fn draw_sheet(
    args: &RenderArgs,
    Sheet(sides): &Sheet,
    outputs: &Outputs<'_>,
    progress: &Display,
) -> Result<()> {
    let mut rows = Rows::new(sides.len());
    let mut seen = args.clone();
    let of_side = |side| {
        seen.scene_options.input.view = Some(side);
        let one = seen.clone();
        // The notes of every side are the same.
        seen.scene_options.quiet = true;
        one
    };
    let all: Vec<RenderArgs> = sides.iter().copied().map(of_side).collect();
    let mut last: Option<(Sequence<'_>, Rendered)> = None;
    for one in &all {
        // Frees the scene before the next is read.
        let before = last.take().map(|(sequence, _)| sequence.so_far());
        let mut sequence = Sequence::prepare(one, &outputs.all(), sides.len(), progress)?;
        before.into_iter().for_each(|before| sequence.go_on(before));
        let rendered = sequence.trace(outputs)?;
        rows.add(&rendered.film)?;
        last = Some((sequence, rendered));
    }
    let (Some((sequence, mut rendered)), Some(film)) = (last, rows.film) else { return Ok(()) };
    rendered.film = film;
    progress.stage(Stage::Write);
    outputs.write(&sequence.ready.scene, &rendered)?;
    progress.stage(Stage::Done);
    let size = [rendered.film.width(), rendered.film.height()];
    sequence.finish(args, &outputs.name(), size);
    Ok(())
}
