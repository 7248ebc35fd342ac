//! The requested settings of the hard cases.

use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::{Count, Effort};

/// The arguments for every case.
pub(super) struct Asked {
    pub(super) seed: u64,
    pub(super) count: Count,
    pub(super) precisions: Vec<Precision>,
}

impl Asked {
    /// The efforts, one for each precision.
    pub(super) fn efforts(&self) -> impl DoubleEndedIterator<Item = Effort> {
        self.efforts_of(self.count)
    }

    /// The same, with this number of tests.
    pub(super) fn efforts_of(&self, count: Count) -> impl DoubleEndedIterator<Item = Effort> {
        let Self { seed, precisions, .. } = self;
        let effort = move |&precision: &Precision| Effort { precision, seed: *seed, count };
        precisions.iter().map(effort)
    }
}
