//! Renders the image: with the samples of the scene, or with as many as an error or a time asks for.

use std::time::Instant;

use serde_json::{Value, json};

use super::once::{render_once, say_resumed};
use super::outputs::Outputs;
use super::show::{Show, warn};
use crate::common::warn as warn_of;
use crate::progress::Display;
use wavecrest_api::goal::{End, Goal, Job, Reached};
use wavecrest_base::error::Result;
use wavecrest_base::words::counted;
use wavecrest_core::film::Film;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::probe::InvalidSample;
use wavecrest_core::render::Rendered;
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
pub(super) fn render_to_goal(
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
    let ending = &|scene: &PreparedScene, film: &Film| Ok(outputs.rehearse(scene, film));
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
