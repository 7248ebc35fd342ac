//! Values, exceptions and threads, which all other modules use.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use wavecrest_api as api;

pyo3::create_exception!(
    wavecrest,
    Error,
    PyValueError,
    "An error in the input: the message names the file, the place in it, the value and the remedy."
);

/// A value of Python.
pub(crate) type Any<'py> = Bound<'py, PyAny>;

/// The exception of an error.
#[expect(clippy::needless_pass_by_value, reason = "for map_err")]
pub(crate) fn exception(error: api::Error) -> PyErr {
    Error::new_err(error.to_string())
}

/// This number of threads, one for each core if 0.
pub(crate) fn start(threads: usize) -> PyResult<ThreadPool> {
    // Who waits for a job that panics is told so.
    let threads = ThreadPoolBuilder::new().num_threads(threads).panic_handler(|_| ());
    threads.build().map_err(|error| Error::new_err(format!("cannot start the threads: {error}")))
}

/// The threads on which everything but renders works, one for each core, which stay: with the number of their process, as
/// those of a parent do not run in one that was forked from it, which gets its own.
static POOL: Mutex<Option<(u32, &ThreadPool)>> = Mutex::new(None);

/// Does `work` on them, without the GIL. Nothing may ask for threads elsewhere: it would get rayon's own, which are missing
/// after a fork.
pub(crate) fn on_threads<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let mut known = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    let pool = match *known {
        Some((owner, pool)) if owner == process => pool,
        _ => Box::leak(Box::new(start(0)?)),
    };
    *known = Some((process, pool));
    drop(known);
    Ok(py.detach(|| pool.install(work)))
}

/// Rays traced between two checks for Ctrl-C: a fraction of a second.
const STRETCH: usize = 1 << 20;

/// Does `work` for parts of `count` rays or hits, on all threads and without the GIL.
pub(crate) fn in_stretches(
    py: Python<'_>,
    count: usize,
    mut work: impl FnMut(Range<usize>) + Send,
) -> PyResult<()> {
    for start in (0..count).step_by(STRETCH) {
        on_threads(py, || work(start..count.min(start + STRETCH)))?;
        py.check_signals()?;
    }
    Ok(())
}
