//! Guesses the up axis of a mesh, if neither its format nor its user states it.
//!
//! Scans, printed parts and models have y or z up. Four features count as evidence against the
//! usual axis of a format. The mesh would stand along the other axis, and would fall over along the
//! usual one. Or it is its own mirror image along the usual axis alone, and would fall over along it,
//! as a fish or an aeroplane: left and right may be alike, top and bottom hardly ever are. Or it is a
//! wide, thin surface of one layer that faces along the other axis, as terrain does; or wide and low
//! with a ground below it, a sheet that faces up, as a courtyard has. A mesh stands if its centre is
//! above its support polygon, the convex hull of its lowest points: so a chair stands on its legs.

use glam::{DVec2, DVec3};

use super::Scenery;
use super::grid::{ColumnHits, Grid, MetTriangle, across};
use crate::options::framing::Up;

/// The up axis of a file unless the user states one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Upward {
    /// That of the format.
    Stated(Up),
    /// That of most files of a format that states none, unless the shape suggests another.
    Guessed(Up),
}

/// Largest distance of a support from the lowest point, as a share of the height.
const BASE_DEPTH: f64 = 0.02;
/// The same for what has legs and is not higher than long: some feet of what steps are in the air.
const RAISED: f64 = 0.12;
/// Largest share of a support polygon that is above what supports it, for legs.
const LEGS: f64 = 0.5;
/// Smallest share of the bounding rectangle that a support polygon covers: along the usual axis,
/// where little is enough to leave a mesh as it is,
const COULD_STAND: f64 = 0.1;
/// and along another: the feet of a figure with its arms spread out cover no more.
const STANDS: f64 = 0.15;
/// Smallest share of hits from below on the outside of a mesh that stands: an open mesh that lies on
/// its rim is not a closed one on its base.
const CLOSED: f64 = 0.75;
/// Largest mean difference between a mesh and its mirror image, as a share of its length: that of
/// left and right is below a twelfth, of top and bottom above a fifth.
const SYMMETRIC: f64 = 0.1;
/// The difference from which on the bottom and the top are taken for such without a support.
const ASYMMETRIC: f64 = 0.2;
/// Smallest height of what is set up without a support, as a share of its height so far: masks and
/// shields are not laid down.
const LOWER: f64 = 0.7;
/// Largest height of what is set up for its two sides, as a share of its shorter side: swords lie.
const TALLEST: f64 = 5.0;
/// Smallest share of hits from below on a ground: walls, trees and holes are not hit there,
const GROUND: f64 = 0.5;
/// largest height of a ground, as a share of that of everything,
const GROUND_DEPTH: f64 = 0.25;
/// and largest height of what is on a ground, as a share of its shorter side.
const WIDE: f64 = 0.5;
/// Number of directions in which the outermost points make up a support polygon.
const SIDES: usize = 16;
/// Largest height of what lies flat, as a share of its shorter side.
pub(super) const FLAT: f64 = 0.35;
/// Share of the hits from above with a single layer.
const NEARLY_ALL: f64 = 0.9;
/// Smallest share of its bounding rectangle that terrain covers.
const TERRAIN_COVERS: f64 = 0.6;

/// The up axis, y or z; and the reason if it is not the `usual` one.
pub(super) fn guess(contents: &Scenery<'_>, grid: &Grid, usual: Up) -> (Up, Option<&'static str>) {
    let size = contents.ends[1] - contents.ends[0];
    let (own, (other, axis)) = match usual {
        Up::Z => (2, (Up::Y, 1)),
        _ => (1, (Up::Z, 2)),
    };
    let height = |axis: usize| size[axis] / size[(axis + 1) % 3].min(size[(axis + 2) % 3]);
    let is_flat = |axis| height(axis) <= FLAT;
    let is_field = |axis| is_flat(axis) && is_terrain(grid.along(axis));
    if size[axis] > 0.0 && is_field(axis) && !is_field(own) {
        return (other, Some("the mesh is wide and low, as terrain is"));
    }
    let (columns, asymmetry) = (grid.along(axis), asymmetry(grid.along(axis)));
    let is_symmetric = self::asymmetry(grid.along(own)) < SYMMETRIC && height(axis) <= TALLEST;
    let lies = is_flat(own) && !is_symmetric;
    // What is flat is a figure.
    if lies || asymmetry < SYMMETRIC || size[axis] <= 0.0 {
        return (usual, None);
    }
    let falls = |depth| support(contents, size, own, depth) < COULD_STAND;
    let stands = |depth| support(contents, size, axis, depth) >= STANDS;
    let is_closed = is_closed(columns);
    let steps = || {
        if size[axis] > size[own] {
            return false;
        }
        let legs = columns.iter().filter(|c| c.ends.is_some_and(|[low, _]| low.at <= RAISED));
        let legs = legs.count() as f64 / columns.len() as f64;
        let support = support(contents, size, axis, RAISED);
        support >= STANDS && legs <= LEGS * support && falls(RAISED)
    };
    if is_closed && (stands(BASE_DEPTH) && falls(BASE_DEPTH) || steps()) {
        return (other, Some("the mesh stands along it, and would fall over along the other"));
    }
    let is_set_up = is_closed && asymmetry >= ASYMMETRIC && size[axis] >= LOWER * size[own];
    if height(axis) <= WIDE && has_ground(columns) && stands(RAISED) {
        return (other, Some("the mesh is wide and low, with a ground below it"));
    }
    if is_symmetric && is_set_up && falls(BASE_DEPTH) {
        return (other, Some("the mesh is its own mirror image along the other"));
    }
    (usual, None)
}

/// The mean of what `of` makes of the outermost hits, over the columns with hits.
fn mean(columns: &[ColumnHits], of: impl Fn([MetTriangle; 2]) -> f64) -> f64 {
    let met = || columns.iter().filter_map(|column| column.ends);
    met().map(of).sum::<f64>() / met().count() as f64
}

/// The share of the columns with hits whose outermost hits are such.
fn share(columns: &[ColumnHits], is: impl Fn([MetTriangle; 2]) -> bool) -> f64 {
    mean(columns, |ends| f64::from(u8::from(is(ends))))
}

/// Whether hits from below are on the outside.
fn is_closed(columns: &[ColumnHits]) -> bool {
    share(columns, |[low, _]| !low.faces_high) >= CLOSED
}

/// The mean difference between a mesh and its mirror image along the columns.
fn asymmetry(columns: &[ColumnHits]) -> f64 {
    mean(columns, |[low, high]| (low.at + high.at - 1.0).abs())
}

/// Whether the base is a sheet that faces up, as the ground of a courtyard does, and no back of a
/// cupboard.
fn has_ground(columns: &[ColumnHits]) -> bool {
    share(columns, |[low, _]| low.faces_high && low.at <= GROUND_DEPTH) >= GROUND
}

/// The share of the bounding rectangle that the support polygon covers, of what is at most a `depth`
/// above the lowest point, as a share of the height; 0 if its centre is outside.
fn support(contents: &Scenery<'_>, size: DVec3, axis: usize, depth: f64) -> f64 {
    let sides = across(axis);
    if sides.iter().any(|&side| size[side] <= 0.0) {
        return 0.0;
    }
    // None of them is an axis of the rectangle, along which two corners would be equally far.
    let directions: [DVec2; SIDES] = std::array::from_fn(|i| {
        let (sine, cosine) = libm::sincos((i as f64 + 0.5) * std::f64::consts::TAU / SIDES as f64);
        DVec2::new(cosine, sine)
    });
    let none = [None; SIDES];
    let of = |point: DVec3| {
        let from = point - contents.ends[0];
        let at = DVec2::new(from[sides[0]] / size[sides[0]], from[sides[1]] / size[sides[1]]);
        if from[axis] <= depth * size[axis] { [Some(at); SIDES] } else { none }
    };
    let merge = |a: [Option<DVec2>; SIDES], b: [Option<DVec2>; SIDES]| {
        if b[0].is_none() {
            return a;
        }
        let key = |i: usize, p: &DVec2| (p.dot(directions[i]), p.x);
        std::array::from_fn(|i| {
            a[i].into_iter().chain(b[i]).reduce(|a, b| if key(i, &b) > key(i, &a) { b } else { a })
        })
    };
    let found = contents.reduce(none, of, merge);
    let corner = |i: usize| found[i % SIDES].unwrap_or_default() - DVec2::splat(0.5);
    let edges = (0..SIDES).map(|i| corner(i).perp_dot(corner(i + 1)));
    // Twice the areas of triangles from the centre to each edge.
    if edges.clone().all(|area| area >= 0.0) { edges.sum::<f64>() / 2.0 } else { 0.0 }
}

/// Whether there is one layer that faces up, and covers most of the ground.
fn is_terrain(columns: &[ColumnHits]) -> bool {
    let covered = columns.iter().filter(|column| column.ends.is_some()).count() as f64;
    let is_layer = |[low, high]: [MetTriangle; 2]| low.at == high.at && high.faces_high;
    covered >= TERRAIN_COVERS * columns.len() as f64 && share(columns, is_layer) >= NEARLY_ALL
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Solid, boxes, contents};
    use super::*;
    use glam::Vec3;

    /// What is taken for up where another axis is `usual` in files of the format.
    fn guessed(mesh: &Solid, usual: Up) -> Up {
        let contents = contents(mesh);
        let (up, why) = guess(&contents, &Grid::of(&contents).unwrap(), usual);
        assert_eq!(why.is_some(), up != usual, "what is not usual has a reason");
        up
    }

    /// The points as in a file with y up.
    fn turned((points, triangles): Solid) -> Solid {
        (points.iter().map(|p| Vec3::new(p.x, p.z, -p.y)).collect(), triangles)
    }

    /// A pyramid whose base is a square perpendicular to z; the first two triangles are its base.
    fn pyramid() -> Solid {
        let base = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let points = base.map(|(x, y)| Vec3::new(x, y, 0.0)).into_iter().chain([Vec3::Z * 3.0]);
        let triangles = [[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        (points.collect(), triangles.to_vec())
    }

    /// A body of 3 by 1 on four legs, with a head at one end and a tail at the other; upright along z.
    fn horse() -> Solid {
        let leg = |x: f32, y: f32| ([x, y, 0.0], [x + 0.2, y + 0.2, 1.0]);
        let legs = [leg(0.3, 0.0), leg(2.4, 0.0), leg(0.3, 0.5), leg(2.4, 0.5)];
        // The stirrups keep it from lying on its flank.
        let stirrups = ([1.2, -0.1, 1.0], [1.4, 0.8, 1.2]);
        let body = ([0.0, 0.0, 1.0], [3.0, 0.7, 1.8]);
        let tail = ([-0.5, 0.3, 1.5], [0.0, 0.4, 1.7]);
        let rest = [body, ([2.8, 0.2, 1.5], [3.6, 0.5, 2.4]), stirrups, tail];
        boxes(&[&legs[..], &rest].concat())
    }

    /// A horse whose body is along y, with a hoof of each pair in the air.
    fn stepping_horse() -> Solid {
        let mut mesh = horse();
        mesh.0.iter_mut().take(16).filter(|p| p.z == 0.0).for_each(|p| p.z = 0.2);
        mesh.0.iter_mut().for_each(|p| *p = Vec3::new(-p.y, p.x, p.z));
        mesh
    }

    /// The ground and the walls of a courtyard of 6 by 10; upright along z.
    fn courtyard() -> Solid {
        let mut mesh = boxes(&[
            ([0.0; 3], [6.0, 10.0, 0.0]),
            ([0.0; 3], [0.5, 10.0, 2.0]),
            ([5.5, 0.0, 0.0], [6.0, 10.0, 2.0]),
            ([0.5, 0.0, 0.0], [5.5, 0.5, 2.0]),
            ([0.5, 9.5, 0.0], [5.5, 10.0, 2.0]),
        ]);
        // The upper side of the ground alone.
        mesh.1.drain(..10);
        mesh
    }

    /// A courtyard of which neither the ground nor the walls are even.
    fn scanned_courtyard() -> Solid {
        let mut mesh = courtyard();
        mesh.0.iter_mut().take(2).for_each(|p| p.z = 0.3);
        mesh.0.iter_mut().skip(32).for_each(|p| p.z *= 0.5);
        mesh
    }

    /// A cupboard without doors: the walls of a courtyard, and a back that is seen from behind.
    fn cupboard() -> Solid {
        let mut mesh = courtyard();
        mesh.1.iter_mut().take(2).for_each(|triangle| triangle.swap(1, 2));
        mesh
    }

    /// A room with an open front; upright along y.
    fn room() -> Solid {
        let mut mesh = boxes(&[([0.0; 3], [4.0, 3.0, 4.0]), ([1.0, 0.0, 1.0], [2.0, 1.0, 2.0])]);
        mesh.1.drain(10..12);
        mesh.1.iter_mut().take(10).for_each(|triangle| triangle.swap(1, 2));
        mesh
    }

    /// A body, a head at one end of it and a tail at the other, seen from its left; upright along z.
    fn bird() -> Solid {
        boxes(&[
            ([0.0, 0.4, 0.5], [2.0, 1.1, 1.2]),
            ([1.8, 0.6, 1.0], [2.4, 0.9, 1.6]),
            ([0.7, 0.0, 1.1], [1.2, 1.5, 1.2]),
        ])
    }

    /// A seat on four legs, with a back; upright along z, seen from -y.
    fn chair() -> Solid {
        let leg = |x: f32, y: f32| ([x, y, 0.0], [x + 0.1, y + 0.1, 0.5]);
        let seat = ([0.0, 0.0, 0.5], [1.0, 1.0, 0.6]);
        let back = ([0.0, 0.9, 0.6], [1.0, 1.0, 1.5]);
        boxes(&[leg(0.0, 0.0), leg(0.9, 0.0), leg(0.0, 0.9), leg(0.9, 0.9), seat, back])
    }

    /// A sheet with hills; upright along z.
    fn terrain() -> Solid {
        let height = |x: i32, y: i32| (x * 7 + y * 3).rem_euclid(5) as f32 / 5.0;
        let points = (0..100).map(|i| (i % 10, i / 10));
        let points = points.map(|(x, y)| Vec3::new(x as f32, y as f32, height(x, y)));
        let corners = (0..81u32).map(|i| i / 9 * 10 + i % 9);
        let triangles = corners.flat_map(|i| [[i, i + 1, i + 11], [i, i + 11, i + 10]]);
        (points.collect(), triangles.collect())
    }

    #[test]
    fn things_stand_as_they_would() {
        let bare = |(points, triangles): Solid| (points, triangles[2..].to_vec());
        for (what, mesh, where_y_is_usual, where_z_is_usual) in [
            ("a pyramid stands on its base", pyramid(), Up::Z, Up::Z),
            ("and so it does where y is up", turned(pyramid()), Up::Y, Up::Y),
            ("without its base it could lie on its rim", bare(turned(pyramid())), Up::Y, Up::Z),
            ("a horse stands on its legs", horse(), Up::Z, Up::Z),
            ("and is never laid down", turned(horse()), Up::Y, Up::Y),
            ("a horse that steps stands too", stepping_horse(), Up::Z, Up::Z),
            ("a courtyard lies on its ground", courtyard(), Up::Z, Up::Z),
            ("and so it does where y is up", turned(courtyard()), Up::Y, Up::Y),
            ("a scan of a courtyard likewise", scanned_courtyard(), Up::Z, Up::Z),
            ("and where y is up", turned(scanned_courtyard()), Up::Y, Up::Y),
            ("a cupboard stands on its base", cupboard(), Up::Y, Up::Z),
            ("a room is not laid on its back", room(), Up::Y, Up::Z),
            ("a bird in flight is upright by its sides", bird(), Up::Z, Up::Z),
            ("a chair stands on its legs", chair(), Up::Z, Up::Z),
            ("but upright along y it could lie on its back", turned(chair()), Up::Y, Up::Z),
            ("terrain lies on its back", terrain(), Up::Z, Up::Z),
            ("a cube is left as it is", boxes(&[([0.0; 3], [1.0; 3])]), Up::Y, Up::Z),
        ] {
            let found = [Up::Y, Up::Z].map(|usual| guessed(&mesh, usual));
            assert_eq!(found, [where_y_is_usual, where_z_is_usual], "{what}");
        }
    }
}
