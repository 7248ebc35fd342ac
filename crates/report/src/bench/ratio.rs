//! Ratios of speeds.

use serde::Serialize;

use crate::page::Cell;
use crate::summary::MedianInterval;

/// The speed of one variant over that of another.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Ratio {
    /// Median and interval.
    #[serde(flatten)]
    pub interval: MedianInterval,
    /// Number of rounds.
    pub pairs: usize,
}

impl Ratio {
    /// The speed of the variant `of` over that of `over`: the `seconds` of `over` in each round
    /// over those of the other; `None` without rounds.
    ///
    /// Medians of ratios do not multiply. So that they do, the ratio of any two variants is that of
    /// their speeds relative to the first one. It rarely is outside of its own interval, which is
    /// then extended to it.
    pub(crate) fn of(seconds: &[Vec<f64>], over: usize, of: usize) -> Option<Self> {
        let pairs = |over: usize, of: usize| {
            let each = seconds[over].iter().zip(&seconds[of]);
            MedianInterval::of(&each.map(|(over, of)| over / of).collect::<Vec<_>>())
        };
        let median = pairs(0, of)?.median / pairs(0, over)?.median;
        let i = pairs(over, of)?;
        let (low, high) = (i.low.min(median), i.high.max(median));
        let interval = MedianInterval { median, low, high, ..i };
        Some(Self { interval, pairs: seconds[of].len() })
    }

    /// Median and interval, for a table.
    pub(crate) fn cell(&self) -> Cell {
        let i = &self.interval;
        Cell::number(i.median, format!("{:.3} ({:.3} to {:.3})", i.median, i.low, i.high))
    }
}
