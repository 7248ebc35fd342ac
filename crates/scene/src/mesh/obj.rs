//! Wavefront OBJ: a text of statements, of which `v`, `vt`, `vn`, `f`, `usemtl` and `mtllib` are
//! read. Groups, points, lines, curves and unknown statements are skipped.
//!
//! The file is read in blocks of whole statements, so that the text of a large one is never
//! entirely in memory. A block is cut into pieces, which are read in parallel ([`Contents`])
//! without knowledge of earlier ones. If a piece needs that, for an index that counts backward or
//! for the line of an error, it is read once more after the statements before it have been counted
//! ([`Count`]). The pieces are then joined in order; the result does not depend on the cuts.
//!
//! The crate `tobj` reads the same format on one thread. It is not used because its errors name no
//! line, and because it makes one mesh of each group.

mod contents;
mod corners;
mod count;
mod lines;

use glam::DVec3;
use rayon::prelude::*;

use super::data::{Attribute, MeshData, NamedMaterials, Read};
use super::faults::{check_count, no_triangles};
use super::origin::origin;
use super::place::ReadAt;
use super::polygon;
use super::validate::{first_with, mend, scale_byte_colors};
use contents::{Contents, NO_VALUES, WHITE};
use corners::{Corners, first_beyond, is_beyond};
use count::Count;
use lines::{Keyword, Statement, cut, each_block, statements};
use wavecrest_base::error::{Error, ErrorKind, Result};

pub(super) use count::survey;
pub(super) use lines::BLOCK;

/// Reads a file of `length` bytes, in blocks and pieces of about these sizes.
pub(super) fn read(
    file: &dyn ReadAt,
    length: u64,
    block: usize,
    piece: usize,
) -> Result<(Read, NamedMaterials)> {
    let mut parts = Parts::default();
    each_block(file, length, block, |text| parts.add_block(text, piece))?;
    if let Some(error) = parts.first_bad_index() {
        return Err(find_bad_face(file, length, block, parts.start)?.unwrap_or(error));
    }
    parts.finish()
}

/// The mesh so far.
#[derive(Debug, Default)]
struct Parts {
    /// The counts before the next block.
    start: Count,
    /// Known from the first position on.
    origin: Option<DVec3>,
    all: Contents,
}

impl Parts {
    fn add_block(&mut self, text: &[u8], piece: usize) -> Result<()> {
        self.origin = self.origin.or_else(|| contents::first_position(text).map(origin));
        let origin = self.origin.unwrap_or_default();
        let pieces = cut(text, piece);
        let read: Vec<(Count, Result<Contents>)> =
            pieces.par_iter().map(|text| Contents::read(text, None, origin)).collect();
        let mut starts = Vec::with_capacity(read.len());
        for (count, _) in &read {
            starts.push(self.start);
            self.start = self.start.plus(*count);
        }
        let plurals = ["vertices", "texture coordinates", "normals"];
        for (what, count) in plurals.into_iter().zip(self.start.values()) {
            check_count(what, count)?;
        }
        let again = |(((_, piece), text), start): (((_, Result<Contents>), &&[u8]), Count)| {
            piece.or_else(|_| Contents::read(text, Some(start), origin).1)
        };
        let read: Vec<Result<Contents>> =
            read.into_par_iter().zip(&pieces).zip(starts).map(again).collect();
        read.into_iter().try_for_each(|piece| self.all.append(piece?))
    }

    /// The error of an index that refers to nothing in the whole file: an index may refer to later
    /// values.
    fn first_bad_index(&self) -> Option<Error> {
        let Contents { triangles, uv_indices, normal_indices, .. } = &self.all;
        first_beyond(&self.start, |kind, count| {
            let indices = [triangles, uv_indices, normal_indices][kind];
            first_with(indices, |index| is_beyond(index, count)).map(|(_, index)| index)
        })
    }

    fn finish(self) -> Result<(Read, NamedMaterials)> {
        let mut all = self.all;
        if all.triangles.is_empty() {
            return Err(no_triangles());
        }
        let mut notes = Vec::new();
        notes.extend(drop_absent("vt", all.uvs.len(), &mut all.uv_indices));
        notes.extend(drop_absent("vn", all.normals.len(), &mut all.normal_indices));
        let mut attributes = Vec::new();
        for indices in [&mut all.uv_indices, &mut all.normal_indices] {
            if !indices.is_empty() {
                indices.resize(all.triangles.len(), NO_VALUES);
                attributes.push(&mut indices[..]);
            }
        }
        if !all.colors.is_empty() {
            all.colors.resize(all.positions.len(), WHITE);
        }
        let (positions, triangles) = (&all.positions, &mut all.triangles);
        notes.extend(polygon::split(&all.polygons, positions, triangles, &mut attributes));
        notes.extend(mend(&mut all.normals, &mut all.uvs, &mut all.colors));
        notes.extend(scale_byte_colors(&mut all.colors));
        all.positions.shrink_to_fit();
        all.colors.shrink_to_fit();
        all.triangles.shrink_to_fit();
        let count = all.positions.len();
        let mesh = MeshData {
            uvs: attribute(all.uvs, all.uv_indices, &all.triangles, count),
            normals: attribute(all.normals, all.normal_indices, &all.triangles, count),
            positions: all.positions,
            origin: self.origin.unwrap_or_default(),
            triangles: all.triangles,
            colors: (!all.colors.is_empty()).then_some(all.colors),
        };
        Ok(((mesh, notes), all.materials))
    }
}

/// Drops the indices of an attribute without values in the file, with a warning.
fn drop_absent(keyword: &str, values: usize, indices: &mut Vec<[u32; 3]>) -> Option<Error> {
    if values > 0 || indices.is_empty() {
        return None;
    }
    *indices = Vec::new();
    let message = format!("faces refer to \"{keyword}\", but the file has none");
    Some(Error::new(ErrorKind::Mesh, message).remedy("these indices are ignored"))
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
    Some(Attribute { values, indices: (!same).then_some(indices) })
}

/// The error of the first face with an index out of range, found by reading the file again: storing
/// the line of every face for a rare error would cost memory in every load.
fn find_bad_face(
    file: &dyn ReadAt,
    length: u64,
    block: usize,
    whole: Count,
) -> Result<Option<Error>> {
    let (mut found, mut count, mut corners) = (None, Count::default(), Corners::default());
    each_block(file, length, block, |text| {
        let before = count.lines;
        let mut all = statements(text);
        for Statement { keyword, rest, line } in all.by_ref() {
            // Every face was read before without an error.
            if found.is_none()
                && keyword == Keyword::Face
                && corners.read(rest, Some(&count)).is_ok()
            {
                let error = corners.first_beyond(&whole);
                found = error.map(|error| error.at(format!("line {}", before + line + 1)));
            }
            count.add(keyword);
        }
        count.lines = before + all.lines;
        Ok(())
    })?;
    Ok(found)
}

#[cfg(test)]
mod tests;
