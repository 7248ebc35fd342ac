//! The output of `diff`, as text or as JSON.

use std::path::Path;

use serde::Serialize;

use super::DiffArgs;
use super::limits::Verdict;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_image::compare::{Channel, Comparison};
use wavecrest_image::flip::Flip;

/// The output. The keys of the JSON are the names here.
#[derive(Serialize)]
pub(super) struct Report<'a> {
    a: &'a Path,
    b: &'a Path,
    #[serde(flatten)]
    pub(super) comparison: Comparison,
    /// The mean FLIP.
    pub(super) flip: f64,
    pub(super) flip_pixels_per_degree: f64,
    tolerance: f64,
    within_tolerance: bool,
    /// Number of pixels with a value that differs by more than the tolerance.
    pixels_beyond_tolerance: u64,
    /// The deciding limits.
    limits: Vec<Verdict>,
}

impl<'a> Report<'a> {
    /// The report on two images with `beyond` pixels beyond the tolerance.
    pub(super) fn new(
        args: &'a DiffArgs,
        comparison: Comparison,
        beyond: u64,
        seen: &Flip,
    ) -> Self {
        let tolerance = args.limits.tolerance();
        Self {
            a: &args.a,
            b: &args.b,
            flip: seen.mean,
            flip_pixels_per_degree: seen.pixels_per_degree,
            tolerance,
            within_tolerance: comparison.largest <= tolerance,
            pixels_beyond_tolerance: beyond,
            limits: args.limits.verdicts(&comparison, seen.mean, beyond),
            comparison,
        }
    }

    /// Whether the images count as equal.
    pub(super) fn is_within_limits(&self) -> bool {
        self.limits.iter().all(|verdict| verdict.within)
    }

    pub(super) fn json(&self) -> Result<String> {
        serde_json::to_string_pretty(self).map(|text| text + "\n").map_err(|error| {
            // Only a path that is not Unicode can fail.
            Error::new(ErrorKind::Usage, format!("cannot write the result as JSON: {error}"))
                .remedy("leave out --json")
        })
    }

    pub(super) fn text(&self) -> String {
        let found = &self.comparison;
        let all = u64::from(found.width) * u64::from(found.height);
        let share = |pixels: u64| {
            format!("{pixels} of {all} ({:.3} %)", 100.0 * pixels as f64 / all as f64)
        };
        let channels = Channel::ALL.into_iter().zip(&found.channel_bias);
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
            return "equal in every bit".into();
        }
        let within = self.is_within_limits();
        let decisive = self.limits.iter().filter(|verdict| verdict.within == within);
        let words: Vec<String> = decisive.map(Verdict::words).collect();
        let answer = if within { "equal within limits" } else { "different" };
        format!("{answer}: {}", words.join(", "))
    }
}

/// Six digits, with an exponent for small numbers.
pub(super) fn number(value: f64) -> String {
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
