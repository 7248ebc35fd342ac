//! The foundation of all crates of wavecrest: errors that name file, place, value and remedy;
//! files to read; atomic replacement of files; options with named values; memory and its purpose; progress;
//! numbers and commands as words.

pub mod choice;
pub mod error;
pub mod memory;
pub mod progress;
pub mod read;
pub mod replace;
pub mod words;
