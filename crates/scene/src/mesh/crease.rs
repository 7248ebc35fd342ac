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
//! All threads process ranges of vertices, each with the triangles that use them, so that what a range
//! holds stays in a core's cache.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::join::first_of_each;
use super::{Attribute, NO_VALUE};
use crate::corners::direction;
use wavecrest_base::parallel;
use wavecrest_base::shared::Shared;

/// Largest rotation of a face by single-precision rounding, in degrees. The edges of a prism of
/// twelve sides have 30 degrees up to this error; either all of them are creases or none.
const ROUNDING: f64 = 1e-3;

/// The most vertices in a range.
const RANGE: usize = 1 << 13;

/// Normals for each corner of `triangles`; edges of `degrees` and more are creases. Vertices at the same position count as
/// one if most are not shared, or if it `joins` them.
///
/// The first normal of a vertex has the vertex's number. Others, at creases, come after.
pub(crate) fn normals(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    degrees: f64,
    joins: bool,
) -> Attribute<Vec3> {
    let is_shared = positions.len() <= triangles.len() && !joins;
    let joined: Option<Vec<[u32; 3]>> = (!is_shared).then(|| {
        let numbers = first_of_each(positions);
        let mut joined = triangles.to_vec();
        parallel::each_mut(&mut joined, |_, corners| {
            *corners = corners.map(|i| numbers[i as usize])
        });
        joined
    });
    let mesh = CreaseMesh {
        positions,
        triangles: joined.as_deref().unwrap_or(triangles),
        least: libm::cos((degrees - ROUNDING).max(0.0).to_radians()),
    };
    let size = RANGE.min(positions.len().div_ceil(rayon::current_num_threads())).max(1);
    let parts = mesh.by_range(size);
    let mut values = vec![Vec3::ZERO; positions.len()];
    let further: Vec<Further> = values
        .par_chunks_mut(size)
        .enumerate()
        .map_init(CreaseMemory::default, |room, (range, values)| {
            let mut further = Further::default();
            let triangles = parts.iter().flat_map(|ranges| &ranges[range]);
            room.look(&mesh, triangles, (range * size) as u32, values.len());
            for (vertex, value) in values.iter_mut().enumerate() {
                room.add(vertex, mesh.least, value, &mut further);
            }
            further
        })
        .collect();
    let mut indices = joined;
    for Further { normals, corners } in further.into_iter().filter(|f| !f.normals.is_empty()) {
        let (indices, first) =
            (indices.get_or_insert_with(|| triangles.to_vec()), values.len() as u32);
        for (corner, number) in corners {
            indices.as_flattened_mut()[corner as usize] = first + number;
        }
        values.extend(normals);
    }
    Attribute { values: values.into(), indices: indices.map(Shared::from) }
}

struct CreaseMesh<'a> {
    positions: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    /// The smallest cosine between normals of faces that meet smoothly.
    least: f64,
}

impl CreaseMesh<'_> {
    /// For each part of the triangles, the numbers of those with corners in each range of `size` vertices.
    fn by_range(&self, size: usize) -> Vec<Vec<Vec<u32>>> {
        let part = self.triangles.len().div_ceil(rayon::current_num_threads()).max(1);
        let distribute = |(number, triangles): (usize, &[[u32; 3]])| {
            let mut ranges = vec![Vec::new(); self.positions.len().div_ceil(size)];
            for (number, vertices) in ((number * part) as u32..).zip(triangles) {
                let used = vertices.map(|v| v as usize / size);
                for (i, range) in used.into_iter().enumerate() {
                    if !used[..i].contains(&range) {
                        ranges[range].push(number);
                    }
                }
            }
            ranges
        };
        parallel::map(self.triangles.chunks(part).enumerate(), distribute)
    }

    /// The face of a triangle; `None` without area. In double precision no square of a length underflows:
    /// differences of single-precision numbers are multiples of the smallest of these.
    fn face(&self, number: u32) -> Option<CreaseFace> {
        let vertices = self.triangles[number as usize];
        let [a, b, c] = vertices.map(|v| self.positions[v as usize].as_dvec3());
        let edges = [b - a, c - b, a - c];
        let cross = edges[0].cross(edges[1]);
        let area = cross.length();
        if area == 0.0 {
            return None;
        }
        let units = edges.map(|edge| edge * (1.0 / edge.length()));
        let angle = |next: usize, last: usize| angle(-units[next].dot(units[last]));
        let angles = [angle(0, 2), angle(1, 0), angle(2, 1)];
        Some(CreaseFace { number, vertices, normal: cross * (1.0 / area), angles })
    }
}

/// Coefficients of the arc cosine over the square root of 1 - x, in thousandths, from the constant term
/// on: Abramowitz and Stegun, *Handbook of Mathematical Functions*, 4.4.46.
const ARC_COSINE: [f64; 8] = [
    1_570.796_305_0,
    -214.598_801_6,
    88.978_987_4,
    -50.174_304_6,
    30.891_881_0,
    -17.088_125_6,
    6.670_090_1,
    -1.262_491_1,
];

/// The angle with this cosine, within 3e-8. Weights need no more: compared with an arc cosine of full
/// precision, normals change by less than single precision shows.
fn angle(cosine: f64) -> f64 {
    let x = cosine.abs();
    let series = ARC_COSINE.iter().rev().fold(0.0, |sum, c| sum * x + c) / 1000.0;
    let acute = (1.0 - x).max(0.0).sqrt() * series;
    if cosine < 0.0 { std::f64::consts::PI - acute } else { acute }
}

/// A triangle with area.
struct CreaseFace {
    number: u32,
    vertices: [u32; 3],
    /// Of unit length.
    normal: DVec3,
    /// The angle at each corner, in radians.
    angles: [f64; 3],
}

/// The normals at creases of a range's vertices, beyond the first of each vertex, and the corners
/// that have them.
#[derive(Default)]
struct Further {
    normals: Vec<Vec3>,
    corners: Vec<(u32, u32)>,
}

/// A corner at the current vertex.
#[derive(Clone, Copy)]
struct Corner {
    /// Its number in the mesh: three times that of its triangle, plus its index there.
    number: u32,
    /// Unit normal of its triangle.
    normal: DVec3,
    /// Its angle.
    weight: f64,
    /// An earlier corner of the same group here, or itself; then the number of the group.
    group: usize,
}

/// Memory for a range of vertices, and for the corners around one.
#[derive(Default)]
struct CreaseMemory {
    faces: Vec<CreaseFace>,
    /// For each vertex its first corner, and for each corner the next one at its vertex: three times the
    /// index of a face, plus its index there; [`NO_VALUE`] for none.
    firsts: Vec<u32>,
    nexts: Vec<u32>,
    corners: Vec<Corner>,
    /// The vertex at the other end of an edge, and the corner.
    edges: Vec<(u32, usize)>,
    /// The sum of the normals of each group.
    sums: Vec<DVec3>,
}

impl CreaseMemory {
    /// Finds the faces and corners around `count` vertices from `start` on, which `triangles` use.
    fn look<'t>(
        &mut self,
        mesh: &CreaseMesh<'_>,
        triangles: impl Iterator<Item = &'t u32>,
        start: u32,
        count: usize,
    ) {
        let Self { faces, firsts, nexts, .. } = self;
        faces.clear();
        faces.extend(triangles.filter_map(|&number| mesh.face(number)));
        firsts.clear();
        firsts.resize(count, NO_VALUE);
        nexts.clear();
        nexts.resize(3 * faces.len(), NO_VALUE);
        for (i, face) in faces.iter().enumerate().rev() {
            for (k, vertex) in face.vertices.into_iter().enumerate() {
                if let Some(first) = firsts.get_mut(vertex.wrapping_sub(start) as usize) {
                    nexts[3 * i + k] = std::mem::replace(first, (3 * i + k) as u32);
                }
            }
        }
    }

    /// Computes the normals around the `vertex`th of the range: the first, and `further` ones.
    fn add(&mut self, vertex: usize, least: f64, value: &mut Vec3, further: &mut Further) {
        let Self { faces, firsts, nexts, corners, edges, sums } = self;
        corners.clear();
        edges.clear();
        sums.clear();
        let mut corner = firsts[vertex];
        while corner != NO_VALUE {
            let (face, k) = (&faces[corner as usize / 3], corner as usize % 3);
            let (number, group) = (3 * face.number + k as u32, corners.len());
            edges.extend([1, 2].map(|turn| (face.vertices[(k + turn) % 3], group)));
            corners.push(Corner { number, normal: face.normal, weight: face.angles[k], group });
            corner = nexts[corner as usize];
        }
        edges.sort_unstable();
        for &[(end, one), (other_end, other)] in edges.array_windows() {
            if end == other_end && corners[one].normal.dot(corners[other].normal) >= least {
                let (one, other) = (first(corners, one), first(corners, other));
                corners[one.max(other)].group = one.min(other);
            }
        }
        let others = further.normals.len();
        for place in 0..corners.len() {
            let Corner { number, normal, weight, group } = corners[place];
            let part = normal * weight;
            let group = if group == place { sums.len() } else { corners[group].group };
            // Kept as sums in double precision until all are added.
            match sums.get_mut(group) {
                Some(sum) => *sum += part,
                None => sums.push(part),
            }
            corners[place].group = group;
            if group > 0 {
                further.corners.push((number, (others + group - 1) as u32));
            }
        }
        let mut normals = sums.iter().map(|sum| direction(*sum).unwrap_or_default().as_vec3());
        *value = normals.next().unwrap_or_default();
        further.normals.extend(normals);
    }
}

/// The first corner of a group.
fn first(corners: &mut [Corner], mut place: usize) -> usize {
    while corners[place].group != place {
        // Path halving, for later searches.
        corners[place].group = corners[corners[place].group].group;
        place = corners[place].group;
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The normals at the corners of these triangles.
    fn found(points: &[Vec3], triangles: &[[u32; 3]], degrees: f64) -> Vec<[Vec3; 3]> {
        let Attribute { values, indices } = normals(points, triangles, degrees, false);
        let of = |corners: &[u32; 3]| corners.map(|i| values[i as usize]);
        indices.as_deref().map_or(triangles, Vec::as_slice).iter().map(of).collect()
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
            let found = found(&points, &triangles, crease);
            assert_eq!(found[1][1] == found[2][1], is_smooth, "{degrees}");
            assert_eq!(found[0][0], Vec3::Y, "at the border");
            let count = normals(&points, &triangles, crease, false).values.len();
            assert_eq!(count, if is_smooth { 6 } else { 8 });
            let half = (degrees / 2.0).to_radians();
            let expected = if is_smooth { Vec3::new(half.sin(), half.cos(), 0.0) } else { Vec3::Y };
            assert!(
                found[1][1].distance(expected) < 1e-6,
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
                let normals =
                    |crease| normals(&points, &triangles, crease, false).values.len() as u32;
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
        assert_eq!(found(&points, &triangles, 30.0), found(&soup, &alone, 30.0));
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
        let on_all = normals(&points, &triangles, 30.0, false);
        assert!(on_all.values[0].distance(Vec3::Y) < 1e-4);
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        assert_eq!(
            alone.install(|| normals(&points, &triangles, 30.0, false)),
            on_all,
            "on one thread"
        );
    }

    #[test]
    fn triangles_without_area_and_turned_ones_join_nothing() {
        let (points, mut triangles) = fold(10.0);
        triangles.push([0, 1, 1]);
        triangles[2] = [3, 2, 5];
        let found = found(&points, &triangles, 30.0);
        assert!(found[2][1].y < 0.0 && found[1][1].y > 0.0);
    }

    /// Weights are angles, and triangles with vertices from everywhere change nothing.
    #[test]
    fn angles_are_close_and_the_order_of_triangles_does_not_matter() {
        let steps = (-1000..=1000).map(|i| f64::from(i) / 1000.0);
        let error = steps.map(|x| (angle(x) - libm::acos(x)).abs()).fold(0.0, f64::max);
        assert!(error < 3e-8, "{error}");
        let count = 40_000_u32;
        let (points, triangles) = prism(count, 1.0, 0.0);
        let in_order = found(&points, &triangles, 30.0);
        let scattered = |i: usize| i * 7919 % triangles.len();
        let turned: Vec<_> = (0..triangles.len()).map(|i| triangles[scattered(i)]).collect();
        let other = found(&points, &turned, 30.0);
        let indices = normals(&points, &triangles, 30.0, false).indices;
        assert!(indices.is_none(), "without creases, a normal belongs to a vertex");
        for i in (0..triangles.len()).step_by(97) {
            assert!(other[i][1].distance(in_order[scattered(i)][1]) < 1e-6);
        }
    }
}
