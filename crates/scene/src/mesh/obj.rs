//! Wavefront OBJ: a text of statements, of which `v`, `vt`, `vn`, `f`, `usemtl` and `mtllib` are
//! read. Groups, points, lines, curves and unknown statements are skipped.
//!
//! The file is read in blocks of whole statements, so that the text of a large one is never
//! entirely in memory. A block is cut into pieces, which are read in parallel ([`piece::Piece`])
//! without knowledge of earlier ones. If a piece needs that, for an index that counts backward or
//! for the line of an error, it is read once more after the statements before it have been counted
//! ([`Count`]). The pieces are then joined in order; the result does not depend on the cuts.
//!
//! The crate `tobj` reads the same format on one thread. It is not used because its errors name no
//! line, and because it makes one mesh of each group.

mod blocks;
mod corners;
mod count;
mod lines;
mod piece;
mod survey;

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::data::{Attribute, MeshData, NO_VALUE, NamedMaterials, Read};
use super::faults::{check_count, no_triangles};
use super::origin::origin;
use super::place::ReadAt;
use super::polygon::{self, Polygon};
use super::validate::{bad_index, first_with, mend, scale_byte_colors};
use blocks::{BLOCK_BYTES, PIECE_BYTES, cut, each_block};
use count::Count;
use piece::Piece;
use wavecrest_base::error::{Error, ErrorKind, Result};

pub(super) use survey::survey;

/// Reads a file of `length` bytes.
pub(super) fn read(file: &std::fs::File, length: u64) -> Result<(Read, NamedMaterials)> {
    read_from(file, length, BLOCK_BYTES, PIECE_BYTES)
}

pub(super) fn read_from(
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
    /// Relative to the origin.
    positions: Vec<Vec3>,
    /// Known from the first position on.
    origin: Option<DVec3>,
    /// Empty until a position has a colour.
    colors: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Empty until a corner has texture coordinates.
    uv_indices: Vec<[u32; 3]>,
    /// Empty until a corner has a normal.
    normal_indices: Vec<[u32; 3]>,
    polygons: Vec<Polygon>,
    materials: NamedMaterials,
}

impl Parts {
    fn add_block(&mut self, text: &[u8], piece: usize) -> Result<()> {
        self.origin = self.origin.or_else(|| piece::first_position(text).map(origin));
        let origin = self.origin.unwrap_or_default();
        let pieces = cut(text, piece);
        let read: Vec<(Count, Option<Piece>)> =
            pieces.par_iter().map(|text| Piece::read_anywhere(text, origin)).collect();
        let mut starts = Vec::with_capacity(read.len());
        for (count, _) in &read {
            starts.push(self.start);
            self.start = self.start.plus(*count);
        }
        check_count("vertices", self.start.positions)?;
        check_count("texture coordinates", self.start.uvs)?;
        check_count("normals", self.start.normals)?;
        let again = |(((_, piece), text), start): (((_, Option<Piece>), &&[u8]), Count)| {
            piece.map_or_else(|| Piece::read(text, start, origin), Ok)
        };
        let read: Vec<Result<Piece>> =
            read.into_par_iter().zip(&pieces).zip(starts).map(again).collect();
        read.into_iter().try_for_each(|piece| self.add(piece?))
    }

    fn add(&mut self, piece: Piece) -> Result<()> {
        let before = self.triangles.len();
        let after = before + piece.triangles.len();
        check_count("triangles", after as u64)?;
        // The count was just checked to fit `u32`.
        let shift = |p: Polygon| Polygon { first: p.first + before as u32, ..p };
        self.polygons.extend(piece.polygons.into_iter().map(shift));
        for (first, name) in piece.materials.runs {
            self.materials.begin(first + before as u32, name);
        }
        for statement in piece.materials.libraries {
            self.materials.add_library(statement);
        }
        if piece.colors.is_some() || !self.colors.is_empty() {
            // Positions without a colour are white.
            self.colors.resize(self.positions.len(), Vec3::ONE);
            self.colors.extend(piece.colors.into_iter().flatten());
            self.colors.resize(self.positions.len() + piece.positions.len(), Vec3::ONE);
        }
        self.positions.extend(piece.positions);
        self.uvs.extend(piece.uvs);
        self.normals.extend(piece.normals);
        self.triangles.extend(piece.triangles);
        add_indices(&mut self.uv_indices, piece.uv_indices, before, after);
        add_indices(&mut self.normal_indices, piece.normal_indices, before, after);
        Ok(())
    }

    /// The error of an index that refers to nothing in the whole file: an index may refer to later
    /// values.
    fn first_bad_index(&self) -> Option<Error> {
        let columns = [
            ("vertex", &self.triangles, self.positions.len()),
            ("texture coordinate", &self.uv_indices, self.uvs.len()),
            ("normal", &self.normal_indices, self.normals.len()),
        ];
        columns.into_iter().find_map(|(what, indices, count)| {
            // Attributes without any value count as absent instead of out of range.
            let given = count > 0 || what == "vertex";
            let bad = |i: u32| given && i != NO_VALUE && i as usize >= count;
            let (_, index) = first_with(indices, bad)?;
            Some(bad_index(what, u64::from(index) + 1, count))
        })
    }

    fn finish(mut self) -> Result<(Read, NamedMaterials)> {
        if self.triangles.is_empty() {
            return Err(no_triangles());
        }
        let mut notes = Vec::new();
        notes.extend(drop_absent("vt", self.uvs.len(), &mut self.uv_indices));
        notes.extend(drop_absent("vn", self.normals.len(), &mut self.normal_indices));
        let attributes: [&mut [_]; 2] = [&mut self.uv_indices, &mut self.normal_indices];
        let mut attributes = attributes.into_iter().filter(|a| !a.is_empty()).collect::<Vec<_>>();
        let (positions, triangles) = (&self.positions, &mut self.triangles);
        notes.extend(polygon::split(&self.polygons, positions, triangles, &mut attributes));
        notes.extend(mend(&mut self.normals, &mut self.uvs, &mut self.colors));
        notes.extend(scale_byte_colors(&mut self.colors));
        self.positions.shrink_to_fit();
        self.colors.shrink_to_fit();
        self.triangles.shrink_to_fit();
        let count = self.positions.len();
        let uvs = attribute(self.uvs, self.uv_indices, &self.triangles, count);
        let normals = attribute(self.normals, self.normal_indices, &self.triangles, count);
        let (positions, triangles) = (self.positions, self.triangles);
        let origin = self.origin.unwrap_or_default();
        let colors = (!self.colors.is_empty()).then_some(self.colors);
        let mesh = MeshData { positions, origin, triangles, normals, uvs, colors };
        Ok(((mesh, notes), self.materials))
    }
}

/// Appends the indices of an attribute; triangles without it have [`NO_VALUE`].
fn add_indices(to: &mut Vec<[u32; 3]>, from: Option<Vec<[u32; 3]>>, before: usize, after: usize) {
    match from {
        Some(indices) => {
            to.resize(before, [NO_VALUE; 3]);
            to.extend(indices);
        }
        None if to.is_empty() => {}
        None => to.resize(after, [NO_VALUE; 3]),
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
    let mut found = None;
    let mut start = Count::default();
    each_block(file, length, block, |text| {
        if found.is_none() {
            found = piece::find_bad_face(text, start, whole);
            start = start.plus(Count::of(text));
        }
        Ok(())
    })?;
    Ok(found)
}

#[cfg(test)]
mod tests;
