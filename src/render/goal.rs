//! Renders for a target error or a time budget: a pilot chooses the samples and predicts the error,
//! which is then measured. A render that turns out too slow for its budget begins again with fewer.

use std::time::Instant;

use serde_json::{Value, json};

use super::args::RenderArgs;
use super::parts::trace as trace_once;
use super::show::Seen;
use crate::common::{tell, warn};
use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::prepared::{Original, PreparedScene};
use wavecrest_core::render::Rendered;
use wavecrest_report::accuracy::pilot::budget::{Budget, Pace, Task, in_time};
use wavecrest_report::accuracy::pilot::target::{Reached, reach};
use wavecrest_report::accuracy::pilot::{
    Choice, MOST_SIDE, Measured, Pilot, error, is_sampled, leaves_out_aliasing, measured_share,
};
use wavecrest_report::plot::number::figure;

/// A render with its preset and its choice of samples.
pub(super) struct Traced {
    pub(super) rendered: Rendered,
    pub(super) preset: Preset,
    pub(super) goal: Option<Value>,
    /// The share of it that a checkpoint held, from 0 to 1.
    pub(super) resumed: f64,
}

/// Renders `scene`, whose tree has `preset`, as requested by the arguments, reporting to `seen`.
/// `start` is the start of the command.
pub(super) fn trace(
    seen: &Seen<'_>,
    scene: &mut PreparedScene,
    preset: Preset,
    start: Instant,
) -> Result<Traced> {
    let args = seen.args;
    let aimed = Aimed { seen, original: scene.original() };
    let traced = match (args.target_error, args.time_budget) {
        (Some(error), _) => aimed.for_error(scene, error, preset)?,
        (None, Some(seconds)) => {
            let clock = || start.elapsed().as_secs_f64();
            aimed.in_time(scene, &Budget::new(&clock, seconds), preset)?
        }
        (None, None) => None,
    };
    if let Some(traced) = traced {
        return Ok(traced);
    }
    let (rendered, resumed) = trace_once(seen, scene, None)?;
    Ok(Traced { rendered, preset, goal: None, resumed })
}

/// Prints a note, and adds it to the log.
fn say(seen: &Seen<'_>, words: &str) {
    seen.reporter.note("choice", || words.to_owned());
    if !seen.args.scene_options.quiet {
        tell(words);
    }
}

/// A render with chosen samples.
struct Aimed<'a> {
    seen: &'a Seen<'a>,
    /// The scene's own samples.
    original: Original,
}

impl Aimed<'_> {
    /// Renders, and repeats with more points while the error is above `asked`. `None` without a
    /// choice.
    fn for_error(
        &self,
        scene: &mut PreparedScene,
        asked: f64,
        mut preset: Preset,
    ) -> Result<Option<Traced>> {
        let args = self.seen.args;
        let pilot = Pilot::run(scene, &self.original, args.seed)?;
        let reached = reach(&pilot, asked, |choice| {
            scene.resample(&self.original, &choice.samples());
            preset = choose_tree(args, scene, preset);
            let traced = self.trace(scene, choice, None)?;
            let is_whole = traced.0.finished;
            let found = if is_whole { self.measure(scene, &traced.0)? } else { None };
            Ok((traced, found))
        })?;
        let Some(Reached { choice, rendered: (rendered, resumed), found, renders }) = reached
        else {
            return Ok(None);
        };
        if found.is_some_and(|found| found.error > asked) {
            let error = unreached(asked, &choice).in_file(&args.scene);
            warn(&[Warning::from_error(&error)]);
        }
        let goal = goal(format!("error {asked}"), &choice, found, renders);
        let goal = rendered.finished.then_some(goal);
        Ok(Some(Traced { rendered, preset, goal, resumed }))
    }

    /// Renders within `budget`. `None` without a choice.
    fn in_time(
        &self,
        scene: &mut PreparedScene,
        budget: &Budget<'_>,
        mut preset: Preset,
    ) -> Result<Option<Traced>> {
        let args = self.seen.args;
        let pilot = Pilot::within(scene, &self.original, args.seed, &budget.for_pilot())?;
        if let Some(choice) = pilot.for_time(budget.left()) {
            scene.resample(&self.original, &choice.samples());
            preset = choose_tree(args, scene, preset);
        }
        let [width, height] = scene.camera.size().map(f64::from);
        let in_flight = args.batch as usize * rayon::current_num_threads();
        let task = Task {
            measuring: measured_share(scene.camera.size()),
            in_flight: in_flight as f64 / (width * height),
        };
        let mut renders = 0;
        let done = in_time(&pilot, budget, task, |choice, pace| {
            scene.resample(&self.original, &choice.samples());
            let (rendered, resumed) = self.trace(scene, choice, Some(pace))?;
            renders += 1;
            let is_ended = rendered.finished || self.seen.interrupt.signal().is_some();
            if let Some(expected) = pace.expected().filter(|_| !is_ended) {
                let planned = choice.seconds;
                let words =
                    format!("too slow: about {expected:.1} s of tracing instead of {planned:.1} s");
                say(self.seen, &(words + "; starting again with fewer points"));
            }
            Ok(((rendered, resumed), is_ended))
        })?;
        let Some((choice, (rendered, resumed))) = done else { return Ok(None) };
        if !rendered.finished {
            return Ok(Some(Traced { rendered, preset, goal: None, resumed }));
        }
        let found = self.measure(scene, &rendered)?;
        let asked = args.time_budget.map_or_else(String::new, |seconds| format!("{seconds} s"));
        let goal = goal(asked, &choice, found, renders);
        Ok(Some(Traced { rendered, preset, goal: Some(goal), resumed }))
    }

    fn trace(
        &self,
        scene: &PreparedScene,
        choice: &Choice,
        pace: Option<&Pace<'_>>,
    ) -> Result<(Rendered, f64)> {
        say(self.seen, &format!("chosen: {choice}"));
        trace_once(self.seen, scene, pace)
    }

    /// The measured error, if there is one.
    fn measure(&self, scene: &PreparedScene, rendered: &Rendered) -> Result<Option<Measured>> {
        let found = match is_sampled(scene) {
            true => Some(error(scene, Some(&rendered.film), self.seen.args.seed)?),
            false => None,
        };
        say(self.seen, &measured(found, leaves_out_aliasing(scene)));
        Ok(found)
    }
}

/// The measured error in words, and whether it leaves out what one ray a pixel misses at edges.
fn measured(error: Option<Measured>, without_aliasing: bool) -> String {
    match error {
        Some(Measured { error, .. }) if without_aliasing => format!(
            "measured error: {}, without the aliasing of one ray through the centre of each pixel",
            figure(error)
        ),
        Some(Measured { error, .. }) => format!("measured error: {}", figure(error)),
        None => {
            "error not measured: one ray through the centre of each pixel, without random samples"
                .to_owned()
        }
    }
}

/// Replaces the tree of `preset` if the expected rays are worth it, unless a preset was requested.
/// Returns the preset in use.
fn choose_tree(args: &RenderArgs, scene: &mut PreparedScene, preset: Preset) -> Preset {
    if args.scene_options.bvh.is_some() {
        return preset;
    }
    let best = Preset::choose(scene.accel.geometry().held() as u64, scene.expected_rays());
    if best != preset {
        scene.accel.rebuild(best);
    }
    best
}

fn unreached(asked: f64, choice: &Choice) -> Error {
    let message = format!("the target error {asked} was not reached");
    let remedy = match choice.points.side {
        MOST_SIDE => "the image has as many points as possible; choose a larger error",
        _ => "the image is the last and best; choose a larger error, or more points in the scene",
    };
    Error::new(ErrorKind::Usage, message).remedy(remedy)
}

/// The goal and its outcome, for the statistics.
fn goal(asked: String, choice: &Choice, found: Option<Measured>, renders: u32) -> Value {
    json!({
        "asked": asked,
        "samples": choice.to_string(),
        "expected_error": choice.error,
        "expected_seconds": choice.seconds,
        "found_error": found.map(|found| found.error),
        "renders": renders,
    })
}
