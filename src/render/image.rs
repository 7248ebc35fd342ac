//! One image: as light, with the samples of the scene or as many as an error or a time asks for, or as a look; resumed from a
//! checkpoint, or ended by a signal; and its samples that are not finite.

use std::time::Instant;

use serde_json::{Value, json};

use super::args::RenderArgs;
use super::outputs::Outputs;
use super::show::{Show, warn};
use crate::common::{tell, warn as warn_of};
use crate::interrupt;
use crate::progress::Display;
use wavecrest_api::goal::{End, Goal, Job, Reached};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::words::counted;
use wavecrest_core::counters::Counters;
use wavecrest_core::film::Film;
use wavecrest_core::prepared::{MOST_RAYS, PreparedScene};
use wavecrest_core::probe::{self, InvalidSample};
use wavecrest_core::render::Rendered;
use wavecrest_image::farm::{Passes, Shard};
use wavecrest_image::look;
use wavecrest_report::plot::number::figure;

/// A render with what it was for.
pub(super) struct Outcome {
    pub(super) rendered: Rendered,
    pub(super) goal: Option<Value>,
    /// The share of it that a checkpoint held, from 0 to 1.
    pub(super) resumed: f64,
    /// The first sample that is not finite.
    pub(super) invalid: Option<InvalidSample>,
}

/// Renders `scene` as requested. `start` is the start of the command.
pub(super) fn render_image(
    outputs: &Outputs<'_>,
    progress: &Display,
    scene: &mut PreparedScene,
    start: Instant,
) -> Result<Outcome> {
    let args = outputs.args;
    let (error, seconds) = (args.target_error, args.time_budget);
    if error.or(seconds).is_none() {
        let (rendered, resumed) = render_once(outputs, progress, scene)?;
        return Ok(Outcome { rendered, goal: None, resumed, invalid: None });
    }
    let seconds_from = seconds.map(|seconds| (seconds, start));
    let samples = args.scene_options.input.samples;
    let goal = Goal { error, seconds: seconds_from, samples };
    let show = Show::begin(outputs, progress, scene, false);
    let kept = (args.checkpoint(), outputs.author());
    let passes = Goal::passes(scene, args.options(), kept)?;
    say_resumed(args, &passes);
    let is_over = seconds.is_some_and(|seconds| start.elapsed().as_secs_f64() > seconds);
    if is_over && passes.pass().from == 0 {
        args.say("the time is over before the first ray: one for each pixel follows");
    }
    if passes.pass().from > 0 {
        show.go_on(passes.painted()?.film);
    }
    let ending = &|scene: &PreparedScene, film: &Film, rows| outputs.rehearse(scene, film, rows);
    let reached = goal.render(scene, &passes, &Job { watch: &show, warn: &warn, ending })?;
    let Reached { samples, error: found, end, passes, seconds: spent, resumed, .. } = reached;
    if reached.rendered.finished {
        args.say(&told(&reached));
    }
    if end != End::Cancelled {
        warn_of(goal.unreached(&reached, &args.scene).as_slice());
    }
    let goal = json!({
        "asked": { "error": error, "seconds": seconds },
        "samples": samples,
        "found_error": found.filter(|error| *error > 0.0),
        "passes": passes,
        "seconds": spent,
        "end": end,
    });
    let (rendered, goal) = (reached.rendered, Some(goal));
    let rendered = Rendered { finished: rendered.finished && end != End::Cancelled, ..rendered };
    Ok(Outcome { rendered, goal, resumed, invalid: None })
}

/// The samples and the error in words.
fn told(Reached { samples, error, end, .. }: &Reached) -> String {
    let rays = counted((*samples).into(), "ray");
    let most = if *end == End::Samples { ", the most there are" } else { "" };
    match error {
        Some(error) if *error > 0.0 => format!("{rays} per pixel{most}: error {}", figure(*error)),
        Some(_) => format!("{rays} per pixel{most}: no two halves of them differ"),
        None => format!("{rays} per pixel: error not known"),
    }
}

/// Renders the image with the samples of the scene; returns it with the share that a checkpoint held (0 to 1).
pub(super) fn render_once(
    outputs: &Outputs<'_>,
    progress: &Display,
    scene: &PreparedScene,
) -> Result<(Rendered, f64)> {
    let (show, args) = (Show::begin(outputs, progress, scene, true), outputs.args);
    if args.checkpoint.is_some() {
        let passes = begin(outputs, scene, None)?;
        let rendered = passes.render(scene, &show, &warn)?;
        return Ok((rendered, passes.resumed().unwrap_or_default()));
    }
    Ok((look::render(scene, args.look, &args.options(), &show)?, 0.0))
}

/// The work on the image, or on a shard of it; says what a checkpoint held.
pub(super) fn begin(
    outputs: &Outputs<'_>,
    scene: &PreparedScene,
    shard: Option<Shard>,
) -> Result<Passes> {
    let args = outputs.args;
    let (options, author) = (args.options(), outputs.author());
    let passes = Passes::begin(scene, options, author, shard, (args.checkpoint(), false))?;
    say_resumed(args, &passes);
    Ok(passes)
}

/// Says what a checkpoint held.
pub(super) fn say_resumed(args: &RenderArgs, passes: &Passes) {
    if let Some(file) = &args.checkpoint
        && args.resume
    {
        let (file, percent) = (file.display(), |share: f64| (share * 1000.0).floor() / 10.0);
        args.say(&match passes.resumed().map(percent) {
            Some(percent) => match passes.pass().from {
                0 => format!("resuming from {file}: {percent} % is done"),
                _ if passes.is_finished() => format!("resuming from {file}: 100 % is done"),
                n => format!("resuming from {file}: {} per pixel", counted(n.into(), "ray")),
            },
            None => format!("no checkpoint {file} yet: starting from the beginning"),
        });
    }
}

/// Writes the finished part of an image that a signal ended, unless it would replace an older image; returns the error
/// with the progress.
pub(super) fn interrupted(
    outputs: &Outputs<'_>,
    scene: &PreparedScene,
    rendered: &Rendered,
) -> Error {
    let share = share(rendered);
    // Towards a goal, the image after the last pass is whole.
    let error = match scene.camera.rays_per_pixel() {
        samples if share == 1.0 => {
            interrupt::error_at(&format!("{} per pixel", counted(samples.into(), "ray")))
        }
        _ => interrupt::error(share),
    };
    let written = if share == 0.0 {
        Ok(outputs.untouched())
    } else {
        let entries = outputs.entries(scene);
        entries.and_then(|entries| outputs.write_unfinished(&rendered.film, &entries, share))
    };
    match written {
        Ok(words) => error.remedy(words + &go_on(outputs.args)),
        Err(error) => error,
    }
}

/// The finished share of an image, from 0 to 1.
pub(super) fn share(rendered: &Rendered) -> f64 {
    let pixels: usize = rendered.tiles.iter().map(|tile| tile.len()).sum();
    pixels as f64 / rendered.film.pixels().len() as f64
}

/// How to resume, if possible.
pub(super) fn go_on(args: &RenderArgs) -> String {
    match &args.checkpoint {
        Some(file) => format!("; resume with --checkpoint {} --resume", file.display()),
        // Looks have none.
        None if args.look.is_some() => String::new(),
        None => "; use --checkpoint FILE to be able to resume".to_owned(),
    }
}

/// The first sample that was not finite; warns of it, of paths that were cut short, and once of an image with such texels.
///
/// # Errors
/// If there is such a sample or texel, and `--trap-invalid` is given.
pub(super) fn find_invalid(
    args: &RenderArgs,
    scene: &PreparedScene,
    counters: &Counters,
) -> Result<Option<InvalidSample>> {
    static WARNED: std::sync::Once = std::sync::Once::new();
    let mut images = scene.appearance.all_images();
    if let Some(image) = images.find(|image| image.held().is_some_and(|held| held.invalid > 0)) {
        let message = format!("texels of {} are not finite and count as 0", image.name());
        let error = Error::new(ErrorKind::Texture, message).in_file(&args.scene);
        if args.trap_invalid {
            return Err(error);
        }
        WARNED.call_once(|| warn(&error));
    }
    let first = counters.first_invalid;
    let first = first.map(|sample| probe::name_invalid(scene, sample, args.seed));
    if let Some(invalid) = first.as_ref().filter(|_| args.trap_invalid) {
        let InvalidSample { x, y, shape, .. } = invalid;
        let error = Error::new(ErrorKind::Scene, "a sample is not finite").in_file(&args.scene);
        let scene = args.scene.display();
        let remedy = format!("see it with: wavecrest probe {scene} --pixel {x},{y}");
        return Err(error.at(shape).value(invalid).remedy(remedy));
    }
    if counters.cut_short > 0 {
        tell(&format!(
            "warning: paths ended at {MOST_RAYS} rays, in number {}: transparent surfaces send on more light than \
             they receive, or hardly less; use a smaller kr, kt or nbounces (in glTF, transmissionFactor)",
            counters.cut_short
        ));
    }
    if let Some(first) = &first {
        let count = counters.invalid;
        tell(&format!(
            "warning: {count} samples were not finite and count as black; the first is {first}"
        ));
    }
    Ok(first)
}
