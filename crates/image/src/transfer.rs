//! From linear values to the levels of 8-bit formats.

use wavecrest_core::math::srgb::srgb_encode;

wavecrest_base::choices! {
    /// How a linear value from 0 to 1 becomes one of 256 levels. Float formats are always linear.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Transfer {
        /// Level 255 times the value.
        #[default]
        Linear = "linear",
        /// The sRGB curve first, which is what screens expect.
        Srgb = "srgb",
    }
}

/// A row of pixels as 8-bit values.
pub(super) fn row_to_bytes(row: &[[f32; 3]], transfer: Transfer) -> Vec<u8> {
    let values = row.as_flattened().iter();
    match transfer {
        Transfer::Linear => values.map(|&value| linear_level(value)).collect(),
        Transfer::Srgb => values.map(|&value| linear_level(srgb_encode(value))).collect(),
    }
}

/// The nearest of 256 levels; a value that is not a number is black.
fn linear_level(value: f32) -> u8 {
    // The conversion takes what is not a number to 0. Rounding so is a few vector instructions, `round` a call.
    let scaled = value.clamp(0.0, 1.0) * 255.0;
    let below = scaled as i32;
    (below + i32::from(scaled - below as f32 >= 0.5)) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use wavecrest_core::math::srgb::srgb_decode;

    #[test]
    fn levels_round_and_clamp() {
        let level = |value| row_to_bytes(&[[value; 3]], Transfer::Linear)[0];
        let cases = [
            (0.0, 0),
            (1.0, 255),
            (0.5, 128),
            (1.4 / 255.0, 1),
            (1.6 / 255.0, 2),
            (-3.0, 0),
            (7.0, 255),
            (f32::INFINITY, 255),
            (f32::NEG_INFINITY, 0),
            (f32::NAN, 0),
        ];
        for (value, expected) in cases {
            assert_eq!(level(value), expected, "{value}");
        }
    }

    #[test]
    fn the_srgb_curve_has_its_known_levels() {
        let level = |value| row_to_bytes(&[[value; 3]], Transfer::Srgb)[0];
        for (value, expected) in
            [(0.0, 0), (0.001, 3), (0.2159, 128), (0.5, 188), (1.0, 255), (2.0, 255), (-1.0, 0)]
        {
            assert_eq!(level(value), expected, "{value}");
        }
        assert_eq!(level(f32::NAN), 0);
        assert_eq!(srgb_encode(0.5).to_bits(), 0.735_356_9_f32.to_bits());
    }

    #[test]
    fn the_srgb_curve_can_be_undone() {
        for level in 0..=255 {
            let encoded = level as f32 / 255.0;
            assert!((srgb_encode(srgb_decode(encoded)) - encoded).abs() < 1e-6, "{level}");
        }
        // ((0.5 + 0.055) / 1.055)^2.4
        assert!((srgb_decode(0.5) - 0.214_041_14).abs() < 1e-7);
    }
}
