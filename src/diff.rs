//! `diff`: compares two images.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::Serialize;

use super::common::{choice, not_negative, print, to_json};
use wavecrest_base::error::Result;
use wavecrest_base::replace::check_differs;
use wavecrest_core::film::Film;
use wavecrest_core::math::srgb::srgb_decode;
use wavecrest_image::compare::{ColorChannel, Comparison, compare, pixels_beyond};
use wavecrest_image::error_map::{MapKind, error_map, flip_map};
use wavecrest_image::flip::{DEFAULT_PIXELS_PER_DEGREE, Flip, flip};
use wavecrest_image::read::read;
use wavecrest_image::write::{Format, Transfer, check_writable, write};

/// Compare an image with a reference.
///
/// Reads the colour of PPM, PNG, EXR, PFM and most other formats; integers are scaled to 0 to 1, without a transfer
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
    /// Write an image of the difference (.png, .jpg, .ppm, .exr or .pfm)
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// What that image shows; all but the first in false colours
    #[arg(long, value_name = "KIND", value_parser = choice::<MapKind>(), default_value_t, requires = "output")]
    pub(crate) map: MapKind,
    /// Factor on the difference in that image, to make small ones visible
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = not_negative(EXAMPLE),
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

/// Options on what may differ. Every limit that is given must hold; where none is, no value may differ.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Limits {
    /// Largest accepted difference of two values [default: 0]; --max-pixels exempts some pixels
    #[arg(long, value_name = "MAX", value_parser = not_negative(EXAMPLE))]
    pub(crate) tolerance: Option<f64>,
    /// Largest accepted RMSE
    #[arg(long, value_name = "MAX", value_parser = not_negative(EXAMPLE))]
    pub(crate) max_rmse: Option<f64>,
    /// Largest accepted FLIP, 0 to 1
    #[arg(long, value_name = "MAX", value_parser = not_negative(EXAMPLE))]
    pub(crate) max_flip: Option<f64>,
    /// Pixels, such as 20 or 0.1%, that may differ by more than the tolerance
    #[arg(long, value_name = "PIXELS", allow_hyphen_values = true)]
    pub(crate) max_pixels: Option<Pixels>,
}

/// A number of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Pixels {
    Count(u64),
    /// As a share of all, from 0 to 1.
    Share(f64),
}

impl FromStr for Pixels {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let pixels = match text.strip_suffix('%') {
            Some(percent) => {
                let percent = percent.trim().parse().ok().filter(|p| (0.0..=100.0).contains(p));
                percent.map(|percent: f64| Self::Share(percent / 100.0))
            }
            None => text.parse().ok().map(Self::Count),
        };
        pixels.ok_or_else(|| "write a whole number of pixels, or a share such as 0.1%".to_owned())
    }
}

/// What is compared, of a format that may hold more.
const OF_COLOR: &str = " of colour; alpha and other layers are not compared";

/// What a number of 0 or more may be.
const EXAMPLE: &str = "0 or more, such as 0.001";

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
    let perceived = perceived(args, &a, &b)?;
    let tolerance = args.limits.tolerance();
    let beyond = pixels_beyond(&a, &b, tolerance)?;
    let report = DiffReport {
        a: &args.a,
        b: &args.b,
        flip: perceived.mean,
        flip_pixels_per_degree: perceived.pixels_per_degree,
        tolerance,
        within_tolerance: comparison.largest <= tolerance,
        pixels_beyond_tolerance: beyond,
        limits: args.limits.verdicts(&comparison, perceived.mean, beyond),
        comparison,
    };
    if let Some(output) = &args.output {
        let gain = args.gain as f32;
        let map = match args.map {
            MapKind::Flip => flip_map(&perceived, gain)?,
            kind => error_map(&a, &b, kind, gain)?,
        };
        write(&map, output, Transfer::Linear)?;
    }
    print(&if args.json { to_json(&report)? } else { report.text() })?;
    Ok(report.is_within_limits())
}

/// The perceived difference.
fn perceived(args: &DiffArgs, a: &Film, b: &Film) -> Result<Flip> {
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

/// The output. The keys of the JSON are the names here.
#[derive(Serialize)]
struct DiffReport<'a> {
    a: &'a Path,
    b: &'a Path,
    #[serde(flatten)]
    comparison: Comparison,
    /// The mean FLIP.
    flip: f64,
    flip_pixels_per_degree: f64,
    tolerance: f64,
    within_tolerance: bool,
    /// Number of pixels with a value that differs by more than the tolerance.
    pixels_beyond_tolerance: u64,
    /// The deciding limits.
    limits: Vec<CheckedLimit>,
}

impl DiffReport<'_> {
    /// Whether the images count as equal.
    fn is_within_limits(&self) -> bool {
        self.limits.iter().all(|verdict| verdict.within)
    }

    fn text(&self) -> String {
        let found = &self.comparison;
        let all = u64::from(found.width) * u64::from(found.height);
        let share = |pixels: u64| {
            format!("{pixels} of {all} ({:.3} %)", 100.0 * pixels as f64 / all as f64)
        };
        let channels = ColorChannel::ALL.into_iter().zip(&found.channel_bias);
        let biases: String =
            channels.map(|(of, &bias)| format!(", {} {}", of.name(), number(bias))).collect();
        let place = match (found.largest_at, found.largest_channel) {
            (Some((x, y)), Some(of)) => format!(", {} at column {x}, row {y}", of.name()),
            _ => String::new(),
        };
        let (flip, per_degree) = (number(self.flip), self.flip_pixels_per_degree);
        let mut lines = vec![
            ("size", format!("{} x {}", found.width, found.height)),
            ("MSE", number(found.mse)),
            ("RMSE", number(found.rmse)),
            ("PSNR", decibels(found.psnr)),
            ("relative MSE", number(found.relative_mse)),
            ("bias", number(found.bias) + &biases),
            ("FLIP", format!("{flip} at {per_degree:.2} pixels per degree")),
            ("largest difference", number(found.largest) + &place),
            ("different pixels", share(found.different_pixels)),
        ];
        if found.nonfinite > 0 {
            lines.push(("pixels not finite", share(found.nonfinite)));
        }
        lines.push(("result", self.verdict()));
        lines.iter().map(|(name, value)| format!("{name:<20}{value}\n")).collect()
    }

    fn verdict(&self) -> String {
        if self.comparison.equal {
            // Other formats may hold more.
            let is_all = |path| Format::from_path(path).is_ok_and(|format| !format.has_alpha());
            let of = if is_all(self.a) && is_all(self.b) { "" } else { OF_COLOR };
            return format!("equal in every bit{of}");
        }
        let within = self.is_within_limits();
        let decisive = self.limits.iter().filter(|verdict| verdict.within == within);
        let words: Vec<String> = decisive.map(CheckedLimit::words).collect();
        let answer = if within { "equal within limits" } else { "different" };
        format!("{answer}: {}", words.join(", "))
    }
}

/// Six digits, with an exponent for small numbers.
fn number(value: f64) -> String {
    match value {
        0.0 => "0".into(),
        f64::INFINITY => "infinite".into(),
        f64::NEG_INFINITY => "-infinite".into(),
        _ if value.is_nan() => "unknown".into(),
        _ if (1e-3..1e6).contains(&value.abs()) => format!("{value:.6}"),
        _ => format!("{value:.5e}"),
    }
}

fn decibels(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.2} dB")
    } else if value > 0.0 {
        "infinite (no difference)".into()
    } else {
        "none (infinite difference)".into()
    }
}

/// A limit, and whether it holds.
#[derive(Serialize)]
struct CheckedLimit {
    /// The limited quantity.
    of: &'static str,
    found: f64,
    /// The largest allowed value.
    limit: f64,
    within: bool,
}

impl CheckedLimit {
    /// Such as "RMSE 0.2 is above 0.1".
    fn words(&self) -> String {
        let Self { of, found, limit, within } = *self;
        let place = if within { "not above" } else { "above" };
        format!("{of} {} is {place} {}", shown(found), shown(limit))
    }
}

/// Integers without decimals.
fn shown(value: f64) -> String {
    if value.fract() == 0.0 { value.to_string() } else { number(value) }
}

impl Limits {
    /// The largest difference of two values that counts as equal.
    fn tolerance(&self) -> f64 {
        self.tolerance.unwrap_or_default()
    }

    /// The verdicts on a comparison: `flip` is the mean FLIP, and `beyond` the number of pixels
    /// beyond the tolerance.
    fn verdicts(&self, found: &Comparison, flip: f64, beyond: u64) -> Vec<CheckedLimit> {
        let all = u64::from(found.width) * u64::from(found.height);
        let most = self.max_pixels.map(|pixels| match pixels {
            Pixels::Count(count) => count as f64,
            Pixels::Share(share) => (share * all as f64).floor(),
        });
        let has_others = self.max_rmse.or(self.max_flip).or(most).is_some();
        let largest = match (self.tolerance, most) {
            (_, Some(_)) => None,
            (None, None) if has_others => None,
            _ => Some(self.tolerance()),
        };
        // Of a pixel that is not finite FLIP sees a difference in colour alone.
        let flip = if found.rmse.is_finite() { flip } else { f64::INFINITY };
        let limits = [
            ("largest difference", found.largest, largest),
            ("RMSE", found.rmse, self.max_rmse),
            ("FLIP", flip, self.max_flip),
            ("the number of different pixels", beyond as f64, most),
        ];
        let checked = |(of, found, most): (&'static str, f64, Option<f64>)| {
            // NaN is not within a limit.
            most.map(|limit| CheckedLimit { of, found, limit, within: found <= limit })
        };
        limits.into_iter().filter_map(checked).collect()
    }
}
