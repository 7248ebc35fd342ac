//! The command line: `wavecrest SCENE OUTPUT`, and a subcommand for everything else.
//!
//! | exit code | meaning |
//! |---|---|
//! | 0 | done; for `diff`, the images are equal |
//! | 1 | for `diff`, the images differ; for `bench`, the tracers disagree |
//! | 2 | an error, told on standard error |

pub mod check;
pub mod common;
pub mod diff;
pub mod explain;
pub mod generate;
pub mod render;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use crate::error::Result;
use common::tell;

/// A ray tracer for large triangle meshes: wavefront and recursive tracing over one set of kernels.
#[derive(Debug, Parser)]
#[command(name = "wavecrest", version, args_conflicts_with_subcommands = true)]
#[command(subcommand_negates_reqs = true, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    render: Option<render::RenderArgs>,
}

#[derive(Debug, Subcommand)]
enum Command {
    Render(render::RenderArgs),
    Check(check::CheckArgs),
    Explain(explain::ExplainArgs),
    Generate(generate::GenerateArgs),
    Diff(diff::DiffArgs),
}

/// Runs the command that the process's arguments ask for.
pub fn run() -> ExitCode {
    let cli = Cli::parse();
    let outcome = match (cli.command, cli.render) {
        (Some(command), _) => dispatch(&command),
        (None, Some(args)) => render::run(&args).map(|()| true),
        (None, None) => {
            tell(&Cli::command().render_help().to_string());
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            tell(&format!("error: {error}"));
            ExitCode::from(2)
        }
    }
}

/// Runs `command`; false is the answer "no" of a command that asks something.
fn dispatch(command: &Command) -> Result<bool> {
    match command {
        Command::Render(args) => render::run(args).map(|()| true),
        Command::Check(args) => check::run(args).map(|()| true),
        Command::Explain(args) => explain::run(args).map(|()| true),
        Command::Generate(args) => generate::run(args).map(|()| true),
        Command::Diff(args) => diff::run(args),
    }
}
