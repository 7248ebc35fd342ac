//! Cloth: fine grids that hang in folds.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec2, DVec3};

use super::builder::Builder;
use super::colour::Colour;
use super::place::Place;
use super::solids::MM;
use crate::generate::grid::Ends;
use crate::generate::noise::Fractal;

/// Crumple waves per metre of cloth.
const CRUMPLES: f64 = 9.0;
/// Depth of crumples, as a share of the folds.
const CRUMPLE_DEPTH: f64 = 0.08;

impl Builder {
    fn crumples(&mut self) -> Fractal {
        let seed = (self.random().unit() * f64::from(u32::MAX)) as u64;
        Fractal::new(seed, CRUMPLES, 1.0 / self.detail as f64)
    }

    /// A curtain in the plane z = 0 from the origin to `width` and down from y = 0, gathered to
    /// `gather` of its width at its bottom.
    pub(super) fn curtain(
        &mut self,
        place: Place,
        [width, height]: [f64; 2],
        folds: f64,
        gather: f64,
    ) {
        let (depth, crumples) = (self.folds, self.crumples());
        let phase = self.random().between(0.0, TAU);
        // Cloth is longer than the distance that it spans.
        let cells = [self.steps(2.0 * width, 1.0, 48), self.steps(height, 1.0, 12)];
        let shape = move |u: f64, v: f64| {
            let sway = 0.5 * libm::sin(2.0 * v + phase) + 0.3 * libm::sin(5.0 * v * u + phase);
            let wave = libm::sin(TAU * folds * u + phase + sway);
            let pinch = 1.0 - (1.0 - gather) * libm::sin(FRAC_PI_2 * v.min(1.0));
            let flat = DVec3::new(width * u * pinch, -height * v, 0.0);
            let z = depth * (0.55 + 0.45 * v) * wave
                + depth * CRUMPLE_DEPTH * crumples.sum(flat + DVec3::Z * wave * depth);
            place.point(flat.with_z(z))
        };
        self.grid(Ends::Open, cells, Colour::CURTAIN, shape);
    }

    /// A cloth over a table centred at `place` with these half sizes, which hangs down by `drop`
    /// all around.
    pub(super) fn drape(&mut self, place: Place, half: DVec2, drop: f64, colour: Colour) {
        /// The radius of the bend over the table's edge.
        const BEND: f64 = 0.012;
        /// Folds per metre of the edge.
        const FOLDS: f64 = 3.5;
        let (depth, crumples) = (self.folds, self.crumples());
        let size = (half + drop) * 2.0;
        let cells = [self.steps(size.x, 1.0, 24), self.steps(size.y, 1.0, 24)];
        let shape = move |u: f64, v: f64| {
            let flat = (DVec2::new(u, 1.0 - v) - 0.5) * size;
            let edge = flat.clamp(-half, half);
            let over = (flat - edge).length();
            let crumple = depth * CRUMPLE_DEPTH * crumples.sum(DVec3::new(flat.x, 0.0, flat.y));
            if over == 0.0 {
                return place.point(DVec3::new(flat.x, crumple.max(0.0), flat.y));
            }
            let outward = (flat - edge) / over;
            // Around the corners the cloth spreads like a cone.
            let across = 2.0 * outward.x * outward.y;
            let corner = across * across;
            let along = edge.x - edge.y + 0.2 * libm::atan2(outward.y, outward.x.abs());
            let (sin, cos) = libm::sincos((over / BEND).min(FRAC_PI_2));
            let hang = (over - BEND * FRAC_PI_2).max(0.0);
            let wave = 0.5 + 0.5 * libm::sin(TAU * FOLDS * along);
            let flare = hang / drop * depth * (wave + 3.0 * corner) + 0.12 * hang * corner;
            let out = edge + outward * (BEND * sin + flare + crumple.abs());
            place.point(DVec3::new(out.x, -BEND * (1.0 - cos) - hang * (1.0 - 0.1 * corner), out.y))
        };
        self.grid(Ends::Open, cells, colour, shape);
    }

    /// A rug on the floor around `place`, with a border.
    pub(super) fn rug(&mut self, place: Place, half: DVec2) {
        /// Width of the border.
        const BORDER: f64 = 0.18;
        let layers = [(half, 8.0 * MM, Colour::RUG_BORDER), (half - BORDER, 0.011, Colour::RUG)];
        for (half, height, colour) in layers {
            let crumples = self.crumples();
            let depth = self.folds.min(height) * 0.15;
            let cells = [self.steps(2.0 * half.x, 1.0, 8), self.steps(2.0 * half.y, 1.0, 8)];
            let shape = move |u: f64, v: f64| {
                let p = (DVec2::new(u, 1.0 - v) * 2.0 - 1.0) * half;
                let pile = depth * crumples.sum(DVec3::new(p.x, 0.0, p.y));
                place.point(DVec3::new(p.x, height + pile, p.y))
            };
            self.grid(Ends::Open, cells, colour, shape);
        }
    }
}
