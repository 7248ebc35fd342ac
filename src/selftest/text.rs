//! The outcome of the cases as text: the verdict, a table, and failures; and the errors of hits.

use std::fmt::Write as _;

use super::{Row, SelftestArgs, Trial, Yield};
use crate::common::rounded;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::Outcome;
use wavecrest_report::selftest::errors::{Distribution, ulps};

/// The whole text.
pub(super) fn of(rows: &[Row], args: &SelftestArgs) -> String {
    let precisions: Vec<Precision> =
        rows.first().map_or_else(Vec::new, |row| row.trials.iter().map(|t| t.precision).collect());
    verdict(rows, &precisions) + &table(rows, &precisions) + &failures(rows, &precisions, args)
}

/// The number of passed cases in each precision, and the share that fast misses.
fn verdict(rows: &[Row], precisions: &[Precision]) -> String {
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
fn table(rows: &[Row], precisions: &[Precision]) -> String {
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
fn failures(rows: &[Row], precisions: &[Precision], args: &SelftestArgs) -> String {
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
pub(super) fn of_errors(yields: &[Yield]) -> String {
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
