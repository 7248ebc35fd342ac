//! The shell of the room: floor, ceiling, walls with openings, and fixtures.

use glam::DVec2;

use super::builder::Builder;
use super::colour::Colour;
use super::facets::{Facets, rectangle};
use super::place::Place;
use super::profiles::{
    ARCHITRAVE, DOOR, MOUNT, PICTURE_FRAME, PLAIN, PRINT, Profile, WINDOW_FRAME,
};
use super::solids::{BEVEL, MM};

/// Half the size of the room in x and z, in metres.
pub(super) const HALF: DVec2 = DVec2::new(3.0, 2.5);
/// Its height.
pub(super) const HEIGHT: f64 = 2.7;
/// Thickness of the walls at openings.
const THICKNESS: f64 = 0.22;

/// A hole in a wall, from the lower left to the upper right as seen from inside.
pub(super) struct Opening {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
}

/// The window in the left wall, in the space of that wall.
pub(super) const WINDOW: Opening =
    Opening { low: DVec2::new(-0.95, 0.85), high: DVec2::new(0.95, 2.2) };
/// The door in the back wall, above a threshold.
const ENTRANCE: Opening = Opening { low: DVec2::new(-0.72, 0.07), high: DVec2::new(0.18, 2.08) };
/// The window in the wall behind the camera.
const SMALL_WINDOW: Opening = Opening { low: DVec2::new(-0.7, 1.0), high: DVec2::new(0.7, 2.1) };

/// The walls as seen from inside: each is in the plane z = 0 of its space, and faces +z.
pub(super) fn back() -> Place {
    Place::at(0.0, 0.0, -HALF.y)
}

pub(super) fn left() -> Place {
    Place::at(-HALF.x, 0.0, 0.0).turned(90.0)
}

pub(super) fn right() -> Place {
    Place::at(HALF.x, 0.0, 0.0).turned(-90.0)
}

fn front() -> Place {
    Place::at(0.0, 0.0, HALF.y).turned(180.0)
}

/// Width of the moulding around an opening.
const SURROUND: f64 = 0.07;

impl Builder {
    pub(super) fn shell(&mut self) {
        let lying = |y: f64, degrees: f64| Place::at(0.0, y, 0.0).pitched(degrees);
        self.panel(lying(0.0, -90.0), HALF, PLAIN, Colour::FLOOR);
        self.panel(lying(HEIGHT, 90.0), HALF, PLAIN, Colour::CEILING);
        self.wall(back(), HALF.x, Some(&ENTRANCE));
        self.wall(left(), HALF.y, Some(&WINDOW));
        self.wall(right(), HALF.y, None);
        self.wall(front(), HALF.x, Some(&SMALL_WINDOW));
        self.window(left(), &WINDOW, [3, 2]);
        self.window(front(), &SMALL_WINDOW, [2, 2]);
        self.door(back(), &ENTRANCE);
        self.cornice();
    }

    /// A panel of one piece around the origin of `place`.
    fn panel(&mut self, place: Place, half: DVec2, profile: Profile, colour: Colour) {
        self.flat(colour, |facets| facets.panel(&place, -half, half, profile));
    }

    /// A wall of two triangles, or of four mitred quads around its opening and the reveal.
    fn wall(&mut self, place: Place, half: f64, opening: Option<&Opening>) {
        let (low, high) = (DVec2::new(-half, 0.0), DVec2::new(half, HEIGHT));
        self.flat(Colour::WALL, |wall| match opening {
            None => wall.panel(&place, low, high, PLAIN),
            Some(Opening { low: inner, high: upper }) => wall.between(&[
                rectangle(&place, low, high, 0.0),
                rectangle(&place, *inner, *upper, 0.0),
                rectangle(&place, *inner, *upper, -THICKNESS),
            ]),
        });
    }

    /// Frame and bars of a window with this number of panes, and a sill. It has no glass.
    fn window(&mut self, place: Place, opening: &Opening, panes: [u32; 2]) {
        let Opening { low, high } = *opening;
        let frame = place.moved(0.0, 0.0, 0.06 - THICKNESS);
        let bars = |axis: usize| {
            let size = high[axis] - low[axis];
            let place = move |i| low[axis] + size * f64::from(i) / f64::from(panes[axis]);
            (1..panes[axis]).map(place)
        };
        self.flat(Colour::PAINT, |wood| {
            wood.frames(&frame, low, high, WINDOW_FRAME);
            for x in bars(0) {
                wood.board(&frame, [x - 0.015, low.y, -0.02], [x + 0.015, high.y, 0.012], BEVEL);
            }
            for y in bars(1) {
                let (from, to) = ([low.x, y - 0.015, -0.025], [high.x, y + 0.015, 8.0 * MM]);
                wood.board(&frame, from, to, BEVEL);
            }
            let out = [low.x - 0.08, low.y - 0.035, -THICKNESS + 0.05];
            wood.board(&place, out, [high.x + 0.08, low.y, 0.09], 2.0 * BEVEL);
            surround(wood, &place, opening);
        });
    }

    /// A door with six panels, and its frame.
    fn door(&mut self, place: Place, opening: &Opening) {
        let Opening { low, high } = *opening;
        let leaf = place.moved(0.0, 0.0, -0.07);
        let size = (high - low) / DVec2::new(2.0, 3.0);
        self.flat(Colour::PAINT, |wood| {
            surround(wood, &place, opening);
            wood.board(&leaf, [low.x, low.y, -0.03], [high.x, high.y, -MM], 0.0);
            for (i, j) in (0..2).flat_map(|i| (0..3).map(move |j| (i, j))) {
                let corner = low + size * DVec2::new(f64::from(i), f64::from(j));
                wood.panel(&leaf, corner, corner + size, DOOR);
            }
        });
        self.knob(leaf.moved(low.x + 0.06, 1.0, 0.02).scaled(1.6));
    }

    /// Skirting boards and a cornice: strips as long as the walls, millimetres high.
    fn cornice(&mut self) {
        let beside = [(-HALF.x, ENTRANCE.low.x - 0.07), (ENTRANCE.high.x + 0.07, HALF.x)];
        let long = [(back(), beside[0]), (back(), beside[1]), (front(), (-HALF.x, HALF.x))];
        let short = [left(), right()].map(|wall| (wall, (-HALF.y, HALF.y)));
        let top = [0.09, 0.085, 0.06, 0.04, 0.025, 0.015, 0.0];
        let insets = [0.0, 0.01, 0.02, 0.035, 0.06, 0.085, 0.09];
        let profile: Vec<[f64; 2]> =
            top.iter().zip(insets).map(|(&down, inset)| [inset, HEIGHT - down]).collect();
        self.flat(Colour::PAINT, |wood| {
            for (wall, (from, to)) in long.into_iter().chain(short) {
                wood.board(&wall, [from, 0.0, 0.0], [to, 0.11, 0.018], 2.0 * BEVEL);
            }
            let lying = Place::at(0.0, 0.0, 0.0).pitched(-90.0);
            wood.frames(&lying, -HALF, HALF, &profile);
        });
    }

    /// A picture on a wall: a moulded frame, a mount and a print.
    pub(super) fn picture(&mut self, place: Place, half: DVec2) {
        let print = self.random().one_of(&Colour::PRINTS);
        for (colour, profile) in [(Colour::BRASS, PICTURE_FRAME), (Colour::PAPER, MOUNT)] {
            self.flat(colour, |frame| frame.frames(&place, -half, half, profile));
        }
        self.panel(place, half, PRINT, print);
    }
}

/// The moulding around an opening.
fn surround(wood: &mut Facets, place: &Place, opening: &Opening) {
    wood.frames(place, opening.low - SURROUND, opening.high + SURROUND, ARCHITRAVE);
}
