//! The memory of a render's images: while it is traced, and while its files are written.

use super::args::RenderArgs;
use super::sides::{Rows, animated};
use wavecrest_image::animation;
use wavecrest_image::write::{Format, bytes_to_write};
use wavecrest_image::{aov, look};
use wavecrest_scene::load::framing::Sheet;
use wavecrest_scene::memory::{Images, film_bytes};

impl RenderArgs {
    /// Upper bound on the memory of the images, if the whole image has this width and height in pixels.
    pub(super) fn images(&self, size: [u32; 2]) -> Images {
        let input = &self.scene_options.input;
        let image = self.crop.map_or(size, |crop| [crop.width, crop.height]);
        let pixels = area(image);
        let film = film_bytes(pixels) + self.beside(pixels, area(size));
        let animated = self.output().ok().and_then(|path| animated(path));
        match (&input.sheet, input.turntable, animated) {
            _ if self.frame.is_some() => Images { film, writing: self.writing(pixels) },
            (Some(Sheet(sides)), ..) => {
                let sheet = area(Rows::new(sides.len()).size(image));
                // The last image is kept while the next is traced.
                let film = film + film_bytes(pixels) + film_bytes(sheet);
                Images { film, writing: self.writing(sheet) }
            }
            (None, Some(_), Some(format)) => {
                Images { film, writing: animation::bytes_to_write(format, pixels) }
            }
            _ => Images { film, writing: self.writing(pixels) },
        }
    }

    /// What tracing keeps beside the image: sums for a checkpoint or a shard, the image so far, the pixels of a look.
    fn beside(&self, pixels: u64, whole: u64) -> u64 {
        let so_far = match self.save_every {
            // Tiles are added to one while another is written.
            Some(_) => 2 * film_bytes(pixels) + self.file_bytes(pixels, 0),
            None => 0,
        };
        let look = self.look.map_or(0, |kind| look::bytes(kind, pixels, whole));
        let keeps = self.checkpoint.is_some() || self.shard.is_some();
        let sums = if keeps { pixels * size_of::<[f64; 3]>() as u64 } else { 0 };
        sums + so_far + look
    }

    /// What writing the files takes, beside an image of this number of pixels.
    fn writing(&self, pixels: u64) -> u64 {
        let values = aov::values_per_pixel(&self.layers());
        pixels * values * size_of::<f32>() as u64 + self.file_bytes(pixels, values)
    }

    /// What the largest file takes while it is written, with this number of further values in each pixel.
    fn file_bytes(&self, pixels: u64, values: u64) -> u64 {
        let paths = self.output().into_iter().chain(&self.also);
        let formats = paths.filter_map(|path| Format::from_path(path).ok());
        let bytes = |format: Format| {
            let developed =
                if format.is_developed(self.develop.into()) { film_bytes(pixels) } else { 0 };
            developed + bytes_to_write(format, pixels, values)
        };
        formats.map(bytes).max().unwrap_or(0)
    }
}

/// The number of pixels of this width and height.
fn area([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height)
}
