//! Colour maps.
//!
//! Both maps are perceptually uniform: equal steps of the number look equal. Colours are encoded
//! display values, sRGB with its curve: write a film of them with
//! [`Transfer::Linear`](super::write::Transfer::Linear).

use std::f64::consts::FRAC_PI_3;

use super::color::{lab_to_xyz, xyz_to_rgb};
use wavecrest_core::math::srgb::srgb_encode;

/// From black over purple and orange to a light yellow, for a number from 0 to 1. Numbers beyond
/// are clamped; NaN is black.
///
/// The map `magma` by Smith and van der Walt (matplotlib, CC0), with 256 colours and straight
/// lines between them.
///
/// ```
/// # use wavecrest_image::colormap::magma;
/// assert_eq!(magma(0.0).map(|v| (v * 255.0) as u8), [0, 0, 4]);
/// assert_eq!(magma(1.0).map(|v| (v * 255.0) as u8), [252, 253, 191]);
/// ```
pub fn magma(t: f32) -> [f32; 3] {
    if t.is_nan() {
        return [0.0; 3];
    }
    let last = MAGMA.len() - 1;
    let place = t.clamp(0.0, 1.0) * last as f32;
    let index = (place as usize).min(last - 1);
    let part = place - index as f32;
    let (low, high) = (levels(MAGMA[index]), levels(MAGMA[index + 1]));
    [0, 1, 2].map(|i| (low[i] + part * (high[i] - low[i])) / 255.0)
}

/// From blue over grey to red, for a number from -1 to 1. Numbers beyond are clamped; NaN is black,
/// which is no colour of the map.
///
/// The cool and warm colours of Moreland, "Diverging Color Maps for Scientific Visualization"
/// (2009): a path through CIELAB in polar coordinates, along which lightness rises to the middle
/// and falls again without an edge.
///
/// ```
/// # use wavecrest_image::colormap::diverging;
/// assert_eq!(diverging(0.0).map(|v| (v * 255.0).round()), [221.0; 3]);
/// ```
pub fn diverging(t: f32) -> [f32; 3] {
    if t.is_nan() {
        return [0.0; 3];
    }
    let t = f64::from(t.clamp(-1.0, 1.0));
    let (end, part) = if t < 0.0 { (COOL, -t) } else { (WARM, t) };
    // A spiral instead of a straight line through the a-b plane: the hue at the grey middle, where
    // it is invisible, is turned so that the path there is as long as elsewhere.
    let turn = SATURATION * (MIDDLE * MIDDLE - MAGNITUDE * MAGNITUDE).sqrt()
        / (MAGNITUDE * libm::sin(SATURATION));
    let away = if end > -FRAC_PI_3 { turn } else { -turn };
    let magnitude = MIDDLE + part * (MAGNITUDE - MIDDLE);
    let saturation = part * SATURATION;
    let hue = end + (1.0 - part) * away;
    let across = magnitude * libm::sin(saturation);
    encoded([magnitude * libm::cos(saturation), across * libm::cos(hue), across * libm::sin(hue)])
}

/// The colour of the `n`th of many categories, as encoded sRGB. Consecutive numbers get clearly
/// different colours, all light enough to stand out from black.
///
/// Hues in CIELAB advance by the golden angle, which spreads any number of them evenly; three lightnesses alternate.
pub fn distinct(n: u32) -> [f32; 3] {
    let (lightness, chroma) = DISTINCT[n as usize % DISTINCT.len()];
    // Whole turns first: the angle of many turns would lose digits.
    let hue = std::f64::consts::TAU * (f64::from(n) * GOLDEN_TURN).fract();
    encoded([lightness, chroma * libm::cos(hue), chroma * libm::sin(hue)])
}

/// A colour of CIELAB as encoded sRGB.
fn encoded(lab: [f64; 3]) -> [f32; 3] {
    xyz_to_rgb(lab_to_xyz(lab)).map(|value| srgb_encode(value.clamp(0.0, 1.0) as f32))
}

/// The golden angle in turns: 2 minus the golden ratio, 1.618...
const GOLDEN_TURN: f64 = 0.381_966_011_250_105_2;

/// Lightness and chroma, nearly within the gamut of displays for every hue.
const DISTINCT: [(f64, f64); 3] = [(66.0, 48.0), (82.0, 38.0), (50.0, 44.0)];

/// The blue and the red of Moreland's table, in his polar coordinates of CIELAB: the distance from
/// black and the angle to the axis of greys, the same for both, and the angle about that axis.
const MAGNITUDE: f64 = 80.0;
const SATURATION: f64 = 1.08;
const COOL: f64 = -1.1;
const WARM: f64 = 0.5;

/// The magnitude of the grey in the middle.
const MIDDLE: f64 = 88.0;

/// The three bytes of a colour.
fn levels(color: u32) -> [f32; 3] {
    let [_, red, green, blue] = color.to_be_bytes();
    [red, green, blue].map(f32::from)
}

/// The colours of `magma`, rounded to bytes: red, green, blue.
#[rustfmt::skip]
const MAGMA: [u32; 256] = [
    0x000004, 0x010005, 0x010106, 0x010108, 0x020109, 0x02020b, 0x02020d, 0x03030f, 0x030312,
    0x040414, 0x050416, 0x060518, 0x06051a, 0x07061c, 0x08071e, 0x090720, 0x0a0822, 0x0b0924,
    0x0c0926, 0x0d0a29, 0x0e0b2b, 0x100b2d, 0x110c2f, 0x120d31, 0x130d34, 0x140e36, 0x150e38,
    0x160f3b, 0x180f3d, 0x19103f, 0x1a1042, 0x1c1044, 0x1d1147, 0x1e1149, 0x20114b, 0x21114e,
    0x221150, 0x241253, 0x251255, 0x271258, 0x29115a, 0x2a115c, 0x2c115f, 0x2d1161, 0x2f1163,
    0x311165, 0x331067, 0x341069, 0x36106b, 0x38106c, 0x390f6e, 0x3b0f70, 0x3d0f71, 0x3f0f72,
    0x400f74, 0x420f75, 0x440f76, 0x451077, 0x471078, 0x491078, 0x4a1079, 0x4c117a, 0x4e117b,
    0x4f127b, 0x51127c, 0x52137c, 0x54137d, 0x56147d, 0x57157e, 0x59157e, 0x5a167e, 0x5c167f,
    0x5d177f, 0x5f187f, 0x601880, 0x621980, 0x641a80, 0x651a80, 0x671b80, 0x681c81, 0x6a1c81,
    0x6b1d81, 0x6d1d81, 0x6e1e81, 0x701f81, 0x721f81, 0x732081, 0x752181, 0x762181, 0x782281,
    0x792282, 0x7b2382, 0x7c2382, 0x7e2482, 0x802582, 0x812581, 0x832681, 0x842681, 0x862781,
    0x882781, 0x892881, 0x8b2981, 0x8c2981, 0x8e2a81, 0x902a81, 0x912b81, 0x932b80, 0x942c80,
    0x962c80, 0x982d80, 0x992d80, 0x9b2e7f, 0x9c2e7f, 0x9e2f7f, 0xa02f7f, 0xa1307e, 0xa3307e,
    0xa5317e, 0xa6317d, 0xa8327d, 0xaa337d, 0xab337c, 0xad347c, 0xae347b, 0xb0357b, 0xb2357b,
    0xb3367a, 0xb5367a, 0xb73779, 0xb83779, 0xba3878, 0xbc3978, 0xbd3977, 0xbf3a77, 0xc03a76,
    0xc23b75, 0xc43c75, 0xc53c74, 0xc73d73, 0xc83e73, 0xca3e72, 0xcc3f71, 0xcd4071, 0xcf4070,
    0xd0416f, 0xd2426f, 0xd3436e, 0xd5446d, 0xd6456c, 0xd8456c, 0xd9466b, 0xdb476a, 0xdc4869,
    0xde4968, 0xdf4a68, 0xe04c67, 0xe24d66, 0xe34e65, 0xe44f64, 0xe55064, 0xe75263, 0xe85362,
    0xe95462, 0xea5661, 0xeb5760, 0xec5860, 0xed5a5f, 0xee5b5e, 0xef5d5e, 0xf05f5e, 0xf1605d,
    0xf2625d, 0xf2645c, 0xf3655c, 0xf4675c, 0xf4695c, 0xf56b5c, 0xf66c5c, 0xf66e5c, 0xf7705c,
    0xf7725c, 0xf8745c, 0xf8765c, 0xf9785d, 0xf9795d, 0xf97b5d, 0xfa7d5e, 0xfa7f5e, 0xfa815f,
    0xfb835f, 0xfb8560, 0xfb8761, 0xfc8961, 0xfc8a62, 0xfc8c63, 0xfc8e64, 0xfc9065, 0xfd9266,
    0xfd9467, 0xfd9668, 0xfd9869, 0xfd9a6a, 0xfd9b6b, 0xfe9d6c, 0xfe9f6d, 0xfea16e, 0xfea36f,
    0xfea571, 0xfea772, 0xfea973, 0xfeaa74, 0xfeac76, 0xfeae77, 0xfeb078, 0xfeb27a, 0xfeb47b,
    0xfeb67c, 0xfeb77e, 0xfeb97f, 0xfebb81, 0xfebd82, 0xfebf84, 0xfec185, 0xfec287, 0xfec488,
    0xfec68a, 0xfec88c, 0xfeca8d, 0xfecc8f, 0xfecd90, 0xfecf92, 0xfed194, 0xfed395, 0xfed597,
    0xfed799, 0xfed89a, 0xfdda9c, 0xfddc9e, 0xfddea0, 0xfde0a1, 0xfde2a3, 0xfde3a5, 0xfde5a7,
    0xfde7a9, 0xfde9aa, 0xfdebac, 0xfcecae, 0xfceeb0, 0xfcf0b2, 0xfcf2b4, 0xfcf4b6, 0xfcf6b8,
    0xfcf7b9, 0xfcf9bb, 0xfcfbbd, 0xfcfdbf,
];

#[cfg(test)]
mod tests {
    use super::super::color::{rgb_to_xyz, xyz_to_lab};
    use super::*;
    use wavecrest_core::math::srgb::srgb_decode;

    fn lab(color: [f32; 3]) -> [f64; 3] {
        xyz_to_lab(rgb_to_xyz(color.map(|value| f64::from(srgb_decode(value)))))
    }

    fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    #[test]
    fn magma_meets_its_table_and_goes_straight_between() {
        for (i, &color) in MAGMA.iter().enumerate() {
            let found = magma(i as f32 / 255.0);
            for (found, level) in found.into_iter().zip(levels(color)) {
                assert!((found - level / 255.0).abs() < 1e-6);
            }
        }
        let (low, high, middle) = (magma(0.0), magma(1.0 / 255.0), magma(0.5 / 255.0));
        assert!(
            middle.iter().zip(low).zip(high).all(|((m, l), h)| (m - 0.5 * (l + h)).abs() < 1e-6)
        );
    }

    #[test]
    fn what_lies_beyond_has_the_colour_of_the_end_and_what_is_no_number_is_black() {
        assert_eq!((magma(-1.0), magma(2.0)), (magma(0.0), magma(1.0)));
        assert_eq!((magma(f32::NEG_INFINITY), magma(f32::INFINITY)), (magma(0.0), magma(1.0)));
        assert_eq!((diverging(-9.0), diverging(9.0)), (diverging(-1.0), diverging(1.0)));
        assert_eq!((magma(f32::NAN), diverging(f32::NAN)), ([0.0; 3], [0.0; 3]));
    }

    #[test]
    fn many_colours_stay_distinct() {
        let colors: Vec<[f64; 3]> = (0..1000).map(|n| lab(distinct(n))).collect();
        assert!(colors.iter().all(|color| color[0] > 45.0));
        // Neighbouring numbers, as in a file, differ clearly: 2.3 is just noticeable.
        for window in colors.windows(12) {
            let others = window[1..].iter().map(|other| apart(window[0], *other));
            assert!(others.fold(f64::INFINITY, f64::min) > 10.0, "{window:?}");
        }
    }

    #[test]
    fn the_diverging_map_has_the_colours_of_the_paper() {
        // Moreland's colours; the polar coordinates in his table are rounded.
        for (t, expected) in [(-1.0, [59, 76, 192]), (0.0, [221, 221, 221]), (1.0, [180, 4, 38])] {
            let found = diverging(t).map(|value| value * 255.0);
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected as f32).abs() < 1.5, "{t}: {found} {expected}");
            }
        }
    }
}
