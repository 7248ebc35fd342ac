//! Progress options of a render.

use std::path::PathBuf;

use crate::common::above_zero;

/// Where tev listens by default.
const TEV: &str = "127.0.0.1:14158";

/// Options on what is seen of a render.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ShowOptions {
    /// How to show progress on standard error
    #[arg(long, value_enum, default_value_t)]
    pub(crate) progress: Style,
    /// Append a log to this file; - for standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) log: Option<PathBuf>,
    /// Write the unfinished image at this interval
    #[arg(long, value_name = "SECONDS", value_parser = above_zero)]
    pub(crate) save_every: Option<f64>,
    /// Show the image in the viewer tev while rendering
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, require_equals = true,
          default_missing_value = TEV)]
    pub(crate) tev: Option<String>,
}

/// How progress is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Style {
    /// A bar if standard error is a terminal, unless --quiet is given
    #[default]
    Auto,
    /// A bar if standard error is a terminal
    Bar,
    /// Lines of JSON, at most ten a second
    Json,
    /// Nothing
    None,
}
