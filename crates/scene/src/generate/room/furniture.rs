//! Furniture: a bookshelf, cupboards, a table with chairs, a sofa.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::builder::Builder;
use super::colour::Colour;
use super::place::Place;
use super::profiles::{BOWL, DOOR, DRAWER, GLASS, LEG, PLATE, VASE};
use super::random::Random;
use super::solids::{BEVEL, FINE, MM, TURNED};
use crate::generate::grid::Ends;

/// Width, height and depth of the bookshelf.
pub(super) const SHELF: DVec3 = DVec3::new(1.5, 2.1, 0.32);
/// Thickness of its boards.
const SHELF_BOARD: f64 = 0.024;
/// Rows of books, over a plinth.
const ROWS: u32 = 5;
const PLINTH: f64 = 0.1;
/// Books in a row.
const BOOKS: u32 = 26;
/// Thickness of their covers.
const COVER: f64 = 2.5 * MM;

/// Width, height and depth of a cupboard: the lower part of a dresser.
const CUPBOARD: DVec3 = DVec3::new(1.7, 0.9, 0.46);
/// Height and depth of the shelves above it.
const UPPER: DVec2 = DVec2::new(1.2, 0.26);
/// Thickness of its boards.
const BOARD: f64 = 0.025;
/// Doors and drawers side by side.
const DOORS: u32 = 4;

/// Half the size of the table's top.
const TABLE: DVec2 = DVec2::new(0.85, 0.5);
/// Height of its top, with the cloth.
const TOP: f64 = 0.76;
/// Half the width of a chair, and the height of its seat.
const CHAIR: f64 = 0.21;
const SEAT: f64 = 0.45;
/// The places at its long sides.
const PLACES: [(f64, f64); 4] = [(-0.42, 1.0), (0.42, 1.0), (-0.42, -1.0), (0.42, -1.0)];

/// Depth of a sofa's seat, from the front to the back rest; and its width.
const DEPTH: f64 = 0.62;
const WIDTH: f64 = 0.62;
/// Width of an arm.
const ARM: f64 = 0.2;

impl Builder {
    /// A bookshelf with its back against the plane z = 0.
    pub(super) fn bookshelf(&mut self, place: Place) {
        let half = SHELF.x / 2.0;
        let inner = half - SHELF_BOARD;
        let pitch = (SHELF.y - PLINTH - 0.05) / f64::from(ROWS);
        let height = |row: u32| PLINTH + pitch * f64::from(row);
        self.flat(Colour::WALNUT, |wood| {
            let mut board = |x: [f64; 2], y: [f64; 2], z: [f64; 2], bevel| {
                wood.board(&place, [x[0], y[0], z[0]], [x[1], y[1], z[1]], bevel);
            };
            let inside = [SHELF_BOARD - half, inner];
            board(inside, [0.05, SHELF.y - 0.03], [0.0, 8.0 * MM], 0.0);
            for x in [-half, inner] {
                board([x, x + SHELF_BOARD], [0.0, SHELF.y], [0.0, SHELF.z], BEVEL);
            }
            board(inside, [0.0, PLINTH - SHELF_BOARD], [SHELF.z - 0.05, SHELF.z - 0.03], BEVEL);
            for y in (0..=ROWS).map(height) {
                board(inside, [y - SHELF_BOARD, y], [0.0, SHELF.z - 5.0 * MM], BEVEL);
            }
            let (x, y) = ([-half - 0.03, half + 0.03], [SHELF.y - 5.0 * MM, SHELF.y + 0.03]);
            board(x, y, [0.0, SHELF.z + 0.03], 3.0 * BEVEL);
        });
        for y in (0..ROWS).map(height) {
            let row = place.moved(SHELF_BOARD - half, y, 0.03);
            self.books(row, SHELF.x - 2.0 * SHELF_BOARD, pitch - SHELF_BOARD);
        }
    }

    /// A row of books from x = 0 to `width`, no higher than `room`.
    fn books(&mut self, place: Place, width: f64, room: f64) {
        let mut random = self.random();
        let mut shares = [0.0; BOOKS as usize];
        shares.fill_with(|| random.between(0.5, 1.6));
        // Some room is left at the end, into which the last books lean.
        let unit = width * 0.94 / shares.iter().sum::<f64>();
        let mut x = 0.0;
        for (book, share) in shares.into_iter().enumerate() {
            let thickness = share * unit;
            let leans = book + 3 > shares.len();
            let lean = if leans { random.between(-7.0, -4.0) } else { 0.0 };
            let at = place.moved(x, 0.0, 0.0).rolled(lean);
            self.book(at, thickness - MM, room, &mut random);
            x += thickness + if leans { 8.0 * MM } else { 0.0 };
        }
    }

    /// A standing book: two covers, pages, and a round spine towards +z.
    fn book(&mut self, place: Place, thickness: f64, room: f64, random: &mut Random) {
        let height = room * random.between(0.62, 0.93);
        let depth = random.between(0.16, 0.22);
        let place = place.moved(0.0, 0.0, random.between(0.0, 0.04));
        let colour = random.one_of(&Colour::PRINTS);
        self.flat(colour, |covers| {
            covers.board(&place, [0.0; 3], [COVER, height, depth], 0.0);
            covers.board(&place, [thickness - COVER, 0.0, 0.0], [thickness, height, depth], 0.0);
        });
        self.flat(Colour::PAPER, |pages| {
            let high = [thickness - COVER, height - 4.0 * MM, depth];
            pages.board(&place, [COVER, 4.0 * MM, 5.0 * MM], high, 0.0);
        });
        let cells = [self.steps(0.04, 2.0, 4), self.steps(0.25, 0.5, 2)];
        self.grid(Ends::Open, cells, colour, move |u, v| {
            let (sin, cos) = libm::sincos(PI * u);
            let x = thickness / 2.0 * (1.0 - cos);
            // Bands run across the spine.
            let bands = 0.6 * MM * (1.0 - libm::cos(12.0 * PI * v));
            place.point(DVec3::new(x, height * v, depth + sin * (6.0 * MM + bands)))
        });
    }

    /// A dresser with its back against the plane z = 0: shelves of crockery over a cupboard.
    pub(super) fn dresser(&mut self, place: Place) {
        self.cupboard(place, Colour::OAK);
        let half = CUPBOARD.x / 2.0 - 0.03;
        let low = CUPBOARD.y;
        let shelves = [0.36, 0.74, UPPER.x].map(|up| low + up);
        self.flat(Colour::OAK, |wood| {
            let (inner, top) = (half - BOARD, low + UPPER.x);
            wood.board(&place, [BOARD - half, low, 0.0], [inner, top, 0.012], 0.0);
            for x in [-half, inner] {
                wood.board(&place, [x, low, 0.0], [x + BOARD, top, UPPER.y], BEVEL);
            }
            for y in shelves {
                let reach = if y == shelves[2] { half + 0.04 } else { inner };
                let depth = UPPER.y + reach - half + BOARD;
                wood.board(&place, [-reach, y, 0.0], [reach, y + BOARD, depth], 2.0 * BEVEL);
                // Leaning plates rest against this.
                let rail = [inner, y + BOARD + 0.012, 0.085];
                wood.board(&place, [-inner, y + BOARD, 0.075], rail, BEVEL);
            }
        });
        self.plates_and_cups(place.moved(0.0, shelves[0] + BOARD, 0.0), half);
        self.bowls_and_plates(place.moved(0.0, shelves[1] + BOARD, 0.0), half);
        self.top_of_dresser(place.moved(0.0, low, 0.0));
    }

    /// A row of drawers over a row of doors, all panelled.
    fn cupboard(&mut self, place: Place, colour: Colour) {
        let DVec3 { x: width, y: height, z: depth } = CUPBOARD;
        let half = width / 2.0;
        let front = place.moved(0.0, 0.0, depth - 0.02);
        let width = width / f64::from(DOORS);
        let columns = || (0..DOORS).map(|i| (i, width * f64::from(i) - half));
        let heights = [(0.7, height - BOARD - 4.0 * MM, DRAWER), (0.085, 0.694, DOOR)];
        for (i, x) in columns() {
            let (low, high, _) = heights[0];
            let side = if i % 2 == 0 { width - 0.03 } else { 0.03 };
            self.knob(front.moved(x + width / 2.0, (low + high) / 2.0, 0.02));
            self.knob(front.moved(x + side, 0.45, 0.02));
        }
        self.flat(colour, |wood| {
            wood.board(&place, [-half, 0.08, 0.0], [half, height - BOARD, depth - 0.021], 0.0);
            wood.board(&place, [0.04 - half, 0.0, 0.02], [half - 0.04, 0.08, depth - 0.07], 0.0);
            let out = half + 0.02;
            let top = [out, height, depth + 0.02];
            wood.board(&place, [-out, height - BOARD, 0.0], top, 2.0 * BEVEL);
            for (_, x) in columns() {
                for (low, high, profile) in heights {
                    let (from, to) = (x + 3.0 * MM, x + width - 3.0 * MM);
                    wood.panel(&front, DVec2::new(from, low), DVec2::new(to, high), profile);
                }
            }
        });
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
                self.lathe(at, BOWL, FINE, Colour::GLAZE);
                self.lathe(at.moved(0.0, 0.022, 0.0), BOWL, FINE, Colour::GLAZE);
                self.lathe(at.moved(0.0, 0.044, 0.0), BOWL, FINE, Colour::CHINA);
            }
        }
    }

    fn leaning_plate(&mut self, place: Place, colour: Colour) {
        self.lathe(place.moved(0.0, 0.128, 0.05).pitched(76.0), PLATE, FINE, colour);
    }

    fn top_of_dresser(&mut self, place: Place) {
        for i in 0..6_u32 {
            let at = place.moved(-0.6, 9.0 * MM * f64::from(i), 0.2);
            let colour = if i % 2 == 0 { Colour::CHINA } else { Colour::GLAZE };
            self.lathe(at, PLATE, FINE, colour);
        }
        self.teapot(place.moved(-0.22, 0.0, 0.24).turned(-25.0), Colour::GLAZE);
        for (i, j) in (0..4_u32).map(|k| (f64::from(k % 2), f64::from(k / 2))) {
            let at = place.moved(0.08 + 0.1 * i, 0.0, 0.16 + 0.11 * j);
            self.lathe(at, GLASS, FINE, Colour::CHINA);
        }
        self.lathe(place.moved(0.52, 0.0, 0.2).scaled(1.1), VASE, FINE, Colour::CLAY);
        self.candle(place.moved(0.74, 0.0, 0.3));
    }

    /// A cupboard with some things on it.
    pub(super) fn sideboard(&mut self, place: Place) {
        self.cupboard(place, Colour::WALNUT);
        let top = place.moved(0.0, CUPBOARD.y, 0.0);
        self.lathe(top.moved(-0.6, 0.0, 0.22).scaled(1.3), VASE, FINE, Colour::GLAZE);
        self.lathe(top.moved(-0.35, 0.0, 0.26).scaled(0.7), VASE, FINE, Colour::CHINA);
        self.candle(top.moved(0.42, 0.0, 0.2));
        self.candle(top.moved(0.6, 0.0, 0.28).scaled(1.2));
    }

    /// A laid table with six chairs around it.
    pub(super) fn dining(&mut self, place: Place) {
        let (x, z) = (TABLE.x - 0.09, TABLE.y - 0.09);
        for (side, end) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let leg = place.moved(side * x, 0.0, end * z).scaled(1.13);
            self.lathe(leg, LEG, TURNED, Colour::OAK);
        }
        self.flat(Colour::OAK, |wood| {
            // Smaller than the cloth, so that it stays below a coarse one.
            let board = TABLE - 0.03;
            let top = [board.x, TOP - 2.0 * MM, board.y];
            wood.board(&place, [-board.x, TOP - 0.035, -board.y], top, 2.0 * BEVEL);
            let (low, high) = (TOP - 0.13, TOP - 0.036);
            for (side, end) in [(-x, -z), (x, z)] {
                wood.board(&place, [-x, low, end - 0.012], [x, high, end + 0.012], 0.0);
                wood.board(&place, [side - 0.012, low, -z], [side + 0.012, high, z], 0.0);
            }
        });
        self.drape(place.moved(0.0, TOP, 0.0), TABLE, 0.24, Colour::LINEN);
        self.laid(place.moved(0.0, TOP + 3.0 * MM, 0.0));
        for (x, side) in PLACES {
            let turn = self.random().between(-9.0, 9.0) + if side < 0.0 { 180.0 } else { 0.0 };
            self.chair(place.moved(x, 0.0, side * (TABLE.y + 0.2)).turned(turn));
        }
        for side in [-1.0, 1.0] {
            let turn = self.random().between(-12.0, 12.0) + side * 90.0;
            self.chair(place.moved(side * (TABLE.x + 0.26), 0.0, 0.0).turned(turn));
        }
    }

    /// The things on the table.
    fn laid(&mut self, place: Place) {
        for (x, side) in PLACES {
            let seat = place.moved(x, 0.0, side * 0.33);
            let turn = self.random().between(-60.0, 60.0);
            self.lathe(seat, PLATE, FINE, Colour::CHINA);
            self.lathe(seat.moved(0.0, 6.0 * MM, 0.0).scaled(0.7), BOWL, FINE, Colour::GLAZE);
            let saucer = place.moved(x + 0.22, 0.0, side * 0.26);
            self.lathe(saucer.scaled(0.58), PLATE, FINE, Colour::CHINA);
            self.cup(saucer.moved(0.0, 3.0 * MM, 0.0).turned(turn), Colour::CHINA);
            self.lathe(place.moved(x - 0.19, 0.0, side * 0.22), GLASS, FINE, Colour::GLAZE);
        }
        self.lathe(place.moved(0.05, 0.0, 0.0), VASE, FINE, Colour::GLAZE);
        self.bouquet(place.moved(0.05, 0.24, 0.0));
        self.fruit(place.moved(-0.4, 0.0, 0.0));
        self.teapot(place.moved(0.42, 0.0, 0.02).turned(150.0), Colour::CHINA);
        self.candle(place.moved(-0.14, 0.0, 0.06));
        self.candle(place.moved(0.24, 0.0, -0.07));
    }

    /// A chair around the centre of its seat, with its back towards +z.
    fn chair(&mut self, place: Place) {
        let side = CHAIR - 0.03;
        for (x, z) in [(-side, -side), (-side, side), (side, -side), (side, side)] {
            self.lathe(place.moved(x, 0.0, z).scaled(0.67), LEG, TURNED, Colour::WALNUT);
        }
        self.flat(Colour::WALNUT, |wood| {
            wood.board(&place, [-CHAIR, SEAT - 0.03, -CHAIR], [CHAIR, SEAT, CHAIR], 2.0 * BEVEL);
            for x in [-side, side] {
                let apron = [x + 0.01, SEAT - 0.031, CHAIR - 0.02];
                wood.board(&place, [x - 0.01, SEAT - 0.08, -CHAIR + 0.02], apron, 0.0);
                let rung = [side, 0.2, x + 8.0 * MM];
                wood.board(&place, [-side, 0.18, x - 8.0 * MM], rung, BEVEL);
            }
            let back = place.moved(0.0, SEAT, CHAIR - 0.025).pitched(9.0);
            for x in [-CHAIR, CHAIR - 0.035] {
                wood.board(&back, [x, -0.01, -0.018], [x + 0.035, 0.52, 0.018], 2.0 * BEVEL);
            }
            for (y, height) in [(0.07, 0.04), (0.44, 0.075)] {
                let rail = [CHAIR - 0.034, y + height, 0.011];
                wood.board(&back, [0.034 - CHAIR, y, -0.011], rail, BEVEL);
            }
            for slat in -2..=2_i32 {
                let x = 0.065 * f64::from(slat);
                let high = [x + 0.014, 0.441, 6.0 * MM];
                wood.board(&back, [x - 0.014, 0.109, -6.0 * MM], high, 0.5 * BEVEL);
            }
        });
        let half = DVec3::new(CHAIR - 0.012, 0.03, CHAIR - 0.03);
        let seat = place.moved(0.0, SEAT + 0.025, -0.012);
        self.cushion(seat, half, 0.35, 1.0, Colour::PILLOW);
    }

    /// A sofa with this number of seats, with its back against the plane z = 0.
    pub(super) fn sofa(&mut self, place: Place, seats: u32) {
        let half = WIDTH * f64::from(seats) / 2.0;
        self.flat(Colour::WALNUT, |wood| {
            for (x, z) in [(-half, 0.1), (half, 0.1), (-half, 0.78), (half, 0.78)] {
                wood.board(&place, [x - 0.03, 0.0, z - 0.03], [x + 0.03, 0.13, z + 0.03], BEVEL);
            }
        });
        self.flat(Colour::SOFA, |frame| {
            let out = half + 0.02;
            frame.board(&place, [-out, 0.13, 0.04], [out, 0.3, 0.82], 4.0 * BEVEL);
            frame.board(&place, [-out, 0.3, 0.02], [out, 0.8, 0.12], 8.0 * BEVEL);
        });
        for i in 0..seats {
            let x = WIDTH * (f64::from(i) + 0.5) - half;
            let seat = place.moved(x, 0.37, 0.22 + DEPTH / 2.0);
            self.cushion(seat, DVec3::new(WIDTH / 2.0, 0.1, DEPTH / 2.0), 0.3, 1.0, Colour::SOFA);
            let rest = place.moved(x, 0.66, 0.2).pitched(-12.0);
            self.cushion(rest, DVec3::new(WIDTH / 2.0, 0.25, 0.1), 0.4, 1.0, Colour::SOFA);
        }
        for side in [-1.0, 1.0] {
            let arm = place.moved(side * (half + ARM / 2.0), 0.36, 0.46);
            self.cushion(arm, DVec3::new(ARM / 2.0, 0.25, 0.44), 0.3, 1.0, Colour::SOFA);
            let turn = self.random().between(8.0, 30.0) * -side;
            let pillow = place.moved(side * (half - 0.24), 0.62, 0.36).turned(turn).pitched(-25.0);
            let size = DVec3::new(0.22, 0.2, 0.075);
            self.cushion(pillow.rolled(side * 7.0), size, 0.6, 1.0, Colour::PILLOW);
        }
        let throw = place.moved(half + ARM / 2.0, 0.617, 0.5);
        self.drape(throw, DVec2::new(ARM / 2.0, 0.3), 0.2, Colour::THROW);
    }
}
