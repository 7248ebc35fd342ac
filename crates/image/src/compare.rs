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
    pub enum Channel {
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
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    pub largest_channel: Option<Channel>,
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
    let mut tally = Tally::default();
    for (y, (row_a, row_b)) in a.rows().zip(b.rows()).enumerate() {
        tally.add_row(y, row_a, row_b);
    }
    let pixels = a.pixels().len() as f64;
    let [squares, relative, red, green, blue] = tally.sums;
    let mse = squares / (3.0 * pixels);
    Ok(Comparison {
        width: a.width(),
        height: a.height(),
        mse,
        rmse: mse.sqrt(),
        psnr: psnr(mse),
        relative_mse: relative / (3.0 * pixels),
        bias: (red + green + blue) / (3.0 * pixels),
        channel_bias: [red / pixels, green / pixels, blue / pixels],
        largest: tally.largest,
        largest_at: tally.place.map(|(x, y, _)| (x, y)),
        largest_channel: tally.place.map(|(_, _, channel)| channel),
        different_pixels: tally.different,
        nonfinite: tally.nonfinite,
        equal: tally.different == 0,
    })
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

/// The absolute difference of two images, times `gain`.
///
/// # Errors
/// If their sizes differ.
pub fn difference_image(a: &Film, b: &Film, gain: f32) -> Result<Film> {
    check_sizes(a, b)?;
    let mut film = Film::new(a.width(), a.height())?;
    let values = a.pixels().as_flattened().iter().zip(b.pixels().as_flattened());
    for (out, (&a, &b)) in film.pixels_mut().as_flattened_mut().iter_mut().zip(values) {
        *out = (distance(signed_difference(a, b)) * f64::from(gain)) as f32;
    }
    Ok(film)
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
fn distance(signed: f64) -> f64 {
    if signed.is_nan() { f64::INFINITY } else { signed.abs() }
}

fn relative_to(b: f32, squared: f64) -> f64 {
    let b = f64::from(b);
    // Equal values may have any reference, and infinite distances stay infinite.
    if squared > 0.0 && squared.is_finite() { squared / (b * b + RELATIVE_OFFSET) } else { squared }
}

/// The state of a comparison.
#[derive(Default)]
struct Tally {
    /// Sums over values: of squared differences, of relative ones, and of the signed ones of each
    /// channel.
    sums: [f64; 5],
    largest: f64,
    place: Option<(u32, u32, Channel)>,
    different: u64,
    nonfinite: u64,
}

impl Tally {
    fn add_row(&mut self, y: usize, row_a: &[[f32; 3]], row_b: &[[f32; 3]]) {
        // Each row has its own sums, so that less precision is lost over many pixels.
        let mut sums = [0.0; 5];
        for (x, (a, b)) in row_a.iter().zip(row_b).enumerate() {
            self.pixel(x, y, a, b, &mut sums);
        }
        self.sums.iter_mut().zip(sums).for_each(|(sum, term)| *sum += term);
    }

    fn pixel(&mut self, x: usize, y: usize, a: &[f32; 3], b: &[f32; 3], sums: &mut [f64; 5]) {
        self.different += u64::from(a.map(f32::to_bits) != b.map(f32::to_bits));
        self.nonfinite += u64::from(!a.iter().chain(b).all(|value| value.is_finite()));
        let [all_squares, relative, signed_sums @ ..] = sums;
        let mut squares = 0.0;
        for (i, channel) in Channel::ALL.into_iter().enumerate() {
            let signed = signed_difference(a[i], b[i]);
            let difference = distance(signed);
            let squared = difference * difference;
            squares += squared;
            *relative += relative_to(b[i], squared);
            signed_sums[i] += signed;
            if difference > self.largest {
                self.largest = difference;
                self.place = Some((x as u32, y as u32, channel));
            }
        }
        *all_squares += squares;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(pixels: &[[f32; 3]]) -> Film {
        Film::from_pixels(2, pixels.len() as u32 / 2, pixels.to_vec()).unwrap()
    }

    #[test]
    fn equal_pictures_differ_by_nothing() {
        let a = film(&[[0.5, f32::NAN, f32::INFINITY], [1.0; 3]]);
        let found = compare(&a, &a).unwrap();
        let expected = Comparison {
            width: 2,
            height: 1,
            mse: 0.0,
            rmse: 0.0,
            psnr: f64::INFINITY,
            relative_mse: 0.0,
            bias: 0.0,
            channel_bias: [0.0; 3],
            largest: 0.0,
            largest_at: None,
            largest_channel: None,
            different_pixels: 0,
            nonfinite: 1,
            equal: true,
        };
        assert_eq!(found, expected);
    }

    #[test]
    fn the_numbers_are_those_found_by_hand() {
        let a = film(&[[0.0; 3]; 4]);
        let b = film(&[[0.0; 3], [0.5, 0.0, 0.0], [0.0; 3], [0.0, -0.75, 0.25]]);
        let found = compare(&a, &b).unwrap();
        // (0.25 + 0.5625 + 0.0625) / 12 = 0.875 / 12
        assert_eq!(found.mse, 0.875 / 12.0);
        assert_eq!(found.rmse, (0.875f64 / 12.0).sqrt());
        assert!((found.psnr - 11.371_731_93).abs() < 1e-8, "{}", found.psnr);
        assert_eq!((found.largest, found.largest_at), (0.75, Some((1, 1))));
        assert_eq!(found.largest_channel.map(Channel::name), Some("green"));
        assert_eq!((found.different_pixels, found.nonfinite, found.equal), (2, 0, false));
    }

    #[test]
    fn the_second_picture_is_the_reference() {
        let (a, b) = (film(&[[0.5, 0.0, 1.0], [0.25; 3]]), film(&[[0.25; 3], [0.25; 3]]));
        let found = compare(&a, &b).unwrap();
        assert_eq!(found.channel_bias, [0.125, -0.125, 0.375]);
        assert_eq!(found.bias, 0.125);
        // (0.0625 + 0.0625 + 0.5625) / (0.0625 + 0.01) / 6
        assert!((found.relative_mse - 0.6875 / 0.0725 / 6.0).abs() < 1e-15);
        let back = compare(&b, &a).unwrap();
        assert_eq!((back.mse, back.bias), (found.mse, -found.bias));
        let terms = [0.0625 / 0.26, 0.0625 / 0.01, 0.5625 / 1.01];
        assert!((back.relative_mse - terms.iter().sum::<f64>() / 6.0).abs() < 1e-15);
    }

    #[test]
    fn relative_errors_count_by_their_ratio_where_it_is_bright_and_by_their_size_where_dark() {
        let relative = |a: f32, b: f32| {
            compare(&film(&[[a; 3]; 2]), &film(&[[b; 3]; 2])).unwrap().relative_mse
        };
        assert!((relative(1100.0, 1000.0) - 0.01).abs() < 1e-9);
        assert!((relative(1.1e6, 1e6) - 0.01).abs() < 1e-9);
        assert_eq!(relative(0.25, 0.0), 6.25);
        assert!((relative(2e-3, 1e-3) - 1e-4).abs() < 1e-7);
    }

    #[test]
    fn a_tenth_everywhere_is_20_decibels() {
        let b = Film::from_pixels(2, 1, vec![[0.1; 3]; 2]).unwrap();
        let found = compare(&film(&[[0.0; 3]; 2]), &b).unwrap();
        assert!((found.psnr - 20.0).abs() < 1e-6, "{}", found.psnr);
        assert_eq!(psnr(1.0), 0.0);
        assert_eq!(psnr(1e-6), 60.0);
    }

    #[test]
    fn the_first_of_equal_differences_is_named() {
        let found = compare(&film(&[[0.0; 3]; 4]), &film(&[[1.0; 3]; 4])).unwrap();
        assert_eq!(found.largest_at, Some((0, 0)));
        assert_eq!(found.largest_channel, Some(Channel::Red));
    }

    #[test]
    fn zeros_of_either_sign_differ_in_bits_alone() {
        let found = compare(&film(&[[0.0; 3]; 2]), &film(&[[-0.0; 3]; 2])).unwrap();
        assert_eq!((found.mse, found.largest, found.largest_at), (0.0, 0.0, None));
        assert_eq!((found.different_pixels, found.equal), (2, false));
        assert_eq!(found.psnr, f64::INFINITY);
    }

    #[test]
    fn what_is_not_finite_differs_by_infinity() {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let found =
                compare(&film(&[[0.0; 3]; 2]), &film(&[[0.0; 3], [0.0, 0.0, value]])).unwrap();
            assert_eq!((found.largest, found.largest_at), (f64::INFINITY, Some((1, 0))));
            assert_eq!((found.mse, found.psnr), (f64::INFINITY, f64::NEG_INFINITY));
            assert_eq!(found.nonfinite, 1);
            assert_eq!(found.relative_mse, f64::INFINITY);
            let expected = -value / 2.0;
            assert_eq!((found.channel_bias[0], found.channel_bias[1]), (0.0, 0.0));
            for bias in [found.bias, found.channel_bias[2]] {
                assert_eq!(bias.is_nan(), value.is_nan());
                assert!(value.is_nan() || bias == f64::from(expected), "{value}: {bias}");
            }
        }
        let quiet = |payload| f32::from_bits(0x7fc0_0000u32 | payload);
        let found = compare(&film(&[[quiet(1); 3]; 2]), &film(&[[quiet(2); 3]; 2])).unwrap();
        assert_eq!((found.equal, found.largest), (false, f64::INFINITY));
    }

    #[test]
    fn sizes_must_be_the_same() {
        let (a, b) = (Film::new(3, 2).unwrap(), Film::new(2, 3).unwrap());
        let text = "the images differ in size, found 3 x 2 and 2 x 3; \
                    render both at one size";
        assert_eq!(compare(&a, &b).unwrap_err().to_string(), text);
        assert_eq!(difference_image(&a, &b, 1.0).unwrap_err().to_string(), text);
    }

    #[test]
    fn pixels_beyond_a_tolerance_are_counted_once_each() {
        let a = film(&[[0.0; 3]; 4]);
        let b = film(&[[0.5, 0.5, 0.0], [0.25, 0.0, 0.0], [-0.0; 3], [0.0, f32::NAN, 0.0]]);
        let count = |tolerance| pixels_beyond(&a, &b, tolerance).unwrap();
        assert_eq!([0.0, 0.25, 0.5].map(count), [3, 2, 1]);
        assert!(pixels_beyond(&a, &Film::new(1, 1).unwrap(), 0.0).is_err());
    }

    #[test]
    fn json_has_null_for_infinity() {
        let a = film(&[[0.0; 3]; 2]);
        let text = serde_json::to_string(&compare(&a, &a).unwrap()).unwrap();
        assert_eq!(
            text,
            r#"{"width":2,"height":1,"mse":0.0,"rmse":0.0,"psnr":null,"relative_mse":0.0,"bias":0.0,"channel_bias":[0.0,0.0,0.0],"largest":0.0,"largest_at":null,"largest_channel":null,"different_pixels":0,"nonfinite":0,"equal":true}"#
        );
    }

    #[test]
    fn json_has_null_for_an_undefined_bias() {
        let (a, b) = (film(&[[0.0; 3]; 2]), film(&[[0.0, f32::NAN, 0.0], [0.0; 3]]));
        let json = serde_json::to_value(compare(&a, &b).unwrap()).unwrap();
        assert_eq!(json["bias"], serde_json::Value::Null);
        assert_eq!(json["channel_bias"], serde_json::json!([0.0, null, 0.0]));
    }

    #[test]
    fn a_difference_image_shows_how_far_apart() {
        let a = film(&[[0.5, 0.25, f32::NAN], [0.0; 3]]);
        let b = film(&[[0.25, 0.5, f32::NAN], [0.0, f32::NAN, 1.0]]);
        let found = difference_image(&a, &b, 2.0).unwrap();
        assert_eq!(found.pixels(), [[0.5, 0.5, 0.0], [0.0, f32::INFINITY, 2.0]]);
    }
}
