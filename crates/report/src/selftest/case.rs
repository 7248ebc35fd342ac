//! How a case is run, and what comes of it.

use std::iter::Sum;

use wavecrest_base::error::Result;
use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::geometry::Geometry;
use wavecrest_core::kernels::precision::Precision;

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// Little enough for every run of the tests.
    Quick,
    /// What the case's bound speaks of.
    Full,
}

/// How a case is run.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// The arithmetic that is tried.
    pub precision: Precision,
    /// What its inputs follow from.
    pub seed: u64,
    /// How many there are.
    pub count: Count,
}

impl Effort {
    /// What finds hits on `geometry` in the precision that is tried.
    pub(super) fn accel(&self, geometry: Geometry, preset: Preset) -> Accel {
        Accel::new(Geometry { precision: self.precision, ..geometry }, preset)
    }

    /// `full`, or a hundredth of it.
    pub(super) fn of(&self, full: usize) -> usize {
        self.either(full / 100, full)
    }

    /// One of these.
    pub(super) fn either<T>(&self, quick: T, full: T) -> T {
        match self.count {
            Count::Quick => quick,
            Count::Full => full,
        }
    }
}

/// What came of a case.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Outcome {
    /// How many questions were asked.
    pub tried: u64,
    /// How many of the answers broke the bound.
    pub failed: u64,
    /// The first of these, in words.
    pub first: Option<String>,
    /// Answers whose time was taken.
    pub timed: u64,
    /// Seconds that these took, summed over threads.
    pub seconds: f64,
}

impl Outcome {
    /// Nanoseconds for an answer; `None` where no time was taken.
    pub fn nanoseconds(&self) -> Option<f64> {
        (self.timed > 0).then(|| self.seconds * 1e9 / self.timed as f64)
    }

    /// Whether it was tried, and the bound held.
    pub fn holds(&self) -> bool {
        self.tried > 0 && self.failed == 0
    }

    /// Of one answer; `failure` says what is wrong with it, if anything is.
    pub(super) fn one(failure: Option<String>) -> Self {
        let mut outcome = Self::default();
        outcome.count(failure);
        outcome
    }

    /// Counts an answer; `failure` says what is wrong with it, if anything is.
    pub(super) fn count(&mut self, failure: Option<String>) {
        self.tried += 1;
        if let Some(failure) = failure {
            self.failed += 1;
            self.first.get_or_insert(failure);
        }
    }

    /// Counts an answer; `failure` says what is wrong with it where it is not `right`.
    pub(super) fn check(&mut self, right: bool, failure: impl FnOnce() -> String) {
        self.count((!right).then(failure));
    }

    /// With `context` before the words of the first failure.
    pub(super) fn with_context(self, context: impl Fn() -> String) -> Self {
        Self { first: self.first.map(|first| format!("{}, {first}", context())), ..self }
    }

    /// With all failures forgiven that are no more than this share of the answers.
    pub(super) fn allowing(self, share: f64) -> Self {
        if self.failed as f64 > share * self.tried as f64 {
            return self;
        }
        Self { failed: 0, first: None, ..self }
    }

    /// Counts what another has counted.
    pub(super) fn add(&mut self, other: Self) {
        self.tried += other.tried;
        self.failed += other.failed;
        self.timed += other.timed;
        self.seconds += other.seconds;
        if self.first.is_none() {
            self.first = other.first;
        }
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

/// A question that could not be asked is one failure.
impl From<Result<Self>> for Outcome {
    fn from(result: Result<Self>) -> Self {
        result.unwrap_or_else(|error| Self::one(Some(error.to_string())))
    }
}
