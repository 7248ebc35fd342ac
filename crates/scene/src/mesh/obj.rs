//! Wavefront OBJ: a text of statements, of which `v`, `vt`, `vn`, `f`, `usemtl` and `mtllib` are
//! read. Groups, points, lines, curves and unknown statements are skipped.
//!
//! The file is read in blocks of whole statements, so that the text of a large one is never
//! entirely in memory. A block is cut into pieces, which are read in parallel ([`Contents`])
//! without knowledge of earlier ones. If a piece needs that, for an index that counts backward or
//! for the line of an error, it is read once more after the statements before it have been counted
//! ([`LineCounts`]). The pieces are then joined in order; the result does not depend on the cuts.
//!
//! The crate `tobj` reads the same format on one thread. It is not used because its errors name no
//! line, and because it makes one mesh of each group.

mod contents;
mod lines;

use super::data::{Attribute, MeshData, Read};
use super::faults::{check_count, no_triangles, too_few_corners};
use super::origin::origin;
use super::place::ReadAt;
use super::polygon;
use super::validate::{mend, scale_byte_colors};
use contents::{Contents, LineCounts, NO_VALUES, WHITE};
use lines::{cut, each_block};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::parallel;

pub(super) use lines::BLOCK;

/// Reads a file of `length` bytes, in blocks and pieces of about these sizes.
pub(super) fn read(file: &dyn ReadAt, length: u64, block: usize, piece: usize) -> Result<Read> {
    let mut parts = UnfinishedMesh::default();
    each_block(file, length, block, |text| parts.add_block(text, piece))?;
    // An index may refer to later values.
    let indices = parts.all.indices.each_ref().map(|all| all.as_flattened());
    if let Some(error) = parts.start.first_beyond(indices) {
        // Its line is found by reading the file again: storing the line of every face for a rare
        // error would cost memory in every load.
        let (mut start, origin) = (LineCounts::default(), parts.all.origin);
        each_block(file, length, block, |text| {
            let (count, piece) = Contents::read(text, Some(start), origin, Some(&parts.start));
            start = count;
            piece.map(drop)
        })?;
        return Err(error);
    }
    parts.finish()
}

/// The mesh so far.
#[derive(Debug, Default)]
struct UnfinishedMesh {
    /// The counts before the next block.
    start: LineCounts,
    all: Contents,
}

impl UnfinishedMesh {
    fn add_block(&mut self, text: &[u8], piece: usize) -> Result<()> {
        if self.start.values[0] == 0 {
            self.all.origin = contents::first_position(text).map(origin).unwrap_or_default();
        }
        let origin = self.all.origin;
        let pieces = cut(text, piece);
        let read = parallel::map(pieces.iter(), |text| Contents::read(text, None, origin, None));
        let mut starts = Vec::with_capacity(read.len());
        for (count, _) in &read {
            starts.push(self.start);
            self.start = self.start.plus(*count);
        }
        let plurals = ["vertices", "texture coordinates", "normals"];
        for (what, count) in plurals.into_iter().zip(self.start.values) {
            check_count(what, count)?;
        }
        let again = |(((_, piece), text), start): (((_, Result<Contents>), &&[u8]), LineCounts)| {
            piece.or_else(|_| Contents::read(text, Some(start), origin, None).1)
        };
        let read = parallel::map(read.into_iter().zip(&pieces).zip(starts), again);
        read.into_iter().try_for_each(|piece| self.all.append(piece?))
    }

    fn finish(self) -> Result<Read> {
        let mut all = self.all;
        let [mut triangles, mut of_uvs, mut of_normals] = all.indices;
        if triangles.is_empty() {
            return Err(no_triangles());
        }
        let mut notes = Vec::new();
        for (keyword, values, indices) in
            [("vt", all.uvs.len(), &mut of_uvs), ("vn", all.normals.len(), &mut of_normals)]
        {
            if !indices.is_empty() && values == 0 {
                *indices = Vec::new();
                let message = format!("faces refer to \"{keyword}\", but the file has none");
                let note = Error::new(ErrorKind::Mesh, message);
                notes.push(note.remedy("these indices are ignored"));
            } else if !indices.is_empty() {
                indices.resize(triangles.len(), NO_VALUES);
            }
        }
        if !all.colors.is_empty() {
            all.colors.resize(all.positions.len(), WHITE);
        }
        let attributes = &mut [&mut of_uvs[..], &mut of_normals[..]];
        notes.extend(too_few_corners(all.too_few_corners));
        if all.has_paint {
            let note = Error::new(ErrorKind::Mesh, "colours in comments (#MRGB) are ignored");
            notes.push(note.remedy("export colours after the coordinates of vertices, or as PLY"));
        }
        notes.extend(polygon::split(&all.polygons, &all.positions, &mut triangles, attributes));
        notes.extend(mend(&mut all.normals, &mut all.uvs, &mut all.colors));
        notes.extend(scale_byte_colors(&mut all.colors));
        all.positions.shrink_to_fit();
        all.colors.shrink_to_fit();
        triangles.shrink_to_fit();
        let count = all.positions.len();
        let mesh = MeshData {
            uvs: attribute(all.uvs, of_uvs, &triangles, count),
            normals: attribute(all.normals, of_normals, &triangles, count),
            positions: all.positions.into(),
            origin: all.origin,
            triangles: triangles.into(),
            colors: (!all.colors.is_empty()).then_some(all.colors.into()),
            alphas: None,
        };
        Ok((mesh, notes, all.materials))
    }
}

/// An attribute that some corner has. Indices equal to those of the positions are dropped.
fn attribute<T>(
    mut values: Vec<T>,
    mut indices: Vec<[u32; 3]>,
    triangles: &[[u32; 3]],
    positions: usize,
) -> Option<Attribute<T>> {
    if indices.is_empty() {
        return None;
    }
    values.shrink_to_fit();
    indices.shrink_to_fit();
    let same = values.len() == positions && indices == triangles;
    Some(Attribute { values: values.into(), indices: (!same).then_some(indices.into()) })
}

#[cfg(test)]
mod tests;
