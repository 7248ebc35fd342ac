//! `selftest`: the hard cases, on this machine.

mod built_in;
mod examine;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::Serialize;
use serde_json::json;

use self::examine::Examined;
use super::common::{Threads, choice, known, print, progress_bar, rounded, to_json, whole};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::Listed;
use wavecrest_base::words::counted;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_report::selftest::{CASES, Case, CasePart, Count, Effort, Losses, SEED, case};
use wavecrest_scene::load::{LoadOptions, load};

/// Test that this machine finds the recorded bits in cases that break ray tracers.
///
/// Hits and images in exact precision are the same on every machine. Each case is traced by every
/// kernel, tracer and instruction set, and compared with the hash that is recorded for it; the exit
/// code is 1 if one differs. Of fast precision, the rays that it loses are counted.
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
    /// Trace a hundred times as many rays, for minutes, and compare them with the reference kernel
    #[arg(long)]
    pub(crate) full: bool,
    /// Seed of the inputs; bits are recorded for the default, others are compared with the reference kernel
    #[arg(long, value_name = "N", default_value_t = SEED, value_parser = whole(0..=u64::MAX))]
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

/// What was found in a case.
#[derive(Serialize)]
struct CaseRow {
    case: u32,
    name: &'static str,
    /// What is the same or differs in exact precision; absent if that is not tested.
    #[serde(skip_serializing_if = "Option::is_none")]
    exact: Option<Vec<CasePart>>,
    /// What fast precision loses; absent if that is not tested, or the case has no rays.
    #[serde(skip_serializing_if = "Option::is_none")]
    fast: Option<Losses>,
    seconds: f64,
}

impl CaseRow {
    /// The parts in exact precision that are not the same.
    fn failed(&self) -> impl Iterator<Item = &CasePart> {
        self.exact.iter().flatten().filter(|part| !part.outcome.holds())
    }
}

/// Runs the cases that the arguments name. Returns whether all pass.
///
/// # Errors
/// If there is no such case, a file cannot be read, or standard output cannot be written.
pub(crate) fn run(args: &SelftestArgs) -> Result<bool> {
    let cases = named(&args.cases)?;
    let count = if args.full { Count::Full } else { Count::Quick };
    let mut precisions = args.precision.clone();
    if precisions.is_empty() {
        precisions.extend(Precision::ALL);
    }
    let bar = progress_bar(args.quiet, "{wide_bar} {pos}/{len} {msg}, {eta} left");
    bar.set_length(cases.len() as u64);
    let effort = |&precision: &Precision| Effort { precision, seed: args.seed, count };
    let efforts: Vec<Effort> = precisions.iter().map(effort).collect();
    let folder = built_in::unpacked()?;
    let _listed = Listed::new(folder.path());
    let (rows, scene) = args.threads.run(|| {
        // A file that cannot be read is an error now, not after the cases.
        args.scene.as_deref().map(|file| load(file, &LoadOptions::default())).transpose()?;
        let rows = cases.iter().map(|case| {
            bar.set_message(case.name);
            let row = row(case, &efforts, &folder.path().join("scenes"));
            bar.inc(1);
            row
        });
        let rows = rows.collect::<Vec<_>>();
        bar.set_message("the scene");
        let scene = args.scene.as_deref().map(|file| examine::run(file, &efforts));
        Ok((rows, scene.transpose()?))
    })?;
    bar.finish_and_clear();
    let all_hold = rows.iter().all(|row| row.failed().next().is_none())
        && scene.as_ref().is_none_or(Examined::holds);
    let text = if args.json {
        to_json(&known(json!({
            "version": env!("CARGO_PKG_VERSION"),
            "seed": args.seed,
            "full": args.full,
            "levels": levels(),
            "cases": rows,
            "scene": scene,
        })))?
    } else {
        verdict(&rows, args)
            + &table(&rows)
            + &failures(&rows, args)
            + &scene.as_ref().map_or_else(String::new, Examined::text)
    };
    print(&text)?;
    Ok(all_hold)
}

/// The instruction levels of this machine.
fn levels() -> Vec<&'static str> {
    Level::available().into_iter().map(Level::name).collect()
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

fn row(case: &Case, efforts: &[Effort], scenes: &Path) -> CaseRow {
    let start = Instant::now();
    let effort = |precision| efforts.iter().find(|effort| effort.precision == precision);
    let exact = effort(Precision::Exact).map(|effort| case.exact(effort, scenes));
    let fast = effort(Precision::Fast).and_then(|effort| case.fast(effort));
    let Case { number, name, .. } = *case;
    CaseRow { case: number, name, exact, fast, seconds: start.elapsed().as_secs_f64() }
}

/// What the rows say together.
fn verdict(rows: &[CaseRow], args: &SelftestArgs) -> String {
    let cases = |count: usize| counted(count as u64, "case");
    let is_recorded = args.seed == SEED && !args.full;
    let bits = if is_recorded { "recorded bits" } else { "bits of the reference kernel" };
    let exact = rows.iter().filter(|row| row.exact.is_some()).count();
    let failing = rows.iter().filter(|row| row.failed().next().is_some()).count();
    let (all, levels) = (cases(exact), levels().join(", "));
    let mut text = match failing {
        _ if exact == 0 => String::new(),
        0 => format!(
            "exact finds the {bits} in all {all}, by every kernel and tracer with {levels}\n"
        ),
        _ => format!("exact DIFFERS from the {bits} in {failing} of {all}\n"),
    };
    let fast: Vec<Losses> = rows.iter().filter_map(|row| row.fast).collect();
    let losing = fast.iter().filter(|found| found.leaks + found.false_hits > 0).count();
    if !fast.is_empty() {
        text += &format!("fast loses rays in {losing} of {}, as expected\n", cases(fast.len()));
    }
    text
}

/// A row for each case.
fn table(rows: &[CaseRow]) -> String {
    let widest = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
    let line = |case: &str, input: &str, [exact, leaks, false_hits]: [&str; 3]| {
        let row = format!("{case:>4}  {input:<widest$}  {exact:>7}  {leaks:>8}  {false_hits:>10}");
        row.trim_end().to_owned() + "\n"
    };
    let mut text = format!("\n{}", line("case", "input", ["exact", "leaks", "false hits"]));
    for row in rows {
        let exact = match row.exact {
            None => "",
            Some(_) if row.failed().next().is_some() => "DIFFERS",
            Some(_) => "same",
        };
        let share = |count: fn(Losses) -> u64| {
            let per_cent = |fast: Losses| 100.0 * count(fast) as f64 / fast.tried.max(1) as f64;
            let text = |share: f64| match share {
                0.0 => "0".to_owned(),
                share => format!("{} %", rounded(share, 2)),
            };
            row.fast.map(per_cent).map(text).unwrap_or_default()
        };
        let [leaks, false_hits] = [share(|fast| fast.leaks), share(|fast| fast.false_hits)];
        text += &line(&row.case.to_string(), row.name, [exact, &leaks, &false_hits]);
    }
    if rows.iter().any(|row| row.fast.is_some()) {
        text += "leaks: rays of fast precision that pass what they meet; false hits: those that meet what\n\
                 is not there, such as the surface that they leave\n";
    }
    text
}

/// Failures, and how to repeat them.
fn failures(rows: &[CaseRow], args: &SelftestArgs) -> String {
    let mut text = String::new();
    let seed = if args.seed == SEED { String::new() } else { format!(" --seed {}", args.seed) };
    let full = if args.full { " --full" } else { "" };
    for row in rows {
        for CasePart { name, outcome, .. } in row.failed() {
            let first = outcome.first.as_deref().unwrap_or("nothing was tested");
            let _ = writeln!(
                text,
                "\n{name}: {} of {} answers differ\n  the first: {first}\n  again: wavecrest selftest --case {}{seed}{full}",
                outcome.failed, outcome.tried, row.case
            );
        }
    }
    text
}
