//! The shell of the room: floor, ceiling, walls with openings, and fixtures.

use glam::DVec2;

use super::builder::Builder;
use super::colour::Colour;
use super::pieces::Facets;
use super::place::Place;
use super::solid::{BEVEL, DOOR, MM, rectangle};

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

impl Builder {
    pub(super) fn shell(&mut self) {
        let mut floor = Facets::default();
        floor.panel(&Place::at(0.0, 0.0, 0.0).pitched(-90.0), -HALF, HALF, &[[0.0, 0.0]]);
        self.facets(floor, Colour::FLOOR);
        let mut ceiling = Facets::default();
        ceiling.panel(&Place::at(0.0, HEIGHT, 0.0).pitched(90.0), -HALF, HALF, &[[0.0, 0.0]]);
        self.facets(ceiling, Colour::CEILING);
        self.wall(back(), HALF.x, Some(&ENTRANCE));
        self.wall(left(), HALF.y, Some(&WINDOW));
        self.wall(right(), HALF.y, None);
        self.wall(front(), HALF.x, Some(&SMALL_WINDOW));
        self.window(left(), &WINDOW, [3, 2]);
        self.window(front(), &SMALL_WINDOW, [2, 2]);
        self.door(back(), &ENTRANCE);
        self.cornice();
    }

    /// A wall of two triangles, or of four mitred quads around its opening and the reveal.
    fn wall(&mut self, place: Place, half: f64, opening: Option<&Opening>) {
        let (low, high) = (DVec2::new(-half, 0.0), DVec2::new(half, HEIGHT));
        let mut wall = Facets::default();
        let Some(Opening { low: inner, high: upper }) = opening else {
            wall.panel(&place, low, high, &[[0.0, 0.0]]);
            return self.facets(wall, Colour::WALL);
        };
        let rings = [
            rectangle(&place, low, high, 0.0),
            rectangle(&place, *inner, *upper, 0.0),
            rectangle(&place, *inner, *upper, -THICKNESS),
        ];
        wall.between(&rings);
        self.facets(wall, Colour::WALL);
    }

    /// Frame and bars of a window with this number of panes, and a sill. It has no glass.
    fn window(&mut self, place: Place, opening: &Opening, panes: [u32; 2]) {
        let Opening { low, high } = *opening;
        let size = high - low;
        let mut wood = Facets::default();
        let frame = place.moved(0.0, 0.0, 0.06 - THICKNESS);
        let profile = [[0.0, 0.0], [0.0, 0.02], [0.045, 0.02], [0.055, 0.012], [0.055, -0.03]];
        wood.frames(&frame, low, high, &profile);
        for i in 1..panes[0] {
            let x = low.x + size.x * f64::from(i) / f64::from(panes[0]);
            wood.board(&frame, [x - 0.015, low.y, -0.02], [x + 0.015, high.y, 0.012], BEVEL);
        }
        for j in 1..panes[1] {
            let y = low.y + size.y * f64::from(j) / f64::from(panes[1]);
            wood.board(&frame, [low.x, y - 0.015, -0.025], [high.x, y + 0.015, 8.0 * MM], BEVEL);
        }
        let out = [low.x - 0.08, low.y - 0.035, -THICKNESS + 0.05];
        wood.board(&place, out, [high.x + 0.08, low.y, 0.09], 2.0 * BEVEL);
        architrave(&mut wood, &place, opening);
        self.facets(wood, Colour::PAINT);
    }

    /// A door with six panels, and its frame.
    fn door(&mut self, place: Place, opening: &Opening) {
        let Opening { low, high } = *opening;
        let mut wood = Facets::default();
        architrave(&mut wood, &place, opening);
        let leaf = place.moved(0.0, 0.0, -0.07);
        let size = (high - low) / DVec2::new(2.0, 3.0);
        wood.block(&leaf, [low.x, low.y, -0.03], [high.x, high.y, -MM]);
        for (i, j) in (0..2).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let corner = low + size * DVec2::new(f64::from(i), f64::from(j));
            wood.panel(&leaf, corner, corner + size, &DOOR);
        }
        self.facets(wood, Colour::PAINT);
        self.knob(leaf.moved(low.x + 0.06, 1.0, 0.02).scaled(1.6));
    }

    /// Skirting boards and a cornice: strips as long as the walls, millimetres high.
    fn cornice(&mut self) {
        let mut wood = Facets::default();
        let beside = [(-HALF.x, ENTRANCE.low.x - 0.07), (ENTRANCE.high.x + 0.07, HALF.x)];
        let long = [(back(), beside[0]), (back(), beside[1]), (front(), (-HALF.x, HALF.x))];
        let short = [left(), right()].map(|wall| (wall, (-HALF.y, HALF.y)));
        for (wall, (from, to)) in long.into_iter().chain(short) {
            wood.board(&wall, [from, 0.0, 0.0], [to, 0.11, 0.018], 2.0 * BEVEL);
        }
        let lying = Place::at(0.0, 0.0, 0.0).pitched(-90.0);
        let top = [0.09, 0.085, 0.06, 0.04, 0.025, 0.015, 0.0];
        let cornice = [0.0, 0.01, 0.02, 0.035, 0.06, 0.085, 0.09];
        let profile: Vec<[f64; 2]> =
            top.iter().zip(cornice).map(|(&down, inset)| [inset, HEIGHT - down]).collect();
        wood.frames(&lying, -HALF, HALF, &profile);
        self.facets(wood, Colour::PAINT);
    }

    /// A picture on a wall: a moulded frame, a mount and a print.
    pub(super) fn picture(&mut self, place: Place, half: DVec2) {
        let print = self.random().one_of(&Colour::PRINTS);
        let mut frame = Facets::default();
        let profile = [
            [0.0, 0.0],
            [0.0, 0.02],
            [6.0 * MM, 0.026],
            [0.02, 0.02],
            [0.03, 0.022],
            [0.034, 0.015],
            [0.036, 8.0 * MM],
        ];
        frame.frames(&place, -half, half, &profile);
        self.facets(frame, Colour::BRASS);
        let mut mount = Facets::default();
        mount.frames(&place, -half, half, &[[0.03, 8.0 * MM], [0.11, 8.0 * MM], [0.113, 6.0 * MM]]);
        self.facets(mount, Colour::PAPER);
        let mut picture = Facets::default();
        picture.panel(&place, -half, half, &[[0.113, 6.0 * MM]]);
        self.facets(picture, print);
    }
}

/// The moulding around an opening.
fn architrave(wood: &mut Facets, place: &Place, opening: &Opening) {
    /// Its width.
    const WIDTH: f64 = 0.07;
    let profile = [
        [0.0, 0.0],
        [0.0, 0.014],
        [5.0 * MM, 0.02],
        [0.02, 0.02],
        [0.024, 0.014],
        [WIDTH - 8.0 * MM, 0.014],
        [WIDTH, 8.0 * MM],
        [WIDTH, 0.0],
    ];
    wood.frames(place, opening.low - WIDTH, opening.high + WIDTH, &profile);
}
