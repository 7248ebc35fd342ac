//! Options of image files: their metadata, and the development of light to levels.

use std::path::Path;

use clap::ValueEnum;

use super::common::{IMAGE, choice, command_words, number};
use wavecrest_base::words;
use wavecrest_image::farm::Identity;
use wavecrest_image::metadata::{Entry, Extras};
use wavecrest_image::write::{Develop, Format, Tone};

/// What files say of how their image was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Metadata {
    /// Program, scene, seed, samples and precision, in .exr and .png; independent of tracer and machine
    #[default]
    Auto,
    /// The same and the command line, also in .ppm as comments, which not every reader accepts
    Full,
    /// Nothing
    None,
}

impl Metadata {
    /// Whether an image in this file gets metadata.
    pub(super) fn is_stored_in(self, file: &Path) -> bool {
        match (self, Format::from_path(file)) {
            (Self::None, _) | (_, Ok(Format::Pfm | Format::Jpg)) => false,
            (_, Ok(Format::Ppm)) => self == Self::Full,
            // Animations too.
            (_, Ok(Format::Png | Format::Exr) | Err(_)) => true,
        }
    }

    /// The metadata of an image with this identity, as far as requested.
    pub(super) fn entries(self, identity: &Identity) -> Vec<Entry> {
        if self == Self::None {
            return Vec::new();
        }
        let command = (self == Self::Full).then(|| words::command(command_words()));
        identity.entries(command)
    }

    /// What is written with an image that is developed so, with these entries.
    pub(super) fn extras(self, entries: &[Entry], develop: DevelopOptions) -> Extras<'_> {
        let (comments, develop) = (self == Self::Full, develop.into());
        Extras { entries, comments, develop, ..Extras::default() }
    }
}

/// How light is developed for 8-bit images.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct DevelopOptions {
    /// Exposure of 8-bit images in stops; each doubles the light
    #[arg(long, help_heading = IMAGE, value_name = "STOPS", default_value_t = 0.0, value_parser = stops, allow_hyphen_values = true)]
    pub(crate) exposure: f32,
    /// Tone mapping of 8-bit images
    #[arg(long, help_heading = IMAGE, value_name = "CURVE", value_parser = choice::<Tone>(), default_value_t)]
    pub(crate) tone: Tone,
}

impl From<DevelopOptions> for Develop {
    fn from(DevelopOptions { exposure, tone }: DevelopOptions) -> Self {
        Self { exposure, tone }
    }
}

fn stops(text: &str) -> std::result::Result<f32, String> {
    let most = Develop::MOST_STOPS;
    let wrong = format!("use a number from -{most} to {most}");
    number(text, |stops: &f32| stops.abs() <= most, &wrong)
}
