//! How far the current work of the process is, for a display that reads it now and then.
//!
//! Whoever works adds what is done, in portions so large that counting costs nothing. The process has one count, as it has
//! one [`Stage`](crate::memory::Stage).

use std::sync::atomic::{AtomicU64, Ordering};

/// Units of work that are done, and all that are known of: bytes, triangles, pixels.
static DONE: AtomicU64 = AtomicU64::new(0);
static ALL: AtomicU64 = AtomicU64::new(0);

/// Forgets the work before.
pub fn begin() {
    ALL.store(0, Ordering::Relaxed);
    DONE.store(0, Ordering::Relaxed);
}

/// There are so many more units to do.
pub fn expect(units: u64) {
    ALL.fetch_add(units, Ordering::Relaxed);
}

/// So many units more are done.
pub fn add(units: u64) {
    DONE.fetch_add(units, Ordering::Relaxed);
}

/// The units that are done, and all. What is done twice, such as reading a line again for its error, counts at most as all.
pub fn now() -> [u64; 2] {
    let all = ALL.load(Ordering::Relaxed);
    [DONE.load(Ordering::Relaxed).min(all), all]
}
