//! The triangles at each edge of a mesh: where a ray must not pass between them.

use glam::Vec3;
use rayon::prelude::*;

use wavecrest_core::geometry::Geometry;

/// An edge that two triangles share.
pub(super) struct Edge {
    /// Its ends, as the first vertex at each position.
    pub(super) ends: [u32; 2],
    pub(super) triangles: [u32; 2],
}

/// An edge of a triangle: the numbers of its ends, the lower first, and the triangle.
type Side = ([u32; 2], u32);

/// The edges of a mesh's triangles, without degenerate ones.
pub(super) struct Topology {
    /// Sorted by the numbers of their ends.
    sides: Vec<Side>,
    /// Edges of only one triangle: the border of the mesh.
    pub(super) borders: u64,
    /// Edges of more than two.
    pub(super) crowded: u64,
}

impl Topology {
    pub(super) fn new(geometry: &Geometry) -> Self {
        let number = weld(&geometry.positions);
        let mut sides: Vec<Side> = (0..geometry.triangles.len() as u32)
            .into_par_iter()
            .filter(|&triangle| !geometry.is_degenerate(triangle))
            .flat_map_iter(|triangle| {
                let [a, b, c] = geometry.triangles[triangle as usize].map(|v| number[v as usize]);
                [[a, b], [b, c], [c, a]].map(|[a, b]| ([a.min(b), a.max(b)], triangle))
            })
            .collect();
        sides.par_sort_unstable();
        let groups = sides.chunk_by(|a, b| a.0 == b.0).map(<[Side]>::len);
        let (borders, crowded) = groups.fold((0, 0), |(borders, crowded), triangles| {
            (borders + u64::from(triangles == 1), crowded + u64::from(triangles > 2))
        });
        Self { sides, borders, crowded }
    }

    /// The number of indices for [`Self::edge`].
    pub(super) fn len(&self) -> usize {
        self.sides.len()
    }

    /// The edge at an index; `None` if it does not have two triangles.
    pub(super) fn edge(&self, place: usize) -> Option<Edge> {
        let (ends, _) = self.sides[place];
        let first = self.sides.partition_point(|side| side.0 < ends);
        let count = self.sides[first..].iter().take_while(|side| side.0 == ends).count();
        let triangles = || [self.sides[first].1, self.sides[first + 1].1];
        (count == 2).then(|| Edge { ends, triangles: triangles() })
    }
}

/// For each vertex the first at its position.
fn weld(positions: &[Vec3]) -> Vec<u32> {
    // Zeros of both signs are the same position.
    let place = |v: u32| positions[v as usize].to_array().map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&v| (place(v), v));
    let mut number = vec![0; positions.len()];
    for same in order.chunk_by(|&a, &b| place(a) == place(b)) {
        same.iter().for_each(|&v| number[v as usize] = same[0]);
    }
    number
}
