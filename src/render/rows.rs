//! Images in rows, with a line of text under each.

use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_report::plot::label::label;

/// Height of the text line under each image of a sheet, as a share of the image's height, and at
/// least in pixels.
const LINE_SHARE: f64 = 0.06;
const LEAST_LINE: u32 = 12;
/// Linear colours of the background and the text of names.
const PAPER: f32 = 1.0;
const INK: f32 = 0.01;

/// Images in rows, with a line of text under each.
pub(super) struct Rows {
    pictures: u32,
    columns: u32,
    added: u32,
    /// The whole, once an image is added.
    pub(super) film: Option<Film>,
}

impl Rows {
    /// For this number of images: as many to a row as there are rows, or one more.
    pub(super) fn new(pictures: usize) -> Self {
        let columns = (pictures as f64).sqrt().ceil() as u32;
        Self { pictures: pictures as u32, columns, added: 0, film: None }
    }

    /// The height of a line of text under images of this height.
    fn line(height: u32) -> u32 {
        ((f64::from(height) * LINE_SHARE) as u32).max(LEAST_LINE)
    }

    /// The width and height of the whole, for images of this size.
    pub(super) fn size(&self, [width, height]: [u32; 2]) -> [u32; 2] {
        let rows = self.pictures.div_ceil(self.columns);
        let with_line = height.saturating_add(Self::line(height));
        [width.saturating_mul(self.columns), with_line.saturating_mul(rows)]
    }

    /// Adds an image of the same size as those before it.
    ///
    /// # Errors
    /// If the whole is too large.
    pub(super) fn add(&mut self, name: &str, picture: &Film) -> Result<()> {
        let (width, height) = (picture.width(), picture.height());
        let (line, whole) = (Self::line(height), self.size([width, height]));
        let film = match &mut self.film {
            Some(film) => film,
            empty => {
                let mut film = Film::new(whole[0], whole[1])?;
                film.pixels_mut().fill([PAPER; 3]);
                empty.insert(film)
            }
        };
        let (left, top) =
            (self.added % self.columns * width, self.added / self.columns * (height + line));
        self.added += 1;
        let across = film.width() as usize;
        let at = |y: u32| (top + y) as usize * across + left as usize;
        for (y, row) in (0..).zip(picture.rows()) {
            film.pixels_mut()[at(y)..][..row.len()].copy_from_slice(row);
        }
        let ink = label(name, width, line).unwrap_or_default();
        for (y, row) in (height..).zip(ink.chunks(width as usize)) {
            for (pixel, part) in film.pixels_mut()[at(y)..].iter_mut().zip(row) {
                *pixel = [PAPER + (INK - PAPER) * part; 3];
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_put_in_rows_with_a_line_under_each() {
        let mut rows = Rows::new(3);
        for level in [0.1, 0.2, 0.3] {
            let film = Film::from_pixels(40, 30, vec![[level; 3]; 1200]).unwrap();
            rows.add("iso", &film).unwrap();
        }
        let film = rows.film.unwrap();
        assert_eq!((film.width(), film.height()), (80, 84));
        let level = |x, y| film.pixel(x, y).unwrap()[0];
        assert_eq!([level(0, 0), level(79, 29), level(39, 71)], [0.1, 0.2, 0.3]);
        assert_eq!([level(0, 30), level(79, 83)], [PAPER, PAPER]);
        let dark = |left: u32| (0..12).any(|y| (0..40).any(|x| level(left + x, 30 + y) < 0.5));
        assert!(dark(0) && dark(40), "names are written");
    }
}
