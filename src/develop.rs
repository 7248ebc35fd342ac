//! Options on the development of light to levels.

use crate::choice::choice;
use wavecrest_core::film::Film;
use wavecrest_image::metadata::{ALPHA, Extras, Values};
use wavecrest_image::write::{Develop, Format, Tone};

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

impl DevelopOptions {
    /// The developed film for a format; `None` if nothing changes.
    pub(crate) fn developed(
        &self,
        film: &Film,
        format: Format,
        extras: &Extras<'_>,
    ) -> Option<Film> {
        if !self.changes(format) {
            return None;
        }
        let alpha = extras.channels.iter().find(|channel| channel.name == ALPHA);
        let alpha = alpha.and_then(|channel| match &channel.values {
            Values::Floats(values) => Some(values.as_slice()),
            Values::Integers(_) => None,
        });
        Some(self.develop().film(film, alpha))
    }

    /// Whether an image of this format is developed.
    pub(crate) fn changes(&self, format: Format) -> bool {
        !self.develop().is_plain() && !format.is_float()
    }

    fn develop(&self) -> Develop {
        Develop { exposure: self.exposure, tone: self.tone }
    }
}

fn stops(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|stops: &f32| stops.abs() <= STOPS);
    number.ok_or_else(|| format!("use a number from -{STOPS} to {STOPS}"))
}
