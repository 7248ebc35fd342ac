//! Cupboards: a dresser with crockery on its shelves, and a sideboard.

use glam::{DVec2, DVec3};

use super::builder::Builder;
use super::colour::Colour;
use super::pieces::Facets;
use super::place::Place;
use super::solid::{BEVEL, DOOR, DRAWER, MM};

/// Width, height and depth of the lower part of a dresser.
pub(super) const SIZE: DVec3 = DVec3::new(1.7, 0.9, 0.46);
/// Height and depth of the shelves above it.
const UPPER: DVec2 = DVec2::new(1.2, 0.26);
/// Thickness of boards.
const BOARD: f64 = 0.025;
/// Doors and drawers side by side.
const DOORS: u32 = 4;

impl Builder {
    /// A dresser with its back against the plane z = 0.
    pub(super) fn dresser(&mut self, place: Place) {
        self.cupboard(place, Colour::OAK);
        let half = SIZE.x / 2.0 - 0.03;
        let mut wood = Facets::default();
        let low = SIZE.y;
        wood.block(&place, [BOARD - half, low, 0.0], [half - BOARD, low + UPPER.x, 0.012]);
        for x in [-half, half - BOARD] {
            wood.board(&place, [x, low, 0.0], [x + BOARD, low + UPPER.x, UPPER.y], BEVEL);
        }
        let shelves = [0.36, 0.74, UPPER.x].map(|up| low + up);
        for y in shelves {
            let reach = if y == shelves[2] { half + 0.04 } else { half - BOARD };
            let depth = UPPER.y + reach - half + BOARD;
            wood.board(&place, [-reach, y, 0.0], [reach, y + BOARD, depth], 2.0 * BEVEL);
            // Leaning plates rest against this.
            let rail = [half - BOARD, y + BOARD + 0.012, 0.085];
            wood.board(&place, [-rail[0], y + BOARD, 0.075], rail, BEVEL);
        }
        self.facets(wood, Colour::OAK);
        self.plates_and_cups(place.moved(0.0, shelves[0] + BOARD, 0.0), half);
        self.bowls_and_plates(place.moved(0.0, shelves[1] + BOARD, 0.0), half);
        self.top_of_dresser(place.moved(0.0, low, 0.0));
    }

    /// The lower part: a row of drawers over a row of doors, all panelled.
    fn cupboard(&mut self, place: Place, colour: Colour) {
        let half = SIZE.x / 2.0;
        let mut wood = Facets::default();
        wood.block(&place, [-half, 0.08, 0.0], [half, SIZE.y - BOARD, SIZE.z - 0.021]);
        wood.block(&place, [0.04 - half, 0.0, 0.02], [half - 0.04, 0.08, SIZE.z - 0.07]);
        let out = half + 0.02;
        let top = [out, SIZE.y, SIZE.z + 0.02];
        wood.board(&place, [-out, SIZE.y - BOARD, 0.0], top, 2.0 * BEVEL);
        let front = place.moved(0.0, 0.0, SIZE.z - 0.02);
        let width = SIZE.x / f64::from(DOORS);
        for i in 0..DOORS {
            let x = width * f64::from(i) - half;
            let rect = |y0: f64, y1: f64| {
                (DVec2::new(x + 3.0 * MM, y0), DVec2::new(x + width - 3.0 * MM, y1))
            };
            let (low, high) = rect(0.7, SIZE.y - BOARD - 4.0 * MM);
            wood.panel(&front, low, high, &DRAWER);
            self.knob(front.moved(x + width / 2.0, (low.y + high.y) / 2.0, 0.02));
            let (low, high) = rect(0.085, 0.694);
            wood.panel(&front, low, high, &DOOR);
            let side = if i % 2 == 0 { width - 0.03 } else { 0.03 };
            self.knob(front.moved(x + side, 0.45, 0.02));
        }
        self.facets(wood, colour);
    }

    /// Plates leaning at the back, with cups in front of them.
    fn plates_and_cups(&mut self, place: Place, half: f64) {
        let mut random = self.random();
        for i in 0..5_u32 {
            let x = -half + 0.19 + (2.0 * half - 0.38) * f64::from(i) / 4.0;
            self.leaning_plate(place.moved(x, 0.0, 0.0), Colour::GLAZE);
        }
        for i in 0..8_u32 {
            let x = -half + 0.11 + (2.0 * half - 0.22) * f64::from(i) / 7.0;
            let at = place.moved(x, 0.0, 0.18 + random.between(-0.015, 0.015));
            self.cup(at.turned(random.between(-80.0, 20.0)), Colour::CHINA);
        }
    }

    /// Bowls, nested and side by side, in front of larger plates.
    fn bowls_and_plates(&mut self, place: Place, half: f64) {
        for i in 0..4_u32 {
            let x = -half + 0.22 + (2.0 * half - 0.44) * f64::from(i) / 3.0;
            self.leaning_plate(place.moved(x, 0.0, 0.0).scaled(1.2), Colour::CHINA);
            let at = place.moved(x + 0.19, 0.0, 0.15).scaled(0.75);
            if i < 3 {
                self.bowl(at, Colour::GLAZE);
                self.bowl(at.moved(0.0, 0.022, 0.0), Colour::GLAZE);
                self.bowl(at.moved(0.0, 0.044, 0.0), Colour::CHINA);
            }
        }
    }

    fn leaning_plate(&mut self, place: Place, colour: Colour) {
        self.plate(place.moved(0.0, 0.128, 0.05).pitched(76.0), colour);
    }

    fn top_of_dresser(&mut self, place: Place) {
        for i in 0..6_u32 {
            let at = place.moved(-0.6, 9.0 * MM * f64::from(i), 0.2);
            self.plate(at, if i % 2 == 0 { Colour::CHINA } else { Colour::GLAZE });
        }
        self.teapot(place.moved(-0.22, 0.0, 0.24).turned(-25.0), Colour::GLAZE);
        for i in 0..4_u32 {
            self.glass(
                place.moved(0.08 + 0.1 * f64::from(i % 2), 0.0, 0.16 + 0.11 * f64::from(i / 2)),
                Colour::CHINA,
            );
        }
        self.vase(place.moved(0.52, 0.0, 0.2).scaled(1.1), Colour::CLAY);
        self.candle(place.moved(0.74, 0.0, 0.3));
    }

    /// A cupboard with only the lower part, and some things on it.
    pub(super) fn sideboard(&mut self, place: Place) {
        self.cupboard(place, Colour::WALNUT);
        let top = place.moved(0.0, SIZE.y, 0.0);
        self.vase(top.moved(-0.6, 0.0, 0.22).scaled(1.3), Colour::GLAZE);
        self.vase(top.moved(-0.35, 0.0, 0.26).scaled(0.7), Colour::CHINA);
        self.candle(top.moved(0.42, 0.0, 0.2));
        self.candle(top.moved(0.6, 0.0, 0.28).scaled(1.2));
    }
}
