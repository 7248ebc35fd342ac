//! `merge`: merges parts into an image.

use std::path::PathBuf;

use super::common::{FILES, choice, tell};
use super::output_options::{DevelopOptions, Metadata};
use wavecrest_base::error::Result;
use wavecrest_base::replace::check_differs;
use wavecrest_base::words::counted;
use wavecrest_image::farm::merge::{Merged, merge};
use wavecrest_image::write::{Transfer, check_writable, write_with};

/// Merge the parts that `render --shard` wrote into one image.
///
/// The image is the same, byte for byte, as if one process had rendered it. Parts can be given in any order, and twice.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct MergeArgs {
    /// Parts, in any order
    #[arg(value_name = "PART", required = true)]
    pub(crate) parts: Vec<PathBuf>,
    /// Image to write: .png, .jpg, .ppm, .exr or .pfm
    #[arg(short, long, value_name = "OUTPUT")]
    pub(crate) output: PathBuf,
    /// Transfer function of 8-bit images (.ppm, .png, .jpg) [default: that of the render]
    #[arg(long, value_parser = choice::<Transfer>())]
    pub(crate) transfer: Option<Transfer>,
    /// Exposure and tone mapping
    #[command(flatten)]
    pub(crate) develop: DevelopOptions,
    /// Metadata to write
    #[arg(long, help_heading = FILES, value_enum, default_value_t)]
    pub(crate) metadata: Metadata,
    /// Print no summary; warnings and errors stay
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Merges the parts. Nothing is written before all of them are known to fit.
///
/// # Errors
/// If the parts do not form one image, or it cannot be written.
pub(crate) fn run(args: &MergeArgs) -> Result<()> {
    check_writable(&args.output)?;
    for part in &args.parts {
        check_differs(&args.output, part, "a part")?;
    }
    let Merged { identity, transfer, film, invalid } = merge(&args.parts)?;
    let entries = args.metadata.entries(&identity);
    let extras = args.metadata.extras(&entries, args.develop);
    write_with(&film, &args.output, args.transfer.unwrap_or(transfer), &extras)?;
    if !args.quiet {
        let (name, parts) = (args.output.display(), counted(args.parts.len() as u64, "part"));
        tell(&format!("{name}  {}x{}  {parts}", film.width(), film.height()));
    }
    if invalid > 0 {
        tell(&format!("warning: {invalid} samples were not finite and count as black"));
    }
    Ok(())
}
