//! Things on furniture, and lamps: bodies with walls of a few millimetres, closed all around.

use std::f64::consts::PI;

use glam::DVec3;

use super::builder::Builder;
use super::colour::Colour;
use super::place::Place;
use super::profiles::{
    BOWL, CANDLE, CANDLESTICK, CUP, HANGING_SHADE, KNOB, POT_OF_TEA, SHADE, STAND,
};
use super::solids::{FINE, MM, TURNED};

/// The height of a hanging shade's lower edge below the ceiling.
const HANGS: f64 = 0.95;

impl Builder {
    pub(super) fn cup(&mut self, place: Place, colour: Colour) {
        self.lathe(place, CUP, FINE, colour);
        self.handle(place.moved(0.038, 0.042, 0.0), [0.027, 0.024], 3.5 * MM, colour);
    }

    /// A knob on a door or a drawer, which faces +z.
    pub(super) fn knob(&mut self, place: Place) {
        self.lathe(place.pitched(90.0), KNOB, FINE, Colour::BRASS);
    }

    pub(super) fn candle(&mut self, place: Place) {
        self.lathe(place, CANDLESTICK, FINE, Colour::BRASS);
        self.lathe(place.moved(0.0, 0.16, 0.0), CANDLE, FINE, Colour::PAPER);
    }

    pub(super) fn teapot(&mut self, place: Place, colour: Colour) {
        self.lathe(place, POT_OF_TEA, FINE, colour);
        self.handle(place.moved(-0.082, 0.068, 0.0).turned(180.0), [0.05, 0.042], 6.0 * MM, colour);
        self.tube(place, (0.16, FINE), DVec3::Z, colour, |t| {
            let rise = t * t * (3.0 - 2.0 * t);
            (DVec3::new(0.07 + 0.1 * t, 0.045 + 0.085 * rise, 0.0), 0.019 - 0.011 * t)
        });
    }

    /// Half a ring towards +x, of these half widths, around a point in the wall of a vessel.
    fn handle(&mut self, place: Place, [out, up]: [f64; 2], radius: f64, colour: Colour) {
        self.tube(place, (PI * out, FINE), DVec3::Z, colour, move |t| {
            let (sin, cos) = libm::sincos(PI * t);
            (DVec3::new(out * sin, -up * cos, 0.0), radius)
        });
    }

    /// Apples and lemons in a bowl.
    pub(super) fn fruit(&mut self, place: Place) {
        self.lathe(place.scaled(1.5), BOWL, FINE, Colour::GLAZE);
        let mut random = self.random();
        for i in 0..7_u32 {
            let (sin, cos) = libm::sincos(f64::from(i) * PI / 3.0);
            let (ring, height) = if i == 6 { (0.0, 0.115) } else { (0.075, 0.075) };
            let at = place.moved(ring * cos, height, ring * sin);
            let at = at.pitched(random.between(-40.0, 40.0)).turned(random.between(0.0, 360.0));
            let is_lemon = i % 3 == 1;
            let (length, colour) =
                if is_lemon { (0.046, Colour::LEMON) } else { (0.036, Colour::APPLE) };
            self.cushion(at, DVec3::new(0.037, length, 0.037), 0.95, FINE, colour);
        }
    }

    /// A lamp that hangs from `place` at the ceiling.
    pub(super) fn hanging_lamp(&mut self, place: Place) {
        let top = DVec3::new(0.0, -HANGS + 0.25, 0.0);
        self.rod(place, [DVec3::ZERO, top], 4.0 * MM, Colour::BRASS);
        self.lathe(place.moved(0.0, -HANGS, 0.0), HANGING_SHADE, TURNED, Colour::BRASS);
        let bulb = place.moved(0.0, 0.12 - HANGS, 0.0);
        self.cushion(bulb, DVec3::new(0.03, 0.045, 0.03), 0.95, 4.0, Colour::PAPER);
    }

    /// A lamp that stands on the floor.
    pub(super) fn standing_lamp(&mut self, place: Place) {
        self.lathe(place, STAND, TURNED, Colour::BRASS);
        self.lathe(place.moved(0.0, 1.36, 0.0), SHADE, TURNED, Colour::LINEN);
    }
}
