//! Options on the development of light to levels.

use crate::choice::choice;
use crate::common::number;
use wavecrest_image::write::{Develop, Tone};

/// The largest exposure in stops, in both directions.
const STOPS: f32 = 64.0;

/// How light is developed for 8-bit images.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct DevelopOptions {
    /// Exposure of 8-bit images in stops; each doubles the light
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, value_parser = stops, allow_hyphen_values = true)]
    pub(crate) exposure: f32,
    /// Tone mapping of 8-bit images
    #[arg(long, value_name = "CURVE", value_parser = choice::<Tone>(), default_value_t)]
    pub(crate) tone: Tone,
}

impl From<DevelopOptions> for Develop {
    fn from(DevelopOptions { exposure, tone }: DevelopOptions) -> Self {
        Self { exposure, tone }
    }
}

fn stops(text: &str) -> Result<f32, String> {
    let wrong = format!("use a number from -{STOPS} to {STOPS}");
    number(text, |stops: &f32| stops.abs() <= STOPS, &wrong)
}
