//! Settings and outcome of a case.

use std::iter::Sum;

use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::precision::Precision;

/// The number of tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// Few enough for each of many scenes.
    Brief,
    /// Few enough for every test run.
    Quick,
    /// As many as the case's bound states.
    Full,
}

/// The settings of a case.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// The tested precision.
    pub precision: Precision,
    /// The seed of its inputs.
    pub seed: u64,
    /// The number of tests.
    pub count: Count,
}

impl Effort {
    /// `geometry` with a tree of `preset`, in the tested precision.
    pub(super) fn accel(&self, mut geometry: Geometry, preset: Preset) -> Accel {
        geometry.set_precision(self.precision);
        Accel::new(geometry, preset)
    }

    /// `full`, a hundredth of it, or a quarter of that.
    pub(super) fn of(&self, full: usize) -> usize {
        match self.count {
            Count::Brief => full / 400,
            Count::Quick => full / 100,
            Count::Full => full,
        }
    }
}

/// The outcome of a case.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Outcome {
    /// The number of tests.
    pub tried: u64,
    /// The number of tests that broke the bound.
    pub failed: u64,
    /// A description of the first of these.
    pub first: Option<String>,
}

impl Outcome {
    /// Whether anything was tested, and the bound held.
    pub fn holds(&self) -> bool {
        self.tried > 0 && self.failed == 0
    }

    /// The outcome of one test; `failure` describes the error unless it is `right`.
    pub(super) fn of(right: bool, failure: impl FnOnce() -> String) -> Self {
        Self { tried: 1, failed: (!right).into(), first: (!right).then(failure) }
    }

    /// Counts a test; `failure` describes the error unless it is `right`.
    pub(super) fn check(&mut self, right: bool, failure: impl FnOnce() -> String) {
        self.add(Self::of(right, failure));
    }

    /// Adds `context` before the description of the first failure.
    pub(super) fn with_context(self, context: impl Fn() -> String) -> Self {
        Self { first: self.first.map(|first| format!("{}, {first}", context())), ..self }
    }

    /// Adds another outcome.
    pub(super) fn add(&mut self, other: Self) {
        self.tried += other.tried;
        self.failed += other.failed;
        self.first = self.first.take().or(other.first);
    }
}

impl Sum for Outcome {
    fn sum<I: Iterator<Item = Self>>(outcomes: I) -> Self {
        outcomes.fold(Self::default(), |mut all, one| {
            all.add(one);
            all
        })
    }
}
