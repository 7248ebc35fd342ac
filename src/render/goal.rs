//! Renders for a target error or a time budget: a pilot chooses the samples and predicts the error,
//! which is then measured.

use std::time::Instant;

use super::args::RenderArgs;
use super::parts::trace as trace_once;
use super::show::Seen;
use crate::common::tell;
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::math::sampling::Points;
use wavecrest_core::prepared::{Original, PreparedScene};
use wavecrest_core::render::Rendered;
use wavecrest_report::accuracy::pilot::{Choice, Pilot, error, is_sampled};
use wavecrest_report::plot::number::figure;
use wavecrest_report::statistics::Goal;

/// Largest number of renders for one target error.
const MAX_RENDERS: u32 = 3;

/// Accepted ratio of the error to the target.
const ACCEPTED: f64 = 1.1;

/// Share of the remaining time to plan for: the rest is for writing and for the error of the pilot.
const PLANNED_SHARE: f64 = 0.9;

/// A render with its preset and its choice of samples.
pub(super) struct Traced {
    pub(super) rendered: Rendered,
    pub(super) preset: Preset,
    pub(super) goal: Option<Goal>,
    /// The share of it that a checkpoint held, from 0 to 1.
    pub(super) resumed: f64,
}

/// Renders `scene`, whose tree has `preset`, as requested by the arguments, reporting to `seen`.
/// `start` is the start of the command.
pub(super) fn trace(
    args: &RenderArgs,
    scene: &mut PreparedScene,
    preset: Preset,
    seen: &Seen<'_>,
    start: Instant,
) -> Result<Traced> {
    if args.target_error.is_none() && args.time_budget.is_none() {
        return plain(args, scene, preset, seen);
    }
    let original = scene.original();
    let pilot = Pilot::run(scene, &original, args.seed)?;
    match choose(args, &pilot, start) {
        Some(choice) => Aimed { args, seen, original }.trace(scene, choice, preset),
        None => plain(args, scene, preset, seen),
    }
}

/// The choice of the pilot; `None` without a goal.
fn choose(args: &RenderArgs, pilot: &Pilot, start: Instant) -> Option<Choice> {
    match (args.target_error, args.time_budget) {
        (Some(error), _) => pilot.for_error(error),
        (None, Some(budget)) => {
            pilot.for_time((budget - start.elapsed().as_secs_f64()).max(0.0) * PLANNED_SHARE)
        }
        (None, None) => None,
    }
}

/// Prints a note, and adds it to the log.
fn say(args: &RenderArgs, seen: &Seen<'_>, words: &str) {
    seen.reporter.note("choice", || words.to_owned());
    if !args.scene_options.quiet {
        tell(words);
    }
}

/// A render with chosen samples.
struct Aimed<'a> {
    args: &'a RenderArgs,
    seen: &'a Seen<'a>,
    /// The scene's own samples.
    original: Original,
}

impl Aimed<'_> {
    /// Renders, and repeats with more points while the error is too large.
    fn trace(
        &self,
        scene: &mut PreparedScene,
        mut choice: Choice,
        mut preset: Preset,
    ) -> Result<Traced> {
        let args = self.args;
        let mut renders = 0;
        loop {
            scene.resample(&self.original, &choice.samples());
            preset = choose_tree(args, scene, preset);
            say(args, self.seen, &format!("chosen: {choice}"));
            let (rendered, resumed) = trace_once(args, scene, self.seen)?;
            if !rendered.finished {
                return Ok(Traced { rendered, preset, goal: None, resumed });
            }
            renders += 1;
            let found = match is_sampled(scene) {
                true => Some(error(scene, Some(&rendered.film), args.seed)?),
                false => None,
            };
            say(args, self.seen, &measured(found));
            match args.target_error.zip(found).filter(|(asked, found)| *found > asked * ACCEPTED) {
                Some((asked, found)) if renders < MAX_RENDERS => {
                    choice = finer(&choice, found / asked);
                }
                _ => {
                    let goal = Some(goal(args, &choice, found, renders));
                    return Ok(Traced { rendered, preset, goal, resumed });
                }
            }
        }
    }
}

/// The measured error in words.
fn measured(error: Option<f64>) -> String {
    match error {
        Some(error) => format!("measured error: {}", figure(error)),
        None => {
            "error not measured: one ray through the centre of each pixel, without random samples"
                .to_owned()
        }
    }
}

/// Renders with the scene's own samples.
fn plain(
    args: &RenderArgs,
    scene: &PreparedScene,
    preset: Preset,
    seen: &Seen<'_>,
) -> Result<Traced> {
    let (rendered, resumed) = trace_once(args, scene, seen)?;
    Ok(Traced { rendered, preset, goal: None, resumed })
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

/// More points after an error `excess` times the target, as for independent points: this suffices
/// for any sampler.
fn finer(choice: &Choice, excess: f64) -> Choice {
    let side = (f64::from(choice.points.side) * excess).ceil() as u32;
    let points = Points { side: side.max(choice.points.side + 1), ..choice.points };
    let more = f64::from(points.count()) / f64::from(choice.points.count());
    Choice { points, error: choice.error / excess, seconds: choice.seconds * more, ..*choice }
}

fn goal(args: &RenderArgs, choice: &Choice, found: Option<f64>, renders: u32) -> Goal {
    let asked = match (args.target_error, args.time_budget) {
        (Some(error), _) => format!("error {error}"),
        (None, Some(seconds)) => format!("{seconds} s"),
        (None, None) => String::new(),
    };
    Goal {
        asked,
        samples: choice.to_string(),
        expected_error: choice.error,
        expected_seconds: choice.seconds,
        found_error: found,
        renders,
    }
}
