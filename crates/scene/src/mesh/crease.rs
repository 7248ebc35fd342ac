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
//! Each thread has a range of the vertices, and a list of the corners at each: a pass over all triangles counts them, a
//! second one fills it.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::Attribute;
use super::join::first_of_each;
use wavecrest_base::parallel;
use wavecrest_base::shared::Shared;

/// Largest rotation of a face by single-precision rounding, in degrees. The edges of a prism of
/// twelve sides have 30 degrees up to this error; either all of them are creases or none.
const ROUNDING: f64 = 1e-3;

/// Edges of more degrees are always creases: the normals of faces back to back would cancel out. Single precision tells
/// them from these.
const WIDEST: f64 = 179.9;

/// The most corners at a vertex that are searched for each other one by one. Nearly all vertices have fewer.
const FEW: usize = 16;

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
    let numbered = joined.as_deref().unwrap_or(triangles);
    let face = |vertices: &[u32; 3]| CreaseFace::of(vertices.map(|v| positions[v as usize]));
    let faces: Vec<CreaseFace> = numbered.par_iter().map(face).collect();
    let half_sine = libm::sin((degrees - ROUNDING).clamp(0.0, WIDEST).to_radians() / 2.0);
    let most = (4.0 * half_sine * half_sine) as f32;
    let size = positions.len().div_ceil(rayon::current_num_threads()).max(1);
    let mut values = vec![Vec3::ZERO; positions.len()];
    let ranges = values.chunks_mut(size).enumerate();
    let further = parallel::map(ranges, |(range, values)| {
        smooth(numbered, &faces, most, (range * size) as u32, values)
    });
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

/// The face of a triangle.
#[derive(Clone, Copy, Default)]
struct CreaseFace {
    /// Of unit length; zero without area.
    normal: Vec3,
    /// The angle at each corner, in radians.
    angles: [f32; 3],
}

impl CreaseFace {
    /// In double precision no square of a length underflows: differences of single-precision numbers are multiples of the
    /// smallest of these.
    fn of(vertices: [Vec3; 3]) -> Self {
        let [a, b, c] = vertices.map(|v| v.as_dvec3());
        let [ab, bc, ca] = [b - a, c - b, a - c];
        let cross = ab.cross(bc);
        let area = cross.length();
        if area == 0.0 {
            return Self::default();
        }
        let angle = |dot: f64| FRAC_PI_2 + libm::atanf((dot / area) as f32);
        let [at_a, at_b] = [ab.dot(ca), ab.dot(bc)].map(angle);
        Self { normal: (cross / area).as_vec3(), angles: [at_a, at_b, (PI - at_a - at_b).max(0.0)] }
    }
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
    /// The vertices before and after it.
    ends: [u32; 2],
    /// Of its face.
    normal: Vec3,
    /// Its angle.
    weight: f32,
    /// An earlier corner of the same group, or itself; in the end the first of the group.
    group: usize,
}

/// Computes the normals around the vertices from `start` on: the first of each, and further ones. `most` is the largest
/// squared distance between normals of faces that meet smoothly: in single precision it shows small angles, which a cosine
/// does not.
fn smooth(
    triangles: &[[u32; 3]],
    faces: &[CreaseFace],
    most: f32,
    start: u32,
    values: &mut [Vec3],
) -> Further {
    let corners = || (0..).zip(triangles.as_flattened());
    let place = |vertex: &u32| vertex.wrapping_sub(start) as usize;
    // Where the corners of each vertex begin in their list; once they are there, where they end.
    let mut bounds = vec![0_u32; values.len() + 1];
    for (_, vertex) in corners() {
        if let Some(count) = bounds[1..].get_mut(place(vertex)) {
            *count += 1;
        }
    }
    let mut count = 0;
    for bound in &mut bounds {
        count += *bound;
        *bound = count;
    }
    let mut list = vec![0_u32; count as usize];
    for (number, vertex) in corners() {
        if let Some(bound) = bounds[..values.len()].get_mut(place(vertex)) {
            list[*bound as usize] = number;
            *bound += 1;
        }
    }
    let (mut further, mut corners) = (Further::default(), Vec::new());
    let mut begin = 0;
    for (value, end) in values.iter_mut().zip(bounds) {
        corners.clear();
        for &number in &list[begin as usize..end as usize] {
            let (face, k) = (number as usize / 3, number as usize % 3);
            let (vertices, CreaseFace { normal, angles }) = (&triangles[face], faces[face]);
            if normal != Vec3::ZERO {
                let (ends, weight) = ([2, 1].map(|turn| vertices[(k + turn) % 3]), angles[k]);
                corners.push(Corner { number, ends, normal, weight, group: 0 });
            }
        }
        add(&mut corners, most, value, &mut further);
        begin = end;
    }
    further
}

/// Computes the normals of the groups of these corners around a vertex: the first, and `further` ones.
fn add(corners: &mut [Corner], most: f32, value: &mut Vec3, further: &mut Further) {
    if !is_fan(corners, most) {
        group(corners, most);
    }
    for (i, group) in corners.chunk_by(|one, other| one.group == other.group).enumerate() {
        let parts = group.iter().map(|corner| (corner.normal * corner.weight).as_dvec3());
        // Kept in double precision until all are added.
        let normal = parts.sum::<DVec3>().normalize_or_zero().as_vec3();
        if i == 0 {
            *value = normal;
        } else {
            let number = further.normals.len() as u32;
            further.corners.extend(group.iter().map(|corner| (corner.number, number)));
            further.normals.push(normal);
        }
    }
}

/// Whether all corners are one group because each shares an edge with the next, which puts them in this order: so it is
/// at nearly all vertices.
fn is_fan(corners: &mut [Corner], most: f32) -> bool {
    let count = corners.len();
    let has_next = |place: usize| {
        let (fan, others) = corners.split_at_mut(place);
        let last = &fan[place - 1];
        let next = others.iter().position(|other| other.ends[0] == last.ends[1]);
        next.is_some_and(|next| {
            others.swap(0, next);
            last.normal.distance_squared(others[0].normal) <= most
        })
    };
    count <= FEW && (1..count).all(has_next)
}

/// Puts the corners in the order of their groups.
fn group(corners: &mut [Corner], most: f32) {
    let mut edges = Vec::with_capacity(2 * corners.len());
    for (place, corner) in corners.iter_mut().enumerate() {
        corner.group = place;
        edges.extend(corner.ends.map(|end| (end, place)));
    }
    edges.sort_unstable();
    for &[(end, one), (other_end, other)] in edges.array_windows() {
        if end == other_end && corners[one].normal.distance_squared(corners[other].normal) <= most {
            let (one, other) = (first(corners, one), first(corners, other));
            corners[one.max(other)].group = one.min(other);
        }
    }
    for place in 0..corners.len() {
        corners[place].group = first(corners, place);
    }
    corners.sort_unstable_by_key(|corner| (corner.group, corner.number));
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

    /// Faces that share a vertex and no edge, and both sides of a sheet.
    #[test]
    fn faces_without_a_smooth_edge_are_groups_of_their_own() {
        let points = [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::new(-1.0, 0.1, 0.0), Vec3::NEG_Z];
        let found = |other| {
            let found = found(&points, &[[0, 2, 1], other], 180.0);
            [found[0][0], found[1][0]]
        };
        let [up, other] = found([0, 4, 3]);
        assert!(up == Vec3::Y && other != up && other.dot(up) > 0.99);
        assert_eq!(found([0, 1, 2]), [Vec3::Y, Vec3::NEG_Y]);
    }

    /// Weights are angles, and triangles with vertices from everywhere change nothing.
    #[test]
    fn angles_are_close_and_the_order_of_triangles_does_not_matter() {
        for x in (-999..1000).map(|i| f64::from(i) / 1000.0) {
            let other = DVec3::new(x, (1.0 - x * x).sqrt(), 0.0).as_vec3();
            let angle = CreaseFace::of([Vec3::ZERO, Vec3::X, other]).angles[0];
            assert!((f64::from(angle) - libm::acos(x)).abs() < 2e-6, "{x}: {angle}");
        }
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
