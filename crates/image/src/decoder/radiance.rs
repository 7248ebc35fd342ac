//! Radiance HDR files, as any program writes their headers.
//!
//! The crate `image` decodes the pixels, after a header of one form. `EXPOSURE` and `COLORCORR` say by
//! what the pixels were multiplied: they are divided by it, as Radiance does.

use std::io::{BufRead, Chain, Cursor, Read as _};
use std::ops::RangeInclusive;

use image::codecs::hdr::HdrDecoder;
use image::{ColorType, ImageDecoder, ImageResult};

use super::{Content, Fault, MAX_METADATA};

/// The first bytes of such a file; the name of a program follows.
pub(super) const MAGIC: &[u8] = b"#?";

/// The factors that pixels may be divided by: with their inverses, normal numbers of single precision.
const FACTORS: RangeInclusive<f64> = 1.0 / (f32::MAX as f64)..=1.0 / (f32::MIN_POSITIVE as f64);

/// The decoder, with the header read.
pub(super) struct Radiance<'a> {
    pixels: HdrDecoder<Chain<Cursor<String>, Box<dyn Content + 'a>>>,
    /// What red, green and blue are multiplied by.
    scale: [f32; 3],
}

impl<'a> Radiance<'a> {
    /// Reads the header.
    pub(super) fn new(mut content: Box<dyn Content + 'a>) -> ImageResult<Self> {
        let mut lines = content.by_ref().take(MAX_METADATA);
        let mut made_with = [1.0; 3];
        loop {
            let line = line(&mut lines)?;
            match line.split_once('=') {
                _ if line.is_empty() => break,
                Some(("FORMAT", format)) => check_format(format.trim())?,
                Some((key @ ("EXPOSURE" | "COLORCORR"), text)) => {
                    let factors = factors(key, text)?;
                    made_with = [0, 1, 2].map(|i| made_with[i] * factors[i]);
                }
                _ => {}
            }
        }
        if !made_with.iter().all(|factor| FACTORS.contains(factor)) {
            let message = format!("EXPOSURE and COLORCORR of its header multiply to {made_with:?}");
            return Err(Fault { message, remedy: "save it again without them".into() }.into());
        }
        let size = line(&mut lines)?;
        if !size.split_whitespace().step_by(2).eq(["-Y", "+X"]) {
            let message = format!("its rows are in the unusual order {:?}", beginning(&size));
            return Err(Fault { message, remedy: "save it with the top row first".into() }.into());
        }
        let head = Cursor::new(format!("#?RADIANCE\n\n{size}\n"));
        let pixels = HdrDecoder::new(head.chain(content))?;
        Ok(Self { pixels, scale: made_with.map(|factor: f64| (1.0 / factor) as f32) })
    }
}

/// A line of the header without its end.
fn line(lines: &mut impl BufRead) -> ImageResult<String> {
    let mut bytes = Vec::new();
    lines.read_until(b'\n', &mut bytes)?;
    if bytes.pop() != Some(b'\n') {
        let remedy = "check that the file is whole".to_owned();
        return Err(Fault { message: "its header has no end".to_owned(), remedy }.into());
    }
    Ok(String::from_utf8_lossy(bytes.trim_ascii_end()).into_owned())
}

/// What an error has room for.
fn beginning(text: &str) -> &str {
    const MOST: usize = 80;
    text.char_indices().nth(MOST).map_or(text, |(end, _)| &text[..end])
}

fn check_format(format: &str) -> Result<(), Fault> {
    let message = format!("its format {:?} is unknown", beginning(format));
    match format {
        "32-bit_rle_rgbe" => Ok(()),
        "32-bit_rle_xyze" => Err(Fault { message, remedy: "use: ra_xyze -r IN OUT".to_owned() }),
        _ => Err(Fault { message, remedy: "save it as 32-bit_rle_rgbe".to_owned() }),
    }
}

/// The factors of a line: one, or one for each of three colours.
fn factors(key: &str, text: &str) -> Result<[f64; 3], Fault> {
    let is_good = |factor: &f64| *factor > 0.0;
    let parsed = text.split_whitespace().map(|word| word.parse().ok().filter(is_good));
    match (key, parsed.collect::<Option<Vec<f64>>>().as_deref()) {
        ("EXPOSURE", Some(&[all])) => Ok([all; 3]),
        ("COLORCORR", Some(&[r, g, b])) => Ok([r, g, b]),
        _ => Err(Fault {
            message: format!("{key} of its header is {:?}", beginning(text.trim())),
            remedy: "EXPOSURE is one number above 0, COLORCORR three".to_owned(),
        }),
    }
}

impl ImageDecoder for Radiance<'_> {
    fn dimensions(&self) -> (u32, u32) {
        self.pixels.dimensions()
    }

    fn color_type(&self) -> ColorType {
        self.pixels.color_type()
    }

    fn read_image(self, pixels: &mut [u8]) -> ImageResult<()> {
        self.pixels.read_image(pixels)?;
        if self.scale != [1.0; 3] {
            let values = pixels.as_chunks_mut().0.iter_mut();
            for (value, scale) in values.zip(self.scale.iter().cycle()) {
                *value = (f32::from_ne_bytes(*value) * scale).to_ne_bytes();
            }
        }
        Ok(())
    }

    fn read_image_boxed(self: Box<Self>, pixels: &mut [u8]) -> ImageResult<()> {
        (*self).read_image(pixels)
    }
}
