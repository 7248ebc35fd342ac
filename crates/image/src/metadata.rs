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
