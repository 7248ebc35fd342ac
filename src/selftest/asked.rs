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
    pub(super) fn efforts(&self) -> impl Iterator<Item = Effort> {
        let Self { seed, count, precisions } = self;
        let effort = move |&precision: &Precision| Effort { precision, seed: *seed, count: *count };
        precisions.iter().map(effort)
    }
}
