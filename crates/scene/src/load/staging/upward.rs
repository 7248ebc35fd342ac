//! Guesses the up axis of a mesh, if neither its format nor its user states it.
//!
//! Scans and printed parts have y or z up. Only two features count as evidence against the usual
//! axis of a format: a flat base, on which the mesh would stand along one of the two axes but not
//! along the other; and a wide, thin surface of one layer that faces along one of them, as terrain
//! does.

use glam::DVec3;

use super::grid::{Column, Grid};
use crate::load::framing::Up;

/// Largest distance of a base from the lowest point, as a share of the height.
const BASE_DEPTH: f64 = 0.02;
/// Smallest share of hits from below on a base,
const BASE: f64 = 0.5;
/// and the largest share without a base.
const NO_BASE: f64 = 0.2;
/// Largest height of terrain, as a share of its shorter side.
const TERRAIN_HEIGHT: f64 = 0.35;
/// Share of the hits from above with a single layer.
const NEARLY_ALL: f64 = 0.9;
/// Smallest share of its bounding rectangle that terrain covers.
const TERRAIN_COVERS: f64 = 0.6;

/// The up axis, y or z; and the reason if it is not the `usual` one.
pub(super) fn guess(grid: &Grid, size: DVec3, usual: Up) -> (Up, Option<&'static str>) {
    let axes = [(Up::Y, 1), (Up::Z, 2)];
    let bases = axes.map(|(_, axis)| base(grid.along(axis)));
    let fields = axes.map(|(_, axis)| is_terrain(grid.along(axis), size, axis));
    for (i, (up, _)) in axes.into_iter().enumerate() {
        if up == usual {
            continue;
        }
        if bases[i] >= BASE && bases[1 - i] <= NO_BASE {
            return (up, Some("the mesh stands on a flat base"));
        }
        if fields[i] && !fields[1 - i] && bases[1 - i] < BASE {
            return (up, Some("the mesh is wide and low, as terrain is"));
        }
    }
    (usual, None)
}

/// The share of hits from below that are on a flat base.
fn base(columns: &[Column]) -> f64 {
    let ends = columns.iter().filter_map(|column| column.ends);
    let (count, flat) = ends.fold((0u32, 0u32), |(count, flat), [low, _]| {
        (count + 1, flat + u32::from(low.at <= BASE_DEPTH))
    });
    f64::from(flat) / f64::from(count.max(1))
}

/// Whether there is one layer that faces up, wide and low.
fn is_terrain(columns: &[Column], size: DVec3, axis: usize) -> bool {
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
    use super::super::Placed;
    use super::*;
    use glam::{DAffine3, Vec3};

    fn guessed(points: &[Vec3], triangles: &[[u32; 3]], usual: Up) -> (Up, bool) {
        let placed = Placed { points, triangles, world: DAffine3::IDENTITY };
        let merge = |a: (Vec3, Vec3), p: &Vec3| (a.0.min(*p), a.1.max(*p));
        let (low, high) = points.iter().fold((points[0], points[0]), merge);
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let grid = Grid::of(&[placed], low, high).unwrap();
        let (up, why) = guess(&grid, high - low, usual);
        (up, why.is_some())
    }

    /// A pyramid whose base is a square perpendicular to z.
    fn pyramid() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let base = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let points = base.map(|(x, y)| Vec3::new(x, y, 0.0)).into_iter().chain([Vec3::Z * 3.0]);
        let triangles = [[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        (points.collect(), triangles.to_vec())
    }

    #[test]
    fn what_stands_on_a_base_is_set_on_it() {
        let (mut points, mut triangles) = pyramid();
        assert_eq!(guessed(&points, &triangles, Up::Y), (Up::Z, true));
        assert_eq!(guessed(&points, &triangles, Up::Z), (Up::Z, false));
        points.iter_mut().for_each(|p| *p = Vec3::new(p.x, p.z, -p.y));
        assert_eq!(guessed(&points, &triangles, Up::Z), (Up::Y, true));
        // Without its base there is no evidence.
        triangles.drain(..2);
        assert_eq!(guessed(&points, &triangles, Up::Z), (Up::Z, false));
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
        assert_eq!(guessed(&points, &triangles, Up::Y), (Up::Z, true));
    }

    #[test]
    fn a_cube_is_left_as_it_is() {
        let points: Vec<Vec3> = (0..8)
            .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32))
            .collect();
        let quads =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles: Vec<[u32; 3]> =
            quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        assert_eq!(guessed(&points, &triangles, Up::Y), (Up::Y, false));
        assert_eq!(guessed(&points, &triangles, Up::Z), (Up::Z, false));
    }
}
