//! A laid table and its chairs.

use glam::{DVec2, DVec3};

use super::builder::Builder;
use super::colour::Colour;
use super::pieces::Facets;
use super::place::Place;
use super::solid::{BEVEL, MM};

/// Half the size of the table's top.
pub(super) const HALF: DVec2 = DVec2::new(0.85, 0.5);
/// Height of its top, with the cloth.
pub(super) const TOP: f64 = 0.76;

/// The fineness of legs, relative to cloth.
const TURNED: f64 = 1.5;

const LEG: [[f64; 2]; 17] = [
    [0.1, 0.0],
    [1.6, 0.0],
    [2.2, 2.0],
    [1.4, 5.0],
    [2.0, 6.0],
    [2.0, 6.0],
    [2.6, 20.0],
    [3.2, 34.0],
    [2.0, 37.0],
    [3.4, 39.0],
    [2.0, 41.0],
    [3.0, 42.5],
    [3.0, 42.5],
    [3.0, 56.0],
    [3.0, 56.0],
    [2.6, 64.0],
    [0.1, 64.0],
];

impl Builder {
    /// A laid table with six chairs around it.
    pub(super) fn dining(&mut self, place: Place) {
        let mut wood = Facets::default();
        // Smaller than the cloth, so that it stays below a coarse one.
        let board = HALF - 0.03;
        let top = [board.x, TOP - 2.0 * MM, board.y];
        wood.board(&place, [-board.x, TOP - 0.035, -board.y], top, 2.0 * BEVEL);
        let (x, z) = (HALF.x - 0.09, HALF.y - 0.09);
        for side in [-1.0, 1.0] {
            let rail = [x, TOP - 0.036, side * z + 0.012];
            wood.block(&place, [-x, TOP - 0.13, side * z - 0.012], rail);
            let rail = [side * x + 0.012, TOP - 0.036, z];
            wood.block(&place, [side * x - 0.012, TOP - 0.13, -z], rail);
            for end in [-1.0, 1.0] {
                let leg = place.moved(side * x, 0.0, end * z).scaled(1.13);
                self.lathe(leg, &LEG, TURNED, Colour::OAK);
            }
        }
        self.facets(wood, Colour::OAK);
        self.drape(place.moved(0.0, TOP, 0.0), HALF, 0.24, Colour::LINEN);
        self.laid(place.moved(0.0, TOP + 3.0 * MM, 0.0));
        for (x, side) in [(-0.42, 1.0), (0.42, 1.0), (-0.42, -1.0), (0.42, -1.0)] {
            let turn = self.random().between(-9.0, 9.0) + if side < 0.0 { 180.0 } else { 0.0 };
            self.chair(place.moved(x, 0.0, side * (HALF.y + 0.2)).turned(turn));
        }
        for side in [-1.0, 1.0] {
            let turn = self.random().between(-12.0, 12.0) + side * 90.0;
            self.chair(place.moved(side * (HALF.x + 0.26), 0.0, 0.0).turned(turn));
        }
    }

    /// The things on the table.
    fn laid(&mut self, place: Place) {
        for (x, side) in [(-0.42, 1.0), (0.42, 1.0), (-0.42, -1.0), (0.42, -1.0)] {
            let seat = place.moved(x, 0.0, side * 0.33);
            let turn = self.random().between(-60.0, 60.0);
            self.plate(seat, Colour::CHINA);
            self.bowl(seat.moved(0.0, 6.0 * MM, 0.0).scaled(0.7), Colour::GLAZE);
            let saucer = place.moved(x + 0.22, 0.0, side * 0.26);
            self.plate(saucer.scaled(0.58), Colour::CHINA);
            self.cup(saucer.moved(0.0, 3.0 * MM, 0.0).turned(turn), Colour::CHINA);
            self.glass(place.moved(x - 0.19, 0.0, side * 0.22), Colour::GLAZE);
        }
        self.vase(place.moved(0.05, 0.0, 0.0), Colour::GLAZE);
        self.bouquet(place.moved(0.05, 0.24, 0.0));
        self.fruit(place.moved(-0.4, 0.0, 0.0));
        self.teapot(place.moved(0.42, 0.0, 0.02).turned(150.0), Colour::CHINA);
        self.candle(place.moved(-0.14, 0.0, 0.06));
        self.candle(place.moved(0.24, 0.0, -0.07));
    }

    /// A chair around the centre of its seat, with its back towards +z.
    pub(super) fn chair(&mut self, place: Place) {
        const HALF: f64 = 0.21;
        const SEAT: f64 = 0.45;
        let mut wood = Facets::default();
        wood.board(&place, [-HALF, SEAT - 0.03, -HALF], [HALF, SEAT, HALF], 2.0 * BEVEL);
        for side in [-1.0, 1.0] {
            let x = side * (HALF - 0.03);
            let apron = [x + 0.01, SEAT - 0.031, HALF - 0.02];
            wood.block(&place, [x - 0.01, SEAT - 0.08, -HALF + 0.02], apron);
            let rung = [HALF - 0.03, 0.2, x + 8.0 * MM];
            wood.board(&place, [0.03 - HALF, 0.18, x - 8.0 * MM], rung, BEVEL);
            for z in [0.03 - HALF, HALF - 0.03] {
                self.lathe(place.moved(x, 0.0, z).scaled(0.67), &LEG, TURNED, Colour::WALNUT);
            }
        }
        let back = place.moved(0.0, SEAT, HALF - 0.025).pitched(9.0);
        for x in [-HALF, HALF - 0.035] {
            wood.board(&back, [x, -0.01, -0.018], [x + 0.035, 0.52, 0.018], 2.0 * BEVEL);
        }
        for (y, height) in [(0.07, 0.04), (0.44, 0.075)] {
            let rail = [HALF - 0.034, y + height, 0.011];
            wood.board(&back, [0.034 - HALF, y, -0.011], rail, BEVEL);
        }
        for slat in -2..=2_i32 {
            let x = 0.065 * f64::from(slat);
            let high = [x + 0.014, 0.441, 6.0 * MM];
            wood.board(&back, [x - 0.014, 0.109, -6.0 * MM], high, 0.5 * BEVEL);
        }
        self.facets(wood, Colour::WALNUT);
        let half = DVec3::new(HALF - 0.012, 0.03, HALF - 0.03);
        let seat = place.moved(0.0, SEAT + 0.025, -0.012);
        self.cushion(seat, half, 0.35, 1.0, Colour::PILLOW);
    }
}
