//! The command line: `wavecrest SCENE OUTPUT`, and a subcommand for everything else.
//!
//! [`exit::CODES`] lists the exit codes.

mod accuracy;
mod allocator;
mod bench;
mod check;
mod common;
mod convert;
mod describe;
mod diff;
mod exit;
mod explain;
mod generate;
mod input;
mod interrupt;
mod merge;
mod output_options;
mod probe;
mod progress;
mod render;
mod selftest;
mod trace;
#[cfg(feature = "view")]
mod view;

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, FromArgMatches, Parser};

use common::{Threads, tell, tell_error};
use wavecrest_base::error::{Error, ErrorKind, Result, did_you_mean};

/// A ray tracer for large triangle meshes.
///
/// Renders a scene (.json), a glTF file (.gltf, .glb) or a mesh (.ply, .obj, .stl) to an image. `wavecrest render --help`
/// lists the options.
#[derive(Debug, Parser)]
#[command(name = "wavecrest", version, arg_required_else_help = true)]
#[command(override_usage = "wavecrest scene.json image.png [OPTIONS]\n       wavecrest <COMMAND>")]
enum Command {
    Render(Box<render::RenderArgs>),
    Merge(merge::MergeArgs),
    Check(check::CheckArgs),
    Convert(convert::ConvertArgs),
    Explain(explain::ExplainArgs),
    Probe(probe::ProbeArgs),
    #[cfg(feature = "view")]
    View(Box<view::ViewArgs>),
    Generate(generate::GenerateArgs),
    Trace(trace::TraceArgs),
    Diff(diff::DiffArgs),
    Bench(bench::BenchArgs),
    Selftest(selftest::SelftestArgs),
    Accuracy(accuracy::AccuracyArgs),
    Schema(describe::SchemaArgs),
    Completions(describe::CompletionsArgs),
    Man(describe::ManArgs),
}

fn main() -> ExitCode {
    interrupt::clean_up();
    let arguments = match with_command(std::env::args_os().collect()) {
        Ok(arguments) => arguments,
        Err(error) => return failed(&error),
    };
    let matches = match program().try_get_matches_from(&arguments) {
        Ok(matches) => matches,
        Err(error) => {
            let command = arguments.get(1);
            let known = other_name(&error, command).or_else(|| no_output(&error, command));
            return known.map_or_else(|| error.exit(), |error| failed(&error));
        }
    };
    let command = Command::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    match dispatch(&command) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => failed(&error),
    }
}

/// Prints an error, and returns its exit code.
fn failed(error: &Error) -> ExitCode {
    match error.kind() {
        ErrorKind::Interrupted(signal) => {
            tell(&error.to_string());
            ExitCode::from(interrupt::exit_code(signal))
        }
        _ => {
            tell_error(error);
            ExitCode::from(exit::ERROR)
        }
    }
}

/// The command line of clap.
fn program() -> clap::Command {
    let codes = exit::CODES.map(|(code, meaning)| format!("\n  {code}  {meaning}"));
    // The parser of each value knows its range; clap would take -1 for an option.
    let negative = |arg: clap::Arg| {
        let takes_values = arg.get_action().takes_values();
        if takes_values { arg.allow_negative_numbers(true) } else { arg }
    };
    Command::command()
        .mut_subcommands(|command| command.mut_args(negative))
        .after_help(format!("Exit codes:{}", codes.concat()))
}

/// What other renderers, or older versions, call an option, and what it is here.
const OTHER_NAMES: [(&str, &[&str]); 14] = [
    ("--samples N", &["--spp", "--sample", "--samples-per-pixel", "--aa", "--antialias"]),
    ("--size WIDTHxHEIGHT", &["--resolution", "--res", "--dimensions", "--image-size"]),
    ("--width PIXELS", &["-w", "-W"]),
    ("--height PIXELS", &["-H"]),
    ("--threads N", &["--jobs", "--cores", "--num-threads", "--nthreads", "--cpus", "-j", "-t"]),
    ("--output FILE", &["--out", "--outfile", "--output-file"]),
    ("--crop X,Y,WIDTH,HEIGHT", &["--region", "--window", "--crop-window"]),
    ("--background COLOR", &["--bg", "--bg-color", "--background-color"]),
    ("--color R,G,B", &["--colour", "--base-color"]),
    ("--environment FILE", &["--hdri", "--hdri-file", "--envmap", "--env"]),
    ("--progress json", &["--verbose", "-v"]),
    ("--view SIDE, once for each side", &["--sheet"]),
    ("--metadata none", &["--no-metadata"]),
    ("--full", &["--side-pixels", "--seeds", "--most", "--reference"]),
];

/// The error that an option of another renderer, or an older version, is not here, with the one that is, if the `command` has it.
fn other_name(error: &clap::Error, command: Option<&OsString>) -> Option<Error> {
    let ContextValue::String(given) = error.get(ContextKind::InvalidArg)? else { return None };
    let is_given = |(_, others): &&(&str, &[&str])| others.contains(&given.as_str());
    let (usage, _) = OTHER_NAMES.iter().find(is_given)?;
    let name = usage.split(' ').next()?.trim_start_matches('-');
    let commands = Command::command();
    let mut options = commands.find_subcommand(command?)?.get_arguments();
    options.find(|option| option.get_long() == Some(name))?;
    let message = format!("there is no {given}");
    Some(Error::new(ErrorKind::Usage, message).remedy(format!("use {usage}")))
}

/// The error that a render has no output, and all else.
fn no_output(error: &clap::Error, command: Option<&OsString>) -> Option<Error> {
    let ContextValue::Strings(missing) = error.get(ContextKind::InvalidArg)? else { return None };
    if command? != "render" || missing[..] != ["<OUTPUT>"] {
        return None;
    }
    let look = if cfg!(feature = "view") { ", or `wavecrest view FILE`" } else { "" };
    let error = Error::new(ErrorKind::Usage, "the output is missing");
    Some(error.remedy(format!("add one, such as out.png{look}")))
}

/// The arguments, with `render` inserted if they name no command.
///
/// # Errors
/// If the first is the name of neither a command nor a file.
fn with_command(mut arguments: Vec<OsString>) -> Result<Vec<OsString>> {
    let Some(first) = arguments.get(1) else { return Ok(arguments) };
    let word = first.to_string_lossy();
    let commands = Command::command();
    let is_command = matches!(&*word, "help" | "-h" | "--help" | "-V" | "--version")
        || commands.find_subcommand(&*word).is_some();
    if is_command {
        return Ok(arguments);
    }
    let path = Path::new(first);
    // Anything with an extension or a folder is taken as a file.
    let is_word =
        !word.starts_with('-') && path.extension().is_none() && path.components().count() == 1;
    if is_word && !path.exists() {
        let near = did_you_mean(&word, commands.get_subcommands().map(clap::Command::get_name));
        let message = format!("{word:?} is neither a command nor a file");
        return Err(Error::new(ErrorKind::Usage, message).remedy(match near {
            Some(near) => format!("did you mean \"wavecrest {near}\"?"),
            None => "see wavecrest --help for the commands".to_owned(),
        }));
    }
    arguments.insert(1, "render".into());
    Ok(arguments)
}

/// Runs `command`; false is the answer "no" of a command that checks something.
fn dispatch(command: &Command) -> Result<bool> {
    match command {
        Command::Render(args) => render::run(args).map(|()| true),
        Command::Merge(args) => pooled(|| merge::run(args)).map(|()| true),
        Command::Check(args) => check::run(args).map(|()| true),
        Command::Convert(args) => pooled(|| convert::run(args)).map(|()| true),
        Command::Explain(args) => explain::run(args).map(|()| true),
        Command::Probe(args) => probe::run(args).map(|()| true),
        #[cfg(feature = "view")]
        Command::View(args) => view::run(args).map(|()| true),
        Command::Generate(args) => pooled(|| generate::run(args)).map(|()| true),
        Command::Trace(args) => trace::run(args).map(|()| true),
        Command::Diff(args) => pooled(|| diff::run(args)),
        Command::Bench(args) => bench::run(args),
        Command::Selftest(args) => selftest::run(args),
        Command::Accuracy(args) => accuracy::run(args).map(|()| true),
        Command::Schema(args) => describe::schema(args).map(|()| true),
        Command::Completions(args) => describe::completions(args, program()).map(|()| true),
        Command::Man(args) => describe::man(args, program()).map(|()| true),
    }
}

/// Runs a command without options on threads; a failure to start threads is an error here, too.
fn pooled<R: Send>(command: impl FnOnce() -> Result<R> + Send) -> Result<R> {
    Threads { threads: None }.run(command)
}
