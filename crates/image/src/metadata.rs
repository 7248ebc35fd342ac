//! What an image file says of how it was made, and pictures that go with the colours.
//!
//! A PNG has its words as text chunks, an EXR as attributes, and a PPM, where that is asked for, as comments in
//! its header. A PFM has no place for any. The same render gives the same words: nothing of the machine, the
//! folder or the hour is among them.

/// A name, and what is said under it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// In lower case, one word, such as `seed`.
    pub name: &'static str,
    /// One line of text.
    pub text: String,
}

/// The name of the channel that says how much of a pixel is covered: colours are multiplied by it. A PNG has it too.
pub const ALPHA: &str = "A";

/// What is written besides the colours of a film.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extras<'a> {
    /// How the image was made: an attribute of an EXR or a text of a PNG each.
    pub entries: &'a [Entry],
    /// Whether a PPM has the entries too. Readers that take its header for three lines then fail.
    pub comments: bool,
    /// More channels of an EXR; a PNG has room for [`ALPHA`] alone.
    pub channels: &'a [Channel],
}

/// How a render came about: all that the image follows from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    /// The version of the program.
    pub version: String,
    /// A hash of the scene, of [`PreparedScene::fingerprint`](wavecrest_core::prepared::PreparedScene::fingerprint).
    pub scene: u128,
    /// What chose the random numbers.
    pub seed: u64,
    /// Number of samples of each pixel.
    pub samples: u32,
    /// How exactly hits were found.
    pub precision: String,
    /// The part of the image, as x, y, width and height in pixels, where it is not all of it.
    pub crop: Option<[u32; 4]>,
    /// The command, where it is requested: it differs between ways to the same image.
    pub command: Option<String>,
}

impl Provenance {
    /// As entries, the program first.
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

/// The name that an entry has among those of other programs.
pub(super) fn full_name(name: &str) -> String {
    format!("wavecrest.{name}")
}

/// A number for each pixel, the top row first, under a name of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The layer and the channel within it, such as `depth.Z`.
    pub name: String,
    /// As many as the film has pixels.
    pub values: Values,
}

/// The numbers of a channel.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Quantities.
    Floats(Vec<f32>),
    /// Counts, or numbers that stand for something.
    Integers(Vec<u32>),
}

impl Values {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Floats(values) => values.len(),
            Self::Integers(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
