//! Conversion of linear values to the levels of 8-bit formats.

use std::sync::LazyLock;

use wavecrest_base::{parallel, progress};
use wavecrest_core::film::Film;
use wavecrest_core::math::srgb::{srgb_decode, srgb_encode};

wavecrest_base::choices! {
    /// The transfer curve from linear values, 0 to 1, to 256 levels. Float formats are always
    /// linear.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Transfer {
        /// Linear: 255 times the value.
        #[default]
        Linear = "linear",
        /// The sRGB transfer function, as displays expect.
        Srgb = "srgb",
    }
}

wavecrest_base::choices! {
    /// Tone mapping of light brighter than white.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Tone {
        /// Clip to white.
        #[default]
        Clip = "clip",
        /// A filmic curve: deeper shadows, highlights that roll off to white.
        Filmic = "filmic",
    }
}

/// Development of light before it becomes levels. Float formats store it undeveloped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Develop {
    /// In stops: each doubles the light.
    pub exposure: f32,
    /// Tone mapping.
    pub tone: Tone,
}

impl Develop {
    /// The largest exposure in stops, in both directions.
    pub const MOST_STOPS: f32 = 64.0;

    /// The factor on all light.
    pub fn factor(&self) -> f32 {
        libm::exp2f(self.exposure)
    }

    /// The developed light of a channel.
    pub fn of(&self, light: f32) -> f32 {
        self.tone.of(light * self.factor())
    }

    /// The developed film. `alpha` is the coverage of each pixel, if any is partial: colours are
    /// premultiplied by it before and after.
    pub fn film(&self, film: &Film, alpha: Option<&[f32]>) -> Film {
        let factor = self.factor();
        let mut developed = film.clone();
        for (i, pixel) in developed.pixels_mut().iter_mut().enumerate() {
            let share = alpha.and_then(|alpha| alpha.get(i)).map_or(1.0, |&share| share);
            if share > 0.0 {
                *pixel = pixel.map(|value| share * self.tone.of(value / share * factor));
            }
        }
        developed
    }
}

/// Narkowicz's fit to the curve of the Academy Color Encoding System (*ACES Filmic Tone Mapping
/// Curve*, 2016): the coefficients of two quadratics, one over the other, and a factor applied to
/// light first, which preserves middle grey.
const ABOVE: [f32; 2] = [2.51, 0.03];
const BELOW: [f32; 3] = [2.43, 0.59, 0.14];
const BEFORE: f32 = 0.7;

impl Tone {
    /// The value, linear in and linear out.
    fn of(self, value: f32) -> f32 {
        match self {
            Self::Clip => value,
            Self::Filmic => {
                // NaN stays NaN; the quotient of infinities would become one, so they are clamped.
                let x = (value * BEFORE).clamp(0.0, BRIGHTEST);
                x * (ABOVE[0] * x + ABOVE[1]) / (x * (BELOW[0] * x + BELOW[1]) + BELOW[2])
            }
        }
    }
}

/// Light above this is treated as infinite: its square is still finite.
const BRIGHTEST: f32 = 1e18;

/// The 8-bit red, green and blue of each pixel of a film, the top row first, found on all threads.
pub fn levels(film: &Film, transfer: Transfer) -> Vec<u8> {
    let width = film.width() as usize;
    let mut levels = vec![0; size_of::<[u8; 3]>() * film.pixels().len()];
    let rows = levels.chunks_exact_mut(size_of::<[u8; 3]>() * width);
    parallel::each(rows.zip(film.pixels().chunks_exact(width)), |(levels, row)| {
        levels.copy_from_slice(&row_to_bytes(row, transfer));
    });
    levels
}

/// The 8-bit red, green and blue of each pixel of a row.
pub fn row_to_bytes(row: &[[f32; 3]], transfer: Transfer) -> Vec<u8> {
    progress::add(row.len() as u64);
    let values = row.as_flattened().iter();
    match transfer {
        Transfer::Linear => values.map(|&value| linear_level(value)).collect(),
        Transfer::Srgb => values.map(|&value| srgb_level(value)).collect(),
    }
}

/// The nearest of 256 levels; NaN is black.
pub(super) fn linear_level(value: f32) -> u8 {
    // The conversion takes NaN to 0. This rounding is a few vector instructions, `round` a call.
    let scaled = value.clamp(0.0, 1.0) * 255.0;
    let below = scaled as i32;
    (below + i32::from(scaled - below as f32 >= 0.5)) as u8
}

/// The least values of all levels but black on the sRGB curve: to search them takes a tenth of the time of its power
/// function.
static LEAST_OF_SRGB: LazyLock<Vec<f32>> = LazyLock::new(|| {
    let least = |level: u8| {
        let is_below = |value| linear_level(srgb_encode(value)) < level;
        let mut value = srgb_decode((f32::from(level) - 0.5) / 255.0);
        while !is_below(value.next_down()) {
            value = value.next_down();
        }
        while is_below(value) {
            value = value.next_up();
        }
        value
    };
    (1..=255).map(least).collect()
});

/// As the level of [`srgb_encode`]; NaN is black.
fn srgb_level(value: f32) -> u8 {
    LEAST_OF_SRGB.partition_point(|&least| least <= value) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_round_and_clamp_in_either_transfer() {
        for (value, linear, srgb) in [
            (0.0, 0, 0),
            (0.001, 0, 3),
            (1.4 / 255.0, 1, 17),
            (1.6 / 255.0, 2, 18),
            (0.2159, 55, 128),
            (0.5, 128, 188),
            (1.0, 255, 255),
            (7.0, 255, 255),
            (-3.0, 0, 0),
            (f32::INFINITY, 255, 255),
            (f32::NEG_INFINITY, 0, 0),
            (f32::NAN, 0, 0),
        ] {
            let level = |transfer| row_to_bytes(&[[value; 3]], transfer)[0];
            assert_eq!([Transfer::Linear, Transfer::Srgb].map(level), [linear, srgb], "{value}");
        }
    }

    #[test]
    fn a_film_is_exposed_in_stops_and_curved_within_its_cover() {
        let film = Film::from_pixels(2, 1, vec![[0.2, 0.4, 3.0], [0.1, 0.0, 0.0]]).unwrap();
        let exposed = Develop { exposure: 1.0, ..Develop::default() }.film(&film, None);
        assert_eq!(exposed.pixels()[0], [0.4, 0.8, 6.0]);
        let filmic = Develop { exposure: 0.0, tone: Tone::Filmic };
        let whole = filmic.film(&film, None);
        let half = filmic.film(&film, Some(&[1.0, 0.5]));
        assert_eq!(whole.pixels()[0], half.pixels()[0]);
        // 0.1 on half of a pixel is 0.2 there.
        assert_eq!(half.pixels()[1][0], 0.5 * whole.pixels()[0][0]);
        assert_eq!(filmic.film(&film, Some(&[0.0, 0.0])).pixels(), film.pixels());
    }

    #[test]
    fn the_filmic_curve_rises_from_black_to_white_and_keeps_the_middle() {
        let of = |value| Tone::Filmic.of(value);
        assert_eq!(of(0.0), 0.0);
        assert!((of(0.18) - 0.18).abs() < 0.02, "{}", of(0.18));
        let values: Vec<f32> = (0..200).map(|i| of(i as f32 * 0.1)).collect();
        assert!(values.windows(2).all(|pair| pair[0] < pair[1]));
        for value in [f32::INFINITY, 1e30, -1.0] {
            assert!(
                of(value).is_finite() && linear_level(of(value)).is_multiple_of(255),
                "{value}"
            );
        }
        assert!(of(f32::NAN).is_nan());
    }

    #[test]
    fn the_srgb_curve_can_be_undone_and_its_levels_are_exact() {
        let same = |bits| {
            let value = f32::from_bits(bits);
            assert_eq!(srgb_level(value), linear_level(srgb_encode(value)), "{value}");
        };
        (0..=2.0_f32.to_bits()).step_by(9973).for_each(same);
        for least in &*LEAST_OF_SRGB {
            (least.to_bits() - 100..least.to_bits() + 100).for_each(same);
        }
        for level in 0..=255 {
            let encoded = level as f32 / 255.0;
            assert!((srgb_encode(srgb_decode(encoded)) - encoded).abs() < 1e-6, "{level}");
        }
        assert_eq!(srgb_encode(0.5).to_bits(), 0.735_356_9_f32.to_bits());
        // ((0.5 + 0.055) / 1.055)^2.4
        assert!((srgb_decode(0.5) - 0.214_041_14).abs() < 1e-7);
    }
}
