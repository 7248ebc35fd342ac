//! A line of text as pixels, for labels under images.

use tiny_skia::{FillRule, Paint, Pixmap, Transform};

use super::font;

/// The size of letters as a share of the line's height, and the position of their base line below
/// its top.
const SIZE: f64 = 0.6;
const BASE: f64 = 0.7;

/// The coverage of each pixel by `text`, from 0 to 1, centred in a line with this width and height
/// in pixels, the top row first. Text that is too long loses its start. `None` if the line is
/// empty.
pub fn label(text: &str, width: u32, height: u32) -> Option<Vec<f32>> {
    let mut pixmap = Pixmap::new(width, height)?;
    let (wide, high) = (f64::from(width), f64::from(height));
    let size = SIZE * high;
    let text = font::shortened(text, size, wide);
    let start = [(wide - font::width(&text, size)) / 2.0, BASE * high];
    if let Some(path) = font::outline(&text, size, start) {
        let paint = Paint { anti_alias: true, ..Paint::default() };
        pixmap.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
    }
    Some(pixmap.pixels().iter().map(|pixel| f32::from(pixel.alpha()) / 255.0).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_in_the_middle_of_its_line() {
        let mask = label("iso", 60, 20).unwrap();
        let columns: Vec<usize> =
            (0..mask.len()).filter(|&i| mask[i] > 0.5).map(|i| i % 60).collect();
        let (first, last) = (columns.iter().min().unwrap(), columns.iter().max().unwrap());
        assert!(first + last > 55 && first + last < 65, "{first} {last}");
        assert!(label("", 60, 20).unwrap().iter().all(|&part| part == 0.0));
        assert_eq!(label("x", 0, 20), None);
    }
}
