//! A bookshelf and its books.

use std::f64::consts::PI;

use glam::DVec3;

use super::builder::Builder;
use super::colour::Colour;
use super::pieces::Facets;
use super::place::Place;
use super::random::Random;
use super::solid::{BEVEL, MM};

/// Width, height and depth of the shelf.
pub(super) const SIZE: DVec3 = DVec3::new(1.5, 2.1, 0.32);
/// Thickness of its boards.
const BOARD: f64 = 0.024;
/// Rows of books, over a plinth.
const ROWS: u32 = 5;
const PLINTH: f64 = 0.1;
/// Books in a row.
const BOOKS: u32 = 26;

impl Builder {
    /// A bookshelf with its back against the plane z = 0.
    pub(super) fn bookshelf(&mut self, place: Place) {
        let half = SIZE.x / 2.0;
        let mut wood = Facets::default();
        wood.block(&place, [BOARD - half, 0.05, 0.0], [half - BOARD, SIZE.y - 0.03, 8.0 * MM]);
        for x in [-half, half - BOARD] {
            wood.board(&place, [x, 0.0, 0.0], [x + BOARD, SIZE.y, SIZE.z], BEVEL);
        }
        let inside = |low: [f64; 2], high: [f64; 2]| {
            ([BOARD - half, low[0], low[1]], [half - BOARD, high[0], high[1]])
        };
        let (low, high) = inside([0.0, SIZE.z - 0.05], [PLINTH - BOARD, SIZE.z - 0.03]);
        wood.board(&place, low, high, BEVEL);
        let pitch = (SIZE.y - PLINTH - 0.05) / f64::from(ROWS);
        for row in 0..=ROWS {
            let y = PLINTH + pitch * f64::from(row);
            let (low, high) = inside([y - BOARD, 0.0], [y, SIZE.z - 5.0 * MM]);
            wood.board(&place, low, high, BEVEL);
        }
        let top = [-half - 0.03, SIZE.y - 5.0 * MM, 0.0];
        wood.board(&place, top, [half + 0.03, SIZE.y + 0.03, SIZE.z + 0.03], 3.0 * BEVEL);
        self.facets(wood, Colour::WALNUT);
        for row in 0..ROWS {
            let y = PLINTH + pitch * f64::from(row);
            self.books(place.moved(BOARD - half, y, 0.03), SIZE.x - 2.0 * BOARD, pitch - BOARD);
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
        const COVER: f64 = 2.5 * MM;
        let height = room * random.between(0.62, 0.93);
        let depth = random.between(0.16, 0.22);
        let place = place.moved(0.0, 0.0, random.between(0.0, 0.04));
        let colour = random.one_of(&Colour::PRINTS);
        let mut covers = Facets::default();
        covers.block(&place, [0.0, 0.0, 0.0], [COVER, height, depth]);
        covers.block(&place, [thickness - COVER, 0.0, 0.0], [thickness, height, depth]);
        self.facets(covers, colour);
        let mut pages = Facets::default();
        let high = [thickness - COVER, height - 4.0 * MM, depth];
        pages.block(&place, [COVER, 4.0 * MM, 5.0 * MM], high);
        self.facets(pages, Colour::PAPER);
        let cells = [self.steps(0.04, 2.0, 4), self.steps(0.25, 0.5, 2)];
        let spine = move |u: f64, v: f64| {
            let (sin, cos) = libm::sincos(PI * u);
            let x = thickness / 2.0 * (1.0 - cos);
            // Bands run across the spine.
            let bands = 0.6 * MM * (1.0 - libm::cos(12.0 * PI * v));
            place.point(DVec3::new(x, height * v, depth + sin * (6.0 * MM + bands)))
        };
        self.sheet(cells, colour, Box::new(spine));
    }
}
