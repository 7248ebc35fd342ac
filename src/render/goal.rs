//! Renders for a target error or a time budget: a pilot chooses the samples and predicts the error,
//! which is then measured. A render that turns out too slow for its budget begins again with fewer.

use std::time::Instant;

use serde_json::{Value, json};

use super::parts::trace as trace_once;
use super::show::Rendering;
use crate::common::{tell, warn};
use crate::interrupt;
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{Rendered, Watch};
use wavecrest_report::accuracy::pilot::budget::{Budget, Overhead, Pace, in_time};
use wavecrest_report::accuracy::pilot::target::{Reached, reach};
use wavecrest_report::accuracy::pilot::{Chosen, MeasuredError, Pilot, measured, measured_share};
use wavecrest_report::plot::number::figure;

/// A render with its preset and its choice of samples.
pub(super) struct Traced {
    pub(super) rendered: Rendered,
    pub(super) preset: Preset,
    pub(super) goal: Option<Value>,
    /// The share of it that a checkpoint held, from 0 to 1.
    pub(super) resumed: f64,
}

/// Ends a pilot, or a measurement, on a signal.
struct UntilSignal;

impl Watch for UntilSignal {
    fn cancelled(&self) -> bool {
        interrupt::signal().is_some()
    }
}

/// Renders `scene`, whose tree has `preset`, as requested. `start` is the start of the command.
pub(super) fn trace(
    rendering: &Rendering<'_>,
    scene: &mut PreparedScene,
    mut preset: Preset,
    start: Instant,
) -> Result<Traced> {
    let args = rendering.args;
    let tree = args.scene_options.bvh.is_none().then_some(&mut preset);
    let goal = match (args.target_error, args.time_budget) {
        (Some(error), _) => for_error(rendering, scene, tree, error)?,
        (None, Some(seconds)) => {
            let clock = || start.elapsed().as_secs_f64();
            within(rendering, scene, tree, &Budget::new(&clock, seconds), seconds)?
        }
        (None, None) => None,
    };
    match goal {
        // Neither has a checkpoint.
        Some((rendered, goal)) => Ok(Traced { rendered, preset, goal, resumed: 0.0 }),
        None => {
            let (rendered, resumed) = trace_once(rendering, scene, None)?;
            Ok(Traced { rendered, preset, goal: None, resumed })
        }
    }
}

/// A render, and its goal if it is finished.
type AimedRender = (Rendered, Option<Value>);

/// Renders, and repeats with more points while the error is above `target`. The tree with the
/// preset `tree` may be replaced. `None` without a choice.
fn for_error(
    rendering: &Rendering<'_>,
    scene: &mut PreparedScene,
    tree: Option<&mut Preset>,
    target: f64,
) -> Result<Option<AimedRender>> {
    let args = rendering.args;
    let reached = reach(scene, tree, (target, args.seed), &UntilSignal, |scene, choice| {
        let rendered = trace_chosen(rendering, scene, choice, None)?;
        let found = measure(rendering, scene, &rendered)?;
        Ok((rendered, found))
    })?;
    let Some(reached) = reached else { return Ok(None) };
    warn(reached.unreached(target, &args.scene).as_slice());
    let Reached { choice, rendered, found, renders } = reached;
    let goal = goal(format!("error {target}"), &choice, found, renders);
    let goal = rendered.finished.then_some(goal);
    Ok(Some((rendered, goal)))
}

/// Renders within `budget`, of so many seconds. The tree with the preset `tree` may be replaced.
/// `None` without a choice.
fn within(
    rendering: &Rendering<'_>,
    scene: &mut PreparedScene,
    tree: Option<&mut Preset>,
    budget: &Budget<'_>,
    seconds: f64,
) -> Result<Option<AimedRender>> {
    let args = rendering.args;
    let original = scene.original();
    let pilot = Pilot::run(scene, &original, args.seed, &budget.for_pilot(), &UntilSignal)?;
    if let Some(choice) = pilot.for_time(budget.left()) {
        choice.apply(scene, &original, tree);
    }
    let [width, height] = scene.camera.size().map(f64::from);
    let in_flight = args.batch as usize * rayon::current_num_threads();
    let overhead = Overhead {
        measuring: measured_share(scene.camera.size()),
        in_flight: in_flight as f64 / (width * height),
    };
    let mut renders = 0;
    let last = in_time(&pilot, budget, overhead, |choice, pace| {
        scene.resample(&original, &choice.samples());
        let rendered = trace_chosen(rendering, scene, choice, Some(pace))?;
        renders += 1;
        let is_ended = rendered.finished || interrupt::signal().is_some();
        if let Some(expected) = pace.expected().filter(|_| !is_ended) {
            let planned = choice.seconds;
            let words =
                format!("too slow: about {expected:.1} s of tracing instead of {planned:.1} s");
            say(rendering, &(words + "; starting again with fewer points"));
        }
        Ok((rendered, is_ended))
    })?;
    let Some((choice, rendered)) = last else { return Ok(None) };
    let found = measure(rendering, scene, &rendered)?;
    let goal = goal(format!("{seconds} s"), &choice, found, renders);
    let goal = rendered.finished.then_some(goal);
    Ok(Some((rendered, goal)))
}

fn trace_chosen(
    rendering: &Rendering<'_>,
    scene: &PreparedScene,
    choice: &Chosen,
    pace: Option<&Pace<'_>>,
) -> Result<Rendered> {
    say(rendering, &format!("chosen: {choice}"));
    trace_once(rendering, scene, pace).map(|(rendered, _)| rendered)
}

/// The measured error of a finished render, if there is one and no signal ends the measurement.
fn measure(
    rendering: &Rendering<'_>,
    scene: &PreparedScene,
    rendered: &Rendered,
) -> Result<Option<MeasuredError>> {
    let found = measured(scene, rendered, rendering.args.seed, &UntilSignal)?;
    if interrupt::signal().is_some() {
        return Ok(None);
    }
    if rendered.finished {
        say(rendering, &told(found, scene.camera.antialias() == 1));
    }
    Ok(found)
}

/// Prints a note.
fn say(rendering: &Rendering<'_>, words: &str) {
    if !rendering.args.scene_options.quiet {
        tell(words);
    }
}

/// The measured error in words, and whether it leaves out what one ray a pixel misses at edges.
fn told(error: Option<MeasuredError>, without_aliasing: bool) -> String {
    const CENTRE: &str = "one ray through the centre of each pixel";
    match error.map(|found| figure(found.error)) {
        Some(error) if without_aliasing => {
            format!("measured error: {error}, without the aliasing of {CENTRE}")
        }
        Some(error) => format!("measured error: {error}"),
        None => format!("error not measured: {CENTRE}, without random samples"),
    }
}

/// The goal and its outcome, for the statistics.
fn goal(requested: String, choice: &Chosen, found: Option<MeasuredError>, renders: u32) -> Value {
    json!({
        "asked": requested,
        "samples": choice.to_string(),
        "expected_error": choice.error,
        "expected_seconds": choice.seconds,
        "found_error": found.map(|found| found.error),
        "renders": renders,
    })
}
