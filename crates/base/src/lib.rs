//! The foundation of all crates of wavecrest: errors that name file, place, value and remedy;
//! atomic replacement of files; options with named values.

pub mod choice;
pub mod error;
pub mod replace;
