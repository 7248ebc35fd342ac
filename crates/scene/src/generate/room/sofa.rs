//! A sofa and an armchair.

use glam::{DVec2, DVec3};

use super::builder::Builder;
use super::colour::Colour;
use super::pieces::Facets;
use super::place::Place;
use super::solid::BEVEL;

/// Depth of a seat, from the front to the back rest.
const DEPTH: f64 = 0.62;
/// Width of a seat.
const SEAT: f64 = 0.62;
/// Width of an arm.
const ARM: f64 = 0.2;

impl Builder {
    /// A sofa with this number of seats, with its back against the plane z = 0.
    pub(super) fn sofa(&mut self, place: Place, seats: u32) {
        let half = SEAT * f64::from(seats) / 2.0;
        self.base(place, half);
        for i in 0..seats {
            let x = SEAT * (f64::from(i) + 0.5) - half;
            let seat = place.moved(x, 0.37, 0.22 + DEPTH / 2.0);
            self.cushion(seat, DVec3::new(SEAT / 2.0, 0.1, DEPTH / 2.0), 0.3, 1.0, Colour::SOFA);
            let rest = place.moved(x, 0.66, 0.2).pitched(-12.0);
            self.cushion(rest, DVec3::new(SEAT / 2.0, 0.25, 0.1), 0.4, 1.0, Colour::SOFA);
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

    /// The base below the cushions.
    fn base(&mut self, place: Place, half: f64) {
        let mut wood = Facets::default();
        for (x, z) in [(-half, 0.1), (half, 0.1), (-half, 0.78), (half, 0.78)] {
            wood.board(&place, [x - 0.03, 0.0, z - 0.03], [x + 0.03, 0.13, z + 0.03], BEVEL);
        }
        self.facets(wood, Colour::WALNUT);
        let mut frame = Facets::default();
        let out = half + 0.02;
        frame.board(&place, [-out, 0.13, 0.04], [out, 0.3, 0.82], 4.0 * BEVEL);
        frame.board(&place, [-out, 0.3, 0.02], [out, 0.8, 0.12], 8.0 * BEVEL);
        self.facets(frame, Colour::SOFA);
    }
}
