//! `merge`: parts in, an image out.

use std::path::PathBuf;

use super::common::tell;
use super::develop::DevelopOptions;
use super::metadata::MetadataOptions;
use crate::choice::choice;
use wavecrest_base::error::Result;
use wavecrest_base::replace::check_differs;
use wavecrest_image::farm::merge::{Merged, merge};
use wavecrest_image::metadata::Extras;
use wavecrest_image::write::{Format, Transfer, check_writable, write_with};

/// Puts the parts of an image together that `render --shard` made.
///
/// The image is the same, byte for byte, as one process would write it. Parts may come in any order, and twice.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct MergeArgs {
    /// The parts, in any order
    #[arg(value_name = "PART", required = true)]
    pub(crate) parts: Vec<PathBuf>,
    /// The image to write: .ppm, .png, .exr or .pfm
    #[arg(short, long, value_name = "OUTPUT")]
    pub(crate) output: PathBuf,
    /// How linear colours become 8-bit levels (.ppm, .png) [default: as the render would have it]
    #[arg(long, value_parser = choice::<Transfer>())]
    pub(crate) transfer: Option<Transfer>,
    /// How light becomes levels
    #[command(flatten)]
    pub(crate) develop: DevelopOptions,
    /// What is said of the image
    #[command(flatten)]
    pub(crate) metadata: MetadataOptions,
    /// Say nothing but errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Puts the parts together. Nothing is written before all of them are known to fit.
///
/// # Errors
/// When the parts do not make one image, or it cannot be written.
pub(crate) fn run(args: &MergeArgs) -> Result<()> {
    check_writable(&args.output)?;
    for part in &args.parts {
        check_differs(&args.output, part, "a part")?;
    }
    let Merged { identity, transfer, film, invalid } = merge(&args.parts)?;
    let entries = args.metadata.entries(&identity);
    let extras = Extras { entries: &entries, ..args.metadata.extras() };
    let developed = args.develop.developed(&film, Format::from_path(&args.output)?, &extras);
    let film = developed.unwrap_or(film);
    write_with(&film, &args.output, args.transfer.unwrap_or(transfer), &extras)?;
    if invalid > 0 && !args.quiet {
        tell(&format!("warning: {invalid} samples were not finite and count as black"));
    }
    Ok(())
}
