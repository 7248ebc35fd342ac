//! The output of `diff`, as text or as JSON.

use std::fmt::Write as _;
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
        let size = format!("{} x {}", found.width, found.height);
        let mut text = String::new();
        line(&mut text, "size", &size);
        line(&mut text, "MSE", &number(found.mse));
        line(&mut text, "RMSE", &number(found.rmse));
        line(&mut text, "PSNR", &decibels(found.psnr));
        line(&mut text, "relative MSE", &number(found.relative_mse));
        line(&mut text, "bias", &self.bias());
        line(&mut text, "FLIP", &self.flip());
        line(&mut text, "largest difference", &self.largest());
        line(&mut text, "different pixels", &share(found, found.different_pixels));
        if found.nonfinite > 0 {
            line(&mut text, "pixels not finite", &share(found, found.nonfinite));
        }
        line(&mut text, "result", &self.verdict());
        text
    }

    fn bias(&self) -> String {
        let found = &self.comparison;
        let mut text = number(found.bias);
        for (channel, &bias) in Channel::ALL.into_iter().zip(&found.channel_bias) {
            let _ = write!(text, ", {} {}", channel.name(), number(bias));
        }
        text
    }

    fn flip(&self) -> String {
        format!("{} at {:.2} pixels per degree", number(self.flip), self.flip_pixels_per_degree)
    }

    fn largest(&self) -> String {
        let found = &self.comparison;
        let mut text = number(found.largest);
        if let (Some((x, y)), Some(channel)) = (found.largest_at, found.largest_channel) {
            let _ = write!(text, ", {} at column {x}, row {y}", channel.name());
        }
        text
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

fn line(text: &mut String, name: &str, value: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{name:<20}{value}");
}

/// Six digits, with an exponent for small numbers.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 {
        "0".into()
    } else if value.is_nan() {
        "unknown".into()
    } else if value.is_infinite() {
        if value > 0.0 { "infinite".into() } else { "-infinite".into() }
    } else if (1e-3..1e6).contains(&value.abs()) {
        format!("{value:.6}")
    } else {
        format!("{value:.5e}")
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

fn share(found: &Comparison, pixels: u64) -> String {
    let all = u64::from(found.width) * u64::from(found.height);
    format!("{pixels} of {all} ({:.3} %)", 100.0 * pixels as f64 / all as f64)
}
