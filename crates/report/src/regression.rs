//! Compares two runs of the same measurements: what became slower or less accurate.
//!
//! [`sweep`] compares two sweeps of error against time, [`mod@bench`] two reports of `bench`. Each
//! comparison is a ratio, after over before. Its standard error comes from the bootstrap: rounds (a
//! seed of a sweep, a run of a benchmark) are resampled with replacement, alike on both sides. If
//! consecutive rounds are correlated, as when another program ran for a while, it comes from the
//! means of blocks of rounds.
//!
//! Equivalent programs differ in speed by the placement of their code and data (Mytkowicz et al.,
//! *Producing Wrong Data Without Doing Anything Obviously Wrong!*, ASPLOS 2009). So a ratio is
//! judged against 1 with a [`TOLERANCE`]; for all settings together, where such effects cancel,
//! with half of it. Probabilities are corrected for the number of comparisons by Holm (*A Simple
//! Sequentially Rejective Multiple Test Procedure*, 1979), and intervals by Bonferroni: all hold
//! together with 99 per cent. Half of the error probability is for the comparisons of all settings
//! together, which detect the smallest changes, and half for the others.

pub mod bench;
pub mod page;
pub mod sweep;
#[cfg(test)]
mod tests;
mod unit;

use std::path::Path;

use serde::Serialize;

use crate::accuracy::fit::{Rng, chance_beyond, normal_of, student};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// Relative difference in time or error allowed between equivalent programs.
pub const TOLERANCE: f64 = 0.01;

/// The probability of any wrong verdict of worse or better, over all comparisons, if nothing
/// changed.
pub const SIGNIFICANCE: f64 = 0.01;

/// Number of bootstrap samples: enough for a standard error (Efron and Tibshirani, *An Introduction
/// to the Bootstrap*, 1993, section 6.4).
const RESAMPLES: usize = 300;

/// Fewer rounds do not show their spread.
const LEAST_ROUNDS: usize = 4;

/// Smallest and largest number of blocks of rounds, which reveal slow phases of the machine; and
/// the number of rounds in each, whose faster half may contain one slow round.
const BLOCKS: [usize; 2] = [2, 8];
const ROUNDS_OF_BLOCK: usize = 4;

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
    /// Its folder or file.
    pub path: String,
    /// The program's version.
    pub version: String,
    /// The commit that it was built from, if known.
    pub commit: Option<String>,
    /// The machine.
    pub machine: serde_json::Value,
}

/// The verdict on a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It takes longer, or has a larger error.
    Worse,
    /// It is faster, or has a smaller error.
    Better,
    /// No significant change.
    Same,
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
    /// The probability of a change at least as large if nothing changed, corrected for the number
    /// of comparisons.
    pub p: f64,
    /// The verdict.
    pub verdict: Verdict,
    /// Error against time before and after, as `[seconds, error]`, if measured.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<Vec<[f64; 2]>>,
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
#[derive(Clone, Debug)]
struct Found {
    scene: String,
    what: String,
    of: &'static str,
    /// Whether it covers all settings of a scene together.
    overall: bool,
    estimate: Estimate,
    curves: Vec<Vec<[f64; 2]>>,
}

/// The estimated logarithm of a ratio.
#[derive(Clone, Copy, Debug)]
struct Estimate {
    log: f64,
    standard_error: f64,
    /// Degrees of freedom of the standard error.
    freedom: f64,
}

impl Regression {
    /// Compares two sweeps in folders, or two reports of `bench`.
    ///
    /// # Errors
    /// If one of them cannot be read, they are of different kinds, or have nothing in common.
    pub fn of(before: &Path, after: &Path) -> Result<Self> {
        let found = match [before, after].map(Path::is_dir) {
            [true, true] => sweep::compare(before, after)?,
            [false, false] => bench::compare(before, after)?,
            _ => {
                return Err(Error::new(ErrorKind::Usage, "a sweep and a file are not comparable")
                    .in_file(after)
                    .remedy("name two folders of `accuracy`, or two files of `bench --output`"));
            }
        };
        if found.ratios.is_empty() {
            return Err(Error::new(ErrorKind::Usage, "the two have nothing in common to compare")
                .in_file(after)
                .value(found.warnings.join("; "))
                .remedy("measure the same scenes at one size, with four seeds or runs at least"));
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
        let all = self.ratios.len() + self.changes.len();
        let all = if all == 1 { "1 comparison".to_owned() } else { format!("{all} comparisons") };
        match (worse, better) {
            (0, 0) => format!("No change in {all}."),
            _ => format!("Of {all}, {worse} became worse and {better} became better."),
        }
    }

    /// Sets the verdicts of all comparisons together.
    fn judged(mut self, found: Vec<Found>) -> Self {
        self.tolerance = TOLERANCE;
        let corrected = corrected(&found);
        let ratio = |(found, (p, count)): (Found, (f64, usize))| {
            let Found { scene, what, of, estimate, curves, .. } = found;
            let verdict = match estimate.log {
                _ if p >= SIGNIFICANCE => Verdict::Same,
                log if log > 0.0 => Verdict::Worse,
                _ => Verdict::Better,
            };
            let [low, high] = estimate.interval(count);
            let ratio = libm::exp(estimate.log);
            Ratio { scene, what, of, ratio, low, high, p, verdict, curves }
        };
        self.ratios = found.into_iter().zip(corrected).map(ratio).collect();
        self
    }
}

impl Found {
    fn new(scene: &str, what: String, of: &'static str, estimate: Estimate) -> Self {
        let scene = scene.to_owned();
        Self { scene, what, of, overall: false, estimate, curves: Vec::new() }
    }

    fn chance(&self) -> f64 {
        self.estimate.chance(if self.overall { TOLERANCE / 2.0 } else { TOLERANCE })
    }
}

impl Change {
    /// A value of a scene that differs: these words on either side, and whether it is worse.
    fn new(scene: &str, what: String, [before, after]: [String; 2], worse: bool) -> Self {
        let verdict = if worse { Verdict::Worse } else { Verdict::Better };
        Self { scene: scene.to_owned(), what, before, after, verdict }
    }
}

impl Estimate {
    /// The estimate of a ratio of typical times, one for each round.
    fn of_times(before: &[f64], after: &[f64]) -> Option<Self> {
        Self::of(before.len().min(after.len()), |rounds| {
            log_ratio(typical(before, rounds), typical(after, rounds))
        })
    }

    /// The estimate of a statistic of `rounds` rounds, given by their indices; `None` for fewer
    /// than [`LEAST_ROUNDS`].
    fn of(rounds: usize, statistic: impl Fn(&[usize]) -> f64) -> Option<Self> {
        if rounds < LEAST_ROUNDS {
            return None;
        }
        let all: Vec<usize> = (0..rounds).collect();
        let mut rng = Rng::new(3);
        let draw = |_| statistic(&all.iter().map(|_| rng.below(rounds)).collect::<Vec<_>>());
        let freedom = rounds as f64 - 1.0;
        // Resamples have a smaller variance than the rounds themselves by this factor.
        let drawn = variance((0..RESAMPLES).map(draw).collect()) * (freedom + 1.0) / freedom;
        let count = (rounds / ROUNDS_OF_BLOCK).clamp(BLOCKS[0], BLOCKS[1]);
        let bound = |block: usize| block * rounds / count;
        let block = |block: usize| statistic(&all[bound(block)..bound(block + 1)]);
        let blocks = variance((0..count).map(block).collect()) / count as f64;
        // Both are NaN if an error is 0 in all rounds of one side: then there is no doubt.
        let standard_error =
            Some(drawn.max(blocks).sqrt()).filter(|e| e.is_finite()).unwrap_or(0.0);
        Some(Self { log: statistic(&all), standard_error, freedom })
    }

    /// The probability of a change at least as large, on either side, if the ratio is within the
    /// tolerance.
    fn chance(self, tolerance: f64) -> f64 {
        let beyond = self.log.abs() - libm::log1p(tolerance);
        if beyond <= 0.0 {
            return 1.0;
        }
        chance_beyond(normal_of(beyond / self.standard_error, self.freedom))
    }

    /// The interval, if `count` of them hold together.
    fn interval(self, count: usize) -> [f64; 2] {
        let reach = student(SIGNIFICANCE / count as f64, self.freedom) * self.standard_error;
        [self.log - reach, self.log + reach].map(libm::exp)
    }
}

fn variance(values: Vec<f64>) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (count - 1.0)
}

/// For each comparison its corrected probability, and the number of comparisons for its interval.
fn corrected(found: &[Found]) -> Vec<(f64, usize)> {
    let mut corrected = vec![(1.0, 1); found.len()];
    let groups = [true, false].map(|overall| {
        (0..found.len()).filter(|n| found[*n].overall == overall).collect::<Vec<usize>>()
    });
    let shares = groups.iter().filter(|group| !group.is_empty()).count();
    for group in &groups {
        let chances: Vec<f64> = group.iter().map(|n| found[*n].chance()).collect();
        for (n, chance) in group.iter().zip(holm(&chances)) {
            corrected[*n] = ((chance * shares as f64).min(1.0), group.len() * shares);
        }
    }
    corrected
}

/// Probabilities corrected for their number.
fn holm(chances: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..chances.len()).collect();
    order.sort_by(|a, b| chances[*a].total_cmp(&chances[*b]));
    let mut corrected = vec![1.0; chances.len()];
    let mut largest: f64 = 0.0;
    for (rank, index) in order.into_iter().enumerate() {
        largest = largest.max(chances[index] * (chances.len() - rank) as f64).min(1.0);
        corrected[index] = largest;
    }
    corrected
}

/// A typical time: the mean of the faster half, since other programs can only add to a time. Up to
/// half of the times may be disturbed, and for few times it is more stable than the median.
fn typical(times: &[f64], rounds: &[usize]) -> f64 {
    let mut times: Vec<f64> =
        rounds.iter().filter_map(|round| times.get(*round)).copied().collect();
    times.sort_by(f64::total_cmp);
    let half = times.len().div_ceil(2);
    times[..half].iter().sum::<f64>() / half as f64
}

/// The logarithm of `after` over `before`, which is 0 if they are equal, even if both are 0.
fn log_ratio(before: f64, after: f64) -> f64 {
    if before == after { 0.0 } else { libm::log(after / before) }
}
