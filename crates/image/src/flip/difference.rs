//! The difference of two filtered pixels, from 0 to 1 (sections 4.1.2 to 4.3 of the paper).

use std::f64::consts::FRAC_1_SQRT_2;

use super::super::color::{from_opponents, opponents, rgb_to_xyz, xyz_to_lab, xyz_to_rgb};

/// To this power a distance of colours is taken (q_c): small ones count for more.
const COLOR_POWER: f64 = 0.7;

/// Up to this part of the largest difference (p_c) ...
const KNEE_FROM: f64 = 0.4;

/// ... differences are spread over this part of the scale (p_t): what is larger hardly differs
/// to the eye.
const KNEE_TO: f64 = 0.95;

/// How strongly a pixel stands out as part of an edge, and as a point.
#[derive(Clone, Copy)]
pub(super) struct Features {
    pub(super) edge: f64,
    pub(super) point: f64,
}

/// Compares two pixels; holds what is the same for all.
pub(super) struct Difference {
    /// The largest difference of colours, to the power that is taken.
    largest: f64,
}

impl Difference {
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
        // The colours that filters leave are clamped, but roundings may reach beyond the largest.
        if part < KNEE_FROM {
            part * (KNEE_TO / KNEE_FROM)
        } else {
            (KNEE_TO + (part - KNEE_FROM) / (1.0 - KNEE_FROM) * (1.0 - KNEE_TO)).min(1.0)
        }
    }

    /// The difference of two features, from 0 to 1.
    pub(super) fn of_features(&self, a: Features, b: Features) -> f64 {
        let difference = (a.edge - b.edge).abs().max((a.point - b.point).abs());
        // Along both axes a feature may have the strength 1. The power q_f is a half.
        (difference * FRAC_1_SQRT_2).sqrt().min(1.0)
    }

    /// The whole difference: that of colours, the larger the more features differ.
    pub(super) fn combined(&self, colors: f64, features: f64) -> f64 {
        // Where the colours are the same nothing is seen, whatever surrounds them.
        if colors == 0.0 { 0.0 } else { libm::pow(colors, 1.0 - features) }
    }
}

/// A pixel's linear values as the light of a display, in YCxCz.
///
/// YCxCz has the axes of CIELAB, without its roots: averages are those of light.
pub(super) fn shown(pixel: [f32; 3]) -> [f64; 3] {
    let light = |value: f32| if value > 0.0 { f64::from(value.min(1.0)) } else { 0.0 };
    opponents(rgb_to_xyz(pixel.map(light)))
}

/// A filtered colour, clamped to what a display can show, in CIELAB after Hunt.
fn perceived(filtered: [f64; 3]) -> [f64; 3] {
    let rgb = xyz_to_rgb(from_opponents(filtered)).map(|value| value.clamp(0.0, 1.0));
    hunt(xyz_to_lab(rgb_to_xyz(rgb)))
}

/// Hunt's effect: colours are the less vivid the darker they are.
fn hunt([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    [lightness, 0.01 * lightness * a, 0.01 * lightness * b]
}

/// The distance of Abasi, Tehran and Fairchild (*Distance metrics for very large color
/// differences*, 2020): lightness apart from the rest.
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [l, u, v] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    l.abs() + (u * u + v * v).sqrt()
}
