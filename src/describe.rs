//! Commands that describe the program: `schema`, the scene format; `completions`, scripts for shells; `man`, manual
//! pages, one for each command.

use std::path::{Path, PathBuf};

use clap::Command;
use clap::builder::Resettable;
use clap_complete::{Shell, generate};
use clap_mangen::Man;

use super::common::{print, to_json, write_text};
use super::exit;
use wavecrest_base::error::{Error, ErrorKind, Result, did_you_mean};
use wavecrest_base::replace::check_replaceable;
use wavecrest_scene::json_schema;

/// Print the JSON Schema of scene files, for editors.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct SchemaArgs {}

/// Prints the schema.
///
/// # Errors
/// If standard output cannot be written to.
pub(crate) fn schema(_: &SchemaArgs) -> Result<()> {
    print(&to_json(&json_schema())?)
}

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
pub(crate) fn completions(args: &CompletionsArgs, mut program: Command) -> Result<()> {
    let mut script = Vec::new();
    let name = program.get_name().to_owned();
    generate(args.shell, &mut program, name, &mut script);
    let text = String::from_utf8(script)
        .map_err(|cause| Error::new(ErrorKind::Usage, "the script is not UTF-8").because(cause))?;
    print(&text)
}

/// Print a manual page, or write all pages to a folder.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ManArgs {
    /// Command to describe [default: wavecrest]
    pub(crate) command: Option<String>,
    /// Folder to write all pages to, such as ~/.local/share/man/man1
    #[arg(short, long, value_name = "FOLDER", conflicts_with = "command")]
    pub(crate) output: Option<PathBuf>,
}

/// Writes the requested pages of `program`.
///
/// # Errors
/// If there is no such command, or a page cannot be written.
pub(crate) fn man(args: &ManArgs, program: Command) -> Result<()> {
    let pages = pages(program);
    match &args.output {
        Some(folder) => write_all(&pages, folder),
        None => {
            let page = find(&pages, args.command.as_deref())?;
            print(&render(page)?)
        }
    }
}

/// The program and its commands for the manual.
fn pages(program: Command) -> Vec<Command> {
    let mut program = program.disable_help_subcommand(true);
    program.build();
    let commands: Vec<Command> = program.get_subcommands().cloned().collect();
    std::iter::once(program).chain(commands).collect()
}

fn find<'a>(pages: &'a [Command], name: Option<&str>) -> Result<&'a Command> {
    let names = || pages.iter().map(Command::get_name);
    let wanted = name.or_else(|| names().next()).unwrap_or_default();
    pages.iter().find(|page| page.get_name() == wanted).ok_or_else(|| {
        let error = Error::new(ErrorKind::Usage, "there is no such command").value(wanted);
        match did_you_mean(wanted, names()) {
            Some(near) => error.remedy(format!("did you mean {near}?")),
            None => error.remedy("see wavecrest --help"),
        }
    })
}

fn render(page: &Command) -> Result<String> {
    let mut text = Vec::new();
    let cannot = |cause| Error::io("cannot write the page", page.get_name(), cause);
    // Exit codes have their own section.
    Man::new(page.clone().after_help(Resettable::Reset)).render(&mut text).map_err(cannot)?;
    let codes = exit::CODES.map(|(code, meaning)| format!(".TP\n{code}\n{meaning}\n"));
    // As a list in roff.
    Ok(String::from_utf8_lossy(&text).into_owned() + ".SH \"EXIT CODES\"\n" + &codes.concat())
}

/// Writes every page, after checking that all can be written.
fn write_all(pages: &[Command], folder: &Path) -> Result<()> {
    let file = |page: &Command| folder.join(Man::new(page.clone()).get_filename());
    pages.iter().try_for_each(|page| check_replaceable(&file(page)))?;
    pages.iter().try_for_each(|page| write_text(&file(page), &render(page)?))
}
