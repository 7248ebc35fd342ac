//! Lamps: a hanging one and a standing one.

use glam::DVec3;

use super::builder::Builder;
use super::colour::Colour;
use super::place::Place;
use super::solid::MM;

/// The height of a hanging shade's lower edge below the ceiling.
pub(super) const HANGS: f64 = 0.95;

const HANGING_SHADE: [[f64; 2]; 12] = [
    [0.6, 19.5],
    [3.0, 19.5],
    [10.0, 18.0],
    [22.0, 9.0],
    [25.6, -0.2],
    [26.2, -0.4],
    [26.0, 0.0],
    [23.0, 9.0],
    [10.0, 19.0],
    [3.0, 21.0],
    [2.0, 25.0],
    [0.6, 26.0],
];

const SHADE: [[f64; 2]; 8] = [
    [12.9, 26.8],
    [13.1, 26.6],
    [20.7, 0.0],
    [21.0, -0.3],
    [21.0, 0.0],
    [13.4, 27.0],
    [13.2, 27.2],
    [13.0, 27.0],
];

const STAND: [[f64; 2]; 15] = [
    [0.1, 0.0],
    [15.0, 0.0],
    [15.5, 0.6],
    [14.0, 1.6],
    [3.0, 2.4],
    [1.2, 6.0],
    [1.2, 60.0],
    [2.6, 62.0],
    [1.2, 64.0],
    [1.2, 120.0],
    [2.8, 123.0],
    [1.2, 126.0],
    [1.0, 140.0],
    [2.2, 142.0],
    [0.2, 148.0],
];

impl Builder {
    /// A lamp that hangs from `place` at the ceiling.
    pub(super) fn hanging_lamp(&mut self, place: Place) {
        let top = DVec3::new(0.0, -HANGS + 0.25, 0.0);
        self.rod(place, [DVec3::ZERO, top], 4.0 * MM, Colour::BRASS);
        self.lathe(place.moved(0.0, -HANGS, 0.0), &HANGING_SHADE, 1.5, Colour::BRASS);
        let bulb = place.moved(0.0, 0.12 - HANGS, 0.0);
        self.cushion(bulb, DVec3::new(0.03, 0.045, 0.03), 0.95, 4.0, Colour::PAPER);
    }

    /// A lamp that stands on the floor.
    pub(super) fn standing_lamp(&mut self, place: Place) {
        self.lathe(place, &STAND, 1.5, Colour::BRASS);
        self.lathe(place.moved(0.0, 1.36, 0.0), &SHADE, 1.5, Colour::LINEN);
    }
}
