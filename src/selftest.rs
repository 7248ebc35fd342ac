//! `selftest`: the hard cases, on this machine.

mod examine;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use serde::Serialize;
use serde_json::json;

use self::examine::Examined;
use super::common::{Threads, choice, known, print, progress_bar, rounded, to_json, whole};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::errors::{Distribution, HitErrors, SITUATIONS, Situation, ulps};
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
struct CaseRow {
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
        let errors = if errors.is_empty() { String::new() } else { text_of_errors(&errors) };
        table_and_failures(&rows, args)
            + &errors
            + &scene.as_ref().map_or_else(String::new, Examined::text)
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
fn row(case: &Case, efforts: &[Effort], step: impl Fn()) -> CaseRow {
    let start = Instant::now();
    let trial = |effort: &Effort| {
        let outcome = case.run(effort);
        step();
        Trial { precision: effort.precision, holds: outcome.holds(), outcome }
    };
    let trials = efforts.iter().map(trial).collect();
    let Case { number, name, bound, .. } = *case;
    CaseRow { case: number, name, bound, trials, seconds: start.elapsed().as_secs_f64() }
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

/// The whole text.
fn table_and_failures(rows: &[CaseRow], args: &SelftestArgs) -> String {
    let precisions: Vec<Precision> =
        rows.first().map_or_else(Vec::new, |row| row.trials.iter().map(|t| t.precision).collect());
    verdict(rows, &precisions) + &table(rows, &precisions) + &failures(rows, &precisions, args)
}

/// The number of passed cases in each precision, and the share that fast misses.
fn verdict(rows: &[CaseRow], precisions: &[Precision]) -> String {
    let all = rows.len();
    let cases = if all == 1 { "case" } else { "cases" };
    let mut text = String::new();
    for (index, precision) in precisions.iter().enumerate() {
        let failing = rows.iter().filter(|row| !row.trials[index].holds).count();
        let name = precision.name();
        let _ = match (failing, precision) {
            (0, _) => writeln!(text, "{name} passes all {all} {cases}"),
            (_, Precision::Fast) => {
                writeln!(text, "{name} fails in {failing} of {all} {cases}, as expected")
            }
            _ => writeln!(text, "{name} FAILS in {failing} of {all} {cases}"),
        };
    }
    text
}

/// A row for each case.
fn table(rows: &[CaseRow], precisions: &[Precision]) -> String {
    let widest = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
    let mut text = format!("\ncase  {:<widest$}", "input");
    precisions.iter().for_each(|precision| text += &format!("  {:>9}", precision.name()));
    text.push('\n');
    for row in rows {
        let _ = write!(text, "{:>4}  {:<widest$}", row.case, row.name);
        row.trials.iter().for_each(|trial| text += &format!("  {:>9}", answers(trial)));
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    if text.contains('%') {
        text += "%: share of wrong answers\n";
    }
    text
}

/// Whether a case passes, or the share of wrong answers.
fn answers(Trial { precision, holds, outcome, .. }: &Trial) -> String {
    match (holds, precision) {
        (true, _) => "pass".to_owned(),
        (false, Precision::Fast) => {
            let share = 100.0 * outcome.failed as f64 / outcome.tried.max(1) as f64;
            format!("{} %", rounded(share, 2))
        }
        (false, _) => "FAIL".to_owned(),
    }
}

/// Failures, and how to repeat them. Those in fast precision are listed only if no other precision
/// was tested.
fn failures(rows: &[CaseRow], precisions: &[Precision], args: &SelftestArgs) -> String {
    let mut text = String::new();
    let full = if args.full { " --full" } else { "" };
    for row in rows {
        for trial in row.trials.iter().filter(|trial| !trial.holds) {
            if trial.precision == Precision::Fast && precisions != [Precision::Fast] {
                continue;
            }
            let Outcome { tried, failed, first, .. } = &trial.outcome;
            let precision = trial.precision.name();
            let first = first.as_deref().unwrap_or("nothing was tested");
            let _ = writeln!(
                text,
                "\n{} in {precision}: {failed} of {tried} wrong; {}\n  the first: {first}\n  again: wavecrest \
                 selftest --case {} --precision {precision} --seed {}{full}",
                row.name, row.bound, row.case, args.seed
            );
        }
    }
    text
}

/// A row for each, with the bound for 999 of 1000 hits.
fn text_of_errors(yields: &[Yield]) -> String {
    let widest = yields.iter().map(|row| row.situation.len()).max().unwrap_or(0);
    let mut text = format!(
        "\n{:<widest$}  {:<9}  {:>12}  {:>12}  {:>12}  {:>20}\n",
        "error of 999 in 1000 hits", "precision", "t", "point", "normal", "worst t"
    );
    for Yield { situation, precision, errors } in yields {
        let most = |e: &Distribution| e.within(0.999).map_or_else(|| "-".to_owned(), ulps);
        let [t, point, normal] = [&errors.t, &errors.point, &errors.normal].map(most);
        let (name, worst) = (precision.name(), ulps(errors.t.worst));
        let _ = writeln!(
            text,
            "{situation:<widest$}  {name:<9}  {t:>12}  {point:>12}  {normal:>12}  {worst:>20}"
        );
    }
    text
}
