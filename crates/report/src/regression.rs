//! Compares two sweeps of error against time, from before and after a change: what became slower
//! or less accurate.
//!
//! Each comparison is a ratio, after over before, with Student's interval over rounds (a round is
//! one seed of a sweep). In a round the ratio is the median over the settings, so that a single
//! disturbed render does not count.
//!
//! Equivalent programs differ in speed by the placement of their code and data (Mytkowicz et al.,
//! *Producing Wrong Data Without Doing Anything Obviously Wrong!*, ASPLOS 2009). So a change counts
//! if the whole interval differs from 1 by more than a [`TOLERANCE`]. All intervals hold together
//! with 99 per cent (Bonferroni).

pub mod page;
pub mod sweep;
#[cfg(test)]
mod tests;

use std::path::Path;

use serde::Serialize;

use crate::accuracy::fit::student;
use crate::plot::number::plural;
use crate::summary::mean_and_error;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// Relative difference in time or error allowed between equivalent programs.
pub const TOLERANCE: f64 = 0.01;

/// The probability of any wrong verdict of worse or better, over all comparisons, if nothing
/// changed.
pub const SIGNIFICANCE: f64 = 0.01;

/// Fewer rounds do not show their spread.
const LEAST_ROUNDS: usize = 4;

/// The results of a comparison.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Regression {
    /// The baseline run.
    pub before: Side,
    /// The judged run.
    pub after: Side,
    /// See [`TOLERANCE`].
    pub tolerance: f64,
    /// Ratios with intervals.
    pub ratios: Vec<Ratio>,
    /// Deterministic values that differ.
    pub changes: Vec<Change>,
    /// Values that could not be compared, and why.
    pub warnings: Vec<String>,
}

/// One of the runs.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Side {
    /// Its folder.
    pub path: String,
    /// The program's version.
    pub version: String,
    /// The commit that it was built from, if known.
    pub commit: Option<String>,
    /// The machine.
    pub machine: serde_json::Value,
}

wavecrest_base::choices! {
    /// The verdict on a value.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Verdict {
        /// It takes longer, or has a larger error.
        Worse = "worse",
        /// It is faster, or has a smaller error.
        Better = "better",
        /// No significant change.
        Same = "unchanged",
    }
}

/// A comparison, after over before: above 1 is worse.
#[derive(Clone, Debug, Serialize)]
pub struct Ratio {
    /// The scene.
    pub scene: String,
    /// The measured value.
    pub what: String,
    /// The kind of ratio, such as "time at equal error".
    pub of: &'static str,
    /// The ratio.
    pub ratio: f64,
    /// One end of its interval.
    pub low: f64,
    /// The other.
    pub high: f64,
    /// The verdict.
    pub verdict: Verdict,
}

/// A deterministic value of the program that changed.
#[derive(Clone, Debug, Serialize)]
pub struct Change {
    /// The scene.
    pub scene: String,
    /// The value.
    pub what: String,
    /// Before.
    pub before: String,
    /// After.
    pub after: String,
    /// Whether it is worse.
    pub verdict: Verdict,
}

/// A comparison before its verdict.
struct LogRatios {
    scene: String,
    what: String,
    of: &'static str,
    /// The logarithm of the ratio in each round, at least [`LEAST_ROUNDS`].
    logs: Vec<f64>,
}

impl Regression {
    /// Compares the sweeps in two folders.
    ///
    /// # Errors
    /// If one of them cannot be read, or they have nothing in common.
    pub fn of(before: &Path, after: &Path) -> Result<Self> {
        let found = sweep::compare(before, after)?;
        if found.ratios.is_empty() {
            return Err(Error::new(ErrorKind::Usage, "the two have nothing in common to compare")
                .in_file(after)
                .value(found.warnings.join("; "))
                .remedy("measure the same scenes at one size, with four seeds at least"));
        }
        Ok(found)
    }

    /// Whether anything became worse.
    pub fn is_worse(&self) -> bool {
        self.count(Verdict::Worse) > 0
    }

    /// The number of comparisons and changes with this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        let ratios = self.ratios.iter().map(|ratio| ratio.verdict);
        ratios.chain(self.changes.iter().map(|c| c.verdict)).filter(|v| *v == verdict).count()
    }

    /// The result, in a sentence or two.
    pub fn answer(&self) -> String {
        let (worse, better) = (self.count(Verdict::Worse), self.count(Verdict::Better));
        let all = plural(self.ratios.len() + self.changes.len(), "comparison");
        match (worse, better) {
            (0, 0) => format!("No change in {all}."),
            _ => format!("Of {all}, {worse} became worse and {better} became better."),
        }
    }
}

impl LogRatios {
    /// The ratio with an interval that misses it with this `chance`.
    fn judged(self, chance: f64) -> Ratio {
        let Self { scene, what, of, logs } = self;
        let count = logs.len() as f64;
        let (mean, standard_error) = mean_and_error(&logs);
        // Both are NaN if an error is 0 in all rounds of one side: then there is no doubt.
        let reach = Some(student(chance, count - 1.0) * standard_error).filter(|r| r.is_finite());
        let reach = reach.unwrap_or(0.0);
        let [low, ratio, high] = [mean - reach, mean, mean + reach].map(libm::exp);
        let verdict = match () {
            () if low > 1.0 + TOLERANCE => Verdict::Worse,
            () if high < 1.0 / (1.0 + TOLERANCE) => Verdict::Better,
            () => Verdict::Same,
        };
        Ratio { scene, what, of, ratio, low, high, verdict }
    }
}

impl Change {
    /// A value of a scene that differs: these words on either side, and whether it is worse.
    fn new(scene: &str, what: String, [before, after]: [String; 2], worse: bool) -> Self {
        let verdict = if worse { Verdict::Worse } else { Verdict::Better };
        Self { scene: scene.to_owned(), what, before, after, verdict }
    }
}

/// The logarithm of `after` over `before`, which is 0 if they are equal, even if both are 0.
fn log_ratio(before: f64, after: f64) -> f64 {
    if before == after { 0.0 } else { libm::log(after / before) }
}
