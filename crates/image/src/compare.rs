//! Differences between two images.
//!
//! The second image, `b`, is the reference, if there is one: relative errors are relative to it,
//! and the bias is positive if the first is brighter.
//!
//! Sums are in double precision, row by row from the top, so that the numbers do not depend on the
//! machine. Two values with the same bits differ by 0, whatever they are; otherwise a value that is
//! not finite differs from any other by infinity.

use serde::Serialize;

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::film::Film;

wavecrest_base::choices! {
    /// A channel of a colour.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
    #[serde(rename_all = "lowercase")]
    pub enum ColorChannel {
        /// The first.
        Red = "red",
        /// The second.
        Green = "green",
        /// The third.
        Blue = "blue",
    }
}

/// The offset in the denominator of relative squared errors, as in Rousselle, Knaus and Zwicker
/// ("Adaptive Sampling and Reconstruction using Greedy Error Minimization", 2011). It is the square
/// of 0.1, a tenth of white: errors on much brighter values count by their ratio, those on much
/// darker ones by their size, so that noise in black cannot dominate.
pub const RELATIVE_OFFSET: f64 = 0.01;

/// Differences between two images of one size. Numbers that are not finite are `null` in JSON.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Comparison {
    /// The number of pixels in a row.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
    /// The mean squared difference, over every value of every pixel.
    pub mse: f64,
    /// The square root of [`mse`](Self::mse).
    pub rmse: f64,
    /// The peak signal-to-noise ratio in decibels, 10 log10(1 / mse), with a peak of 1. Infinite
    /// for equal images.
    pub psnr: f64,
    /// The relative mean squared error: the mean, over every value of every pixel, of (a - b)^2 /
    /// (b^2 + [`RELATIVE_OFFSET`]), where the second image, b, is the reference.
    pub relative_mse: f64,
    /// The mean of a - b, over every value of every pixel: positive if the first image is brighter.
    /// NaN if it is undefined.
    pub bias: f64,
    /// The same for red, green and blue separately.
    pub channel_bias: [f64; 3],
    /// The largest difference of two values.
    pub largest: f64,
    /// Its pixel, as column and row from the top left: the first such pixel. `None` for equal
    /// images.
    pub largest_at: Option<(u32, u32)>,
    /// Its channel.
    pub largest_channel: Option<ColorChannel>,
    /// The number of pixels whose bits are not all the same.
    pub different_pixels: u64,
    /// The number of pixels that are not finite in at least one image.
    pub nonfinite: u64,
    /// Whether every bit is the same: 0 differs from -0.
    pub equal: bool,
}

/// Compares two images; `b` is the reference.
///
/// # Errors
/// If their sizes differ.
pub fn compare(a: &Film, b: &Film) -> Result<Comparison> {
    check_sizes(a, b)?;
    let (width, height) = (a.width(), a.height());
    let mut found = Comparison { width, height, ..Comparison::default() };
    let mut sums = [0.0; 5];
    for (y, (row_a, row_b)) in a.rows().zip(b.rows()).enumerate() {
        // Each row has its own sums, so that less precision is lost over many pixels.
        let mut own = [0.0; 5];
        for (x, (a, b)) in row_a.iter().zip(row_b).enumerate() {
            found.add(x, y, a, b, &mut own);
        }
        sums.iter_mut().zip(own).for_each(|(sum, term)| *sum += term);
    }
    let pixels = a.pixels().len() as f64;
    let [squares, relative, red, green, blue] = sums;
    found.mse = squares / (3.0 * pixels);
    found.rmse = found.mse.sqrt();
    found.psnr = psnr(found.mse);
    found.relative_mse = relative / (3.0 * pixels);
    found.bias = (red + green + blue) / (3.0 * pixels);
    found.channel_bias = [red, green, blue].map(|sum| sum / pixels);
    found.equal = found.different_pixels == 0;
    Ok(found)
}

/// The number of pixels of two images with a value that differs by more than `tolerance`.
///
/// # Errors
/// If their sizes differ.
pub fn pixels_beyond(a: &Film, b: &Film, tolerance: f64) -> Result<u64> {
    check_sizes(a, b)?;
    let is_beyond = |(a, b): &(&[f32; 3], &[f32; 3])| {
        a.iter().zip(*b).any(|(&a, &b)| distance(signed_difference(a, b)) > tolerance)
    };
    Ok(a.pixels().iter().zip(b.pixels()).filter(is_beyond).count() as u64)
}

pub(super) fn check_sizes(a: &Film, b: &Film) -> Result<()> {
    let size = |film: &Film| format!("{} x {}", film.width(), film.height());
    if size(a) == size(b) {
        return Ok(());
    }
    let message = "the images differ in size";
    Err(Error::new(ErrorKind::Usage, message)
        .value(format!("{} and {}", size(a), size(b)))
        .remedy("render both at one size"))
}

/// The peak signal-to-noise ratio for a mean squared error, in decibels, with a peak of 1.
///
/// ```
/// assert_eq!(wavecrest_image::compare::psnr(0.01), 20.0);
/// ```
pub fn psnr(mse: f64) -> f64 {
    // `libm`'s logarithm: the machine's may differ in the last bit.
    if mse == 0.0 { f64::INFINITY } else { -10.0 * libm::log10(mse) }
}

/// a - b: 0 if the bits are the same, NaN if undefined.
pub(super) fn signed_difference(a: f32, b: f32) -> f64 {
    if a.to_bits() == b.to_bits() { 0.0 } else { f64::from(a) - f64::from(b) }
}

/// The square of the distance between two values.
pub(super) fn squared_difference(a: f32, b: f32) -> f64 {
    let distance = distance(signed_difference(a, b));
    distance * distance
}

/// The square of the distance, relative to `b`: see [`RELATIVE_OFFSET`].
pub(super) fn relative_difference(a: f32, b: f32) -> f64 {
    relative_to(b, squared_difference(a, b))
}

/// The distance between two values from their difference: infinite if undefined.
pub(super) fn distance(signed: f64) -> f64 {
    if signed.is_nan() { f64::INFINITY } else { signed.abs() }
}

fn relative_to(b: f32, squared: f64) -> f64 {
    let b = f64::from(b);
    // Equal values may have any reference, and infinite distances stay infinite.
    if squared > 0.0 && squared.is_finite() { squared / (b * b + RELATIVE_OFFSET) } else { squared }
}

impl Comparison {
    /// Adds a pixel, except for what means are of: `sums` over its values of squared differences, of relative ones, and
    /// of the signed ones of each channel.
    fn add(&mut self, x: usize, y: usize, a: &[f32; 3], b: &[f32; 3], sums: &mut [f64; 5]) {
        self.different_pixels += u64::from(a.map(f32::to_bits) != b.map(f32::to_bits));
        self.nonfinite += u64::from(!a.iter().chain(b).all(|value| value.is_finite()));
        let [all_squares, relative, signed_sums @ ..] = sums;
        let mut squares = 0.0;
        for (i, channel) in ColorChannel::ALL.into_iter().enumerate() {
            let signed = signed_difference(a[i], b[i]);
            let difference = distance(signed);
            let squared = difference * difference;
            squares += squared;
            *relative += relative_to(b[i], squared);
            signed_sums[i] += signed;
            if difference > self.largest {
                self.largest = difference;
                self.largest_at = Some((x as u32, y as u32));
                self.largest_channel = Some(channel);
            }
        }
        *all_squares += squares;
    }
}

#[cfg(test)]
mod tests;
