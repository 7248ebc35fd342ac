//! The command line.

pub mod diff;
pub mod generate;

use std::process::ExitCode;

/// Runs the command that the process's arguments ask for.
pub fn run() -> ExitCode {
    ExitCode::SUCCESS
}
