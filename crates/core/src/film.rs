//! The film: the pixels of one image, in linear colour.

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::memory;

/// Largest number of pixels of a film: 2^28, which is 16384 x 16384 and takes 3 GiB.
pub const MAX_PIXELS: u64 = 1 << 28;

/// An image in linear colour: red, green and blue for each pixel, in rows from top to bottom and
/// from left to right. Values below 0, above 1 and not finite are kept.
#[derive(Clone, Debug)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
}

impl Film {
    /// A black film.
    ///
    /// # Errors
    /// If a side is 0, if there are more than [`MAX_PIXELS`] pixels, or if memory does not suffice.
    pub fn new(width: u32, height: u32) -> Result<Self> {
        let count = checked_pixel_count(width, height)?;
        let mut pixels = reserve(count)?;
        pixels.resize(count, [0.0; 3]);
        Ok(Self { width, height, pixels })
    }

    /// The film with these pixels, the top row first.
    ///
    /// # Errors
    /// If a side is 0, if there are more than [`MAX_PIXELS`] pixels, or if `pixels` does not hold
    /// `width * height` of them.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Result<Self> {
        let count = checked_pixel_count(width, height)?;
        if pixels.len() != count {
            let message = format!("an image of {width} x {height} pixels needs {count} pixels");
            return Err(Error::new(ErrorKind::Limit, message).value(pixels.len()));
        }
        Ok(Self { width, height, pixels })
    }

    /// The number of pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Every pixel, the top row first.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// Every pixel, the top row first, mutable.
    pub fn pixels_mut(&mut self) -> &mut [[f32; 3]] {
        &mut self.pixels
    }

    /// Returns the pixels, the top row first.
    pub fn into_pixels(self) -> Vec<[f32; 3]> {
        self.pixels
    }

    /// The pixel in column `x` from the left and row `y` from the top; `None` outside the film.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[f32; 3]> {
        let index = y as usize * self.width as usize + x as usize;
        (x < self.width && y < self.height).then(|| self.pixels[index])
    }

    /// The rows, the top one first.
    pub fn rows(&self) -> std::slice::ChunksExact<'_, [f32; 3]> {
        self.pixels.chunks_exact(self.width as usize)
    }

    /// Replaces the part whose top left pixel is in column `x` and row `y` by these `pixels`, in rows of
    /// this `width`.
    ///
    /// # Panics
    /// If a row leaves the image.
    pub fn paste(&mut self, [x, y]: [u32; 2], width: u32, pixels: &[[f32; 3]]) {
        let columns = x as usize..(x + width) as usize;
        let rows = self.pixels.chunks_exact_mut(self.width as usize).skip(y as usize);
        for (row, own) in rows.zip(pixels.chunks_exact(width as usize)) {
            row[columns.clone()].copy_from_slice(own);
        }
    }

    /// The part `[x, y, width, height]`, in pixels from the top left, cropped to the image.
    ///
    /// # Errors
    /// If the part is entirely outside the image.
    pub fn part(&self, [x, y, width, height]: [u32; 4]) -> Result<Self> {
        let end = |start: u32, length: u32, all: u32| start.saturating_add(length).min(all);
        let (x_end, y_end) = (end(x, width, self.width), end(y, height, self.height));
        let rows = self.rows().take(y_end as usize).skip(y as usize);
        let pixels =
            rows.flat_map(|row| row.get(x as usize..x_end as usize).unwrap_or(&[]).to_vec());
        Self::from_pixels(x_end.saturating_sub(x), y_end.saturating_sub(y), pixels.collect())
    }

    /// Whether the sizes and the bits of every value are equal. Unlike `==` on numbers, this
    /// distinguishes 0 from -0, and NaN equals itself.
    pub fn same_bits(&self, other: &Self) -> bool {
        (self.width, self.height) == (other.width, other.height)
            && bytemuck::cast_slice::<_, u32>(&self.pixels)
                == bytemuck::cast_slice::<_, u32>(&other.pixels)
    }
}

/// The number of pixels of an image with these sides, which are checked.
///
/// # Errors
/// If a side is 0 or if there are more than [`MAX_PIXELS`] pixels.
pub fn checked_pixel_count(width: u32, height: u32) -> Result<usize> {
    let size = format!("{width} x {height}");
    if width == 0 || height == 0 {
        return Err(Error::new(ErrorKind::Limit, "an image must have at least one pixel")
            .value(size)
            .remedy("use a width and a height of 1 or more"));
    }
    let count = u64::from(width) * u64::from(height);
    match usize::try_from(count) {
        Ok(pixels) if count <= MAX_PIXELS => Ok(pixels),
        _ => Err(Error::new(ErrorKind::Limit, "an image has too many pixels")
            .value(format!("{size} = {count}"))
            .remedy(format!("at most {MAX_PIXELS} are allowed (such as 16384 x 16384)"))),
    }
}

/// An empty list with room for `count` values of an image, or an error if memory is short.
pub fn reserve<T>(count: usize) -> Result<Vec<T>> {
    memory::reserve(count, "the image").map_err(|error| error.remedy("use a smaller image"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_out_of_bounds_is_refused_before_allocating() {
        let text = |w, h| Film::new(w, h).unwrap_err().to_string();
        assert_eq!(
            text(0, 5),
            "an image must have at least one pixel, found 0 x 5; use a width and a height of 1 or more"
        );
        assert_eq!(
            text(u32::MAX, u32::MAX),
            "an image has too many pixels, found 4294967295 x 4294967295 = 18446744065119617025; \
             at most 268435456 are allowed (such as 16384 x 16384)"
        );
        assert_eq!(checked_pixel_count(16384, 16384).unwrap(), 1 << 28);
        assert!(checked_pixel_count(16384, 16385).is_err());
        assert_eq!(Film::new(0, 5).unwrap_err().kind(), ErrorKind::Limit);
    }

    #[test]
    fn the_pixels_must_fit_the_size() {
        let error = Film::from_pixels(2, 2, vec![[0.0; 3]; 3]).unwrap_err().to_string();
        assert_eq!(error, "an image of 2 x 2 pixels needs 4 pixels, found 3");
        assert!(Film::from_pixels(2, 2, vec![[0.0; 3]; 4]).is_ok());
    }

    #[test]
    fn bits_distinguish_equal_numbers() {
        let film = |value: f32| Film::from_pixels(1, 1, vec![[0.5, value, 1.0]]).unwrap();
        assert!(film(0.25).same_bits(&film(0.25)));
        assert!(film(f32::NAN).same_bits(&film(f32::NAN)));
        assert!(!film(0.0).same_bits(&film(-0.0)));
        assert!(!Film::new(1, 2).unwrap().same_bits(&Film::new(2, 1).unwrap()));
    }
}
