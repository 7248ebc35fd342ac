//! `render`: renders a scene to an image.

mod animation;
mod args;
mod frames;
mod goal;
pub(crate) mod look;
mod once;
mod outputs;
mod renderer;
mod shard;
mod show;
mod statistics;

pub(crate) use args::RenderArgs;
use args::{Frames, refuse};
use outputs::{Outputs, animated};
use renderer::{Renderer, Run, in_pixels};

use super::common::tell_error;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_image::animation::Animated;
use wavecrest_image::farm::Shard;

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

fn render_scene(args: &RenderArgs) -> Result<()> {
    args.search.check(args.scene_options.precision)?;
    match Job::of(args)? {
        Job::Image => render_image(args),
        Job::Shard(shard) => shard::render_shard(args, shard),
        Job::Frames(frames, shard) => frames::render_frames(args, frames, shard),
        Job::Animation(frames, format) => animation::render_animation(args, frames, format),
    }
}

/// What is made of one scene.
enum Job {
    /// One image.
    Image,
    /// A share of one image, for `wavecrest merge`.
    Shard(Shard),
    /// An image of each of these frames; or of the share of one shard.
    Frames(Frames, Option<Shard>),
    /// A turntable of this many frames in one file.
    Animation(u32, Animated),
}

impl Job {
    /// The job that the arguments describe.
    ///
    /// # Errors
    /// If they name options that cannot be used together.
    fn of(args: &RenderArgs) -> Result<Self> {
        let (output, shard) = (args.output()?, args.shard);
        if let Some(frames) = args.frames.clone() {
            return Ok(Self::Frames(frames, shard));
        }
        let turntable = args.scene_options.input.turntable;
        // Options that belong to one image, not to frames; and to image files of one view.
        let of_image = [
            ("--checkpoint", args.checkpoint.is_some()),
            ("--stats", args.stats.is_some()),
            ("--save-every", args.save_every.is_some()),
            ("--target-error", args.target_error.is_some()),
            ("--time-budget", args.time_budget.is_some()),
        ];
        let of_view = [
            ("--shard", shard.is_some()),
            ("--also", !args.also.is_empty()),
            ("--aov", args.aov.is_some()),
        ];
        if let Some(count) = turntable.filter(|_| args.frame.is_none()) {
            refuse("--turntable", output, &of_image)?;
            let Some(format) = animated(output) else {
                return Ok(Self::Frames(1..=count, shard));
            };
            refuse("--turntable", output, &of_view)?;
            return Ok(Self::Animation(count, format));
        }
        match (shard, args.look) {
            (None, _) => Ok(Self::Image),
            (Some(shard), None) => Ok(Self::Shard(shard)),
            (Some(_), Some(look)) => {
                // A part contains only light.
                let message = "--as and --shard cannot be used together";
                let error = Error::new(ErrorKind::Usage, message).value(look.name());
                Err(error.remedy("leave out one of them, or render whole frames with --frames"))
            }
        }
    }
}

fn render_image(args: &RenderArgs) -> Result<()> {
    let outputs = Outputs::check(args, args.paths()?, false)?;
    Run::start(args, None, |mut work| {
        let mut renderer = Renderer::begin(args, &[&outputs], &mut work)?;
        let outcome = renderer.render(&outputs)?;
        renderer.write(&outputs, &outcome.rendered)?;
        renderer.work.finish(&outputs.name(), &in_pixels(renderer.size()));
        args.stats.iter().try_for_each(|file| statistics::write(file, &renderer, &outcome))
    })
}
