//! What every crate of wavecrest stands on: errors that name file, place, value and remedy; files that appear
//! whole or not at all; values that users choose by name.

pub mod choice;
pub mod error;
pub mod replace;
