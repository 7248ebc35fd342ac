//! Normals for a mesh without any: smooth where faces meet at a small angle, with a crease
//! elsewhere.
//!
//! Around each vertex, faces that share an edge at less than the crease angle form a group,
//! transitively. A group has one normal, the mean of those of its faces, each weighted by its angle
//! at the vertex (Thuermer and Wuethrich, *Computing Vertex Normals from Polygonal Facets*, 1998),
//! so that it does not depend on the triangulation of a polygon.
//!
//! If most vertices are not shared, as in files that list each triangle separately, vertices at the
//! same position count as one.
//!
//! The time is linear in the number of corners, up to sorting the neighbours of a vertex; all
//! threads process vertices, and their normals are numbered in the vertices' order.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{Attribute, NO_VALUE};
use crate::corners::direction;

/// Largest rotation of a face by single-precision rounding, in degrees. The edges of a prism of
/// twelve sides have 30 degrees up to this error; either all of them are creases or none.
const ROUNDING: f64 = 1e-3;

/// Vertices for each task.
const CHUNK: usize = 1 << 12;

/// Normals for each corner of `triangles`; edges of `degrees` and more are creases. Triangles
/// without area have none.
pub(crate) fn normals(positions: &[Vec3], triangles: &[[u32; 3]], degrees: f64) -> Attribute<Vec3> {
    let joined = joined(positions, triangles);
    let triangles = joined.as_deref().unwrap_or(triangles);
    let about = Corners::of(positions.len(), triangles);
    let smooth = (degrees - ROUNDING).max(0.0);
    let mesh = Faces { positions, triangles, least: libm::cos(smooth.to_radians()) };
    let parts: Vec<Part> = (0..positions.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let (mut part, mut room) = (Part::default(), Room::default());
            let first = chunk * CHUNK;
            for vertex in first..positions.len().min(first + CHUNK) {
                mesh.add(about.of_vertex(vertex), &mut room, &mut part);
            }
            part
        })
        .collect();
    drop(about);
    together(parts, triangles.len())
}

/// Largest number of bytes that [`normals`] holds beyond mesh and result if few edges are creases.
pub(crate) fn bytes(positions: u64, triangles: u64) -> u64 {
    // Two offsets for each vertex; the corners; two numbers for each corner; and a copy of the normals.
    let about = (8 * positions).saturating_add(12 * triangles);
    let parts = (12 * positions).saturating_add(24 * triangles);
    // For unshared vertices, a hash table with at most twice as many slots, and all numbers.
    let joining = if positions <= triangles { 0 } else { 38 * positions + 16 * triangles };
    about.saturating_add(parts).saturating_add(joining)
}

/// The normals of all parts, in order.
fn together(parts: Vec<Part>, triangles: usize) -> Attribute<Vec3> {
    let mut values = Vec::with_capacity(parts.iter().map(|part| part.normals.len()).sum());
    let mut indices = vec![[NO_VALUE; 3]; triangles];
    for Part { normals, corners } in parts {
        let first = values.len() as u32;
        for (corner, number) in corners {
            indices[corner as usize / 3][corner as usize % 3] = first + number;
        }
        values.extend(normals);
    }
    Attribute { values, indices: Some(indices) }
}

/// The triangles with vertices at the same position merged; `None` if vertices are shared already:
/// then there are about half as many as triangles.
fn joined(positions: &[Vec3], triangles: &[[u32; 3]]) -> Option<Vec<[u32; 3]>> {
    if positions.len() <= triangles.len() {
        return None;
    }
    let mut first: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
    // Zeros of both signs are the same position.
    let place = |p: &Vec3| (*p + Vec3::ZERO).to_array().map(f32::to_bits);
    let numbers: Vec<u32> =
        (0_u32..).zip(positions).map(|(i, p)| *first.entry(place(p)).or_insert(i)).collect();
    let join = |triangle: &[u32; 3]| triangle.map(|i| numbers[i as usize]);
    Some(triangles.par_iter().map(join).collect())
}

/// The corners around each vertex: a corner is the number of its triangle times 3, plus its index
/// there.
struct Corners {
    /// The start of each vertex's corners, with the end appended.
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Corners {
    /// A counting sort (Knuth, *The Art of Computer Programming*, volume 3, section 5.2).
    fn of(vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut starts = vec![0_u32; vertices + 1];
        let all = triangles.as_flattened();
        all.iter().for_each(|&vertex| starts[vertex as usize + 1] += 1);
        for vertex in 0..vertices {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut corners = vec![0; all.len()];
        for (corner, &vertex) in (0_u32..).zip(all) {
            corners[next[vertex as usize] as usize] = corner;
            next[vertex as usize] += 1;
        }
        Self { starts, corners }
    }

    fn of_vertex(&self, vertex: usize) -> &[u32] {
        &self.corners[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

/// The result for some vertices: their normals, and the corners that have them.
#[derive(Default)]
struct Part {
    normals: Vec<Vec3>,
    corners: Vec<(u32, u32)>,
}

/// A corner at the current vertex.
#[derive(Clone, Copy)]
struct Corner {
    /// Its number in the mesh.
    number: u32,
    /// Unit normal of its triangle.
    normal: DVec3,
    /// Its angle.
    weight: f64,
    /// An earlier corner of the same group here, or itself.
    parent: usize,
    /// The index of the group's normal, once it has one.
    value: u32,
}

/// Memory for the corners around a vertex, and for their edges: the vertex at the other end, and
/// the corner.
#[derive(Default)]
struct Room {
    corners: Vec<Corner>,
    edges: Vec<(u32, usize)>,
}

struct Faces<'a> {
    positions: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    /// The smallest cosine between normals of faces that meet smoothly.
    least: f64,
}

impl Faces<'_> {
    /// Adds the normals around a vertex.
    fn add(&self, about: &[u32], room: &mut Room, part: &mut Part) {
        let Room { corners, edges } = room;
        corners.clear();
        edges.clear();
        for &number in about {
            let Some((corner, others)) = self.corner(number, corners.len()) else { continue };
            edges.extend(others.map(|other| (other, corners.len())));
            corners.push(corner);
        }
        edges.sort_unstable();
        for pair in edges.windows(2) {
            let [(end, one), (other_end, other)] = [pair[0], pair[1]];
            if end == other_end && corners[one].normal.dot(corners[other].normal) >= self.least {
                join(corners, one, other);
            }
        }
        sum_up(corners, part);
    }

    /// The corner with that number, the `place`th of its vertex, with the vertices at the ends of
    /// its edges; `None` if its triangle has no area.
    fn corner(&self, number: u32, place: usize) -> Option<(Corner, [u32; 2])> {
        let triangle = self.triangles[number as usize / 3];
        let turned = |by: usize| triangle[(number as usize + by) % 3];
        let point = |vertex: u32| self.positions[vertex as usize].as_dvec3();
        let [vertex, next, last] = [turned(0), turned(1), turned(2)];
        let [to_next, to_last] = [next, last].map(|other| point(other) - point(vertex));
        let normal = direction(to_next.cross(to_last))?;
        let [a, b] = [direction(to_next)?, direction(to_last)?];
        let weight = libm::atan2(a.cross(b).length(), a.dot(b));
        Some((Corner { number, normal, weight, parent: place, value: NO_VALUE }, [next, last]))
    }
}

/// The first corner of a group.
fn first(corners: &mut [Corner], mut place: usize) -> usize {
    while corners[place].parent != place {
        // Path halving, for later searches.
        corners[place].parent = corners[corners[place].parent].parent;
        place = corners[place].parent;
    }
    place
}

/// Merges the groups of two corners.
fn join(corners: &mut [Corner], one: usize, other: usize) {
    let (one, other) = (first(corners, one), first(corners, other));
    corners[one.max(other)].parent = one.min(other);
}

/// Adds the normal of each group, in the order of their first corners.
fn sum_up(corners: &mut [Corner], part: &mut Part) {
    for place in 0..corners.len() {
        let group = first(corners, place);
        let Corner { number, normal, weight, .. } = corners[place];
        if group == place {
            corners[place].value = part.normals.len() as u32;
            part.normals.push(Vec3::ZERO);
        }
        let value = corners[group].value;
        // Kept as sums in double precision until all are added.
        corners[group].normal =
            if group == place { normal * weight } else { corners[group].normal + normal * weight };
        part.corners.push((number, value));
    }
    for corner in corners.iter().filter(|corner| corner.value != NO_VALUE) {
        part.normals[corner.value as usize] =
            direction(corner.normal).unwrap_or_default().as_vec3();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The normal at a corner.
    fn at(found: &Attribute<Vec3>, triangle: usize, corner: usize) -> Vec3 {
        let number = found.indices.as_ref().expect("corners have numbers")[triangle][corner];
        found.values[number as usize]
    }

    /// Two squares that meet along the z axis at this angle in degrees.
    fn fold(degrees: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let right = Vec3::new(cos, -sin, 0.0);
        let points = [Vec3::NEG_X, Vec3::ZERO, right].map(|p| [p, p + Vec3::Z]).concat();
        (points, vec![[0, 1, 3], [0, 3, 2], [2, 3, 5], [2, 5, 4]])
    }

    #[test]
    fn an_edge_below_the_angle_is_smooth_and_one_above_is_sharp() {
        for (degrees, crease, is_smooth) in
            [(29.0, 30.0, true), (31.0, 30.0, false), (89.0, 180.0, true)]
        {
            let (points, triangles) = fold(degrees);
            let found = normals(&points, &triangles, crease);
            assert_eq!(at(&found, 1, 1) == at(&found, 2, 1), is_smooth, "{degrees}");
            assert_eq!(at(&found, 0, 0), Vec3::Y, "at the border");
            assert_eq!(found.values.len(), if is_smooth { 6 } else { 8 });
            let half = (degrees / 2.0).to_radians();
            let expected = if is_smooth { Vec3::new(half.sin(), half.cos(), 0.0) } else { Vec3::Y };
            assert!(
                at(&found, 1, 1).distance(expected) < 1e-6,
                "by angles: each square has a right one"
            );
        }
    }

    /// The sides of a prism of `count` sides, each a square cut into two.
    fn prism(count: u32, size: f32, turn: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let around = |i: u32| {
            let (sin, cos) =
                libm::sincos(turn + std::f64::consts::TAU * f64::from(i) / f64::from(count));
            DVec3::new(cos, 0.0, sin).as_vec3() * size
        };
        let points = (0..count).flat_map(|i| [around(i), around(i) + Vec3::Y * size]).collect();
        let side = |i: u32| {
            let [a, b] = [2 * i, 2 * ((i + 1) % count)];
            [[a, a + 1, b + 1], [a, b + 1, b]]
        };
        (points, (0..count).flat_map(side).collect())
    }

    /// All edges of a prism are alike, although single precision places its corners: at exactly the angle they are
    /// creases.
    #[test]
    fn an_edge_at_exactly_the_angle_is_a_crease() {
        for (count, degrees) in [(12, 30.0), (8, 45.0), (6, 60.0), (4, 90.0), (360, 1.0)] {
            for (size, turn) in [(1.0, 0.0), (1e-3, 0.1), (123.4, 0.7), (1e6, 2.0)] {
                let (points, triangles) = prism(count, size, turn);
                let normals = |crease| normals(&points, &triangles, crease).values.len() as u32;
                let found = [degrees, 1.01 * degrees].map(normals);
                assert_eq!(found, [4 * count, 2 * count], "{count} sides, {size}, {turn}");
            }
        }
    }

    #[test]
    fn vertices_that_no_triangle_shares_are_joined_by_place() {
        let (points, triangles) = fold(20.0);
        let soup: Vec<Vec3> =
            triangles.as_flattened().iter().map(|&i| points[i as usize]).collect();
        let alone: Vec<[u32; 3]> = (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let (one, other) = (normals(&points, &triangles, 30.0), normals(&soup, &alone, 30.0));
        for (triangle, corner) in (0..4).flat_map(|t| (0..3).map(move |c| (t, c))) {
            assert_eq!(at(&one, triangle, corner), at(&other, triangle, corner));
        }
    }

    /// A fan of this many triangles around one vertex does not take quadratic time.
    #[test]
    fn many_triangles_about_a_vertex_are_one_group() {
        let count = 200_000_u32;
        let around = |i: u32| {
            let (sin, cos) = libm::sincosf(i as f32 * std::f32::consts::TAU / count as f32);
            Vec3::new(sin, 0.0, cos)
        };
        let points: Vec<Vec3> =
            std::iter::once(Vec3::Y * 0.1).chain((0..count).map(around)).collect();
        let triangles: Vec<[u32; 3]> =
            (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
        let found = normals(&points, &triangles, 30.0);
        assert!(at(&found, 0, 0).distance(Vec3::Y) < 1e-4);
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        assert_eq!(alone.install(|| normals(&points, &triangles, 30.0)), found, "on one thread");
    }

    #[test]
    fn triangles_without_area_and_turned_ones_join_nothing() {
        let (points, mut triangles) = fold(10.0);
        triangles.push([0, 1, 1]);
        triangles[2] = [3, 2, 5];
        let found = normals(&points, &triangles, 30.0);
        assert_eq!(found.indices.as_ref().expect("numbers")[4], [NO_VALUE; 3]);
        assert!(at(&found, 2, 1).y < 0.0 && at(&found, 1, 1).y > 0.0);
    }
}
