//! Limits on the difference of images that count as equal.

use std::str::FromStr;

use serde::Serialize;

use super::not_negative;
use super::report::number;
use wavecrest_image::compare::Comparison;

/// Options on what may differ. Every limit that is given must hold; where none is, no value may differ.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Limits {
    /// Largest accepted difference of two values [default: 0]; --max-pixels exempts some pixels
    #[arg(long, value_name = "MAX", value_parser = not_negative)]
    pub(crate) tolerance: Option<f64>,
    /// Largest accepted RMSE
    #[arg(long, value_name = "MAX", value_parser = not_negative)]
    pub(crate) max_rmse: Option<f64>,
    /// Largest accepted FLIP, 0 to 1
    #[arg(long, value_name = "MAX", value_parser = not_negative)]
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

/// A limit, and whether it holds.
#[derive(Serialize)]
pub(super) struct Verdict {
    /// The limited quantity.
    of: &'static str,
    found: f64,
    /// The largest allowed value.
    limit: f64,
    pub(super) within: bool,
}

impl Verdict {
    fn new(of: &'static str, found: f64, limit: f64) -> Self {
        // NaN is not within a limit.
        Self { of, found, limit, within: found <= limit }
    }

    /// Such as "RMSE 0.2 is above 0.1".
    pub(super) fn words(&self) -> String {
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
    pub(super) fn tolerance(&self) -> f64 {
        self.tolerance.unwrap_or_default()
    }

    /// The verdicts on a comparison: `flip` is the mean FLIP, and `beyond` the number of pixels
    /// beyond the tolerance.
    pub(super) fn verdicts(&self, found: &Comparison, flip: f64, beyond: u64) -> Vec<Verdict> {
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
        let limits = [
            ("largest difference", found.largest, largest),
            ("RMSE", found.rmse, self.max_rmse),
            ("FLIP", flip, self.max_flip),
            ("the number of different pixels", beyond as f64, most),
        ];
        limits
            .into_iter()
            .filter_map(|(of, value, most)| Some(Verdict::new(of, value, most?)))
            .collect()
    }
}
