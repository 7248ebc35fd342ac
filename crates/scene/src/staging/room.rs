//! Recognises rooms: files that should be seen from inside.
//!
//! A room has walls at the ends of its box. What decides is what is between them: something, and
//! room to look at it, whichever way the walls face. Where nothing is, a room must show the backs of
//! its walls outward and be open somewhere: a box is closed, and a solid block shows its fronts.
//! What is in closed solids, such as moulds and rows of blocks, is no room to look from, even if they
//! are inside out. If one wall
//! is missing, as in a doll's house or in the Cornell box, the room is seen from outside through the
//! open side.

use glam::DVec3;

use super::grid::{COLUMNS, ColumnHits, Grid, across};
use super::{Scenery, visible};
use crate::options::framing::Up;
use crate::systems::bounds::Ends;

/// Largest distance of a wall from the end of the box, as a share of the room's length.
const WALL_DEPTH: f64 = 0.1;
/// Smallest share of its side that a wall covers: there are windows and doors.
const WALL: f64 = 0.6;
/// Largest covered share of an open side.
const OPEN: f64 = 0.25;
/// Smallest share of outer hits that show their back.
const BACKS: f64 = 0.6;
/// Smallest covered share of each side of a closed box.
const CLOSED: f64 = 0.98;
/// Smallest length of the free way through the centre, as a share of the room's, in half of the
/// columns.
const FREE: f64 = 0.5;
/// Hits farther from both ends than this share of the distance are furniture,
const FURNITURE_DEPTH: f64 = 0.15;
/// which must be in at least this share of the columns.
const FURNITURE: f64 = 0.1;
/// Share of the columns whose way through the centre has a front at one end and a back at the other,
/// which a file of closed solids alone may have in any case.
const MIXED: f64 = 0.02;
/// Height of the eye as a share of the room's: 1.5 of 2.6 metres.
const EYE: f64 = 0.58;
/// Length of the lamp as a share of the room's, in both directions.
const LAMP: f64 = 0.2;
/// Free space above it, as a share of the room's height.
const ABOVE_LAMP: f64 = 0.03;
/// Free space between the eye and what is behind it, as a share of the distance in front of it.
const BEHIND: f64 = 0.03;

/// How to show a room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Room {
    /// From inside: the eye, its look-at point, and the corners of a flat lamp under the ceiling,
    /// in order.
    Closed { eye: DVec3, look: DVec3, lamp: [DVec3; 4] },
    /// From outside, from the side that this axis vector points to.
    Open(DVec3),
}

impl Room {
    /// A description for the user.
    pub(super) fn told(self) -> &'static str {
        match self {
            Self::Closed { .. } => "a room, seen from inside (change with --view); ",
            Self::Open(_) => "a room, seen through its open side (change with --view); ",
        }
    }
}

/// One side of the box around a file.
struct BoxSide {
    axis: usize,
    is_high: bool,
    /// The share of it that a wall covers.
    covered: f64,
    /// The share of the wall that faces inward.
    inward: f64,
}

impl BoxSide {
    fn of(grid: &Grid, axis: usize, is_high: bool) -> Self {
        let (mut wall, mut inward) = (0u32, 0u32);
        for met in grid.along(axis).iter().filter_map(|c| c.ends).map(|e| e[usize::from(is_high)]) {
            let depth = if is_high { 1.0 - met.at } else { met.at };
            if depth <= WALL_DEPTH {
                wall += 1;
                inward += u32::from(met.faces_high != is_high);
            }
        }
        let covered = f64::from(wall) / grid.along(axis).len() as f64;
        Self { axis, is_high, covered, inward: f64::from(inward) / f64::from(wall.max(1)) }
    }

    fn is_wall(&self) -> bool {
        self.covered >= WALL
    }

    /// The outward normal.
    fn normal(&self) -> DVec3 {
        let mut normal = DVec3::ZERO;
        normal[self.axis] = if self.is_high { 1.0 } else { -1.0 };
        normal
    }
}

/// The room that the `contents` are, if they are one.
pub(super) fn find(grid: &Grid, contents: &Scenery<'_>, up: Up) -> Option<Room> {
    let ends = &contents.ends;
    let upward = up.axes().y_axis;
    let sides = [0, 1, 2].map(|axis| [false, true].map(|is_high| BoxSide::of(grid, axis, is_high)));
    let sides = sides.as_flattened();
    let is_floor = |side: &&BoxSide| side.normal() == -upward;
    let around = || sides.iter().filter(|side| side.normal().dot(upward) == 0.0);
    let walls = || sides.iter().filter(|side| side.is_wall());
    let inward = walls().map(|side| side.inward).sum::<f64>() / walls().count().max(1) as f64;
    let is_closed = sides.iter().all(|side| side.covered >= CLOSED);
    let (backs, are_solids) = solids(grid);
    // The walls of a room show their fronts to its middle; those of a mould turned inside out do not.
    let is_mould = are_solids && backs >= FURNITURE;
    let shows_backs = inward >= BACKS && !is_mould && !(is_closed && is_empty(contents));
    let is_furnished = || walls().count() == sides.len() && is_furnished(grid, are_solids);
    if !sides.iter().find(is_floor)?.is_wall() || !(shows_backs || is_furnished()) {
        return None;
    }
    let open: Vec<&BoxSide> = around().filter(|side| !side.is_wall()).collect();
    match open[..] {
        [] => Some(inside(grid, ends, upward)),
        [side] if side.covered <= OPEN => Some(Room::Open(side.normal())),
        _ => None,
    }
}

/// Whether everything is near the walls.
fn is_empty(contents: &Scenery<'_>) -> bool {
    let [low, high] = contents.ends;
    let is_near = |point: DVec3| {
        let share = (point - low) / (high - low);
        share.min(1.0 - share).min_element() <= FURNITURE_DEPTH
    };
    contents.blocks().flat_map(|block| visible(block, 1)).all(is_near)
}

/// The columns along all axes.
fn columns(grid: &Grid) -> impl Iterator<Item = &ColumnHits> {
    (0..3).flat_map(|axis| grid.along(axis))
}

/// The share of the columns that are such.
fn share(grid: &Grid, is: impl Fn(&ColumnHits) -> bool) -> f64 {
    columns(grid).filter(|column| is(column)).count() as f64 / columns(grid).count() as f64
}

/// Whether the ends of the way through the centre of a column show it their backs.
fn backs(column: &ColumnHits) -> Option<[bool; 2]> {
    Some([!column.below?.faces_high, column.above?.faces_high])
}

/// The share of the columns that show their backs to the centre at both ends; and whether all is closed
/// solids: what they have is two backs around a part or two fronts around a gap, so that the ends agree.
fn solids(grid: &Grid) -> (f64, bool) {
    let of = |ends: [bool; 2]| share(grid, |column| backs(column) == Some(ends));
    let (fronts, backs) = (of([false; 2]), of([true; 2]));
    let mixed = of([false, true]) + of([true, false]);
    // Were the ends independent of each other, the former would be twice the root.
    (backs, mixed <= MIXED.max((fronts * backs).sqrt()))
}

/// Whether there is something that is no wall, and room around the centre.
fn is_furnished(grid: &Grid, are_solids: bool) -> bool {
    let is_in_solid = |column: &ColumnHits| are_solids && backs(column) == Some([true; 2]);
    let is_met = |column: &ColumnHits| {
        let [from, to] = free(column);
        from.max(1.0 - to) > FURNITURE_DEPTH
    };
    let is_free = |column: &ColumnHits| {
        let [from, to] = free(column);
        to - from >= FREE && !is_in_solid(column)
    };
    share(grid, is_met) >= FURNITURE && share(grid, is_free) >= 0.5
}

/// The view from one end of the longer axis to the other, along the freest line near the middle.
pub(super) fn inside(grid: &Grid, &[low, high]: &Ends, upward: DVec3) -> Room {
    let size = high - low;
    let vertical = upward.abs().max_position();
    let across = across(vertical);
    let is_first = size[across[0]] > size[across[1]];
    let [long, side] = if is_first { across } else { [across[1], across[0]] };
    let height = 0.5 + (EYE - 0.5) * upward[vertical].signum();
    let cell = (height * COLUMNS as f64) as usize;
    let column = |at: usize| {
        let [column, row] = if (long + 1) % 3 == vertical { [cell, at] } else { [at, cell] };
        &grid.along(long)[row * COLUMNS + column]
    };
    // Of equally long lines, the one nearest to the middle.
    let mut lines: Vec<usize> = (COLUMNS / 3..COLUMNS - COLUMNS / 3).collect();
    lines.sort_by_key(|at| (2 * at + 1).abs_diff(COLUMNS));
    let way = |at: usize| free(column(at));
    let length = |[from, to]: [f64; 2]| to - from;
    let longest =
        |best: usize, at: usize| if length(way(at)) > length(way(best)) { at } else { best };
    let at = lines.into_iter().reduce(longest).unwrap_or(COLUMNS / 2);
    let [from, to] = way(at);
    let mut share = DVec3::splat(height);
    share[side] = (at as f64 + 0.5) / COLUMNS as f64;
    let point = |along: f64| {
        let mut share = share;
        share[long] = along;
        low + size * share
    };
    let (eye, middle) = (point(to - BEHIND * (to - from)), point((from + to) / 2.0));
    // Without extent, the camera looks along the axis all the same.
    let look = if middle == eye { eye - DVec3::AXES[long] } else { middle };
    Room::Closed { eye, look, lamp: lamp(grid, low, size, middle, upward) }
}

/// A lamp under the ceiling, above the point `look`.
fn lamp(grid: &Grid, low: DVec3, size: DVec3, look: DVec3, upward: DVec3) -> [DVec3; 4] {
    let vertical = upward.abs().max_position();
    let across = across(vertical);
    let end = 1.0 - LAMP / 2.0;
    let middle = ((look - low) / size).clamp(DVec3::splat(1.0 - end), DVec3::splat(end));
    let cells = across.map(|axis| {
        let [from, to] = [-LAMP, LAMP].map(|length| (middle[axis] + length / 2.0) * COLUMNS as f64);
        from as usize..(to.ceil() as usize).min(COLUMNS)
    });
    let [columns, rows] = cells;
    let up_is_high = upward[vertical] > 0.0;
    let height = |column: &ColumnHits| match up_is_high {
        true => column.above.map_or(1.0, |met| met.at),
        false => column.below.map_or(1.0, |met| 1.0 - met.at),
    };
    let cell = |(row, column): (usize, usize)| &grid.along(vertical)[row * COLUMNS + column];
    let cells = rows.flat_map(|row| columns.clone().map(move |column| (row, column)));
    let mut heights: Vec<f64> = cells.map(cell).map(height).collect();
    heights.sort_by(f64::total_cmp);
    // Beams and lamps of the room itself may pass through it.
    let ceiling = heights.get(heights.len() / 2).copied().unwrap_or(1.0) - ABOVE_LAMP;
    let corner = |u: f64, v: f64| {
        let mut share = middle;
        share[across[0]] += u * LAMP / 2.0;
        share[across[1]] += v * LAMP / 2.0;
        share[vertical] = if up_is_high { ceiling } else { 1.0 - ceiling };
        low + size * share
    };
    [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)]
}

/// The free range of a column around its centre.
fn free(column: &ColumnHits) -> [f64; 2] {
    [column.below.map_or(0.0, |met| met.at), column.above.map_or(1.0, |met| met.at)]
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Solid, boxes, contents};
    use super::*;

    fn found(mesh: &Solid) -> Option<Room> {
        let contents = contents(mesh);
        find(&Grid::of(&contents).unwrap(), &contents, Up::Y)
    }

    /// The sides of a box of 4 by 2 by 6, turned inward or outward, without those left out, and a
    /// table in it.
    fn furnished(inward: bool, left_out: &[usize], furniture: &[Corners]) -> Option<Room> {
        let walls = ([0.0; 3], [4.0, 2.0, 6.0]);
        let (points, triangles) = boxes(&[&[walls], furniture].concat());
        let sides = triangles.into_iter().enumerate().filter(|(i, _)| !left_out.contains(&(i / 2)));
        let turned = |(i, [a, b, c]): (usize, [u32; 3])| match inward && i < 12 {
            true => [a, c, b],
            false => [a, b, c],
        };
        found(&(points, sides.map(turned).collect()))
    }

    /// The lowest and the highest corner of a box.
    type Corners = ([f32; 3], [f32; 3]);

    fn walls(inward: bool, left_out: &[usize]) -> Option<Room> {
        furnished(inward, left_out, &[])
    }

    const TABLE: Corners = ([1.0, 0.0, 1.0], [2.5, 0.7, 4.0]);

    #[test]
    fn a_closed_room_is_seen_along_its_longer_way() {
        let Some(Room::Closed { eye, look, lamp }) = furnished(true, &[], &[TABLE]) else {
            panic!("no room")
        };
        assert!(eye.z > 5.5 && eye.z < 6.0 && look.z == 3.0, "{eye} {look}");
        assert!((eye.x - 2.0).abs() < 0.1 && eye.x == look.x);
        assert!(eye.y == look.y && eye.y > 1.0 && eye.y < 1.4);
        let [a, b, c, _] = lamp;
        assert!(lamp.iter().all(|p| p.y == a.y && p.y > 1.9 && p.y < 2.0), "{lamp:?}");
        assert!(((c - a).abs() - DVec3::new(0.8, 0.0, 1.2)).length() < 1e-12);
        assert!((c - b).dot(b - a).abs() < 1e-12, "right angles");
        // Without a ceiling it is a room still, and through another open side it is seen.
        assert!(matches!(walls(true, &[3]), Some(Room::Closed { .. })));
        assert_eq!(walls(true, &[4]), Some(Room::Open(DVec3::NEG_Z)));
        assert_eq!(walls(true, &[1]), Some(Room::Open(DVec3::X)));
    }

    #[test]
    fn a_box_is_a_room_if_there_is_something_in_it_and_room_to_look_at_it() {
        for inward in [true, false] {
            assert_eq!(walls(inward, &[]), None, "an empty box");
            assert!(furnished(inward, &[], &[TABLE]).is_some(), "a room with a table");
            let full = ([0.2; 3], [3.8, 1.8, 5.8]);
            assert_eq!(furnished(inward, &[], &[full]), None, "a block in a box");
        }
        assert_eq!(furnished(false, &[4], &[TABLE]), None, "a cupboard");
        // Walls of two sides are solids, and what is between them is free.
        let slab = |axis: usize, at: f32| {
            let (mut low, mut high) = ([0.0; 3], [4.0, 2.0, 6.0]);
            (low[axis], high[axis]) = (at, at + 0.1);
            (low, high)
        };
        let walls = [0.0, 3.9, 0.0, 1.9, 0.0, 5.9].iter().enumerate();
        let walls: Vec<Corners> = walls.map(|(i, &at)| slab(i / 2, at)).collect();
        assert!(found(&boxes(&[&walls, &[TABLE][..]].concat())).is_some(), "thick walls");
    }

    #[test]
    fn a_block_is_no_room_and_neither_are_two_walls() {
        for left_out in [&[][..], &[4], &[3]] {
            assert_eq!(walls(false, left_out), None, "{left_out:?}");
        }
        for count in [3_u8, 4] {
            let block = |i| ([f32::from(i) * 1.2, 0.0, 0.0], [f32::from(i) * 1.2 + 1.0, 1.0, 1.0]);
            assert_eq!(found(&boxes(&(0..count).map(block).collect::<Vec<_>>())), None, "{count}");
        }
        let hollow = ([0.2; 3], [3.8, 2.0, 5.8]);
        assert_eq!(furnished(true, &[3, 9], &[hollow]), None, "an open mould, inside out");
        assert_eq!(walls(true, &[2]), None, "no floor");
        assert_eq!(walls(true, &[0, 5]), None, "two walls");
    }
}
