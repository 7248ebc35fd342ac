//! OpenEXR: colours, further channels and attributes, as 32-bit values in one part.
//!
//! The crate `exr` writes it. It stores custom attributes in a table without order, so they are
//! sorted by name afterwards: the bytes of a file depend only on its content. Values are taken from
//! the film and its channels line by line, without a copy.

use std::io::Cursor;

use exr::block::lines::LineRefMut;
use exr::image::write::samples::{SamplesWriter, WritableSamples};
use exr::math::RoundingMode;
use exr::meta::attribute::LevelMode;
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, Image, Layer, LayerAttributes, SampleType,
    SmallVec, Text, WritableImage as _,
};
use image::error::{EncodingError, ImageFormatHint};
use image::{ImageError, ImageFormat};

use super::metadata::{Entry, Extras, Values, full_name};
use wavecrest_base::progress;
use wavecrest_core::film::Film;

/// The entry with a standard name in the format.
const SOFTWARE: &str = "software";

/// `film` and its extras, as the bytes of a file.
pub(super) fn encode(film: &Film, extras: &Extras<'_>) -> Result<Vec<u8>, ImageError> {
    let size = (film.width() as usize, film.height() as usize);
    let color = |(name, i)| AnyChannel::new(name, ChannelValues::Color(film, i));
    let colors = [("R", 0), ("G", 1), ("B", 2)].map(color);
    let mut channels: SmallVec<[AnyChannel<ChannelValues<'_>>; 4]> = colors.into_iter().collect();
    for channel in extras.channels {
        if channel.values.len() != film.pixels().len() {
            return Err(failed(format!("{} has another size", channel.name)));
        }
        let samples = ChannelValues::Channel(&channel.values, size.0);
        let own = AnyChannel::new(text(&channel.name), samples);
        channels.push(AnyChannel { quantize_linearly: false, ..own });
    }
    let attributes = attributes(extras.entries);
    let layer = Layer::new(size, attributes, Encoding::default(), AnyChannels::sort(channels));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).map_err(failed)?;
    let mut bytes = bytes.into_inner();
    if !extras.entries.is_empty() {
        sort_attributes(&mut bytes).ok_or_else(|| failed("its header is unusual"))?;
    }
    Ok(bytes)
}

fn failed(cause: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> ImageError {
    ImageError::Encoding(EncodingError::new(ImageFormatHint::Exact(ImageFormat::OpenExr), cause))
}

#[derive(Clone, Copy)]
enum ChannelValues<'a> {
    /// One of the three colours of each pixel.
    Color(&'a Film, usize),
    /// Further values, in an image of this width.
    Channel(&'a Values, usize),
}

impl<'a> WritableSamples<'_> for ChannelValues<'a> {
    fn sample_type(&self) -> SampleType {
        match self {
            Self::Color(..) | Self::Channel(Values::Floats(_), _) => SampleType::F32,
            Self::Channel(Values::Integers(_), _) => SampleType::U32,
        }
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    type Writer = ChannelValues<'a>;

    fn create_samples_writer(&self, _: &Header) -> Self {
        *self
    }
}

impl SamplesWriter for ChannelValues<'_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        let at = line.location.position;
        let width = match *self {
            Self::Color(film, _) => film.width() as usize,
            Self::Channel(_, width) => width,
        };
        let start = at.y() * width + at.x();
        let range = start..start + line.location.sample_count;
        if matches!(self, Self::Color(_, 0)) {
            progress::add(range.len() as u64);
        }
        let written = match *self {
            Self::Color(film, i) => line.write_samples(|n| film.pixels()[start + n][i]),
            Self::Channel(Values::Floats(all), _) => line.write_samples_from_slice(&all[range]),
            Self::Channel(Values::Integers(all), _) => line.write_samples_from_slice(&all[range]),
        };
        debug_assert!(written.is_ok(), "a line has room for its samples");
    }
}

/// Text of the format, which is bytes: UTF-8.
fn text(utf8: &str) -> Text {
    let bytes: String = utf8.bytes().map(char::from).collect();
    // Each is a one-byte letter, so the text is always valid.
    Text::new_or_none(bytes).unwrap_or_default()
}

fn attributes(entries: &[Entry]) -> LayerAttributes {
    let mut attributes = LayerAttributes::default();
    for Entry { name, text: words } in entries {
        if *name == SOFTWARE {
            attributes.software_name = Some(text(words));
        } else {
            attributes.other.insert(text(&full_name(name)), AttributeValue::Text(text(words)));
        }
    }
    attributes
}

/// Length in bytes of the magic number and version before the first attribute.
const PREAMBLE: usize = 8;

/// Sorts the attributes of the header by name. `None` if there is no valid header.
fn sort_attributes(bytes: &mut [u8]) -> Option<()> {
    let mut all = Vec::new();
    let mut at = PREAMBLE;
    while *bytes.get(at)? != 0 {
        let end = end_of_attribute(bytes, at)?;
        all.push(bytes.get(at..end)?.to_vec());
        at = end;
    }
    // An attribute begins with its name.
    all.sort();
    bytes.get_mut(PREAMBLE..at)?.copy_from_slice(&all.concat());
    Some(())
}

/// The end of the attribute at `at`: after its name, type, length and value.
fn end_of_attribute(bytes: &[u8], at: usize) -> Option<usize> {
    let after_word = |at: usize| {
        let length = bytes.get(at..)?.iter().position(|&byte| byte == 0)?;
        Some(at + length + 1)
    };
    let length_at = after_word(after_word(at)?)?;
    let length = bytes.get(length_at..)?.first_chunk::<4>()?;
    let value_at = length_at + length.len();
    value_at.checked_add(u32::from_le_bytes(*length) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The start of a file: its preamble, an attribute, and the name of another.
    const START: [u8; 40] =
        *b"\x76\x2f\x31\x01\x02\x02\0\0chunkCount\0int\0\x04\0\0\0\x04\0\0\0channels\0";

    #[test]
    fn a_header_that_is_cut_short_is_no_header() {
        let mut whole = START;
        for length in 0..whole.len() {
            assert_eq!(sort_attributes(&mut whole[..length]), None);
        }
    }
}
