//! `selftest`: the hard cases, on this machine.

mod examine;
mod text;

use std::path::PathBuf;
use std::time::Instant;

use serde::Serialize;
use serde_json::json;

use self::examine::Examined;
use super::common::{Threads, known, print, progress_bar, to_json, whole};
use crate::choice::choice;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::errors::{HitErrors, SITUATIONS, Situation};
use wavecrest_report::selftest::{CASES, Case, Count, Effort, Outcome, case};
use wavecrest_scene::load::{LoadOptions, survey};

/// Test cases that break ray tracers, on every kernel and instruction set of this machine.
///
/// The exit code is 1 if a case fails in exact precision. Failures of fast precision are expected,
/// and printed.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SelftestArgs {
    /// Also test this scene or mesh for leaks, self-intersections and samples that are not finite
    pub(crate) scene: Option<PathBuf>,
    /// Run only this case; can be given several times
    #[arg(long = "case", value_name = "NUMBER")]
    pub(crate) cases: Vec<u32>,
    /// Test only this precision; can be given several times
    #[arg(long, value_name = "PRECISION", value_parser = choice::<Precision>())]
    pub(crate) precision: Vec<Precision>,
    /// Run as many trials as each bound states: minutes instead of seconds
    #[arg(long)]
    pub(crate) full: bool,
    /// Seed of the inputs; the same seed repeats a failure
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole(0..=u64::MAX))]
    pub(crate) seed: u64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Show no progress
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// Threads
    #[command(flatten)]
    pub(crate) threads: Threads,
}

/// The outcome of a case in a precision.
#[derive(Serialize)]
struct Trial {
    precision: Precision,
    holds: bool,
    #[serde(flatten)]
    outcome: Outcome,
}

/// A case with its outcomes.
#[derive(Serialize)]
struct Row {
    case: u32,
    name: &'static str,
    bound: &'static str,
    trials: Vec<Trial>,
    seconds: f64,
}

/// The errors of a precision in a situation.
#[derive(Serialize)]
struct Yield {
    situation: &'static str,
    precision: Precision,
    #[serde(flatten)]
    errors: HitErrors,
}

/// Runs the cases that the arguments name. Returns whether all pass.
///
/// # Errors
/// If there is no such case, or standard output cannot be written.
pub(crate) fn run(args: &SelftestArgs) -> Result<bool> {
    let cases = named(&args.cases)?;
    // A file that cannot be read is an error now, not after the cases.
    args.scene.as_deref().map(|file| survey(file, &LoadOptions::default())).transpose()?;
    let count = if args.full { Count::Full } else { Count::Quick };
    let mut precisions = args.precision.clone();
    if precisions.is_empty() {
        precisions.extend(Precision::ALL);
    }
    let bar = progress_bar(args.quiet, "{wide_bar} {pos}/{len} {msg}, {eta} left");
    bar.set_length((cases.len() * precisions.len()) as u64);
    let effort = |&precision: &Precision| Effort { precision, seed: args.seed, count };
    let efforts: Vec<Effort> = precisions.iter().map(effort).collect();
    let (rows, errors, scene) = args.threads.run(|| {
        let rows = cases.iter().map(|case| {
            bar.set_message(case.name);
            row(case, &efforts, || bar.inc(1))
        });
        let rows = rows.collect::<Vec<_>>();
        bar.set_message("errors of hits");
        let errors = if args.cases.is_empty() { errors_of_hits(&efforts) } else { Vec::new() };
        bar.set_message("the scene");
        let scene = args.scene.as_deref().map(|file| examine::run(file, &efforts));
        Ok((rows, errors, scene.transpose()?))
    })?;
    bar.finish_and_clear();
    let mut trials = rows.iter().flat_map(|row| &row.trials);
    let all_hold = trials.all(|trial| trial.holds || trial.precision == Precision::Fast)
        && scene.as_ref().is_none_or(Examined::holds);
    let text = if args.json {
        to_json(&known(json!({
            "version": env!("CARGO_PKG_VERSION"),
            "seed": args.seed,
            "full": args.full,
            "cases": rows,
            // Errors of hits, in ulp; none if cases are named.
            "errors": Some(errors).filter(|errors| !errors.is_empty()),
            "scene": scene,
        })))?
    } else {
        let errors = if errors.is_empty() { String::new() } else { text::of_errors(&errors) };
        text::of(&rows, args) + &errors + &scene.as_ref().map_or_else(String::new, Examined::text)
    };
    print(&text)?;
    Ok(all_hold)
}

/// The cases with these numbers, or all.
fn named(numbers: &[u32]) -> Result<Vec<&'static Case>> {
    if numbers.is_empty() {
        return Ok(CASES.iter().collect());
    }
    let find = |&number: &u32| {
        case(number).ok_or_else(|| {
            let known: Vec<String> = CASES.iter().map(|case| case.number.to_string()).collect();
            Error::new(ErrorKind::Usage, "there is no such case")
                .value(number)
                .remedy(format!("name one of {}", known.join(", ")))
        })
    };
    numbers.iter().map(find).collect()
}

/// The case in each precision; `step` is called after each.
fn row(case: &Case, efforts: &[Effort], step: impl Fn()) -> Row {
    let start = Instant::now();
    let trial = |effort: &Effort| {
        let outcome = case.run(effort);
        step();
        Trial { precision: effort.precision, holds: outcome.holds(), outcome }
    };
    let trials = efforts.iter().map(trial).collect();
    let Case { number, name, bound, .. } = *case;
    Row { case: number, name, bound, trials, seconds: start.elapsed().as_secs_f64() }
}

/// The errors in all situations.
fn errors_of_hits(efforts: &[Effort]) -> Vec<Yield> {
    let of = |situation: &'static Situation| {
        efforts.iter().map(move |effort| Yield {
            situation: situation.name,
            precision: effort.precision,
            errors: situation.errors(effort),
        })
    };
    SITUATIONS.iter().flat_map(of).collect()
}
