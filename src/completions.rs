//! `completions`: completion scripts for shells.

use clap::Command;
use clap_complete::{Shell, generate};

use super::common::print;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// Print a completion script for a shell.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct CompletionsArgs {
    /// Shell
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

/// Prints the script for `program`.
///
/// # Errors
/// If standard output cannot be written to.
pub(crate) fn run(args: &CompletionsArgs, mut program: Command) -> Result<()> {
    let mut script = Vec::new();
    let name = program.get_name().to_owned();
    generate(args.shell, &mut program, name, &mut script);
    let text = String::from_utf8(script)
        .map_err(|cause| Error::new(ErrorKind::Usage, "the script is not UTF-8").because(cause))?;
    print(&text)
}
