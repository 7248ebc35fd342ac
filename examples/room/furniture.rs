//! The furniture of the room: six metres by five, with the centre of the floor at the origin and y
//! up.

use glam::{DVec2, DVec3, dvec2};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_scene::mesh::MeshData;

use super::solids::{Colour, Place, Profile, Room};

const WALL: Colour = [214, 205, 186];
const WHITE: Colour = [238, 236, 230];
const FLOOR: Colour = [122, 88, 58];
const OAK: Colour = [168, 122, 74];
const WALNUT: Colour = [92, 58, 38];
const BLUE: Colour = [60, 104, 150];
const CLAY: Colour = [186, 100, 64];
const BRASS: Colour = [190, 148, 72];
const RUG: Colour = [150, 52, 48];
const BORDER: Colour = [66, 40, 52];
const SOFA: Colour = [88, 112, 118];
const PILLOW: Colour = [206, 164, 84];
/// Spines of books, and pictures.
const PRINTS: [Colour; 7] = [[44, 84, 66], [38, 62, 98], [86, 62, 92], RUG, CLAY, PILLOW, WHITE];

const PLATE: Profile = &[[0, 0], [66, 0], [76, 8], [130, 20], [130, 24], [76, 12], [0, 5]];
const CUP: Profile = &[[0, 0], [25, 0], [40, 25], [43, 75], [39, 75], [36, 30], [0, 8]];
const BOWL: Profile = &[[0, 0], [36, 0], [80, 25], [94, 74], [90, 74], [70, 20], [0, 9]];
const GLASS: Profile = &[[34, 0], [5, 6], [4, 70], [42, 90], [34, 170], [40, 102], [0, 86]];
const VASE: Profile = &[[44, 0], [46, 30], [100, 90], [60, 190], [20, 200], [52, 260], [0, 190]];
const POT: Profile =
    &[[124, 0], [160, 220], [182, 240], [182, 280], [150, 280], [150, 250], [0, 250]];
const TRUNK: Profile = &[[25, 0], [16, 300], [16, 800], [8, 1200]];
const LEG: Profile = &[[16, 0], [22, 20], [14, 50], [32, 370], [20, 400], [34, 430], [30, 700]];
const HANGING: Profile =
    &[[100, 180], [260, 0], [262, 0], [90, 200], [20, 215], [4, 260], [4, 950]];
const STAND: Profile = &[[150, 0], [140, 16], [12, 40], [12, 600], [12, 1400], [0, 1480]];
const SHADE: Profile = &[[130, 268], [207, 0], [210, 0], [134, 270]];

const HEIGHT: f64 = 2.7;
/// Lower left and upper right of the window in the left wall.
const WINDOW: [DVec2; 2] = [dvec2(-0.95, 0.85), dvec2(0.95, 2.2)];
/// Height of the table.
const TOP: f64 = 0.76;

/// The walls as seen from inside: each is in the plane z = 0 of its space.
fn back() -> Place {
    Place::at(0.0, 0.0, -2.5)
}

fn left() -> Place {
    Place::at(-3.0, 0.0, 0.0).turned(DVec3::Y, 90.0)
}

/// The room with this number of triangles: with more, what is round is finer, and leaves are more
/// and smaller.
pub(crate) fn room(triangles: usize) -> Result<MeshData> {
    let mut room = furnished(0);
    let Some(mut leaves) = triangles.checked_sub(room.triangles()) else {
        return Err(Error::new(ErrorKind::Usage, "a room needs more triangles")
            .value(triangles)
            .remedy(format!("write {} or more", room.triangles())));
    };
    for detail in 1.. {
        let finer = furnished(detail);
        // At least one in 32 is a leaf.
        let most = triangles - triangles / 32;
        if finer.triangles() > most {
            break;
        }
        (leaves, room) = (triangles - finer.triangles(), finer);
    }
    Ok(room.mesh(leaves))
}

fn furnished(detail: u32) -> Room {
    let mut room = Room::new(detail);
    room.shell();
    room.window();
    room.door(back().moved(-0.72, 0.0, 0.0));
    room.picture(back().moved(-0.57, 2.2, 0.0), [0.6, 0.4]);
    room.picture(left().moved(1.47, 1.3, 0.0), [0.5, 0.6]);
    room.picture(left().moved(-2.03, 1.3, 0.0), [0.5, 0.6]);
    room.bookshelf(back().moved(-2.6, 0.0, 0.02));
    room.dresser(back().moved(0.6, 0.0, 0.02));
    room.sofa(left().moved(0.0, 0.0, 0.1));
    room.table(Place::at(0.15, 0.0, 0.1));
    room.lamps();
    room.tree(Place::at(-2.5, 0.0, -1.75));
    room
}

impl Room {
    fn shell(&mut self) {
        let middle = Place::at(0.0, 0.0, 0.0);
        self.board(middle, [-3.0, -0.2, -2.5], [3.0, 0.0, 2.5], FLOOR);
        self.board(middle, [-3.2, HEIGHT, -2.7], [3.2, 2.9, 2.7], WHITE);
        self.board(middle, [3.0, -0.2, -2.7], [3.2, HEIGHT, 2.7], WALL);
        self.board(middle, [-3.2, -0.2, 2.5], [3.0, HEIGHT, 2.7], WALL);
        self.board(back(), [-3.2, -0.2, -0.2], [3.0, HEIGHT, 0.0], WALL);
        let [low, high] = WINDOW;
        self.board(left(), [-2.5, -0.2, -0.2], [2.5, low.y, 0.0], WALL);
        self.board(left(), [-2.5, high.y, -0.2], [2.5, HEIGHT, 0.0], WALL);
        self.board(left(), [-2.5, low.y, -0.2], [low.x, high.y, 0.0], WALL);
        self.board(left(), [high.x, low.y, -0.2], [2.5, high.y, 0.0], WALL);
        for (wall, half) in [(left(), 2.5), (back(), 3.0)] {
            self.board(wall, [-half, 0.0, 0.0], [half, 0.11, 0.02], WHITE);
            self.board(wall, [-half, 2.62, 0.0], [half, HEIGHT, 0.06], WHITE);
        }
        let rug = Place::at(0.15, 0.0, 0.1);
        self.board(rug, [-1.7, 0.0, -1.25], [1.7, 0.008, 1.25], BORDER);
        self.board(rug, [-1.52, 0.0, -1.07], [1.52, 0.011, 1.07], RUG);
    }

    /// Bars and sill of the window, which has no glass, and curtains.
    fn window(&mut self) {
        let [low, high] = WINDOW;
        for x in [low.x, -0.32, 0.32, high.x] {
            self.board(left(), [x - 0.02, low.y, -0.16], [x + 0.02, high.y, -0.12], WHITE);
        }
        for y in [low.y, 1.52, high.y] {
            self.board(left(), [low.x, y - 0.02, -0.17], [high.x, y + 0.02, -0.13], WHITE);
        }
        self.board(left(), [-1.03, low.y - 0.04, 0.0], [1.03, low.y, 0.06], WHITE);
        self.board(left(), [-1.4, 2.33, 0.1], [1.4, 2.35, 0.12], BRASS);
        self.curtain(left().moved(-1.37, 0.73, 0.11), dvec2(0.5, 1.6), CLAY);
        self.curtain(left().moved(0.87, 0.73, 0.11), dvec2(0.5, 1.6), CLAY);
    }

    fn door(&mut self, place: Place) {
        self.board(place, [-0.08, 0.0, 0.0], [0.98, 2.16, 0.02], WHITE);
        self.board(place, [0.0, 0.0, 0.0], [0.9, 2.08, 0.03], WHITE);
        for (x, y) in [0.08, 0.49].into_iter().flat_map(|x| [0.1, 0.75, 1.4].map(|y| (x, y))) {
            self.board(place, [x, y, 0.0], [x + 0.33, y + 0.55, 0.045], WHITE);
        }
        self.cushion(place.moved(0.05, 1.0, 0.05), [0.025; 3], 1, BRASS);
    }

    fn picture(&mut self, place: Place, [width, height]: [f64; 2]) {
        self.board(place, [0.0; 3], [width, height, 0.02], BRASS);
        self.board(place, [0.03, 0.03, 0.0], [width - 0.03, height - 0.03, 0.022], WHITE);
        self.board(place, [0.11, 0.11, 0.0], [width - 0.11, height - 0.11, 0.024], PRINTS[0]);
    }

    fn bookshelf(&mut self, place: Place) {
        self.board(place, [0.0; 3], [1.5, 2.1, 0.01], WALNUT);
        self.board(place, [0.0; 3], [0.025, 2.1, 0.32], WALNUT);
        self.board(place, [1.475, 0.0, 0.0], [1.5, 2.1, 0.32], WALNUT);
        for y in [0.1, 0.5, 0.9, 1.3, 1.7] {
            self.board(place, [0.0, y - 0.025, 0.0], [1.5, y, 0.31], WALNUT);
            let mut x = 0.03;
            while x < 1.4 {
                let (width, height) =
                    (self.random.between(0.03, 0.08), self.random.between(0.24, 0.34));
                let print = PRINTS[self.random.between(0.0, PRINTS.len() as f64) as usize];
                self.board(place, [x, y, 0.03], [x + width - 0.002, y + height, 0.24], print);
                x += width;
            }
        }
        self.board(place, [0.0, 2.075, 0.0], [1.5, 2.1, 0.31], WALNUT);
    }

    /// Shelves of crockery over a cupboard.
    fn dresser(&mut self, place: Place) {
        self.board(place, [0.0; 3], [1.7, 0.88, 0.44], OAK);
        self.board(place, [-0.02, 0.88, 0.0], [1.72, 0.9, 0.48], OAK);
        self.board(place, [0.03, 0.9, 0.0], [1.67, 2.1, 0.012], OAK);
        self.board(place, [0.03, 0.9, 0.0], [0.055, 2.1, 0.26], OAK);
        self.board(place, [1.645, 0.9, 0.0], [1.67, 2.1, 0.26], OAK);
        for y in [1.26, 1.64, 2.1] {
            self.board(place, [0.03, y, 0.0], [1.67, y + 0.025, 0.26], OAK);
        }
        for x in [0.0, 0.425, 0.85, 1.275] {
            for (low, high) in [(0.09, 0.69), (0.7, 0.86)] {
                self.board(place, [x + 0.005, low, 0.4], [x + 0.42, high, 0.455], OAK);
                self.cushion(place.moved(x + 0.21, high - 0.08, 0.465), [0.015; 3], 1, BRASS);
            }
            let leaning = |y: f64| place.moved(x + 0.22, y, 0.06).turned(DVec3::X, 76.0);
            self.lathe(leaning(1.415), PLATE, BLUE);
            self.lathe(leaning(1.82).scaled(1.2), PLATE, WHITE);
            self.lathe(place.moved(x + 0.4, 1.285, 0.17), CUP, WHITE);
            self.lathe(place.moved(x + 0.4, 1.665, 0.16).scaled(0.8), BOWL, BLUE);
            self.lathe(place.moved(x + 0.2, 0.9, 0.2), GLASS, WHITE);
        }
        self.lathe(place.moved(1.3, 0.9, 0.2).scaled(1.1), VASE, CLAY);
    }

    /// A laid table with six chairs around it.
    fn table(&mut self, place: Place) {
        for (x, z) in [(-0.7, -0.35), (-0.7, 0.35), (0.7, -0.35), (0.7, 0.35)] {
            self.lathe(place.moved(x, 0.0, z), LEG, OAK);
        }
        self.board(place, [-0.76, 0.7, -0.41], [0.76, TOP - 0.01, 0.41], OAK);
        let top = place.moved(0.0, TOP, 0.0);
        self.cloth(top, dvec2(0.85, 0.5), 0.24, WHITE);
        for (x, side) in [(-0.42, 1.0), (0.42, 1.0), (-0.42, -1.0), (0.42, -1.0)] {
            self.chair(place.moved(x, 0.0, side * 0.7), 90.0 - side * 90.0);
            let seat = top.moved(x, 0.0, side * 0.33);
            self.lathe(seat, PLATE, WHITE);
            self.lathe(seat.moved(0.0, 0.008, 0.0).scaled(0.7), BOWL, BLUE);
            self.lathe(seat.moved(0.22, 0.0, -0.06), CUP, WHITE);
            self.lathe(seat.moved(-0.19, 0.0, -0.06), GLASS, BLUE);
        }
        self.chair(place.moved(-1.11, 0.0, 0.0), -90.0);
        self.chair(place.moved(1.11, 0.0, 0.0), 90.0);
        self.lathe(top.moved(0.05, 0.0, 0.0), VASE, BLUE);
        self.crown(top.moved(0.05, 0.36, 0.0), [0.15, 0.13, 0.15]);
        let fruit = top.moved(-0.4, 0.0, 0.0);
        self.lathe(fruit.scaled(1.5), BOWL, BLUE);
        for (x, z) in [(-0.045, -0.03), (0.045, -0.03), (0.0, 0.05)] {
            self.cushion(fruit.moved(x, 0.08, z), [0.04; 3], 1, RUG);
        }
    }

    /// A chair around the centre of its seat, with its back towards +z before it is turned.
    fn chair(&mut self, place: Place, degrees: f64) {
        let place = place.turned(DVec3::Y, degrees + self.random.between(-10.0, 10.0));
        for (x, z) in [(-0.18, -0.18), (-0.18, 0.18), (0.18, -0.18), (0.18, 0.18)] {
            self.lathe(place.moved(x, 0.0, z).scaled(0.62), LEG, WALNUT);
        }
        self.board(place, [-0.21, 0.42, -0.21], [0.21, 0.45, 0.21], WALNUT);
        self.cushion(place.moved(0.0, 0.47, -0.01), [0.2, 0.03, 0.18], 2, PILLOW);
        let rest = place.moved(0.0, 0.45, 0.19).turned(DVec3::X, 9.0);
        for x in [-0.19, -0.1, 0.0, 0.1, 0.19] {
            self.board(rest, [x - 0.02, -0.01, -0.01], [x + 0.02, 0.45, 0.01], WALNUT);
        }
        self.board(rest, [-0.21, 0.44, -0.015], [0.21, 0.515, 0.015], WALNUT);
    }

    /// A sofa with three seats, with its back against the plane z = 0.
    fn sofa(&mut self, place: Place) {
        self.board(place, [-0.95, 0.1, 0.02], [0.95, 0.3, 0.82], SOFA);
        self.board(place, [-0.95, 0.3, 0.02], [0.95, 0.8, 0.12], SOFA);
        for side in [-1.0, 1.0] {
            self.board(place, [side - 0.05, 0.0, 0.7], [side + 0.05, 0.15, 0.8], WALNUT);
            self.cushion(place.moved(1.03 * side, 0.36, 0.46), [0.1, 0.25, 0.44], 2, SOFA);
            let pillow = place.moved(0.7 * side, 0.62, 0.36).turned(DVec3::Y, -20.0 * side);
            self.cushion(pillow.turned(DVec3::X, -25.0), [0.22, 0.2, 0.08], 2, PILLOW);
        }
        for x in [-0.62, 0.0, 0.62] {
            self.cushion(place.moved(x, 0.37, 0.53), [0.31, 0.1, 0.31], 3, SOFA);
            let rest = place.moved(x, 0.66, 0.2).turned(DVec3::X, -12.0);
            self.cushion(rest, [0.31, 0.25, 0.1], 3, SOFA);
        }
    }

    /// A lamp over the table, and one beside the sofa.
    fn lamps(&mut self) {
        let hanging = Place::at(0.15, HEIGHT - 0.95, 0.1);
        self.lathe(hanging, HANGING, BRASS);
        self.cushion(hanging.moved(0.0, 0.12, 0.0), [0.03, 0.045, 0.03], 1, WHITE);
        let standing = left().moved(-1.5, 0.0, 0.4);
        self.lathe(standing, STAND, BRASS);
        self.lathe(standing.moved(0.0, 1.36, 0.0), SHADE, WHITE);
    }

    fn tree(&mut self, place: Place) {
        self.lathe(place, POT, CLAY);
        self.lathe(place.moved(0.0, 0.2, 0.0), TRUNK, WALNUT);
        for _ in 0..14 {
            let [x, y, z] = [0.3, 0.4, 0.3].map(|reach| self.random.between(-reach, reach));
            self.crown(place.moved(x, 1.5 + y, z), [0.24, 0.2, 0.24]);
        }
    }
}
