//! The faces at each edge of a mesh: where a ray must not pass between them.

use super::prelude::*;
use wavecrest_core::kernels::triangle::is_degenerate;
use wavecrest_scene::mesh::first_of_each;

/// A triangle at an edge: the vertex opposite to the edge, and the primitive's number.
pub(super) type EdgeFace = (u32, u32);

/// An edge of a face: the numbers of its ends, the lower first.
type FaceEdge = ([u32; 2], EdgeFace);

/// The edges of a mesh's triangles and of the halves of its quads, without degenerate ones.
pub(super) struct Topology {
    /// Sorted by the numbers of their ends.
    sides: Vec<FaceEdge>,
    /// Edges of only one face: the border of the mesh.
    pub(super) borders: u64,
    /// Edges of more than two.
    pub(super) crowded: u64,
}

impl Topology {
    pub(super) fn new(geometry: &Geometry) -> Self {
        let number = first_of_each(&geometry.positions);
        let triangles = (0..).zip(&geometry.triangles).map(|(i, &corners)| (i, corners));
        let first = geometry.triangles.len() as u32;
        let quads = (first..).zip(&geometry.quads);
        let all = triangles.chain(quads.flat_map(|(i, quad)| halves(quad).map(|half| (i, half))));
        let all: Vec<(u32, [u32; 3])> = all.collect();
        let mut sides: Vec<FaceEdge> = all
            .into_par_iter()
            .filter(|(_, face)| !is_degenerate(&face.map(|v| geometry.positions[v as usize])))
            .flat_map_iter(|(primitive, face)| {
                let [a, b, c] = face.map(|v| number[v as usize]);
                [[a, b, c], [b, c, a], [c, a, b]]
                    .map(|[a, b, c]| ([a.min(b), a.max(b)], (c, primitive)))
            })
            .collect();
        sides.par_sort_unstable();
        let groups = sides.chunk_by(|a, b| a.0 == b.0).map(<[FaceEdge]>::len);
        let (borders, crowded) = groups.fold((0, 0), |(borders, crowded), faces| {
            (borders + u64::from(faces == 1), crowded + u64::from(faces > 2))
        });
        Self { sides, borders, crowded }
    }

    /// The number of indices for [`Self::edge`].
    pub(super) fn len(&self) -> usize {
        self.sides.len()
    }

    /// The ends of the edge at an index, as the first vertex at each position, and the faces there;
    /// `None` if there are not two.
    pub(super) fn edge(&self, place: usize) -> Option<([u32; 2], [EdgeFace; 2])> {
        let (ends, _) = self.sides[place];
        let first = self.sides.partition_point(|side| side.0 < ends);
        let count = self.sides[first..].iter().take_while(|side| side.0 == ends).count();
        (count == 2).then(|| (ends, [self.sides[first].1, self.sides[first + 1].1]))
    }
}
