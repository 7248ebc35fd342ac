//! Animations: animated PNG and GIF.
//!
//! Frames are written one by one, so that only one is in memory.

use std::path::Path;
use std::time::Duration;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, ImageError, RgbaImage};

use super::metadata::Entry;
use super::transfer::levels;
use super::write::{Transfer, encode_error, png_encoder, png_error};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{Sink, replace_file};
use wavecrest_core::film::Film;

/// Duration of a frame in milliseconds: GIF counts hundredths of a second.
const MILLISECONDS: u16 = 80;

/// Effort of the search for a GIF's colours, from 1, the slowest, to 30.
const GIF_SPEED: i32 = 10;

/// An animation format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Animated {
    /// Animated PNG: all colours; programs without support for animation show the first frame.
    Png,
    /// GIF: 256 colours a frame.
    Gif,
}

impl Animated {
    /// The animation format for the extension of `path`, if any.
    pub fn from_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_ascii_lowercase();
        match extension.to_str()? {
            "png" => Some(Self::Png),
            "gif" => Some(Self::Gif),
            _ => None,
        }
    }
}

/// The description of an animation to write.
#[derive(Clone, Copy, Debug)]
pub struct Animation<'a> {
    /// The file.
    pub path: &'a Path,
    /// Its format.
    pub format: Animated,
    /// Width and height of each frame in pixels.
    pub size: [u32; 2],
    /// Number of frames.
    pub frames: u32,
    /// The transfer curve.
    pub transfer: Transfer,
    /// Metadata, in formats that support it.
    pub entries: &'a [Entry],
}

impl Animation<'_> {
    /// Writes the frames that `next` returns for their numbers, from 0. An existing file stays
    /// unchanged until the new one is complete.
    ///
    /// # Errors
    /// If `next` fails, or the file cannot be written.
    pub fn write(&self, mut next: impl FnMut(u32) -> Result<Film>) -> Result<()> {
        let mut next = |frame| next(frame).and_then(|film| self.levels(&film));
        replace_file(self.path, |sink| match self.format {
            Animated::Png => self.png(sink, &mut next),
            Animated::Gif => self.gif(sink, &mut next),
        })
    }

    /// The levels of a frame.
    fn levels(&self, film: &Film) -> Result<Vec<u8>> {
        if [film.width(), film.height()] == self.size {
            return Ok(levels(film, self.transfer));
        }
        let error = Error::new(ErrorKind::Usage, "every frame must have the same size");
        Err(error.remedy("render all frames at one size"))
    }

    fn png(&self, sink: &mut Sink<'_>, next: &mut dyn FnMut(u32) -> Result<Vec<u8>>) -> Result<()> {
        let failed = |error| encode_error(self.path, png_error(error));
        let color = png::ColorType::Rgb;
        let mut encoder = png_encoder(sink, self.size, color, self.entries).map_err(failed)?;
        encoder.set_animated(self.frames, 0).map_err(failed)?;
        encoder.set_frame_delay(MILLISECONDS, 1000).map_err(failed)?;
        let mut writer = encoder.write_header().map_err(failed)?;
        for frame in 0..self.frames {
            writer.write_image_data(&next(frame)?).map_err(failed)?;
        }
        writer.finish().map_err(failed)
    }

    fn gif(&self, sink: &mut Sink<'_>, next: &mut dyn FnMut(u32) -> Result<Vec<u8>>) -> Result<()> {
        let failed = |error: ImageError| encode_error(self.path, error);
        let delay = Delay::from_saturating_duration(Duration::from_millis(MILLISECONDS.into()));
        let [width, height] = self.size;
        let mut encoder = GifEncoder::new_with_speed(sink, GIF_SPEED);
        encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
        for frame in 0..self.frames {
            let levels = next(frame)?;
            let image = RgbaImage::from_fn(width, height, |x, y| {
                let at = 3 * (y as usize * width as usize + x as usize);
                image::Rgba([levels[at], levels[at + 1], levels[at + 2], u8::MAX])
            });
            encoder.encode_frame(Frame::from_parts(image, 0, 0, delay)).map_err(failed)?;
        }
        Ok(())
    }
}
