//! The time of each precision relative to fast.

use std::time::Instant;

use serde::Serialize;

use super::asked::Asked;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::{Case, Count};

/// Smallest and largest number of rounds of a case, in each of which every precision is timed once;
/// with fewer there is no ratio.
const LEAST_ROUNDS: usize = 3;
const MOST_ROUNDS: usize = 5;

/// Seconds after which no further round of a case starts.
const LONGEST: f64 = 1.0;

/// A ratio over several rounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Ratio {
    /// The median.
    pub(super) median: f64,
    /// The smallest and the largest.
    pub(super) least: f64,
    pub(super) most: f64,
    /// Number of rounds.
    pub(super) rounds: usize,
}

impl Ratio {
    fn of(mut ratios: Vec<f64>) -> Option<Self> {
        ratios.sort_by(f64::total_cmp);
        let rounds = ratios.len();
        let (&least, &most) = (ratios.first()?, ratios.last()?);
        (rounds >= LEAST_ROUNDS).then(|| Self { median: ratios[rounds / 2], least, most, rounds })
    }

    /// In words: the median, and the largest deviation of a round from it.
    pub(super) fn text(&self) -> String {
        let off = (self.most - self.median).max(self.median - self.least);
        format!("{:.2} \u{b1} {:.2}", self.median, off)
    }
}

/// The ratios of a case in the requested precisions; `None` if fast is not requested or nothing is
/// timed. The precisions alternate, forwards and backwards, so that slow phases of the machine
/// affect all alike.
pub(super) fn of(case: &Case, asked: &Asked) -> Vec<Option<Ratio>> {
    let mut ratios = vec![Vec::new(); asked.precisions.len()];
    let fast = asked.precisions.iter().position(|&precision| precision == Precision::Fast);
    let start = Instant::now();
    for round in 0..MOST_ROUNDS {
        let Some(fast) = fast else { break };
        let mut nanoseconds: Vec<Option<f64>> = vec![None; asked.precisions.len()];
        let time = |(index, effort)| (index, case.run(&effort).nanoseconds());
        let efforts: Vec<_> = asked.efforts_of(Count::Brief).enumerate().collect();
        let timed: Vec<_> = match round % 2 {
            0 => efforts.into_iter().map(time).collect(),
            _ => efforts.into_iter().rev().map(time).collect(),
        };
        timed.into_iter().for_each(|(index, found)| nanoseconds[index] = found);
        let Some(of_fast) = nanoseconds[fast] else { break };
        for (ratios, own) in ratios.iter_mut().zip(nanoseconds) {
            ratios.extend(own.map(|own| own / of_fast));
        }
        if start.elapsed().as_secs_f64() > LONGEST && round + 1 >= LEAST_ROUNDS {
            break;
        }
    }
    ratios.into_iter().map(Ratio::of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_is_the_median_with_its_spread_if_there_are_rounds_enough() {
        let ratio = Ratio::of(vec![1.2, 1.0, 1.1]).expect("three rounds");
        assert_eq!((ratio.median, ratio.least, ratio.most, ratio.rounds), (1.1, 1.0, 1.2, 3));
        assert_eq!(ratio.text(), "1.10 \u{b1} 0.10");
        assert_eq!(Ratio::of(vec![1.0, 1.1]), None);
        assert_eq!(Ratio::of(Vec::new()), None);
    }
}
