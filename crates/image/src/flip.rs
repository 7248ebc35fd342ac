//! FLIP: the perceived difference between two images shown alternately in one place.
//!
//! After Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference
//! Evaluator for Alternating Images", High-Performance Graphics 2020: the metric for images of low
//! dynamic range. Both images pass
//!
//! 1. through the eye's contrast sensitivity for lightness, red against green, and yellow against
//!    blue at the given number of pixels per degree ([`filter`]), into CIELAB, where their distance
//!    is the colour difference ([`tile`]);
//! 2. and through detectors of edges and points, whose difference amplifies the colour difference.
//!
//! Filters are separable and run over tiles of the image ([`tile`]), so that little memory is
//! needed beyond the result. Arithmetic is in double precision and in a fixed order; the result
//! does not depend on the number of threads.
//!
//! # From values to light
//!
//! The metric compares displayed images. A film's linear values are taken as the light of a display
//! with the primaries of sRGB, 1 being its brightest: values are clamped to 0 to 1, and NaN is
//! black, as in a PNG. So this is the metric of correctly displayed images, such as those written
//! with [`Transfer::Srgb`]; an image written without the curve looks darker on a screen that
//! expects it. Decode encoded values first, with [`srgb_decode`]: the reference implementation does
//! so for every PNG.
//!
//! [`Transfer::Srgb`]: super::write::Transfer::Srgb
//! [`srgb_decode`]: wavecrest_core::math::srgb::srgb_decode

mod filter;
mod tile;

use super::compare::check_sizes;
use filter::Filters;
use tile::Tiles;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::parallel;
use wavecrest_core::film::{Film, reserve};

/// The paper's viewing conditions: a display 0.7 m wide with 3840 pixels in a row, 0.7 m away.
pub const DEFAULT_PIXELS_PER_DEGREE: f64 = pixels_per_degree(0.7, 0.7, 3840);

/// Smallest number of pixels per degree: edge detectors need neighbours.
pub const MIN_PIXELS_PER_DEGREE: f64 = 1.0;

/// Largest number of pixels per degree, several times the resolution of the eye. Filters then reach
/// 136 pixels to every side.
pub const MAX_PIXELS_PER_DEGREE: f64 = 1000.0;

/// The perceived difference between two images.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// The mean of [`map`](Self::map).
    pub mean: f64,
    /// The difference at each pixel, from 0 to 1, the top row first.
    pub map: Vec<f32>,
    /// The number of pixels in a row.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
    /// Pixels per degree of the field of view.
    pub pixels_per_degree: f64,
}

/// The number of pixels per degree at the centre of a display that is `width` wide, has `pixels` in
/// a row and is seen from `distance`; both lengths in the same unit.
///
/// ```
/// // A display that is half as wide, with as many pixels.
/// let found = wavecrest_image::flip::pixels_per_degree(0.7, 0.35, 3840);
/// assert_eq!(found, 2.0 * wavecrest_image::flip::DEFAULT_PIXELS_PER_DEGREE);
/// ```
pub const fn pixels_per_degree(distance: f64, width: f64, pixels: u32) -> f64 {
    // The paper's formula: a degree is taken as its arc.
    distance * (pixels as f64 / width) * (std::f64::consts::PI / 180.0)
}

/// Compares `a` with `reference` at `pixels_per_degree`. The metric is symmetric: swapping the two
/// changes no bit.
///
/// # Errors
/// If their sizes differ, `pixels_per_degree` is not from [`MIN_PIXELS_PER_DEGREE`] to
/// [`MAX_PIXELS_PER_DEGREE`], or memory does not suffice for the map.
pub fn flip(a: &Film, reference: &Film, pixels_per_degree: f64) -> Result<Flip> {
    check_sizes(a, reference)?;
    if !(MIN_PIXELS_PER_DEGREE..=MAX_PIXELS_PER_DEGREE).contains(&pixels_per_degree) {
        return Err(Error::new(ErrorKind::Usage, "pixels per degree are out of bounds")
            .value(pixels_per_degree)
            .remedy(format!("use {MIN_PIXELS_PER_DEGREE} to {MAX_PIXELS_PER_DEGREE}")));
    }
    let (width, height) = (a.width(), a.height());
    let mut map: Vec<f32> = reserve(a.pixels().len())?;
    map.resize(a.pixels().len(), 0.0);
    let tiles = Tiles::new(Filters::new(pixels_per_degree), [a, reference]);
    let bands = map.chunks_mut(width as usize * tiles.side()).enumerate();
    parallel::each(bands, |(band, out)| tiles.band(band, out));
    // Each row has its own sum, so that less precision is lost over many pixels.
    let rows = map.chunks_exact(width as usize);
    let sum: f64 = rows.map(|row| row.iter().map(|&v| f64::from(v)).sum::<f64>()).sum();
    let mean = sum / map.len() as f64;
    Ok(Flip { mean, map, width, height, pixels_per_degree })
}

#[cfg(test)]
mod tests;
