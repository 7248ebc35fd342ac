//! Error against time: a sweep over everything that affects the error of an image, with a report
//! that can be published.
//!
//! [`setting`] defines the variations; [`sweep`] renders them, with many seeds in random order, and
//! writes each record to a [`store`] at once; errors are measured against the reference of a
//! [`subject`], with a known error of its own. [`report`] summarises the records
//! with intervals ([`crate::summary`]), and [`page`] shows them.

pub mod page;
pub mod report;
pub mod setting;
pub mod store;
pub mod subject;
pub mod sweep;

use serde::Serialize;

use report::SceneAccuracy;
use store::{Store, SweepHeader, records_of};
use subject::Subject;

use crate::bench::Circumstances;

/// The progress of a sweep. Work is counted in points of pixels: a rough measure, by which the time to go is estimated.
#[derive(Clone, Copy, Debug)]
pub enum SweepProgress<'a> {
    /// There is this much more work.
    More(u64),
    /// The next stage starts.
    Stage(&'a str),
    /// Some of the work is done.
    Step(u64),
}

/// Receives the progress of a sweep, from any thread.
pub type OnProgress<'a> = dyn Fn(SweepProgress<'_>) + Sync + 'a;

/// All results: `accuracy.json`.
#[derive(Clone, Debug, Serialize)]
pub struct AccuracyReport {
    /// The sweep.
    #[serde(flatten)]
    pub header: SweepHeader,
    /// Renders of each setting.
    pub seeds: u32,
    /// Circumstances: an entry for each start or resumption of the sweep.
    pub circumstances: Vec<Circumstances>,
    /// Each scene: see [`report`].
    pub scenes: Vec<SceneAccuracy>,
}

impl AccuracyReport {
    /// Summarises the records of the swept scenes in `store`, with the cost of each of the
    /// `errors`.
    pub fn new(seeds: u32, store: &Store, swept: &[Subject], errors: &[f64]) -> Self {
        let scene = |subject: &Subject| SceneAccuracy::of(subject, &store.records, errors);
        Self {
            header: store.header.clone(),
            seeds,
            circumstances: records_of(&store.records).cloned().collect(),
            scenes: swept.iter().map(scene).collect(),
        }
    }
}
