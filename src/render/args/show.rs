//! What is seen of a render while it is made.

use std::path::PathBuf;

use crate::common::above_zero;

/// Where tev listens by default.
const TEV: &str = "127.0.0.1:14158";

/// Options on what is seen of a render.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ShowOptions {
    /// How progress is shown on standard error
    #[arg(long, value_enum, default_value_t)]
    pub(crate) progress: Style,
    /// Add what is done, chosen and found to the end of this file; - is standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) log: Option<PathBuf>,
    /// Write the image as far as it is every so many seconds
    #[arg(long, value_name = "SECONDS", value_parser = above_zero)]
    pub(crate) save_every: Option<f64>,
    /// Show the image in the viewer tev while it is rendered
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, require_equals = true,
          default_missing_value = TEV)]
    pub(crate) tev: Option<String>,
}

/// How progress is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Style {
    /// A bar on a terminal, and nothing elsewhere or with --quiet
    #[default]
    Auto,
    /// A bar, where there is a terminal
    Bar,
    /// A line of JSON ten times a second at most
    Json,
    /// Nothing
    None,
}
