//! The transfer curve of screens and most image files.

/// The linear value at which the straight segment near black ends (IEC 61966-2-1).
const LINE_END: f32 = 0.003_130_8;
/// The encoded value at the same point.
const ENCODED_LINE_END: f32 = 0.040_45;

/// The sRGB curve (IEC 61966-2-1) for one value, linear in and encoded out.
pub fn srgb_encode(value: f32) -> f32 {
    if value <= LINE_END {
        12.92 * value
    } else {
        // `libm`'s power function: the machine's may differ in the last bit.
        1.055 * libm::powf(value, 1.0 / 2.4) - 0.055
    }
}

/// The inverse of [`srgb_encode`]: encoded in and linear out.
pub fn srgb_decode(value: f32) -> f32 {
    if value <= ENCODED_LINE_END { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
}
