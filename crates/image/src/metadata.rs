//! The metadata of image files: how the image was made, and further channels.
//!
//! A PNG stores the entries as text chunks, an EXR as attributes, and a PPM, on request, as
//! comments in its header. A PFM cannot store any. The same render gives the same entries: they
//! contain nothing of the machine, the folder or the time.

use super::transfer::Develop;

/// A name and its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// One lower-case word, such as `seed`.
    pub name: &'static str,
    /// One line of text.
    pub text: String,
}

/// The name of the channel with the coverage of a pixel: colours are premultiplied by it. A PNG
/// stores it too.
pub const ALPHA: &str = "A";

/// The data written with the colours of a film.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extras<'a> {
    /// How the image was made: an attribute of an EXR or a text of a PNG each.
    pub entries: &'a [Entry],
    /// Whether a PPM has the entries too. Readers that expect three header lines then fail.
    pub comments: bool,
    /// More channels of an EXR; a PNG stores only [`ALPHA`].
    pub channels: &'a [Channel],
    /// How light becomes the levels of 8-bit formats.
    pub develop: Develop,
}

/// The origin of a render: all inputs of the image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    /// The version of the program.
    pub version: String,
    /// A hash of the scene, of [`PreparedScene::fingerprint`](wavecrest_core::prepared::PreparedScene::fingerprint).
    pub scene: u128,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of samples of each pixel.
    pub samples: u32,
    /// Precision of hits.
    pub precision: String,
    /// The part of the image, as x, y, width and height in pixels; `None` for all of it.
    pub crop: Option<[u32; 4]>,
    /// The command, on request: different commands may give the same image.
    pub command: Option<String>,
}

impl Provenance {
    /// The entries, the program first.
    pub fn entries(&self) -> Vec<Entry> {
        let entry = |name, text| Some(Entry { name, text });
        let crop = self.crop.map(|crop| crop.map(|side| side.to_string()).join(","));
        let entries = [
            entry("software", format!("wavecrest {}", self.version)),
            entry("scene", format!("{:032x}", self.scene)),
            entry("seed", self.seed.to_string()),
            entry("samples", self.samples.to_string()),
            entry("precision", self.precision.clone()),
            crop.and_then(|crop| entry("crop", crop)),
            self.command.clone().and_then(|command| entry("command", command)),
        ];
        entries.into_iter().flatten().collect()
    }
}

/// The unambiguous name of an entry among those of other programs.
pub(super) fn full_name(name: &str) -> String {
    format!("wavecrest.{name}")
}

/// A named number for each pixel, the top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The layer and the channel within it, such as `depth.Z`.
    pub name: String,
    /// One value for each pixel of the film.
    pub values: Values,
}

/// The numbers of a channel.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Quantities.
    Floats(Vec<f32>),
    /// Counts or identifiers.
    Integers(Vec<u32>),
}

impl Values {
    /// The number of values.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Floats(values) => values.len(),
            Self::Integers(values) => values.len(),
        }
    }
}
