//! The difference of two filtered pixels, from 0 to 1 (sections 4.1.2 to 4.3 of the paper).

use std::f64::consts::FRAC_1_SQRT_2;

use super::super::color::{from_opponents, opponents, rgb_to_xyz, xyz_to_lab, xyz_to_rgb};

/// The exponent of colour distances (q_c), which gives small ones more weight.
const COLOR_POWER: f64 = 0.7;

/// Up to this part of the largest difference (p_c) ...
const KNEE_FROM: f64 = 0.4;

/// ... differences are spread over this part of the scale (p_t): larger ones hardly differ to the
/// eye.
const KNEE_TO: f64 = 0.95;

/// The strength of a pixel as part of an edge, and as a point.
#[derive(Clone, Copy)]
pub(super) struct Features {
    pub(super) edge: f64,
    pub(super) point: f64,
}

/// Compares two pixels; stores the constants.
pub(super) struct PixelComparer {
    /// The largest colour difference, raised to the exponent.
    largest: f64,
}

impl PixelComparer {
    pub(super) fn new() -> Self {
        let hunted = |rgb| hunt(xyz_to_lab(rgb_to_xyz(rgb)));
        // Green and blue are farthest apart.
        let farthest = hyab(hunted([0.0, 1.0, 0.0]), hunted([0.0, 0.0, 1.0]));
        Self { largest: libm::pow(farthest, COLOR_POWER) }
    }

    /// The difference of two colours in YCxCz, from 0 to 1.
    pub(super) fn of_colors(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let distance = hyab(perceived(a), perceived(b));
        if distance == 0.0 {
            return 0.0;
        }
        let part = libm::pow(distance, COLOR_POWER) / self.largest;
        // Filtered colours are clamped, but rounding may exceed the largest difference.
        if part < KNEE_FROM {
            part * (KNEE_TO / KNEE_FROM)
        } else {
            (KNEE_TO + (part - KNEE_FROM) / (1.0 - KNEE_FROM) * (1.0 - KNEE_TO)).min(1.0)
        }
    }

    /// The difference of two features, from 0 to 1.
    pub(super) fn of_features(&self, a: Features, b: Features) -> f64 {
        let difference = (a.edge - b.edge).abs().max((a.point - b.point).abs());
        // A feature may have strength 1 along both axes. The exponent q_f is a half.
        (difference * FRAC_1_SQRT_2).sqrt().min(1.0)
    }

    /// The total difference: the colour difference, amplified by the feature difference.
    pub(super) fn combined(&self, colors: f64, features: f64) -> f64 {
        // Equal colours show no difference, whatever surrounds them.
        if colors == 0.0 { 0.0 } else { libm::pow(colors, 1.0 - features) }
    }
}

/// A pixel's linear values as the light of a display, in YCxCz.
///
/// YCxCz has the axes of CIELAB without its roots, so averages are averages of light.
pub(super) fn shown(pixel: [f32; 3]) -> [f64; 3] {
    let light = |value: f32| if value > 0.0 { f64::from(value.min(1.0)) } else { 0.0 };
    opponents(rgb_to_xyz(pixel.map(light)))
}

/// A filtered colour, clamped to the gamut of a display, in CIELAB with the Hunt effect.
fn perceived(filtered: [f64; 3]) -> [f64; 3] {
    let rgb = xyz_to_rgb(from_opponents(filtered)).map(|value| value.clamp(0.0, 1.0));
    hunt(xyz_to_lab(rgb_to_xyz(rgb)))
}

/// The Hunt effect: darker colours appear less vivid.
fn hunt([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    [lightness, 0.01 * lightness * a, 0.01 * lightness * b]
}

/// The distance of Abasi, Tehran and Fairchild (*Distance metrics for very large color
/// differences*, 2020): lightness separate from the rest.
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [l, u, v] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    l.abs() + (u * u + v * v).sqrt()
}
