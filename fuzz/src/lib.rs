//! The targets that the tests try, for the fuzzers.

#[path = "../../tests/fuzz/rays.rs"]
mod rays;
#[path = "../../tests/fuzz/targets.rs"]
pub mod targets;
