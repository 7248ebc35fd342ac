//! Guesses the up axis of a mesh, if neither its format nor its user states it.
//!
//! Scans and printed parts have y or z up. Only two features count as evidence against the usual
//! axis of a format: the mesh would stand along the other axis, and would fall over along the usual
//! one; or it is a wide, thin surface of one layer that faces along the other, as terrain does. A
//! mesh stands if its centre is above its support polygon, the convex hull of its lowest points:
//! so a chair stands on its legs.

use glam::{DVec2, DVec3};

use super::Scenery;
use super::grid::{ColumnHits, Grid};
use crate::options::framing::Up;

/// The up axis of a file unless the user states one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Upward {
    /// That of the format.
    Stated(Up),
    /// That of most files of a format that states none.
    Usual(Up),
    /// The same, unless the shape suggests another.
    Guessed(Up),
}

/// Largest distance of a support from the lowest point, as a share of the height.
const BASE_DEPTH: f64 = 0.02;
/// Smallest share of the bounding rectangle that a support polygon covers: along the usual axis,
/// where little is enough to leave a mesh as it is,
const COULD_STAND: f64 = 0.1;
/// and along another.
const STANDS: f64 = 0.25;
/// Smallest share of hits from below on the outside of a mesh that stands: an open mesh that lies
/// on its rim is not a closed one on its base.
const CLOSED: f64 = 0.9;
/// Number of directions in which the outermost points make up a support polygon.
const SIDES: usize = 16;
/// Largest height of terrain, as a share of its shorter side.
const TERRAIN_HEIGHT: f64 = 0.35;
/// Share of the hits from above with a single layer.
const NEARLY_ALL: f64 = 0.9;
/// Smallest share of its bounding rectangle that terrain covers.
const TERRAIN_COVERS: f64 = 0.6;

/// The up axis, y or z; and the reason if it is not the `usual` one.
pub(super) fn guess(contents: &Scenery<'_>, grid: &Grid, usual: Up) -> (Up, Option<&'static str>) {
    let size = contents.ends.1 - contents.ends.0;
    let (own, (other, axis)) = match usual {
        Up::Z => (2, (Up::Y, 1)),
        _ => (1, (Up::Z, 2)),
    };
    let field = |axis| is_terrain(grid.along(axis), size, axis);
    let support = |axis| support(contents, size, axis);
    let is_field = field(axis) && !field(own);
    let stands = || is_closed(grid.along(axis)) && support(axis) >= STANDS;
    // Terrain would also stand on its edge.
    if !is_field && (!stands() || support(own) >= COULD_STAND) {
        return (usual, None);
    }
    let why = if is_field {
        "the mesh is wide and low, as terrain is"
    } else {
        "the mesh stands along it, and would fall over along the other"
    };
    (other, Some(why))
}

/// Whether hits from below are on the outside.
fn is_closed(columns: &[ColumnHits]) -> bool {
    let ends = columns.iter().filter_map(|column| column.ends);
    let (count, outside) = ends.fold((0u32, 0u32), |(count, outside), [low, _]| {
        (count + 1, outside + u32::from(!low.faces_high))
    });
    f64::from(outside) >= CLOSED * f64::from(count)
}

/// The share of the bounding rectangle that the support polygon covers; 0 if its centre is outside.
fn support(contents: &Scenery<'_>, size: DVec3, axis: usize) -> f64 {
    let sides = [(axis + 1) % 3, (axis + 2) % 3];
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
        let from = point - contents.ends.0;
        let at = DVec2::new(from[sides[0]] / size[sides[0]], from[sides[1]] / size[sides[1]]);
        if from[axis] <= BASE_DEPTH * size[axis] { [Some(at); SIDES] } else { none }
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

/// Whether there is one layer that faces up, wide and low.
fn is_terrain(columns: &[ColumnHits], size: DVec3, axis: usize) -> bool {
    let sides = [(axis + 1) % 3, (axis + 2) % 3].map(|side| size[side]);
    let is_low = size[axis] <= TERRAIN_HEIGHT * sides[0].min(sides[1]);
    let met = columns.iter().filter_map(|column| column.ends);
    let (all, upward) = met.fold((0u32, 0u32), |(all, upward), [low, high]| {
        (all + 1, upward + u32::from(low.at == high.at && high.faces_high))
    });
    let (all, upward) = (f64::from(all), f64::from(upward));
    is_low && all >= TERRAIN_COVERS * columns.len() as f64 && upward >= NEARLY_ALL * all
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Solid, boxes, contents};
    use super::*;
    use glam::Vec3;

    fn guessed(mesh: &Solid, usual: Up) -> (Up, bool) {
        let contents = contents(mesh);
        let (up, why) = guess(&contents, &Grid::of(&contents).unwrap(), usual);
        (up, why.is_some())
    }

    /// A pyramid whose base is a square perpendicular to z.
    fn pyramid() -> Solid {
        let base = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let points = base.map(|(x, y)| Vec3::new(x, y, 0.0)).into_iter().chain([Vec3::Z * 3.0]);
        let triangles = [[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        (points.collect(), triangles.to_vec())
    }

    #[test]
    fn what_stands_on_a_base_is_set_on_it() {
        let mut mesh = pyramid();
        assert_eq!(guessed(&mesh, Up::Y), (Up::Z, true));
        assert_eq!(guessed(&mesh, Up::Z), (Up::Z, false));
        mesh.0.iter_mut().for_each(|p| *p = Vec3::new(p.x, p.z, -p.y));
        assert_eq!(guessed(&mesh, Up::Z), (Up::Y, true));
        // Without its base there is no evidence.
        mesh.1.drain(..2);
        assert_eq!(guessed(&mesh, Up::Z), (Up::Z, false));
    }

    /// A seat on four legs, with a back; upright along z, seen from -y.
    fn chair() -> Solid {
        let leg = |x: f32, y: f32| ([x, y, 0.0], [x + 0.1, y + 0.1, 0.5]);
        let seat = ([0.0, 0.0, 0.5], [1.0, 1.0, 0.6]);
        let back = ([0.0, 0.9, 0.6], [1.0, 1.0, 1.5]);
        boxes(&[leg(0.0, 0.0), leg(0.9, 0.0), leg(0.0, 0.9), leg(0.9, 0.9), seat, back])
    }

    #[test]
    fn a_chair_stands_on_its_legs() {
        let mut mesh = chair();
        assert_eq!(guessed(&mesh, Up::Y), (Up::Z, true));
        assert_eq!(guessed(&mesh, Up::Z), (Up::Z, false));
        // Upright along y, it could also lie on its back.
        mesh.0.iter_mut().for_each(|p| *p = Vec3::new(p.x, p.z, -p.y));
        assert_eq!(guessed(&mesh, Up::Y), (Up::Y, false));
    }

    #[test]
    fn terrain_lies_on_its_back() {
        let height = |x: i32, y: i32| (x * 7 + y * 3).rem_euclid(5) as f32 / 5.0;
        let points = (0..100).map(|i| (i % 10, i / 10));
        let points: Vec<Vec3> =
            points.map(|(x, y)| Vec3::new(x as f32, y as f32, height(x, y))).collect();
        let corners = (0..81u32).map(|i| i / 9 * 10 + i % 9);
        let triangles: Vec<[u32; 3]> =
            corners.flat_map(|i| [[i, i + 1, i + 11], [i, i + 11, i + 10]]).collect();
        assert_eq!(guessed(&(points, triangles), Up::Y), (Up::Z, true));
    }

    #[test]
    fn a_cube_is_left_as_it_is() {
        let mesh = boxes(&[([0.0; 3], [1.0; 3])]);
        assert_eq!(guessed(&mesh, Up::Y), (Up::Y, false));
        assert_eq!(guessed(&mesh, Up::Z), (Up::Z, false));
    }
}
