//! Counts memory, and ends the command with an error message and exit code 2 if the limit or the system refuses it.
//!
//! If a list cannot grow, Rust aborts the process; the hook to change this is not stable. The
//! allocator can be replaced: this one forwards to the system's, and reports a refusal. A report
//! needs no memory. [`memory::reserve`] returns an ordinary error instead.

#![allow(unsafe_code, reason = "an allocator cannot be written without")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::ptr::null_mut;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use bytesize::ByteSize;

use wavecrest_base::lock;
use wavecrest_base::memory::{self, Refuser};
use wavecrest_base::replace::remove_temporary_files;

use crate::exit::ERROR;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The system's allocator, with counts, a limit, and reports of refusals.
struct Counting;

// SAFETY: each call and its result are forwarded unchanged from and to the system's allocator, or
// the call is refused. Neither counts nor reports unwind, and none allocates.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller fulfils the same contract.
        counted(0, layout.size(), || unsafe { System.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        counted(0, layout.size(), || unsafe { System.alloc_zeroed(layout) })
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        counted(layout.size(), size, || unsafe { System.realloc(place, layout, size) })
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(place, layout) }
        memory::count(-layout.size().cast_signed());
    }
}

/// What `allocate` returns in place of `old` bytes; the `new` ones are counted, if the limit allows them.
#[inline]
fn counted(old: usize, new: usize, allocate: impl FnOnce() -> *mut u8) -> *mut u8 {
    let (more, less) = (new.saturating_sub(old), old.saturating_sub(new));
    if !memory::take(more) {
        if memory::is_trying() {
            return null_mut();
        }
        report(new, Refuser::Limit);
        memory::count(more.cast_signed());
    }
    let place = allocate();
    if place.is_null() {
        memory::count(-more.cast_signed());
        if !memory::is_trying() {
            report(new, Refuser::System);
        }
    } else if less > 0 {
        memory::count(-less.cast_signed());
    }
    place
}

/// Ends the process with an error, without allocating; returns if another thread ends it.
#[cold]
fn report(size: usize, by: Refuser) {
    static HAS_BEGUN: AtomicBool = AtomicBool::new(false);
    if HAS_BEGUN.swap(true, Ordering::Relaxed) {
        // Or this one does, and removing a file needs memory: what the limit refuses is there.
        if by == Refuser::System {
            std::thread::sleep(PATIENCE);
        }
        return;
    }
    remove_temporary_files();
    let mut text = Cursor::new([0; LONGEST_MESSAGE]);
    // Text that is too long is truncated.
    let _ = write!(text, "error: ");
    if let Ok(Some(scene)) = SCENE.try_lock().as_deref() {
        let _ = write!(text, "{}: ", scene.display());
    }
    let remedy = match by {
        Refuser::Limit => "raise it, or use a smaller scene or image",
        Refuser::System => {
            "free some, raise the limit of the process (ulimit -v), or make the scene or the image smaller"
        }
    };
    let _ = writeln!(text, "{}; {remedy}", by.message(size, memory::activity()));
    let length = (text.position() as usize).min(LONGEST_MESSAGE);
    let _ = std::io::stderr().write_all(&text.get_ref()[..length]);
    std::process::exit(ERROR.into())
}

/// Longer than most messages.
const LONGEST_MESSAGE: usize = 1024;

/// The other thread has ended the process by then.
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(5);

/// The scene that messages name.
static SCENE: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Works on a `scene` from now on, with at most so many bytes if there is a `limit`.
pub(crate) fn begin(scene: &Path, limit: Option<ByteSize>) {
    *lock(&SCENE) = Some(scene.to_owned());
    if let Some(limit) = limit {
        memory::limit(limit.as_u64());
    }
}
