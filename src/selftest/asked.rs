//! How the hard cases are tried.

use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::{Count, Effort};

/// What the arguments say of every case.
pub(super) struct Asked {
    pub(super) seed: u64,
    pub(super) count: Count,
    pub(super) precisions: Vec<Precision>,
}

impl Asked {
    /// One for each precision.
    pub(super) fn efforts(&self) -> impl Iterator<Item = Effort> {
        let Self { seed, count, precisions } = self;
        precisions.iter().map(|&precision| Effort { precision, seed: *seed, count: *count })
    }
}
