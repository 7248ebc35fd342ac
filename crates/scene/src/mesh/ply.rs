//! Stanford PLY: a text header that declares elements and their properties, then the elements, as
//! text or as binary numbers of either byte order.
//!
//! Any header is supported: properties in any order and of any type, elements of any name. Unused
//! ones are skipped. [`header`] reads the declarations and [`layout`] finds the properties of a
//! mesh; [`Numbers`] yields the rows of the body, from text or binary; [`vertices`] and [`faces`]
//! store them in the arrays of the mesh, and [`body`] leads through the elements.
//!
//! Binary rows of constant length are read in blocks on all threads: vertices, and faces as long as
//! they are triangles. Blocks stop at the first invalid row; that row is read again, number by
//! number, which reports the error. So errors have a single source, and the first one is reported
//! whatever the threads did.
//!
//! No crate is used: the existing ones return every property of every row, where the common form is
//! better read as a block, and their errors do not name the element and its number.

mod body;
mod faces;
mod header;
mod layout;
mod numbers;
mod vertices;

use super::BUFFER;
use super::data::{NamedMaterials, Read};
use super::place::{ReadAt, Section, each_line};
use super::survey::{self, MeshSurvey};
use header::{BodyEncoding, Element, Header};
use layout::{COLOR, ListLayout, NORMAL, UV, VertexLayout};
use numbers::Numbers;
use wavecrest_base::error::Result;

/// Reads a file of `length` bytes.
pub(super) fn read(
    file: &dyn ReadAt,
    length: u64,
    buffer: usize,
) -> Result<(Read, NamedMaterials)> {
    let header = header::read(file, length)?;
    body::read(&header, Numbers::new(file, &header, length, buffer))
}

/// Surveys a file of `length` bytes.
pub(super) fn survey(file: &dyn ReadAt, length: u64) -> Result<MeshSurvey> {
    let header = header::read(file, length)?;
    let left = length.saturating_sub(header.bytes);
    let mut found = MeshSurvey::default();
    if let Some(vertex) = header.elements.iter().find(|element| element.name == "vertex") {
        let layout = VertexLayout::of(vertex)?;
        // A row has at least one byte for each property.
        let most = left / (vertex.properties.len() as u64).max(1);
        found.positions = vertex.count.min(most);
        let kinds = [(NORMAL, survey::TRIPLE), (UV, survey::UV), (COLOR, survey::TRIPLE)];
        let there = kinds.into_iter().filter(|(first, _)| layout.has(*first));
        found.attributes = found.positions * there.map(|(_, bytes)| bytes).sum::<u64>();
    }
    let corners = match header.encoding {
        BodyEncoding::Ascii => {
            in_text(&header, Section { file, place: header.bytes, end: length })?
        }
        _ => header.elements.iter().find(is_list).map_or(0, |element| {
            let others = header.elements.iter().filter(|other| other.name != element.name);
            in_rows(element, left.saturating_sub(others.map(fixed_bytes).sum()))
        }),
    };
    found.triangles = corners;
    Ok(found)
}

/// Whether the rows of an element are lists of corners.
fn is_list(element: &&Element) -> bool {
    element.name == "face" || element.name == "tristrips"
}

/// Bytes of an element's rows, with empty lists.
fn fixed_bytes(element: &Element) -> u64 {
    element.count.saturating_mul(element.least_row(|kind| kind.size() as u64))
}

/// Number of triangles of binary faces or strips in `bytes`: each list has two corners more than
/// triangles.
fn in_rows(element: &Element, bytes: u64) -> u64 {
    let Ok(ListLayout { item, .. }) = ListLayout::of(element) else { return 0 };
    let fixed = fixed_bytes(element).min(bytes);
    triangles((bytes - fixed) / item.size() as u64, element.count.min(bytes))
}

/// Number of triangles of `lists` lists with this many corners in total.
fn triangles(corners: u64, lists: u64) -> u64 {
    corners.saturating_sub(lists.saturating_mul(2))
}

/// Triangles of a text, of which each row is a line.
fn in_text(header: &Header, body: Section<'_>) -> Result<u64> {
    let mut rows = header.elements.iter().filter(|element| !element.properties.is_empty());
    let mut current = rows.next();
    let (mut left, mut corners, mut lists) = (current.map_or(0, |e| e.count), 0, 0);
    let mut add_row = |words: u64| {
        while left == 0 && current.is_some() {
            current = rows.next();
            left = current.map_or(0, |element| element.count);
        }
        left = left.saturating_sub(1);
        if let Some(element) = current.filter(is_list) {
            // Each property has its own word; a list has its count.
            corners += words.saturating_sub(element.properties.len() as u64);
            lists += 1;
        }
    };
    // A line without words is not a row.
    let (mut words, mut is_within) = (0, false);
    each_line(body, b'\n', BUFFER, BUFFER as u64, |line| {
        for byte in line {
            let is_blank = byte.is_ascii_whitespace();
            words += u64::from(!is_blank && !is_within);
            is_within = !is_blank;
        }
        if line.ends_with(b"\n") && words > 0 {
            add_row(std::mem::take(&mut words));
        }
        Ok(())
    })?;
    if words > 0 {
        add_row(words);
    }
    Ok(triangles(corners, lists))
}

#[cfg(test)]
mod tests;
