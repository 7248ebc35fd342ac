//! Colours of OpenEXR files, found by the names of channels.
//!
//! Of the first part that has any: R, G and B, or grey Y, in capitals or small letters; or else those
//! of the only layer of colours, such as `diffuse.R`. Pixels outside the display window are dropped.

use std::collections::BTreeMap;

use exr::block::lines::LineRef;
use exr::block::reader::{ChunksReader as _, Reader};
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr::prelude::f16;
use image::error::{DecodingError, ImageFormatHint};
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageResult};

use super::{Content, Fault};

/// The first bytes of such a file.
pub(super) const MAGIC: &[u8] = b"\x76\x2f\x31\x01";

/// The decoder, with the header read.
pub(super) struct Exr<'a> {
    reader: Reader<Box<dyn Content + 'a>>,
    part: usize,
    colors: Colors,
}

/// The numbers of the channels of red, green and blue, and of alpha.
#[derive(Clone, Copy)]
struct Colors([usize; 3], Option<usize>);

impl<'a> Exr<'a> {
    /// Reads the header, and chooses channels.
    pub(super) fn new(content: Box<dyn Content + 'a>) -> ImageResult<Self> {
        let reader = exr::block::read(content, false).map_err(failed)?;
        let headers = reader.headers();
        let choice =
            |part: &Header| colors(part)?.map(|found| can_read(part).map(|()| found)).transpose();
        // One that can be read, even after others that cannot.
        let mut refused = None;
        for (part, header) in headers.iter().enumerate() {
            match choice(header) {
                Ok(Some(colors)) => return Ok(Self { part, colors, reader }),
                Ok(None) => {}
                Err(fault) => refused = refused.or(Some(fault)),
            }
        }
        Err(refused.unwrap_or_else(no_colors).into())
    }

    fn window(&self) -> IntegerBounds {
        self.reader.headers()[self.part].shared_attributes.display_window
    }
}

/// The colours of a part, if it has any.
fn colors(part: &Header) -> Result<Option<Colors>, Fault> {
    const KNOWN: [&str; 6] = ["R", "G", "B", "Y", "A", "X"];
    let names: Vec<String> = part.channels.list.iter().map(|one| one.name.to_string()).collect();
    let mut layers: BTreeMap<&str, [Option<usize>; KNOWN.len()]> = BTreeMap::new();
    for (i, name) in names.iter().enumerate() {
        let (layer, own) = name.rsplit_once('.').unwrap_or(("", name));
        // In layers small letters are also those of other things, such as numbers of objects.
        let is_known =
            |known: &&str| *known == own || layer.is_empty() && known.eq_ignore_ascii_case(own);
        if let Some(place) = KNOWN.iter().position(is_known) {
            layers.entry(layer).or_default()[place].get_or_insert(i);
        }
    }
    let of_layer = |(name, [r, g, b, y, alpha, x]): (_, [_; KNOWN.len()])| match (r, g, b, y, x) {
        (Some(r), Some(g), Some(b), ..) => Some((name, Colors([r, g, b], alpha))),
        // Beside an X it is a coordinate.
        (.., Some(y), None) => Some((name, Colors([y; 3], alpha))),
        _ => None,
    };
    let found: Vec<(&str, Colors)> = layers.into_iter().filter_map(of_layer).collect();
    match found[..] {
        [] => Ok(None),
        [(_, colors)] | [("", colors), ..] => Ok(Some(colors)),
        [(first, _), (second, _), ..] => Err(Fault {
            message: format!("it has several layers of colours, such as {first} and {second}"),
            remedy: "save the one that you want as R, G and B".to_owned(),
        }),
    }
}

fn no_colors() -> Fault {
    Fault {
        message: "it has no channels of colour".to_owned(),
        remedy: "save it with the channels R, G and B, or Y".to_owned(),
    }
}

/// Checks that a part is stored in a way that can be read.
fn can_read(part: &Header) -> Result<(), Fault> {
    use Compression::{DWAA, DWAB, HTJ2K32, HTJ2K256};
    let whole = |one: &ChannelDescription| one.sampling == Vec2(1, 1);
    // What is decoded at a time is allocated whole.
    let block = part.max_block_byte_size() as u64;
    if part.layer_size.0.max(part.layer_size.1) > super::MAX_SIDE as usize
        || block > super::MAX_BYTES
    {
        let Vec2(width, height) = part.layer_size;
        return Err(Fault {
            message: format!(
                "its data window has {width} x {height} pixels, in blocks of {block} bytes"
            ),
            remedy: "check that the file is whole, or use a smaller image".to_owned(),
        });
    }
    let what = match part.compression {
        _ if part.deep => "deep data".to_owned(),
        DWAA(_) | DWAB(_) | HTJ2K32 | HTJ2K256 => part.compression.to_string(),
        _ if !part.channels.list.iter().all(whole) => {
            "channels with fewer samples than pixels".to_owned()
        }
        _ => return Ok(()),
    };
    Err(Fault {
        message: format!("{what} cannot be read"),
        remedy: "save it with a value for each pixel: oiiotool IN --compression zip -o OUT"
            .to_owned(),
    })
}

fn failed(error: exr::error::Error) -> ImageError {
    let format = ImageFormatHint::Exact(ImageFormat::OpenExr);
    ImageError::Decoding(DecodingError::new(format, error))
}

impl ImageDecoder for Exr<'_> {
    fn dimensions(&self) -> (u32, u32) {
        // The format stores both as numbers of 32 bits.
        let Vec2(width, height) = self.window().size;
        (width as u32, height as u32)
    }

    fn color_type(&self) -> ColorType {
        if self.colors.1.is_some() { ColorType::Rgba32F } else { ColorType::Rgb32F }
    }

    fn read_image(self, pixels: &mut [u8]) -> ImageResult<()> {
        pixels.fill(0);
        let (window, part) = (self.window(), self.part);
        let Colors([r, g, b], alpha) = self.colors;
        let header = self.reader.headers()[part].clone();
        let corner = header.own_attributes.layer_position;
        let chunks = self.reader.filter_chunks(false, |_, tile, block| {
            block.layer == part && tile.is_largest_resolution_level()
        });
        let targets = [Some(r), Some(g), Some(b), alpha];
        let channels = if alpha.is_some() { 4 } else { 3 };
        let row = window.size.width() * channels;
        // Where a pixel of the part is in the window.
        let within = |at: usize, corner: i32, window: i32, size: usize| {
            let place = at as i64 + i64::from(corner) - i64::from(window);
            usize::try_from(place).ok().filter(|&place| place < size)
        };
        for block in chunks.map_err(failed)?.sequential_decompressor(false) {
            let block = block.map_err(failed)?;
            for line in block.lines(&header.channels) {
                let Vec2(left, y) = line.location.position;
                let height = window.size.height();
                let Some(y) = within(y, corner.y(), window.position.y(), height) else { continue };
                let row = &mut pixels[y * row * 4..][..row * 4];
                let wanted = |&place: &usize| targets[place] == Some(line.location.channel);
                for place in (0..channels).filter(wanted) {
                    for (x, value) in (left..).zip(samples(&header, &line)) {
                        let x = within(x, corner.x(), window.position.x(), window.size.width());
                        let Some(x) = x else { continue };
                        row[(x * channels + place) * 4..][..4]
                            .copy_from_slice(&value.to_ne_bytes());
                    }
                }
            }
        }
        Ok(())
    }

    fn read_image_boxed(self: Box<Self>, pixels: &mut [u8]) -> ImageResult<()> {
        (*self).read_image(pixels)
    }
}

/// The values of a line of a channel.
fn samples<'l>(header: &Header, line: &LineRef<'l>) -> impl Iterator<Item = f32> + 'l {
    let kind = header.channels.list[line.location.channel].sample_type;
    let sample: fn(&[u8]) -> f32 = match kind {
        SampleType::F16 => |b| f16::from_ne_bytes([b[0], b[1]]).to_f32(),
        SampleType::F32 => |b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]),
        SampleType::U32 => |b| u32::from_ne_bytes([b[0], b[1], b[2], b[3]]) as f32,
    };
    line.value.chunks_exact(kind.bytes_per_sample()).map(sample)
}
