//! Images of one size in rows, in the order in which they are added.

use wavecrest_base::error::Result;
use wavecrest_core::film::Film;

/// The linear level of places that no image takes.
const PAPER: f32 = 1.0;

/// Images in rows.
pub(super) struct Rows {
    pictures: u32,
    columns: u32,
    added: u32,
    film: Option<Film>,
}

impl Rows {
    /// For this number of images: as many to a row as there are rows, or one more.
    pub(super) fn new(pictures: usize) -> Self {
        let columns = (pictures as f64).sqrt().ceil() as u32;
        Self { pictures: pictures as u32, columns, added: 0, film: None }
    }

    /// The width and height of the whole, for images of this size.
    pub(super) fn size(&self, [width, height]: [u32; 2]) -> [u32; 2] {
        let rows = self.pictures.div_ceil(self.columns);
        [width.saturating_mul(self.columns), height.saturating_mul(rows)]
    }

    /// Adds an image of the same size as those before it.
    ///
    /// # Errors
    /// If the whole is too large.
    pub(super) fn add(&mut self, picture: &Film) -> Result<()> {
        let [width, height] = [picture.width(), picture.height()];
        let whole = self.size([width, height]);
        let film = match &mut self.film {
            Some(film) => film,
            empty => {
                let mut film = Film::new(whole[0], whole[1])?;
                film.pixels_mut().fill([PAPER; 3]);
                empty.insert(film)
            }
        };
        let (left, top) = (self.added % self.columns * width, self.added / self.columns * height);
        self.added += 1;
        for (row, pixels) in film.rows_mut().skip(top as usize).zip(picture.rows()) {
            row[left as usize..][..pixels.len()].copy_from_slice(pixels);
        }
        Ok(())
    }

    /// The whole, once every image is added.
    pub(super) fn whole(&mut self) -> Option<Film> {
        self.film.take_if(|_| self.added == self.pictures)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_put_in_rows() {
        let mut rows = Rows::new(3);
        for level in [0.1, 0.2, 0.3] {
            rows.add(&Film::from_pixels(40, 30, vec![[level; 3]; 1200]).unwrap()).unwrap();
        }
        let film = rows.whole().unwrap();
        assert_eq!((film.width(), film.height()), (80, 60));
        let level = |x, y| film.pixel(x, y).unwrap()[0];
        assert_eq!([level(0, 0), level(79, 29), level(39, 59)], [0.1, 0.2, 0.3]);
        assert_eq!([level(40, 30), level(79, 59)], [PAPER, PAPER]);
    }
}
