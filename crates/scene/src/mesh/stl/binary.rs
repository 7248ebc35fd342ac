//! Binary STL: a header of 80 bytes for any text, the count of triangles, and 50 bytes for each: a
//! normal, three corners, and two bytes in which two programs store colours.

use glam::Vec3;
use rayon::prelude::*;

use super::{HEAD, check_count, corner, ignored_colours};
use crate::mesh::faults::{read_failure, syntax};
use crate::mesh::place::ReadAt;
use wavecrest_base::error::{Error, Result};

/// Bytes of a triangle.
const TRIANGLE: usize = 50;
/// Offset of its corners, after the normal.
const CORNERS: usize = 12;
/// Offset of its last two bytes.
const ATTRIBUTE: usize = 48;

/// The mark in the header if Materialise Magics wrote colours.
const COLOR: &[u8] = b"COLOR=";

/// The corners of a file's triangles, and warnings.
type Read = (Vec<[Vec3; 3]>, Vec<Error>);

/// The number of triangles according to the header.
pub(super) fn count(head: &[u8; HEAD]) -> u64 {
    let [.., a, b, c, d] = *head;
    u64::from(u32::from_le_bytes([a, b, c, d]))
}

/// The number of triangles that fit into a file of `length` bytes.
pub(super) fn room(length: u64) -> u64 {
    length.saturating_sub(HEAD as u64) / TRIANGLE as u64
}

/// Reads the triangles after `head` of a file of `length` bytes.
pub(super) fn read(
    file: &dyn ReadAt,
    head: &[u8; HEAD],
    length: u64,
    buffer: usize,
) -> Result<Read> {
    let count = count(head);
    if count > room(length) {
        return Err(syntax(format!("the file has room for {} triangles", room(length)))
            .at("the count of triangles")
            .value(count)
            .remedy("the file may be cut off, or this is not an STL file"));
    }
    check_count(count)?;
    let mut notes = trailing(count, length);
    let mut triangles: Vec<[Vec3; 3]> = bytemuck::zeroed_vec(count as usize);
    let at_once = (buffer / TRIANGLE).max(1);
    let parts = triangles.par_chunks_mut(at_once).enumerate();
    let read: Vec<Result<bool>> =
        parts.map(|(part, into)| read_part(file, part * at_once, into)).collect();
    // Report the first error in file order, whichever thread found one first.
    let has_attributes = read.into_iter().try_fold(false, |any, part| part.map(|p| any | p))?;
    if head.windows(COLOR.len()).any(|text| text == COLOR) {
        notes.push(ignored_colours("colours of triangles (Materialise Magics)"));
    } else if has_attributes {
        notes.push(ignored_colours("colours of triangles (VisCAM, SolidView)"));
    }
    Ok((triangles, notes))
}

/// The warning of bytes after the last triangle.
fn trailing(count: u64, length: u64) -> Vec<Error> {
    let left = length - HEAD as u64 - count * TRIANGLE as u64;
    let note = || syntax("bytes after the last triangle are ignored").value(left);
    (left > 0).then(note).into_iter().collect()
}

/// Reads the triangles from the number `first` on; returns true if one has an attribute.
fn read_part(file: &dyn ReadAt, first: usize, into: &mut [[Vec3; 3]]) -> Result<bool> {
    let mut bytes = vec![0; into.len() * TRIANGLE];
    let place = (HEAD + first * TRIANGLE) as u64;
    file.read_exact_at(&mut bytes, place).map_err(read_failure)?;
    let mut has_attribute = false;
    for (i, (row, corners)) in bytes.chunks_exact(TRIANGLE).zip(into).enumerate() {
        for (k, to) in corners.iter_mut().enumerate() {
            let read = corner(vector(row, CORNERS * (k + 1)));
            *to = read.map_err(|e| e.at(format!("triangle {}", first + i)))?;
        }
        has_attribute |= row[ATTRIBUTE..] != [0, 0];
    }
    Ok(has_attribute)
}

/// The three numbers of `row` at an offset.
fn vector(row: &[u8], at: usize) -> Vec3 {
    let number = |i: usize| {
        let from = at + 4 * i;
        f32::from_le_bytes([row[from], row[from + 1], row[from + 2], row[from + 3]])
    };
    Vec3::new(number(0), number(1), number(2))
}
