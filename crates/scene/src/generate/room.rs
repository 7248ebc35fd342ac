//! A furnished room.
//!
//! Six metres by five, y up, with the centre of the floor at the origin. It has features of rooms
//! that scans lack: walls, floor and ceiling of a few triangles each, boards and mouldings with
//! long thin triangles, turned crockery and cloth as fine grids, and plants whose leaves share no
//! vertex. Areas differ by more than six orders of magnitude.
//!
//! The arrangement is the same for any number of triangles: more triangles make curved surfaces
//! finer, and leaves more and smaller. A fifth of the triangles are leaves, in the number that
//! gives the requested total.
//!
//! Everything is made of a few solids: boards and panels, turned bodies, tubes, cushions, cloth and
//! leaves. Functions of a [`Builder`] add one each, and those for a piece of furniture are lists of
//! them.

mod builder;
mod cloth;
mod colour;
mod facets;
mod furniture;
mod leaf;
mod place;
mod plants;
mod profiles;
mod random;
mod solids;
#[cfg(test)]
mod tests;
mod things;
mod walls;

use glam::{DVec2, DVec3, Vec2};

use super::surface::Surface;
use builder::{Builder, Piece};
use place::Place;

/// One in this many triangles belongs to a leaf.
const LEAF_SHARE: u64 = 5;
/// Edges per metre of the coarsest cloth.
const COARSEST: u64 = 4;
/// Bits of the edges per metre of the finest.
const DETAIL_BITS: u32 = 16;

/// The deepest folds of cloth, in metres: curtains must clear the wall.
pub(super) const MOST_FOLDS: f64 = 0.06;

/// A furnished room as a sequence of pieces.
pub(super) struct Room {
    /// Each piece with the number of its first vertex and first triangle.
    pieces: Vec<(u64, u64, Piece)>,
    vertices: u64,
    triangles: u64,
}

impl Room {
    /// A room of this number of triangles, at least [`fewest_triangles`], with cloth folds of
    /// `folds` metres.
    pub(super) fn new(triangles: u64, folds: f64, seed: u64) -> Self {
        let furniture = triangles - triangles / LEAF_SHARE;
        let mut builder = furnished(finest(furniture), folds, seed);
        builder.grow(triangles.saturating_sub(builder.triangles()));
        let (mut vertices, mut triangles) = (0, 0);
        let mut numbered = |piece: Piece| {
            let first = (vertices, triangles);
            vertices += piece.surface.vertices();
            triangles += piece.surface.triangles();
            (first.0, first.1, piece)
        };
        let pieces = builder.pieces.into_iter().map(&mut numbered).collect();
        Self { pieces, vertices, triangles }
    }

    /// The piece of vertex `v`, and the vertex's number there.
    fn piece(&self, v: u64) -> (&Piece, u64) {
        let after = self.pieces.partition_point(|&(first, ..)| first <= v);
        let (first, _, piece) = &self.pieces[after - 1];
        (piece, v - first)
    }
}

/// The smallest number of triangles that keeps furniture and plants recognisable.
pub(super) fn fewest_triangles() -> u64 {
    (furnished(COARSEST, 0.0, 0).triangles() * LEAF_SHARE).div_ceil(LEAF_SHARE - 1)
}

/// The finest detail at which everything but the leaves has at most this number of triangles.
fn finest(triangles: u64) -> u64 {
    let fits = |detail| furnished(detail, 0.0, 0).triangles() <= triangles;
    // Bit by bit, from the highest. With more bits, a square metre of cloth alone would have more
    // triangles than any mesh.
    (0..DETAIL_BITS)
        .rev()
        .map(|bit| 1 << bit)
        .fold(0, |detail, bit| if fits(detail | bit) { detail | bit } else { detail })
}

/// The room with all its furniture, and with plants that have no leaves yet.
fn furnished(detail: u64, folds: f64, seed: u64) -> Builder {
    let mut b = Builder { detail, folds, seed, ..Builder::default() };
    b.shell();
    b.rug(Place::at(0.15, 0.0, 0.1), DVec2::new(1.7, 1.25));
    b.bookshelf(walls::back().moved(-1.95, 0.0, 0.02));
    b.ivy(walls::back().moved(-2.35, furniture::SHELF.y + 0.03, 0.2), 9, 4);
    b.dresser(walls::back().moved(1.45, 0.0, 0.02));
    b.dining(Place::at(0.15, 0.0, 0.1));
    b.hanging_lamp(Place::at(0.15, walls::HEIGHT, 0.1));
    at_the_window(&mut b);
    b.sideboard(walls::right().moved(0.2, 0.0, 0.02));
    b.picture(walls::right().moved(0.2, 1.75, 0.0), DVec2::new(0.55, 0.4));
    b.picture(walls::back().moved(-0.27, 2.4, 0.0), DVec2::new(0.3, 0.2));
    b.picture(walls::left().moved(1.75, 1.6, 0.0), DVec2::new(0.28, 0.36));
    b.picture(walls::left().moved(-1.75, 1.6, 0.0), DVec2::new(0.28, 0.36));
    b.palm(Place::at(-1.55, 0.0, 1.95), 6);
    b.ficus(Place::at(-2.5, 0.0, -1.75), 1.75, 60);
    b
}

/// A sofa below the window, curtains, a lamp beside it, herbs on the sill.
fn at_the_window(b: &mut Builder) {
    let wall = walls::left();
    b.sofa(wall.moved(0.0, 0.0, 0.1), 3);
    b.standing_lamp(wall.moved(-1.5, 0.0, 0.4));
    let walls::Opening { low, high } = walls::WINDOW;
    let rod = wall.moved(0.0, high.y + 0.13, 0.11);
    let end = high.x + 0.45;
    let ends = [DVec3::NEG_X * end, DVec3::X * end];
    b.rod(rod, ends, 0.012, colour::Colour::BRASS);
    b.curtain(rod.moved(-end + 0.03, 0.0, 0.0), [0.55, 1.6], 7.0, 0.8);
    b.curtain(rod.moved(end - 0.58, 0.0, 0.0), [0.55, 1.6], 7.0, 0.8);
    for x in [-0.5, 0.1, 0.55] {
        b.herbs(wall.moved(x, low.y, -0.03), 8);
    }
}

impl Surface for Room {
    fn vertices(&self) -> u64 {
        self.vertices
    }

    fn triangles(&self) -> u64 {
        self.triangles
    }

    fn position(&self, v: u64) -> DVec3 {
        let (piece, v) = self.piece(v);
        piece.surface.position(v)
    }

    fn normal(&self, v: u64) -> DVec3 {
        let (piece, v) = self.piece(v);
        piece.surface.normal(v)
    }

    fn uv(&self, v: u64) -> Option<Vec2> {
        Some(self.piece(v).0.colour.uv())
    }

    fn triangle(&self, t: u64) -> [u32; 3] {
        let after = self.pieces.partition_point(|&(_, first, _)| first <= t);
        let (first_vertex, first, piece) = &self.pieces[after - 1];
        piece.surface.triangle(t - first).map(|v| v + *first_vertex as u32)
    }
}
