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
    let text = String::from_utf8_lossy(&script);
    let commands: Vec<&str> = program.get_subcommands().map(Command::get_name).collect();
    print(&without_command(args.shell, &text).replace("COMMANDS", &commands.join(" ")))
}

/// The script with `render` understood where the first word is none of the `COMMANDS`, which clap does not know of: it is
/// a file or an option of `render`. Files are offered beside the commands.
fn without_command(shell: Shell, script: &str) -> String {
    match shell {
        Shell::Bash => {
            let (functions, registered) = script.rsplit_once("\nif ").unwrap_or((script, ""));
            let registered = registered.replace("-F _wavecrest ", "-F _wavecrest_or_render ");
            format!("{functions}\n{BASH}\nif {registered}")
        }
        Shell::Zsh => {
            let commands = "_describe -t commands 'wavecrest commands' commands \"$@\"";
            let or_files =
                format!("{commands} && local found=0\n    _files || return ${{found:-1}}");
            let start = "_wavecrest() {\n";
            script.replacen(start, &format!("{start}{ZSH}"), 1).replace(commands, &or_files)
        }
        Shell::Fish => format!("{script}{FISH}"),
        _ => script.to_owned(),
    }
}

/// Options are offered after a dash only, so that files can be.
const BASH: &str = r#"_wavecrest_or_render() {
    local word=${COMP_WORDS[1]} first=$((COMP_CWORD == 1)) found
    if [[ $first == 0 || $word == -* ]] && [[ " COMMANDS " != *" $word "* ]]; then
        COMP_WORDS=("$1" render "${COMP_WORDS[@]:1}")
        COMP_CWORD=$((COMP_CWORD + 1))
    fi
    _wavecrest "$@"
    if [[ $2 != -* && $3 != -* ]]; then
        found=("${COMPREPLY[@]}")
        COMPREPLY=()
        for word in "${found[@]}"; do
            [[ $word == -* ]] || COMPREPLY+=("$word")
        done
    fi
    if [[ $first == 1 && $2 != -* ]]; then
        local IFS=$'\n'
        compopt -o filenames 2>/dev/null
        COMPREPLY+=($(compgen -f -- "$2"))
    fi
}
"#;

const ZSH: &str = r#"    if [[ $CURRENT -gt 2 || $words[2] == -* ]] && [[ " COMMANDS " != *" $words[2] "* ]]; then
        words=("$words[1]" render "${(@)words[2,-1]}")
        (( CURRENT++ ))
    fi
"#;

/// Replaces two functions of the script.
const FISH: &str = r#"
function __fish_wavecrest_needs_command
    test (count (commandline -opc)) -eq 1
end
function __fish_wavecrest_using_subcommand
    set -l words (commandline -opc)
    contains -- "$words[2]" COMMANDS
    or set words[2] render
    contains -- $words[2] $argv
end
complete -c wavecrest -n __fish_wavecrest_needs_command -F
"#;

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
