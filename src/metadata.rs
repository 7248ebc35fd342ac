//! Metadata of image files, as requested by the arguments.

use std::ffi::OsString;
use std::path::Path;

use clap::ValueEnum;

use wavecrest_image::farm::Identity;
use wavecrest_image::metadata::{Entry, Extras, Provenance};
use wavecrest_image::write::Format;

/// Options on what is said.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct MetadataOptions {
    /// Metadata to write
    #[arg(long, value_enum, default_value_t)]
    pub(crate) metadata: MetadataKind,
    /// Write no metadata; the same as --metadata none
    #[arg(long, conflicts_with = "metadata")]
    pub(crate) no_metadata: bool,
}

/// What files say of how their image was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum MetadataKind {
    /// Program, scene, seed, samples and precision, in .exr and .png; independent of tracer and machine
    #[default]
    Auto,
    /// The same, also in .ppm as comments, which not every reader accepts
    Scene,
    /// The same, and the command line
    Full,
    /// Nothing
    None,
}

impl MetadataOptions {
    fn kind(&self) -> MetadataKind {
        if self.no_metadata { MetadataKind::None } else { self.metadata }
    }

    /// Whether an image in this file gets metadata.
    pub(super) fn is_stored_in(&self, file: &Path) -> bool {
        match (self.kind(), Format::from_path(file)) {
            (MetadataKind::None, _) | (_, Ok(Format::Pfm)) => false,
            (_, Ok(Format::Ppm)) => self.extras().comments,
            // Animations too.
            (_, Ok(Format::Png | Format::Exr) | Err(_)) => true,
        }
    }

    /// The metadata of an image with this identity, as far as requested.
    pub(super) fn entries(&self, identity: &Identity) -> Vec<Entry> {
        let command = || (self.kind() == MetadataKind::Full).then(command);
        match self.kind() {
            MetadataKind::None => Vec::new(),
            _ => Provenance { command: command(), ..identity.provenance() }.entries(),
        }
    }

    /// How entries are written.
    pub(super) fn extras(&self) -> Extras<'static> {
        let comments = matches!(self.kind(), MetadataKind::Scene | MetadataKind::Full);
        Extras { comments, ..Extras::default() }
    }
}

/// The command of this process, quoted so that it can be typed again.
pub(super) fn command() -> String {
    let word = |word: OsString| {
        let word = word.to_string_lossy();
        let is_plain = |c: char| c.is_alphanumeric() || "-_./,:=+@%".contains(c);
        if !word.is_empty() && word.chars().all(is_plain) {
            word.into_owned()
        } else {
            format!("'{}'", word.replace('\'', r"'\''"))
        }
    };
    std::env::args_os().map(word).collect::<Vec<_>>().join(" ")
}
