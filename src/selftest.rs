//! `selftest`: the hard cases, on this machine.

mod asked;
mod examine;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use serde::Serialize;

use self::asked::Asked;
use self::examine::Examined;
use super::common::{Threads, print, progress_bar, to_json};
use crate::choice::choice;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::{CASES, Case, Count, Outcome, case};

/// Tries what breaks ray tracers: every kernel, with all instructions that the processor has.
///
/// Exits with 1 if a case does not hold in robust or exact arithmetic. What fast arithmetic fails is printed,
/// and is its price.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SelftestArgs {
    /// Try this scene too, or this mesh (.ply, .obj): leaks, self-hits, samples that are not finite
    pub(crate) scene: Option<PathBuf>,
    /// Try this case alone; may be given several times
    #[arg(long = "case", value_name = "NUMBER")]
    pub(crate) cases: Vec<u32>,
    /// Try this precision alone; may be given several times
    #[arg(long, value_name = "PRECISION", value_parser = choice::<Precision>())]
    pub(crate) precision: Vec<Precision>,
    /// Try as much as each bound speaks of: minutes, not seconds
    #[arg(long)]
    pub(crate) full: bool,
    /// What the inputs follow from: a case that fails, fails again with the same seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Show no progress
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// On how many threads
    #[command(flatten)]
    pub(crate) threads: Threads,
}

/// What came of a case in a precision.
#[derive(Serialize)]
struct Trial {
    precision: Precision,
    holds: bool,
    #[serde(flatten)]
    outcome: Outcome,
    /// Time for an answer, as a multiple of what fast arithmetic takes.
    #[serde(skip_serializing_if = "Option::is_none")]
    times_fast: Option<f64>,
}

/// A case and what came of it.
#[derive(Serialize)]
struct Row {
    case: u32,
    name: &'static str,
    bound: &'static str,
    trials: Vec<Trial>,
    seconds: f64,
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Scoreboard {
    version: &'static str,
    seed: u64,
    full: bool,
    cases: Vec<Row>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<Examined>,
}

/// Tries the cases that the arguments name. Whether all hold.
///
/// # Errors
/// If there is no such case, or standard output cannot be written.
pub(crate) fn run(args: &SelftestArgs) -> Result<bool> {
    let cases = named(&args.cases)?;
    let count = if args.full { Count::Full } else { Count::Quick };
    let mut precisions = args.precision.clone();
    if precisions.is_empty() {
        precisions.extend(Precision::ALL);
    }
    let bar = progress_bar(args.quiet, "{wide_bar} {pos}/{len} {msg}");
    bar.set_length(cases.len() as u64);
    let asked = Asked { seed: args.seed, count, precisions };
    let (rows, scene) = args.threads.run(|| {
        let rows = cases.iter().map(|case| {
            bar.set_message(case.name);
            let row = row(case, &asked);
            bar.inc(1);
            row
        });
        let rows = rows.collect::<Vec<_>>();
        bar.set_message("the scene");
        let scene = args.scene.as_deref().map(|file| examine::run(file, &asked));
        Ok((rows, scene.transpose()?))
    })?;
    bar.finish_and_clear();
    let mut trials = rows.iter().flat_map(|row| &row.trials);
    let all_hold = trials.all(|trial| trial.holds || trial.precision == Precision::Fast)
        && scene.as_ref().is_none_or(Examined::holds);
    let text = if args.json {
        let version = env!("CARGO_PKG_VERSION");
        to_json(&Scoreboard { version, seed: args.seed, full: args.full, cases: rows, scene })?
    } else {
        text(&rows, args) + &scene.as_ref().map_or_else(String::new, Examined::text)
    };
    print(&text)?;
    Ok(all_hold)
}

/// The cases of these numbers, or all.
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

fn row(case: &Case, asked: &Asked) -> Row {
    let start = Instant::now();
    let mut trials: Vec<Trial> = Vec::new();
    for effort in asked.efforts() {
        let outcome = case.run(&effort);
        let fast = trials.iter().find(|trial| trial.precision == Precision::Fast);
        let fast = fast.map_or(outcome.nanoseconds(), |trial| trial.outcome.nanoseconds());
        let times_fast = match (outcome.nanoseconds(), fast) {
            (Some(own), Some(fast)) if asked.precisions.contains(&Precision::Fast) => {
                Some(own / fast)
            }
            _ => None,
        };
        trials.push(Trial {
            precision: effort.precision,
            holds: outcome.holds(),
            outcome,
            times_fast,
        });
    }
    let Case { number, name, bound, .. } = *case;
    Row { case: number, name, bound, trials, seconds: start.elapsed().as_secs_f64() }
}

/// A paragraph for each case, with a line for each precision; and how many cases hold in each.
fn text(rows: &[Row], args: &SelftestArgs) -> String {
    let mut text = String::new();
    for row in rows {
        let _ = writeln!(text, "{:>2}  {}: {}", row.case, row.name, row.bound);
        for trial in &row.trials {
            write_trial(&mut text, row, trial, args);
        }
    }
    let mut precisions: Vec<Precision> = Vec::new();
    for trial in rows.iter().flat_map(|row| &row.trials) {
        if !precisions.contains(&trial.precision) {
            precisions.push(trial.precision);
        }
    }
    for precision in precisions {
        let trials = rows.iter().flat_map(|row| &row.trials);
        let trials = trials.filter(|trial| trial.precision == precision);
        let (all, holding) = trials
            .fold((0, 0), |(all, holding), trial| (all + 1, holding + usize::from(trial.holds)));
        let _ = writeln!(text, "{:<7}{holding} of {all} cases hold", precision.name());
    }
    text
}

fn write_trial(text: &mut String, row: &Row, trial: &Trial, args: &SelftestArgs) {
    let Outcome { tried, failed, first, .. } = &trial.outcome;
    let precision = trial.precision.name();
    let verdict = if trial.holds { "holds" } else { "FAILS" };
    let time = trial.outcome.nanoseconds().map_or(String::new(), |ns| format!("{ns:>9.1} ns each"));
    let ratio = trial.times_fast.map_or(String::new(), |times| format!("  {times:>5.2} x fast"));
    let _ =
        writeln!(text, "    {precision:<7}{verdict}{failed:>11} of {tried:>11} wrong{time}{ratio}");
    if let Some(first) = first {
        let full = if args.full { " --full" } else { "" };
        let _ = writeln!(
            text,
            "      the first: {first}\n      again: wavecrest selftest --case {} --precision {precision} \
             --seed {}{full}",
            row.case, args.seed
        );
    }
}
