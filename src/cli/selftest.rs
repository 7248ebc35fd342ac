//! `selftest`: the hard cases, on this machine.

use std::fmt::Write as _;
use std::time::Instant;

use serde::Serialize;

use super::common::{Threads, print, progress_bar, to_json};
use crate::error::{Error, ErrorKind, Result};
use crate::selftest::{CASES, Case, Count, Effort, Outcome, case};

/// Tries what breaks ray tracers: every kernel, with all instructions that the processor has.
///
/// Exits with 1 if a case does not hold.
#[derive(Clone, Debug, clap::Args)]
pub struct SelftestArgs {
    /// Try this case alone; may be given several times
    #[arg(long = "case", value_name = "NUMBER")]
    pub cases: Vec<u32>,
    /// Try as much as each bound speaks of: minutes, not seconds
    #[arg(long)]
    pub full: bool,
    /// What the inputs follow from: a case that fails, fails again with the same seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Show no progress
    #[arg(short, long)]
    pub quiet: bool,
    /// On how many threads
    #[command(flatten)]
    pub threads: Threads,
}

/// A case and what came of it.
#[derive(Serialize)]
struct Row {
    case: u32,
    name: &'static str,
    bound: &'static str,
    holds: bool,
    #[serde(flatten)]
    outcome: Outcome,
    seconds: f64,
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Scoreboard {
    version: &'static str,
    seed: u64,
    full: bool,
    cases: Vec<Row>,
}

/// Tries the cases that the arguments name. Whether all hold.
///
/// # Errors
/// If there is no such case, or standard output cannot be written.
pub fn run(args: &SelftestArgs) -> Result<bool> {
    let cases = named(&args.cases)?;
    let count = if args.full { Count::Full } else { Count::Quick };
    let effort = Effort { seed: args.seed, count };
    let bar = progress_bar(args.quiet, "{wide_bar} {pos}/{len} {msg}");
    bar.set_length(cases.len() as u64);
    let rows = args.threads.run(|| {
        let rows = cases.iter().map(|case| {
            bar.set_message(case.name);
            let row = row(case, &effort);
            bar.inc(1);
            row
        });
        Ok(rows.collect::<Vec<_>>())
    })?;
    bar.finish_and_clear();
    let all_hold = rows.iter().all(|row| row.holds);
    let text = if args.json {
        let version = env!("CARGO_PKG_VERSION");
        to_json(&Scoreboard { version, seed: args.seed, full: args.full, cases: rows })?
    } else {
        text(&rows, args)
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

fn row(case: &Case, effort: &Effort) -> Row {
    let start = Instant::now();
    let outcome = case.run(effort);
    Row {
        case: case.number,
        name: case.name,
        bound: case.bound,
        holds: outcome.holds(),
        outcome,
        seconds: start.elapsed().as_secs_f64(),
    }
}

/// A line for each case, and below it what failed.
fn text(rows: &[Row], args: &SelftestArgs) -> String {
    let mut text = String::new();
    for row in rows {
        let verdict = if row.holds { "holds" } else { "FAILS" };
        let Outcome { tried, failed, first } = &row.outcome;
        let _ = writeln!(
            text,
            "{:>2}  {verdict}  {tried:>11} asked {:>8.2} s  {}: {}",
            row.case, row.seconds, row.name, row.bound
        );
        if let Some(first) = first {
            let again = format!("wavecrest selftest --case {} --seed {}", row.case, args.seed);
            let full = if args.full { " --full" } else { "" };
            let _ =
                writeln!(text, "    {failed} failed. The first: {first}\n    Again: {again}{full}");
        }
    }
    text
}
