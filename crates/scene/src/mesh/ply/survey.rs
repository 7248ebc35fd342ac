//! Surveys the contents of a PLY file.

use std::io::{BufRead, BufReader};

use super::header::{self, Element, Encoding, Header};
use super::layout::{COLOR, ListLayout, NORMAL, UV, VertexLayout};
use crate::mesh::BUFFER;
use crate::mesh::faults::read_failure;
use crate::mesh::place::{ReadAt, Section};
use crate::mesh::survey::Survey;
use wavecrest_base::error::Result;

/// Surveys a file of `length` bytes.
pub(in crate::mesh) fn survey(file: &dyn ReadAt, length: u64) -> Result<Survey> {
    let header = header::read(file, length, BUFFER)?;
    let left = length.saturating_sub(header.bytes);
    let mut survey = Survey::default();
    if let Some(vertex) = header.elements.iter().find(|element| element.name == "vertex") {
        let layout = VertexLayout::of(vertex)?;
        // A row has at least one byte for each property.
        let most = left / (vertex.properties.len() as u64).max(1);
        survey.positions = vertex.count.min(most);
        let of = |first| if layout.has(first) { survey.positions } else { 0 };
        (survey.normals, survey.uvs, survey.colors) = (of(NORMAL), of(UV), of(COLOR));
    }
    let is_list = |element: &&Element| element.name == "face" || element.name == "tristrips";
    let corners = match header.encoding {
        Encoding::Ascii => in_text(&header, Section::new(file, header.bytes, length))?,
        _ => header.elements.iter().find(is_list).map_or(0, |element| {
            let others = header.elements.iter().filter(|other| other.name != element.name);
            in_rows(element, left.saturating_sub(others.map(fixed_bytes).sum()))
        }),
    };
    survey.triangles = corners;
    Ok(survey)
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

/// Triangles of a text.
fn in_text(header: &Header, body: Section<'_>) -> Result<u64> {
    let mut rows = header.elements.iter().filter(|element| !element.properties.is_empty());
    let mut current = rows.next();
    let (mut left, mut corners, mut lists) = (current.map_or(0, |e| e.count), 0, 0);
    let all = header.elements.iter().map(|element| element.count).fold(0, u64::saturating_add);
    words_of_lines(body, all, |words| {
        while left == 0 && current.is_some() {
            current = rows.next();
            left = current.map_or(0, |element| element.count);
        }
        left = left.saturating_sub(1);
        if let Some(element) = current.filter(|e| e.name == "face" || e.name == "tristrips") {
            // Each property has its own word; a list has its count.
            corners += words.saturating_sub(element.properties.len() as u64);
            lists += 1;
        }
    })
    .map_err(read_failure)?;
    Ok(triangles(corners, lists))
}

/// The number of words on each line of `text`, up to `lines` of them. Lines longer than a buffer
/// are read in parts.
fn words_of_lines(
    text: impl std::io::Read,
    lines: u64,
    mut each: impl FnMut(u64),
) -> std::io::Result<()> {
    let mut reader = BufReader::with_capacity(BUFFER, text);
    let (mut words, mut within, mut taken) = (0, false, 0);
    while taken < lines {
        let buffer = reader.fill_buf()?;
        if buffer.is_empty() {
            if words > 0 {
                each(words);
            }
            break;
        }
        let end = memchr::memchr(b'\n', buffer);
        let part = &buffer[..end.unwrap_or(buffer.len())];
        for byte in part {
            let blank = byte.is_ascii_whitespace();
            words += u64::from(!blank && !within);
            within = !blank;
        }
        let length = part.len() + usize::from(end.is_some());
        reader.consume(length);
        if end.is_some() {
            // A line without words is not a row.
            if words > 0 {
                each(words);
                taken += 1;
            }
            (words, within) = (0, false);
        }
    }
    Ok(())
}
