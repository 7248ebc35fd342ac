//! A line of text as pixels, to be put under a picture.

use tiny_skia::{FillRule, Paint, Pixmap, Transform};

use super::font;

/// The size of letters as a share of the line's height; and how far their base line is below its top.
const SIZE: f64 = 0.6;
const BASE: f64 = 0.7;

/// How much of each pixel `text` covers, from 0 to 1, in the middle of a line of this width and height in pixels,
/// the top row first. What is too long for the line loses its start. `None` where there is nothing to draw on.
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
