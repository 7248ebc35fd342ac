//! Seals: degenerate triangles that keep a mesh tight.
//!
//! Scans with rounded vertices contain triangles whose corners a, m, b lie on one line. Such a
//! triangle is invisible; but the neighbour across ab has one edge where the neighbours across am
//! and mb have two, and from a ray's view single precision places m slightly beside the edge ab. A
//! ray could slip through there. So the triangle stays in the tree, tested like any other with the
//! corners that its neighbours share, and a hit on it counts as one on the neighbour across its
//! longest edge. Without that neighbour it closes nothing and is left out, as are triangles with
//! two corners at one place.

use std::collections::HashMap;

use glam::Vec3;
use rayon::prelude::*;
use xxhash_rust::xxh3::xxh3_64;

use super::geometry::Geometry;

/// The bits of an edge's ends, the lower ones first.
type Edge = [[u32; 3]; 2];

/// Largest number of seals between a seal and a triangle with an area.
const MOST_BETWEEN: usize = 64;

/// Slots in the filter of vertices for each edge.
const FILTER: usize = 16;

/// The seals of a mesh. Nearly every hit is on another triangle: a bit tells so at once.
#[derive(Clone, Debug, Default)]
pub struct Seals {
    /// The number of each seal and that of the triangle it stands for, in rising order.
    pairs: Vec<[u32; 2]>,
    /// A bit for each [`STRIDE`] numbers, without the trailing zeros.
    marks: Vec<u64>,
}

/// Numbers that share a bit.
const STRIDE: usize = 16;

impl Seals {
    fn of(pairs: Vec<[u32; 2]>) -> Self {
        let bit = |number: u32| number as usize / STRIDE;
        let bits = pairs.last().map_or(0, |&[last, _]| bit(last) + 1);
        let mut marks = vec![0; bits.div_ceil(64)];
        pairs.iter().for_each(|&[number, _]| marks[bit(number) / 64] |= 1 << (bit(number) % 64));
        Self { pairs, marks }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    pub(super) fn len(&self) -> usize {
        self.pairs.len()
    }

    pub(super) fn numbers(&self) -> impl Iterator<Item = u32> {
        self.pairs.iter().map(|&[number, _]| number)
    }

    /// The triangle that the seal with that number stands for, if it is a seal.
    #[inline(always)]
    pub(super) fn get(&self, number: u32) -> Option<u32> {
        let bit = number as usize / STRIDE;
        let is_marked = self.marks.get(bit / 64).is_some_and(|marks| marks >> (bit % 64) & 1 == 1);
        if is_marked { self.find(number) } else { None }
    }

    #[cold]
    fn find(&self, number: u32) -> Option<u32> {
        let place = self.pairs.binary_search_by_key(&number, |&[own, _]| own).ok()?;
        Some(self.pairs[place][1])
    }
}

/// The seals among the `degenerate` triangles of a mesh, by number, each with the triangle it
/// stands for.
pub(super) fn find(geometry: &Geometry, degenerate: &[u32]) -> Seals {
    let has_three_corners = |&number: &u32| {
        let [a, b, c] = geometry.triangle(number as usize);
        a != b && b != c && c != a
    };
    let pinched: Vec<u32> = degenerate.iter().copied().filter(has_three_corners).collect();
    if pinched.is_empty() {
        return Seals::default();
    }
    let neighbours = across_longest_edges(geometry, &pinched);
    let mut seals: HashMap<u32, u32> = HashMap::new();
    for &(number, other) in &neighbours {
        if !geometry.is_degenerate(other) {
            seals.entry(number).or_insert(other);
        }
    }
    // Others lie beside a seal.
    for _ in 0..MOST_BETWEEN {
        let more: Vec<(u32, u32)> = neighbours
            .iter()
            .filter(|(number, _)| !seals.contains_key(number))
            .filter_map(|(number, other)| seals.get(other).map(|&other| (*number, other)))
            .collect();
        if more.is_empty() {
            break;
        }
        for (number, other) in more {
            seals.entry(number).or_insert(other);
        }
    }
    let mut seals: Vec<[u32; 2]> =
        seals.into_iter().map(|(number, other)| [number, other]).collect();
    seals.sort_unstable();
    Seals::of(seals)
}

/// Each `pinched` triangle with the other triangles at its longest edge, in rising order.
fn across_longest_edges(geometry: &Geometry, pinched: &[u32]) -> Vec<(u32, u32)> {
    let mut longest: HashMap<Edge, Vec<u32>> = HashMap::new();
    // Nearly every vertex of the mesh is at none of these ends: a filter after Bloom (1970)
    // tells so at once.
    let places = (FILTER * pinched.len()).next_power_of_two();
    let place = |end: &[u32; 3]| xxh3_64(bytemuck::bytes_of(end)) as usize & (places - 1);
    let mut is_end = vec![false; places];
    for &number in pinched {
        let edge = longest_edge(geometry, number);
        edge.iter().for_each(|end| is_end[place(end)] = true);
        longest.entry(edge).or_default().push(number);
    }
    let may_be: Vec<bool> =
        geometry.positions.par_iter().map(|&v| is_end[place(&bits(v))]).collect();
    let mut neighbours: Vec<(u32, u32)> = (0..geometry.triangles.len() as u32)
        .into_par_iter()
        .filter(|&other| {
            let ends = geometry.triangles[other as usize].iter().filter(|&&v| may_be[v as usize]);
            ends.count() > 1
        })
        .flat_map_iter(|other| {
            let edges = edges(geometry, other).into_iter();
            let found = edges.filter_map(|edge| longest.get(&edge));
            let pairs = found.flatten().filter(move |&&number| number != other);
            pairs.map(move |&number| (number, other))
        })
        .collect();
    neighbours.par_sort_unstable();
    neighbours
}

fn edges(geometry: &Geometry, number: u32) -> [Edge; 3] {
    let [a, b, c] = geometry.triangle(number as usize);
    [edge(a, b), edge(b, c), edge(c, a)]
}

fn edge(a: Vec3, b: Vec3) -> Edge {
    let [a, b] = [a, b].map(bits);
    if a < b { [a, b] } else { [b, a] }
}

/// The bits of a position; zeros of both signs are equal.
fn bits(v: Vec3) -> [u32; 3] {
    v.to_array().map(|x| (x + 0.0).to_bits())
}

fn longest_edge(geometry: &Geometry, number: u32) -> Edge {
    let [a, b, c] = geometry.triangle(number as usize);
    let length = |p: Vec3, q: Vec3| p.as_dvec3().distance_squared(q.as_dvec3());
    let (ab, bc, ca) = (length(a, b), length(b, c), length(c, a));
    if ab >= bc && ab >= ca {
        edge(a, b)
    } else if bc >= ca {
        edge(b, c)
    } else {
        edge(c, a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::build::Preset;
    use crate::accel::{Accel, Hit, KernelChoice};
    use crate::math::random::Stream;
    use crate::math::ray::Ray;

    /// A tetrahedron; an edge of it has a vertex that one of the faces there lacks, and a triangle
    /// without area between. Its numbers have few bits, so that the three are on one line.
    fn pinched_tetrahedron(offset: f32) -> Geometry {
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z) + offset;
        let positions = vec![
            at(-7.0, -5.0, -9.0),
            at(9.0, 7.0, -5.0),
            at(-3.0, -2.0, -8.0),
            at(3.0, -11.0, 9.0),
            at(-9.0, 10.0, 8.0),
        ];
        let triangles = vec![[0, 1, 3], [0, 2, 1], [0, 4, 2], [2, 4, 1], [1, 4, 3], [0, 3, 4]];
        Geometry { positions, triangles, ..Geometry::default() }
    }

    #[test]
    fn hc18_a_triangle_without_area_closes_the_gap_beside_it() {
        for offset in [0.0, 1000.0] {
            let geometry = pinched_tetrahedron(offset);
            let [a, b] = [geometry.positions[0], geometry.positions[1]].map(|v| v.as_dvec3());
            assert!(geometry.is_degenerate(1));
            let rays: Vec<Ray> = (0..200_000)
                .map(|i| {
                    let [x, y, z, part] =
                        Stream { seed: 4, pixel: i, sample: 0, bounce: 0 }.uniform(0);
                    let origin = Vec3::new(x, y, z) * 0.5 - 0.25 + offset;
                    let target = (a + (b - a) * f64::from(part)).as_vec3();
                    Ray::new(origin, target - origin)
                })
                .collect();
            let mut accel = Accel::new(geometry.clone(), Preset::VeryFast);
            assert_eq!(
                (accel.left_out(), accel.geometry.seals.pairs.as_slice()),
                (1, &[[1, 0]][..])
            );
            for preset in [Preset::Brute, Preset::Medium] {
                let accel = Accel::new(geometry.clone(), preset);
                let (_, seals) = (accel.left_out(), &accel.geometry.seals);
                assert_eq!(seals.pairs.as_slice(), &[[1, 0]]);
            }
            let mut hits = vec![Hit::MISS; rays.len()];
            for kernel in KernelChoice::ALL {
                accel.kernel = kernel;
                accel.closest_of(&rays[..], &mut hits, &mut accel.traversal());
                for (ray, hit) in rays.iter().zip(&hits) {
                    let is_right =
                        !hit.is_miss() && hit.primitive != 1 && (hit.t - 1.0).abs() < 1e-3;
                    assert!(is_right, "{offset}, {kernel:?}: {ray:?} {hit:?}");
                }
            }
            // Without the seal there is a gap.
            let mut triangles = geometry.triangles.clone();
            triangles.remove(1);
            let open = Accel::new(Geometry { triangles, ..geometry }, Preset::VeryFast);
            open.closest_of(&rays[..], &mut hits, &mut open.traversal());
            assert!(hits.iter().any(Hit::is_miss));
        }
    }

    #[test]
    fn hc18_a_triangle_without_area_or_neighbours_is_left_out() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::Y];
        let triangles = vec![[0, 1, 2], [1, 1, 3]];
        let geometry = Geometry { positions, triangles, ..Geometry::default() };
        let accel = Accel::new(geometry, Preset::VeryFast);
        assert_eq!((accel.left_out(), accel.geometry.seals.len()), (2, 0));
        let ray = Ray::new(Vec3::new(0.5, 0.0, 1.0), Vec3::NEG_Z);
        assert!(accel.closest(&ray, &mut accel.traversal()).is_miss());
    }
}
