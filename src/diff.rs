//! `diff`: compares two images.

mod limits;
mod report;

use std::path::PathBuf;

use super::common::{number, print};
use crate::choice::choice;
use limits::Limits;
use report::Report;
use wavecrest_base::error::Result;
use wavecrest_base::replace::check_differs;
use wavecrest_core::film::Film;
use wavecrest_core::math::srgb::srgb_decode;
use wavecrest_image::compare::{compare, pixels_beyond};
use wavecrest_image::error_map::{MapKind, error_map, flip_map};
use wavecrest_image::flip::{DEFAULT_PIXELS_PER_DEGREE, Flip, flip};
use wavecrest_image::read::read;
use wavecrest_image::write::{Transfer, check_writable, write};

/// Compare an image with a reference.
///
/// Reads PPM, PNG, EXR, PFM and most other formats; integers are scaled to 0 to 1, without a transfer
/// function. For the image A and the reference B, MSE is the mean of (A - B)^2, relative MSE the mean of
/// (A - B)^2 / (B^2 + 0.01), and bias the mean of A - B, positive if A is brighter. FLIP is the mean perceived
/// difference, from 0 to 1, when a viewer alternates between the two.
///
/// The exit code is 0 if the images are equal, or within all given limits; 1 if they differ by more; 2 if
/// they cannot be compared, for example because their sizes differ.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct DiffArgs {
    /// Image
    pub(crate) a: PathBuf,
    /// Reference, of the same size
    pub(crate) b: PathBuf,
    /// Limits
    #[command(flatten)]
    pub(crate) limits: Limits,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Write an image of the difference (.ppm, .png, .exr or .pfm)
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// What that image shows; all but the first in false colours
    #[arg(long, value_name = "KIND", value_parser = choice::<MapKind>(), default_value_t, requires = "output")]
    pub(crate) map: MapKind,
    /// Factor on the difference in that image, to make small ones visible
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = not_negative,
          requires = "output")]
    pub(crate) gain: f64,
    /// Pixels per degree of the viewer's field of view, for FLIP; the default is for a display 0.7 m wide with
    /// 3840 pixels across, seen from 0.7 m
    #[arg(long, value_name = "PIXELS", default_value_t = DEFAULT_PIXELS_PER_DEGREE)]
    pub(crate) pixels_per_degree: f64,
    /// Transfer function of both images, which FLIP undoes
    #[arg(long, value_name = "CURVE", value_parser = choice::<Transfer>(), default_value_t)]
    pub(crate) transfer: Transfer,
}

/// Compares the two images, prints the results, and returns whether they count as equal: whether
/// all [`Limits`] hold.
///
/// # Errors
/// If an image cannot be read, their sizes differ, or the difference cannot be written.
pub(crate) fn run(args: &DiffArgs) -> Result<bool> {
    if let Some(output) = &args.output {
        check_writable(output)?;
        check_differs(output, &args.a, "one of the images")?;
        check_differs(output, &args.b, "one of the images")?;
    }
    let (a, b) = (read(&args.a)?, read(&args.b)?);
    let comparison = compare(&a, &b).map_err(|e| e.in_file(&args.b))?;
    let seen = seen(args, &a, &b)?;
    let beyond = pixels_beyond(&a, &b, args.limits.tolerance())?;
    let report = Report::new(args, comparison, beyond, &seen);
    if let Some(output) = &args.output {
        let gain = args.gain as f32;
        let map = match args.map {
            MapKind::Flip => flip_map(&seen, gain)?,
            kind => error_map(&a, &b, kind, gain)?,
        };
        write(&map, output, Transfer::Linear)?;
    }
    print(&if args.json { report.json()? } else { report.text() })?;
    Ok(report.is_within_limits())
}

/// The perceived difference.
fn seen(args: &DiffArgs, a: &Film, b: &Film) -> Result<Flip> {
    match args.transfer {
        Transfer::Linear => flip(a, b, args.pixels_per_degree),
        Transfer::Srgb => flip(&decoded(a), &decoded(b), args.pixels_per_degree),
    }
}

fn decoded(film: &Film) -> Film {
    let mut film = film.clone();
    let values = film.pixels_mut().as_flattened_mut().iter_mut();
    values.for_each(|value| *value = srgb_decode(*value));
    film
}

fn not_negative(text: &str) -> std::result::Result<f64, String> {
    let fits = |value: &f64| value.is_finite() && *value >= 0.0;
    number(text, fits, "use a number of 0 or more, such as 0.001")
}

#[cfg(test)]
mod tests;
