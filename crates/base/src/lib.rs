//! The foundation of all crates of wavecrest: errors that name file, place, value and remedy;
//! files to read; atomic replacement of files; options with named values; memory and its purpose; shared arrays; work on all
//! threads; progress; numbers and commands as words.

pub mod choice;
pub mod error;
pub mod memory;
pub mod parallel;
pub mod progress;
pub mod read;
pub mod replace;
pub mod shared;
pub mod words;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a mutex holds, also if a thread has panicked that held it.
pub fn lock<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
