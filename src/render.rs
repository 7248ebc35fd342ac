//! `render`: renders a scene to an image.

mod args;
mod frames;
mod image;
mod outputs;
mod renderer;
mod shard;
mod show;
mod statistics;

pub(crate) use args::RenderArgs;
use args::refuse;
use frames::{render_animation, render_frames};
use outputs::{Outputs, animated};
use renderer::{Renderer, in_pixels};
use shard::render_shard;

use super::common::tell_error;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// Renders each scene. Nothing is overwritten before the new image is complete.
///
/// # Errors
/// If a scene cannot be loaded or prepared, or an image cannot be written; after the others, unless a signal ended it.
pub(crate) fn run(args: &RenderArgs) -> Result<()> {
    let all = args.each()?;
    let [scenes @ .., last] = &all[..] else { return Ok(()) };
    let mut failed = 0;
    for scene in scenes {
        if let Err(error) = render_scene(scene) {
            if let ErrorKind::Interrupted(_) = error.kind() {
                return Err(error);
            }
            tell_error(&error);
            failed += 1;
        }
    }
    match (render_scene(last), failed) {
        (Ok(()), 1..) => {
            let message = format!("{failed} of {} scenes were not rendered", all.len());
            Err(Error::new(ErrorKind::Scene, message))
        }
        (done, _) => done,
    }
}

/// Makes what the arguments describe: an image; a share of one, for `wavecrest merge`; an image of each of some frames, or of
/// the share of a shard; or a turntable in one file.
fn render_scene(args: &RenderArgs) -> Result<()> {
    args.search.check(args.scene_options.precision)?;
    let (output, shard) = (args.output()?, args.shard);
    if let Some(frames) = args.frames.clone() {
        return render_frames(args, frames, shard);
    }
    let turntable = args.scene_options.input.turntable;
    if let Some(count) = turntable.filter(|_| args.frame.is_none()) {
        let of_one_image = [
            ("--checkpoint", args.checkpoint.is_some()),
            ("--stats", args.stats.is_some()),
            ("--save-every", args.save_every.is_some()),
            ("--target-error", args.target_error.is_some()),
            ("--time-budget", args.time_budget.is_some()),
        ];
        refuse("--turntable", output, &of_one_image)?;
        let Some(format) = animated(output) else {
            return render_frames(args, 1..=count, shard);
        };
        let of_image_files = [
            ("--shard", shard.is_some()),
            ("--also", !args.also.is_empty()),
            ("--aov", args.aov.is_some()),
        ];
        refuse("--turntable", output, &of_image_files)?;
        return render_animation(args, count, format);
    }
    match (shard, args.look) {
        (None, _) => render_image(args),
        (Some(shard), None) => render_shard(args, shard),
        (Some(_), Some(look)) => {
            // A part contains only light.
            let message = "--as and --shard cannot be used together";
            let error = Error::new(ErrorKind::Usage, message).value(look.name());
            Err(error.remedy("leave out one of them, or render whole frames with --frames"))
        }
    }
}

fn render_image(args: &RenderArgs) -> Result<()> {
    let outputs = Outputs::check(args, args.paths()?, false)?;
    Renderer::run(args, &[&outputs], None, |mut renderer| {
        let outcome = renderer.render(&outputs)?;
        renderer.write(&outputs, &outcome.rendered)?;
        renderer.finish(&outputs.name(), &in_pixels(renderer.size()));
        args.stats.iter().try_for_each(|file| statistics::write(file, &renderer, &outcome))
    })
}
