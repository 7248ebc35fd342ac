//! Renders for a target error, for which a pilot chooses the samples, or within a time budget. The
//! error is measured.

use std::time::Instant;

use serde_json::{Value, json};

use super::args::RenderArgs;
use super::once::render_once;
use super::outputs::Outputs;
use crate::common::warn;
use crate::interrupt;
use crate::progress::Display;
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::probe::InvalidSample;
use wavecrest_core::render::{Rendered, Watch};
use wavecrest_report::accuracy::pilot::budget::{Budget, Overhead, in_time};
use wavecrest_report::accuracy::pilot::target::{Reached, reach};
use wavecrest_report::accuracy::pilot::{
    Chosen, MeasuredError, NO_ERROR, measured, measuring_share,
};
use wavecrest_report::accuracy::setting::{Axis, Facts};
use wavecrest_report::plot::number::figure;

/// A render with its choice of samples.
pub(super) struct Outcome {
    pub(super) rendered: Rendered,
    pub(super) goal: Option<Value>,
    /// The share of it that a checkpoint held, from 0 to 1.
    pub(super) resumed: f64,
    /// The first sample that is not finite.
    pub(super) invalid: Option<InvalidSample>,
}

/// Ends a pilot, or a measurement, on a signal, or at the end of a budget.
struct UntilSignal<'a>(Option<&'a Budget<'a>>);

impl UntilSignal<'_> {
    fn is_over(&self) -> bool {
        self.0.is_some_and(|budget| budget.left() <= 0.0)
    }
}

impl Watch for UntilSignal<'_> {
    fn cancelled(&self) -> bool {
        interrupt::signal().is_some() || self.is_over()
    }
}

/// Renders `scene`, whose tree with its `preset` may be replaced, as requested. `start` is the start of the command.
pub(super) fn render_to_goal(
    outputs: &Outputs<'_>,
    progress: &Display,
    scene: &mut PreparedScene,
    preset: &mut Preset,
    start: Instant,
) -> Result<Outcome> {
    let args = outputs.args;
    let tree = args.scene_options.bvh.is_none().then_some(preset);
    let aimed = match (args.target_error, args.time_budget) {
        (Some(error), _) => for_error(outputs, progress, scene, tree, error)?,
        (None, Some(seconds)) => Some(within(outputs, progress, scene, start, seconds)?),
        (None, None) => None,
    };
    if let Some(outcome) = aimed {
        return Ok(outcome);
    }
    let (rendered, resumed) = render_once(outputs, progress, scene, None)?;
    Ok(Outcome { rendered, goal: None, resumed, invalid: None })
}

/// Renders, and repeats with more points while the error is above `most`. The tree with the
/// preset `tree` may be replaced. `None` without a choice.
fn for_error(
    outputs: &Outputs<'_>,
    progress: &Display,
    scene: &mut PreparedScene,
    tree: Option<&mut Preset>,
    most: f64,
) -> Result<Option<Outcome>> {
    let args = outputs.args;
    let reached = reach(scene, tree, most, args.seed, &UntilSignal(None), |scene, choice| {
        args.say(&format!("chosen: {choice}"));
        let (rendered, _) = render_once(outputs, progress, scene, None)?;
        let found = measure(args, scene, &rendered, &UntilSignal(None))?;
        Ok((rendered, found))
    })?;
    let Some(reached) = reached else { return Ok(None) };
    warn(reached.unreached(most, &args.scene).as_slice());
    let Reached { choice, rendered, found, renders, pilot, .. } = reached;
    args.say(&format!("pilot: {pilot:.2} s"));
    Ok(Some(aimed(scene, rendered, format!("error {most}"), &choice, found, renders, pilot)))
}

/// Renders within so many seconds from `start` on.
fn within(
    outputs: &Outputs<'_>,
    progress: &Display,
    scene: &mut PreparedScene,
    start: Instant,
    seconds: f64,
) -> Result<Outcome> {
    let args = outputs.args;
    let clock = || start.elapsed().as_secs_f64();
    let pixels = scene.camera.size().map(f64::from).iter().product();
    let budget = &Budget::new(&clock, seconds, pixels);
    if budget.left() <= 0.0 {
        args.say("the time is over before the first ray: one point follows");
    }
    let original = scene.original();
    let in_flight = args.batch as usize * rayon::current_num_threads();
    let overhead = Overhead {
        measuring: measuring_share(scene.camera.size()),
        in_flight: in_flight as f64 / pixels,
    };
    let axis = Axis::of(&Facts::of(scene));
    let (choice, rendered, renders) = in_time(axis, budget, overhead, |choice, pace| {
        scene.resample(&original, &choice.samples());
        let (rendered, _) = render_once(outputs, progress, scene, Some(pace))?;
        let is_finished = rendered.finished;
        Ok((rendered, is_finished))
    })?;
    scene.resample(&original, &choice.samples());
    if rendered.finished {
        args.say(&format!("chosen: {choice}"));
    }
    let found = measure(args, scene, &rendered, &UntilSignal(Some(budget)))?;
    Ok(aimed(scene, rendered, format!("{seconds} s"), &choice, found, renders, 0.0))
}

/// The measured error of a finished render, if there is one and `until` does not end the measurement.
fn measure(
    args: &RenderArgs,
    scene: &PreparedScene,
    rendered: &Rendered,
    until: &UntilSignal<'_>,
) -> Result<Option<MeasuredError>> {
    let found = measured(scene, rendered, args.seed, until)?;
    if until.cancelled() {
        if rendered.finished && until.is_over() {
            args.say("error not measured: the time is over");
        }
        return Ok(None);
    }
    if rendered.finished {
        args.say(&told(found, scene));
    }
    Ok(found)
}

/// The measured error in words, and what it leaves out.
fn told(error: Option<MeasuredError>, scene: &PreparedScene) -> String {
    let Some(found) = error else { return format!("error not measured: {NO_ERROR}") };
    let without = left_out(&found, scene).into_iter().map(|of| format!(", without {of}"));
    format!("measured error: {}{}", figure(found.error), without.collect::<String>())
}

/// What an error leaves out: pixels that it does not look at, and what renders with equally many points have in common.
fn left_out(found: &MeasuredError, scene: &PreparedScene) -> Vec<String> {
    let others = 100.0 * (1.0 - found.share);
    let pixels = format!("what only the other {others:.0} % of the pixels show");
    let common = "the aliasing of one ray through the centre of each pixel".to_owned();
    let pixels = (others > 0.0).then_some(pixels);
    pixels.into_iter().chain((scene.camera.antialias() == 1).then_some(common)).collect()
}

/// A render with its goal and the outcome, for the statistics, with the number of renders and the seconds of the pilot.
fn aimed(
    scene: &PreparedScene,
    rendered: Rendered,
    requested: String,
    choice: &Chosen,
    found: Option<MeasuredError>,
    renders: u32,
    pilot: f64,
) -> Outcome {
    let goal = json!({
        "asked": requested,
        "samples": choice.to_string(),
        "expected_error": Some(choice.error).filter(|error| *error > 0.0),
        "expected_seconds": choice.seconds,
        "found_error": found.map(|found| found.error),
        "left_out": found.map(|found| left_out(&found, scene)),
        "renders": renders,
        "pilot_seconds": pilot,
    });
    let goal = rendered.finished.then_some(goal);
    Outcome { rendered, goal, resumed: 0.0, invalid: None }
}
