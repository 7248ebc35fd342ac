//! The `wavecrest` command: everything it does is in the library's [`wavecrest::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    wavecrest::cli::run()
}
