//! Cups, plates, bowls, vases: turned bodies with walls of a few millimetres, closed all around.

use std::f64::consts::PI;

use glam::DVec3;

use super::builder::Builder;
use super::colour::Colour;
use super::lathe::FINE;
use super::place::Place;
use super::solid::MM;

const CUP: [[f64; 2]; 12] = [
    [0.1, 0.3],
    [2.0, 0.3],
    [2.1, 0.0],
    [2.4, 0.0],
    [2.5, 0.5],
    [4.0, 2.5],
    [4.2, 7.2],
    [4.3, 7.5],
    [4.0, 7.5],
    [3.8, 3.0],
    [2.4, 0.7],
    [0.1, 0.6],
];

const PLATE: [[f64; 2]; 12] = [
    [0.1, 0.2],
    [6.0, 0.2],
    [6.1, 0.0],
    [6.6, 0.0],
    [6.8, 0.4],
    [9.0, 1.4],
    [12.8, 2.0],
    [13.0, 2.3],
    [12.6, 2.4],
    [9.0, 1.9],
    [7.6, 0.6],
    [0.1, 0.5],
];

const BOWL: [[f64; 2]; 11] = [
    [0.1, 0.4],
    [3.0, 0.4],
    [3.2, 0.0],
    [3.6, 0.0],
    [3.8, 0.8],
    [8.0, 2.5],
    [9.4, 7.0],
    [9.4, 7.4],
    [9.0, 7.2],
    [7.0, 2.0],
    [0.1, 0.9],
];

const VASE: [[f64; 2]; 14] = [
    [0.1, 0.2],
    [3.8, 0.2],
    [4.0, 0.0],
    [4.4, 0.2],
    [4.6, 3.0],
    [9.5, 9.0],
    [7.0, 18.0],
    [3.0, 20.0],
    [3.4, 24.0],
    [5.2, 26.0],
    [4.8, 26.2],
    [2.6, 20.5],
    [7.0, 14.0],
    [0.1, 2.0],
];

const POT_OF_TEA: [[f64; 2]; 17] = [
    [0.1, 0.3],
    [4.5, 0.3],
    [4.7, 0.0],
    [5.2, 0.0],
    [5.4, 0.8],
    [9.6, 3.0],
    [9.6, 10.0],
    [5.0, 12.4],
    [4.8, 12.4],
    [4.8, 12.4],
    [4.4, 12.8],
    [1.4, 13.8],
    [0.7, 14.0],
    [0.7, 14.6],
    [1.5, 15.2],
    [1.2, 16.2],
    [0.1, 16.4],
];

const GLASS: [[f64; 2]; 13] = [
    [0.1, 0.0],
    [3.2, 0.0],
    [3.4, 0.2],
    [0.5, 0.6],
    [0.4, 2.0],
    [0.4, 7.0],
    [1.2, 8.0],
    [4.2, 10.0],
    [3.4, 17.0],
    [3.3, 17.1],
    [3.2, 17.0],
    [4.0, 10.2],
    [0.1, 8.6],
];

const KNOB: [[f64; 2]; 7] =
    [[0.7, 0.0], [0.8, 0.0], [0.5, 0.5], [0.6, 1.2], [1.6, 1.6], [1.3, 2.4], [0.1, 2.5]];

const CANDLESTICK: [[f64; 2]; 15] = [
    [0.1, 0.0],
    [4.4, 0.0],
    [4.6, 0.3],
    [4.0, 1.0],
    [1.2, 1.4],
    [0.8, 3.0],
    [1.8, 4.2],
    [0.7, 5.4],
    [0.7, 12.0],
    [1.5, 13.0],
    [0.8, 14.0],
    [2.0, 16.0],
    [2.0, 16.4],
    [1.2, 16.4],
    [0.1, 16.0],
];

const CANDLE: [[f64; 2]; 8] = [
    [0.1, 0.0],
    [1.1, 0.0],
    [1.1, 0.0],
    [1.1, 18.0],
    [1.0, 18.2],
    [0.5, 17.8],
    [0.1, 17.9],
    [0.05, 18.8],
];

impl Builder {
    pub(super) fn cup(&mut self, place: Place, colour: Colour) {
        self.lathe(place, &CUP, FINE, colour);
        self.handle(place.moved(0.038, 0.042, 0.0), [0.027, 0.024], 3.5 * MM, colour);
    }

    pub(super) fn plate(&mut self, place: Place, colour: Colour) {
        self.lathe(place, &PLATE, FINE, colour);
    }

    pub(super) fn bowl(&mut self, place: Place, colour: Colour) {
        self.lathe(place, &BOWL, FINE, colour);
    }

    pub(super) fn vase(&mut self, place: Place, colour: Colour) {
        self.lathe(place, &VASE, FINE, colour);
    }

    pub(super) fn glass(&mut self, place: Place, colour: Colour) {
        self.lathe(place, &GLASS, FINE, colour);
    }

    /// A knob on a door or a drawer, which faces +z.
    pub(super) fn knob(&mut self, place: Place) {
        self.lathe(place.pitched(90.0), &KNOB, FINE, Colour::BRASS);
    }

    pub(super) fn candle(&mut self, place: Place) {
        self.lathe(place, &CANDLESTICK, FINE, Colour::BRASS);
        self.lathe(place.moved(0.0, 0.16, 0.0), &CANDLE, FINE, Colour::PAPER);
    }

    pub(super) fn teapot(&mut self, place: Place, colour: Colour) {
        self.lathe(place, &POT_OF_TEA, FINE, colour);
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
        self.bowl(place.scaled(1.5), Colour::GLAZE);
        let mut random = self.random();
        for i in 0..7_u32 {
            let (sin, cos) = libm::sincos(f64::from(i) * PI / 3.0);
            let (ring, height) = if i == 6 { (0.0, 0.115) } else { (0.075, 0.075) };
            let at = place.moved(ring * cos, height, ring * sin);
            let at = at.pitched(random.between(-40.0, 40.0)).turned(random.between(0.0, 360.0));
            let lemon = i % 3 == 1;
            let (length, colour) =
                if lemon { (0.046, Colour::LEMON) } else { (0.036, Colour::APPLE) };
            self.cushion(at, DVec3::new(0.037, length, 0.037), 0.95, FINE, colour);
        }
    }
}
