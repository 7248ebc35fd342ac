//! Triangulation of polygons.
//!
//! Readers write each polygon at once as a fan from its first corner, since a file may give faces
//! before their vertices, and record those with more than three corners as [`Polygon`]s. A fan
//! keeps every corner in order, so that [`split`] can replace wrong fans when all positions are
//! known. A polygon of `n` corners has `n - 2` triangles either way, so that nothing moves.
//!
//! A fan is right if all its triangles have the polygon's own winding, as in every strictly convex
//! polygon. Otherwise the polygon is concave, or some corners lie on a line; it is then
//! triangulated by ear clipping (the `earcut` crate), in the coordinate plane that it faces most.
//! Exact orientation tests (the `robust` crate) decide, not a tolerance. A polygon without area
//! keeps its fan.

use std::ops::Range;

use earcut::Earcut;
use glam::{DVec2, DVec3, Vec3};

use crate::corners::{flattened, orientation};
use wavecrest_base::error::{Error, ErrorKind};
use wavecrest_base::parallel;

/// Polygons with more corners that are not convex keep their fan: ear clipping takes quadratic
/// time, or more if the outline crosses itself, and a file must not be able to cost hours.
pub(super) const MAX_EAR_CORNERS: usize = 1 << 14;

/// A face of more than three corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Polygon {
    /// The first triangle of its fan.
    pub(super) first: u32,
    /// Number of corners.
    pub(super) corners: u32,
}

impl Polygon {
    /// The range of its triangles.
    fn range(self) -> Range<usize> {
        let first = self.first as usize;
        first..first + self.corners as usize - 2
    }

    /// Its corners, from its fan.
    fn corners_of(self, triangles: &[[u32; 3]]) -> Vec<u32> {
        let fan = &triangles[self.range()];
        fan[0][..2].iter().copied().chain(fan.iter().map(|t| t[2])).collect()
    }
}

/// The triangles of the fan from the first of `corners`.
pub(super) fn fan<T: Copy>(corners: &[T]) -> impl Iterator<Item = [T; 3]> {
    (2..corners.len()).map(|i| [corners[0], corners[i - 1], corners[i]])
}

/// Replaces the wrong fans of `polygons`, in `triangles` and alike in the index arrays of
/// `attributes` that are not empty. Indices must be in range and positions finite. Returns a warning if polygons kept
/// a fan for having more than [`MAX_EAR_CORNERS`] corners.
pub(super) fn split(
    polygons: &[Polygon],
    positions: &[Vec3],
    triangles: &mut [[u32; 3]],
    attributes: &mut [&mut [[u32; 3]]],
) -> Option<Error> {
    let mut too_large = 0;
    // In batches, so that the replacements are never large compared with the mesh.
    for batch in polygons.chunks(SPLIT_AT_ONCE) {
        let fans = &*triangles;
        let repaired = parallel::map(batch.chunks(SPLIT_AT_ONCE / 64), |polygons| {
            let mut earcut = Earcut::new();
            let repaired = polygons.iter().filter_map(|&polygon| {
                Some((polygon, repair(&mut earcut, polygon, positions, fans)?))
            });
            repaired.collect::<Vec<(Polygon, Vec<[u32; 3]>)>>()
        });
        for (polygon, split) in repaired.into_iter().flatten() {
            too_large += usize::from(split.is_empty());
            rewrite(polygon, &split, triangles);
            let attributes = attributes.iter_mut().filter(|indices| !indices.is_empty());
            attributes.for_each(|indices| rewrite(polygon, &split, indices));
        }
    }
    (too_large > 0).then(|| {
        let message =
            format!("concave polygons of over {MAX_EAR_CORNERS} corners are split into fans");
        Error::new(ErrorKind::Mesh, message)
            .value(too_large)
            .remedy("triangulate the file to split them correctly")
    })
}

/// Number of polygons split before triangles are written.
const SPLIT_AT_ONCE: usize = 1 << 15;

/// The triangles in place of a polygon's fan, which count its corners from 0; empty if it has too many.
/// `None` if the fan is right, or no triangulation is better.
fn repair(
    earcut: &mut Earcut<f64>,
    polygon: Polygon,
    positions: &[Vec3],
    fans: &[[u32; 3]],
) -> Option<Vec<[u32; 3]>> {
    let corners = polygon.corners_of(fans);
    let flat = flatten(corners.iter().map(|&i| positions[i as usize].as_dvec3()))?;
    if fan(&flat).all(|t| orientation(t) > 0.0) {
        return None;
    }
    if corners.len() > MAX_EAR_CORNERS {
        return Some(Vec::new());
    }
    cut_ears(earcut, &flat)
}

/// The corners in the coordinate plane that the polygon faces most, counter-clockwise there. `None`
/// for a polygon without area.
fn flatten(corners: impl Iterator<Item = DVec3> + Clone) -> Option<Vec<DVec2>> {
    let origin = corners.clone().next()?;
    let around = corners.map(|c| c - origin);
    // Newell's normal: its length is twice the area, even if the corners are not coplanar.
    let next = around.clone().skip(1);
    let normal: DVec3 = around.clone().zip(next).map(|(a, b)| a.cross(b)).sum();
    (normal != DVec3::ZERO).then(|| around.map(|c| flattened(normal, c)).collect())
}

/// Triangulates the polygon `flat` by ear clipping. `None` if there are no ears.
fn cut_ears(earcut: &mut Earcut<f64>, flat: &[DVec2]) -> Option<Vec<[u32; 3]>> {
    let mut indices: Vec<u32> = Vec::new();
    earcut.earcut(flat.iter().map(|p| p.to_array()), &[], &mut indices);
    let mut triangles: Vec<[u32; 3]> = indices.as_chunks::<3>().0.to_vec();
    let wanted = flat.len() - 2;
    if triangles.is_empty() || triangles.len() > wanted {
        return None;
    }
    for t in &mut triangles {
        if orientation(t.map(|i| flat[i as usize])) < 0.0 {
            t.swap(1, 2);
        }
    }
    fill_up(&mut triangles, flat.len());
    Some(triangles)
}

/// Adds a triangle, degenerate or nearly so, at each unused corner, until there are `corners - 2`.
/// Ear clipping skips corners that lie on a line with their neighbours or repeat one; the added
/// triangles join them to the rest.
fn fill_up(triangles: &mut Vec<[u32; 3]>, corners: usize) {
    let wanted = corners - 2;
    let mut used = vec![false; corners];
    triangles.iter().flatten().for_each(|&i| used[i as usize] = true);
    let around = |i: usize| [(i + corners - 1) % corners, i, (i + 1) % corners].map(|i| i as u32);
    let missing = wanted - triangles.len();
    triangles.extend((0..corners).filter(|&i| !used[i]).map(around).take(missing));
    triangles.resize(wanted, [0; 3]);
}

/// Writes `split`, which counts the polygon's corners from 0, over the polygon's fan.
fn rewrite(polygon: Polygon, split: &[[u32; 3]], indices: &mut [[u32; 3]]) {
    let corners = polygon.corners_of(indices);
    for (to, from) in indices[polygon.range()].iter_mut().zip(split) {
        *to = from.map(|i| corners[i as usize]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fan of a polygon through `points`.
    fn whole_fan(points: &[Vec3]) -> Vec<[u32; 3]> {
        fan(&(0..points.len() as u32).collect::<Vec<_>>()).collect()
    }

    /// The triangles of one polygon through `points`, those of the same corners counted from 100, and what is said.
    fn parts(points: &[Vec3]) -> (Vec<[u32; 3]>, Vec<[u32; 3]>, Option<Error>) {
        let mut triangles = whole_fan(points);
        let mut attribute: Vec<_> = triangles.iter().map(|t| t.map(|i| i + 100)).collect();
        let polygon = Polygon { first: 0, corners: points.len() as u32 };
        let note = split(&[polygon], points, &mut triangles, &mut [&mut attribute]);
        (triangles, attribute, note)
    }

    fn triangulate(points: &[Vec3]) -> Vec<[u32; 3]> {
        parts(points).0
    }

    fn area(points: &[Vec3], triangles: &[[u32; 3]]) -> (Vec3, f32) {
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            (b - a).cross(c - a) / 2.0
        };
        (triangles.iter().map(of).sum(), triangles.iter().map(|t| of(t).length()).sum())
    }

    /// A star with `2 * spikes` corners, in the plane that `place` puts it in.
    fn star(spikes: usize, place: impl Fn(f32, f32) -> Vec3) -> Vec<Vec3> {
        let corner = |i: usize| {
            let angle = i as f32 * std::f32::consts::PI / spikes as f32;
            let radius = if i.is_multiple_of(2) { 3.0 } else { 1.0 };
            place(radius * angle.cos(), radius * angle.sin())
        };
        (0..2 * spikes).map(corner).collect()
    }

    #[test]
    fn convex_polygons_and_those_without_area_keep_their_fan() {
        let square = vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        let on_circle = |i: u8| Vec3::new(0.0, f32::from(i).cos(), f32::from(i).sin());
        let hexagon = (0..6).map(on_circle).collect();
        let line = (0..4_u8).map(|i| Vec3::X * f32::from(i)).collect();
        for points in [square, hexagon, vec![Vec3::ONE; 5], line] {
            assert_eq!(triangulate(&points), whole_fan(&points), "{points:?}");
        }
    }

    #[test]
    fn a_quad_with_a_dent_splits_through_the_dent() {
        for dent in 0..4_usize {
            let mut quad = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
            quad[dent] = Vec3::new(0.5, 0.5, 0.0) + (quad[(dent + 2) % 4] - 0.5) * 0.5;
            quad[dent].z = 0.0;
            let triangles = triangulate(&quad);
            for t in &triangles {
                assert!(t.contains(&(dent as u32)), "{dent}: {triangles:?}");
            }
            let (vector, total) = area(&quad, &triangles);
            assert!((vector.z - total).abs() < 1e-6 && total < 1.0);
        }
    }

    #[test]
    fn stars_are_covered_once_in_any_plane() {
        type Place = fn(f32, f32) -> Vec3;
        let places: [Place; 6] = [
            |u, v| Vec3::new(u, v, 0.0),
            |u, v| Vec3::new(v, u, 5.0),
            |u, v| Vec3::new(1.0, u, v),
            |u, v| Vec3::new(1.0, v, u),
            |u, v| Vec3::new(u, -2.0, v),
            |u, v| Vec3::new(u + 100.0, v - u, v + 1000.0),
        ];
        for place in places {
            for spikes in [3, 5, 50] {
                let points = star(spikes, place);
                let triangles = triangulate(&points);
                assert_eq!(triangles.len(), 2 * spikes - 2);
                // All triangles have the polygon's winding, so their area is the polygon's.
                let (vector, total) = area(&points, &triangles);
                let (right, _) = area(&points, &whole_fan(&points));
                assert!((vector - right).length() < 1e-3 * total);
                assert!((vector.length() - total).abs() < 1e-3 * total, "{spikes}");
            }
        }
    }

    #[test]
    fn corners_on_a_line_are_not_lost() {
        let p = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let square = [p(0., 0.), p(1., 0.), p(2., 0.), p(2., 1.), p(2., 2.), p(0., 2.), p(0., 1.)];
        let triangles = triangulate(&square);
        assert_eq!(triangles.len(), 5);
        assert_eq!(area(&square, &triangles), (Vec3::new(0.0, 0.0, 4.0), 4.0));
        let used = |i: u32| triangles.iter().flatten().any(|&j| i == j);
        assert!((0..7).all(used));
    }

    #[test]
    fn attributes_follow_their_corners() {
        let points = star(4, |u, v| Vec3::new(u, v, 0.0));
        let (triangles, attribute, _) = parts(&points);
        assert_ne!(triangles, whole_fan(&points));
        assert!(triangles.iter().zip(&attribute).all(|(t, a)| t.map(|i| i + 100) == *a));
    }

    #[test]
    fn a_concave_polygon_with_too_many_corners_keeps_its_fan() {
        let points = star(MAX_EAR_CORNERS, |u, v| Vec3::new(u, v, 0.0));
        let (triangles, _, note) = parts(&points);
        assert!(note.unwrap().to_string().contains("found 1"));
        assert!(triangles == whole_fan(&points));
    }
}
