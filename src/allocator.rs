//! Memory that the system refuses ends the command with an error in words and exit code 2.
//!
//! Rust ends a process that cannot lengthen a list with an abort; the hook in which this could be changed is not
//! stable. The allocator is what can be replaced: this one is the system's, and reports where that has no more. A
//! report takes no memory. Lists that are asked for with [`memory::reserve`] are errors like any other.

#![allow(unsafe_code, reason = "an allocator cannot be written without")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::{Cursor, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};

use wavecrest_base::memory::{self, Size, Stage};
use wavecrest_base::replace::remove_temporary_files;

use crate::exit::ERROR;

#[global_allocator]
static ALLOCATOR: Reporting = Reporting;

/// The system's allocator, and a report of what it refuses.
struct Reporting;

// SAFETY: each call goes to the system's allocator as it came, and its answer goes back as it is. A report does not
// return, nor does it unwind.
unsafe impl GlobalAlloc for Reporting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the same contract.
        had(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        had(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        had(unsafe { System.realloc(place, layout, size) }, size)
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(place, layout) }
    }
}

/// The place that was asked for; a report where it was refused.
#[inline]
fn had(place: *mut u8, size: usize) -> *mut u8 {
    if place.is_null() && !memory::is_trying() {
        report(size);
    }
    place
}

/// Ends the process with an error, without asking for memory.
#[cold]
fn report(size: usize) -> ! {
    static HAS_BEGUN: AtomicBool = AtomicBool::new(false);
    if HAS_BEGUN.swap(true, Ordering::Relaxed) {
        // Another thread ends the process; or this one does, where to remove a file took memory after all.
        std::thread::sleep(PATIENCE);
        std::process::abort();
    }
    remove_temporary_files();
    let mut text = Cursor::new([0; LONGEST_MESSAGE]);
    // A text that is too long is cut off.
    let _ = writeln!(
        text,
        "error: the system refused {} of memory while {}; free some, raise the limit of the process (ulimit -v), or \
         make the scene or the image smaller",
        Size(size),
        Stage::now().doing()
    );
    let length = (text.position() as usize).min(LONGEST_MESSAGE);
    let _ = std::io::stderr().write_all(&text.get_ref()[..length]);
    std::process::exit(ERROR.into())
}

/// Longer than any message.
const LONGEST_MESSAGE: usize = 512;

/// By then the other thread has ended the process.
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(5);
