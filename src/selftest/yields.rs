//! The errors of hits in each precision in difficult situations.

use std::fmt::Write as _;

use serde::Serialize;

use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::Effort;
use wavecrest_report::selftest::errors::{Distribution, HitErrors, SITUATIONS, Situation, ulps};

/// The errors of a precision in a situation.
#[derive(Serialize)]
pub(super) struct Yield {
    situation: &'static str,
    precision: Precision,
    #[serde(flatten)]
    errors: HitErrors,
}

/// The errors in all situations.
pub(super) fn measure(efforts: &[Effort]) -> Vec<Yield> {
    let of = |situation: &'static Situation| {
        efforts.iter().map(move |effort| Yield {
            situation: situation.name,
            precision: effort.precision,
            errors: situation.errors(effort),
        })
    };
    SITUATIONS.iter().flat_map(of).collect()
}

/// A row for each, with the bound for 999 of 1000 hits.
pub(super) fn text(yields: &[Yield]) -> String {
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
