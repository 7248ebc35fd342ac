//! Ends the command with an error message and exit code 2 if the system refuses memory.
//!
//! If a list cannot grow, Rust aborts the process; the hook to change this is not stable. The
//! allocator can be replaced: this one forwards to the system's, and reports a refusal. A report
//! needs no memory. [`memory::reserve`] returns an ordinary error instead.

#![allow(unsafe_code, reason = "an allocator cannot be written without")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::{Cursor, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};

use wavecrest_base::memory::{self, Stage};
use wavecrest_base::replace::remove_temporary_files;
use wavecrest_base::words::Size;

use crate::exit::ERROR;

#[global_allocator]
static ALLOCATOR: Reporting = Reporting;

/// The system's allocator, with reports of refusals.
struct Reporting;

// SAFETY: each call and its result are forwarded unchanged from and to the system's allocator. A
// report neither returns nor unwinds.
unsafe impl GlobalAlloc for Reporting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller fulfils the same contract.
        checked(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        checked(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        checked(unsafe { System.realloc(place, layout, size) }, size)
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(place, layout) }
    }
}

/// Returns the memory, or reports that it was refused.
#[inline]
fn checked(place: *mut u8, size: usize) -> *mut u8 {
    if place.is_null() && !memory::is_trying() {
        report(size);
    }
    place
}

/// Ends the process with an error, without allocating.
#[cold]
fn report(size: usize) -> ! {
    static HAS_BEGUN: AtomicBool = AtomicBool::new(false);
    if HAS_BEGUN.swap(true, Ordering::Relaxed) {
        // Another thread is ending the process; or this one, if removing a file needed memory after
        // all.
        std::thread::sleep(PATIENCE);
        std::process::abort();
    }
    remove_temporary_files();
    let mut text = Cursor::new([0; LONGEST_MESSAGE]);
    // Text that is too long is truncated.
    let _ = writeln!(
        text,
        "error: the system refused {} of memory while {}; free some, raise the limit of the process (ulimit -v), or \
         make the scene or the image smaller",
        Size(size as u64),
        Stage::now().name()
    );
    let length = (text.position() as usize).min(LONGEST_MESSAGE);
    let _ = std::io::stderr().write_all(&text.get_ref()[..length]);
    std::process::exit(ERROR.into())
}

/// Longer than any message.
const LONGEST_MESSAGE: usize = 512;

/// The other thread has ended the process by then.
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(5);
