//! Renders for a target error or a time budget: a pilot chooses the samples and predicts the error,
//! which is then measured. A render that turns out too slow for its budget begins again with fewer.

use std::time::Instant;

use serde_json::{Value, json};

use super::parts::trace as trace_once;
use super::show::Rendering;
use crate::common::{tell, warn};
use crate::interrupt;
use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::prepared::{Original, PreparedScene};
use wavecrest_core::render::Rendered;
use wavecrest_report::accuracy::pilot::budget::{Budget, Overhead, Pace, in_time};
use wavecrest_report::accuracy::pilot::target::{Reached, reach};
use wavecrest_report::accuracy::pilot::{
    Chosen, MOST_SIDE, MeasuredError, Pilot, error, is_sampled, leaves_out_aliasing, measured_share,
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

/// Renders `scene`, whose tree has `preset`, as requested. `start` is the start of the command.
pub(super) fn trace(
    rendering: &Rendering<'_>,
    scene: &mut PreparedScene,
    preset: Preset,
    start: Instant,
) -> Result<Traced> {
    let args = rendering.args;
    let original = scene.original();
    let mut aimed = Aimed { rendering, scene, original, preset };
    let goal = match (args.target_error, args.time_budget) {
        (Some(error), _) => aimed.for_error(error)?,
        (None, Some(seconds)) => {
            let clock = || start.elapsed().as_secs_f64();
            aimed.in_time(&Budget::new(&clock, seconds), seconds)?
        }
        (None, None) => None,
    };
    let Aimed { scene, preset, .. } = aimed;
    match goal {
        // Neither has a checkpoint.
        Some((rendered, goal)) => Ok(Traced { rendered, preset, goal, resumed: 0.0 }),
        None => {
            let (rendered, resumed) = trace_once(rendering, scene, None)?;
            Ok(Traced { rendered, preset, goal: None, resumed })
        }
    }
}

/// A scene to render with chosen samples.
struct Aimed<'a> {
    rendering: &'a Rendering<'a>,
    scene: &'a mut PreparedScene,
    /// Its own samples.
    original: Original,
    /// The preset of its tree.
    preset: Preset,
}

/// A render, and its goal if it is finished.
type AimedRender = (Rendered, Option<Value>);

impl Aimed<'_> {
    /// Renders, and repeats with more points while the error is above `target`. `None` without a
    /// choice.
    fn for_error(&mut self, target: f64) -> Result<Option<AimedRender>> {
        let pilot = Pilot::run(self.scene, &self.original, self.rendering.args.seed)?;
        let reached = reach(&pilot, target, |choice| {
            self.choose(choice);
            let rendered = self.trace(choice, None)?;
            let found = if rendered.finished { self.measure(&rendered)? } else { None };
            Ok((rendered, found))
        })?;
        let Some(Reached { choice, rendered, found, renders }) = reached else { return Ok(None) };
        if found.is_some_and(|found| found.error > target) {
            let error = unreached(target, &choice).in_file(&self.rendering.args.scene);
            warn(&[Warning::from_error(&error)]);
        }
        let goal = goal(format!("error {target}"), &choice, found, renders);
        let goal = rendered.finished.then_some(goal);
        Ok(Some((rendered, goal)))
    }

    /// Renders within `budget`, of so many seconds. `None` without a choice.
    fn in_time(&mut self, budget: &Budget<'_>, seconds: f64) -> Result<Option<AimedRender>> {
        let args = self.rendering.args;
        let pilot = Pilot::within(self.scene, &self.original, args.seed, &budget.for_pilot())?;
        if let Some(choice) = pilot.for_time(budget.left()) {
            self.choose(&choice);
        }
        let [width, height] = self.scene.camera.size().map(f64::from);
        let in_flight = args.batch as usize * rayon::current_num_threads();
        let overhead = Overhead {
            measuring: measured_share(self.scene.camera.size()),
            in_flight: in_flight as f64 / (width * height),
        };
        let mut renders = 0;
        let last = in_time(&pilot, budget, overhead, |choice, pace| {
            self.scene.resample(&self.original, &choice.samples());
            let rendered = self.trace(choice, Some(pace))?;
            renders += 1;
            let is_ended = rendered.finished || interrupt::signal().is_some();
            if let Some(expected) = pace.expected().filter(|_| !is_ended) {
                let planned = choice.seconds;
                let words =
                    format!("too slow: about {expected:.1} s of tracing instead of {planned:.1} s");
                self.say(&(words + "; starting again with fewer points"));
            }
            Ok((rendered, is_ended))
        })?;
        let Some((choice, rendered)) = last else { return Ok(None) };
        if !rendered.finished {
            return Ok(Some((rendered, None)));
        }
        let found = self.measure(&rendered)?;
        let goal = goal(format!("{seconds} s"), &choice, found, renders);
        Ok(Some((rendered, Some(goal))))
    }

    /// Takes the samples of `choice`, and the tree that the expected rays are worth, unless a preset
    /// was requested.
    fn choose(&mut self, choice: &Chosen) {
        self.scene.resample(&self.original, &choice.samples());
        if self.rendering.args.scene_options.bvh.is_some() {
            return;
        }
        let (held, rays) = (self.scene.accel.geometry().held(), self.scene.expected_rays());
        let best = Preset::choose(held as u64, rays);
        if best != self.preset {
            self.scene.accel.rebuild(best);
            self.preset = best;
        }
    }

    fn trace(&self, choice: &Chosen, pace: Option<&Pace<'_>>) -> Result<Rendered> {
        self.say(&format!("chosen: {choice}"));
        trace_once(self.rendering, self.scene, pace).map(|(rendered, _)| rendered)
    }

    /// The measured error, if there is one.
    fn measure(&self, rendered: &Rendered) -> Result<Option<MeasuredError>> {
        let found = match is_sampled(self.scene) {
            true => Some(error(self.scene, Some(&rendered.film), self.rendering.args.seed)?),
            false => None,
        };
        self.say(&measured(found, leaves_out_aliasing(self.scene)));
        Ok(found)
    }

    /// Prints a note, and adds it to the log.
    fn say(&self, words: &str) {
        self.rendering.reporter.note("choice", || words.to_owned());
        if !self.rendering.args.scene_options.quiet {
            tell(words);
        }
    }
}

/// The measured error in words, and whether it leaves out what one ray a pixel misses at edges.
fn measured(error: Option<MeasuredError>, without_aliasing: bool) -> String {
    match error {
        Some(MeasuredError { error, .. }) if without_aliasing => format!(
            "measured error: {}, without the aliasing of one ray through the centre of each pixel",
            figure(error)
        ),
        Some(MeasuredError { error, .. }) => format!("measured error: {}", figure(error)),
        None => {
            "error not measured: one ray through the centre of each pixel, without random samples"
                .to_owned()
        }
    }
}

fn unreached(target: f64, choice: &Chosen) -> Error {
    let message = format!("the target error {target} was not reached");
    let remedy = match choice.points.side {
        MOST_SIDE => "the image has as many points as possible; choose a larger error",
        _ => "the image is the last and best; choose a larger error, or more points in the scene",
    };
    Error::new(ErrorKind::Usage, message).remedy(remedy)
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
