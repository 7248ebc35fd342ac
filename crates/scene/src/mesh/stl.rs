//! STL: triangles in sequence, each with its three corners, as binary numbers or as text.
//!
//! A corner shared by several triangles is repeated for each: corners with equal positions are
//! merged ([`super::join`]), so that the mesh has the neighbours of the surface. The normals of
//! the file are ignored: the order of the corners gives them.
//!
//! Binary: a header of 80 bytes for any text, the count of triangles, and 50 bytes for each: a
//! normal, three corners, and two bytes in which two programs store colours.
//!
//! Text: `facet normal`, `outer loop`, three times `vertex`, `endloop`, `endfacet`, each on its own
//! line, in upper or lower case, between `solid` and `endsolid`. Several solids in a file form one
//! mesh. Ends may be two words, and lines end in LF, CR LF or CR.
//!
//! Both forms may begin with `solid`. A file is binary if its length fits its count of triangles,
//! or if it has a zero byte where a text has words.

use std::io::{BufRead as _, BufReader, Read as _};

use glam::Vec3;

use super::data::{MeshData, NamedMaterials, Read};
use super::faults::{self, no_triangles, read_failure, syntax};
use super::place::{ReadAt, Sequence, part};
use super::validate::{bad_position, is_good_position};
use super::{join, number};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::parallel;

/// Length of a binary file's header: a text, and the count of triangles.
const HEAD: usize = 84;
/// Bytes of a triangle.
const TRIANGLE: usize = 50;
/// Bytes of its normal, and of a corner.
const VECTOR: usize = 12;
/// Offset of its last two bytes.
const ATTRIBUTE: usize = 48;

/// The byte order mark that some programs put before a text.
const MARK: &[u8] = b"\xEF\xBB\xBF";

/// The mark in the header if Materialise Magics wrote colours.
const COLOR: &[u8] = b"COLOR=";

/// The longest line of a text in bytes: only names are longer than a few numbers.
const LONGEST_LINE: u64 = 1 << 16;

/// First words of lines without positions.
const FRAME: [&str; 5] = ["solid", "endsolid", "facet", "outer", "endfacet"];

/// The corners of a file's triangles, and warnings.
type StlTriangles = (Vec<[Vec3; 3]>, Vec<Error>);

/// Reads a file of `length` bytes, or the first triangles of a binary one with more, if their number is given.
pub(super) fn read(
    file: &dyn ReadAt,
    length: u64,
    buffer: usize,
    first: Option<u64>,
) -> Result<Read> {
    let (head, line_end) = form(file, length)?;
    let (corners, notes) = match line_end {
        Some(_) if first.is_some() => return Err(faults::no_part()),
        Some(end) => read_text(file, end, buffer)?,
        None => read_binary(file, (&head, length), buffer, first)?,
    };
    if corners.is_empty() {
        return Err(no_triangles());
    }
    let (positions, triangles) = join::join(corners);
    let mesh = MeshData {
        positions: positions.into(),
        triangles: triangles.into(),
        ..MeshData::default()
    };
    Ok((mesh, notes, NamedMaterials::default()))
}

/// The header of a file of `length` bytes, and the byte at the end of its lines if it is a text.
fn form(file: &dyn ReadAt, length: u64) -> Result<([u8; HEAD], Option<u8>)> {
    if length == 0 {
        return Err(syntax("the file is empty").remedy("export it again"));
    }
    let mut head = [0; HEAD];
    let there = length.min(HEAD as u64) as usize;
    file.read_exact_at(&mut head[..there], 0).map_err(read_failure)?;
    let is_whole = there == HEAD && count(&head) == room(length);
    let text = head.strip_prefix(MARK).unwrap_or(&head);
    let first = text.trim_ascii_start().get(..5);
    let begins_as_text = first.is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    if begins_as_text && !is_whole && !head[..there].contains(&0) {
        // The first line is that of the name, or the keyword alone.
        let mut start = vec![0; length.min(LONGEST_LINE) as usize];
        file.read_exact_at(&mut start, 0).map_err(read_failure)?;
        let end = memchr::memchr2(b'\r', b'\n', &start);
        let is_alone = |end: &usize| start[*end] == b'\r' && start.get(end + 1) != Some(&b'\n');
        return Ok((head, Some(end.filter(is_alone).map_or(b'\n', |_| b'\r'))));
    }
    if there < HEAD {
        let remedy = format!("begin it with \"solid\", or with a binary header of {HEAD} bytes");
        return Err(syntax("the file is too short for STL").value(length).remedy(remedy));
    }
    Ok((head, None))
}

/// Checks that the corners of this number of triangles can be numbered.
fn check_count(triangles: u64) -> Result<()> {
    faults::check_count("corners", triangles.saturating_mul(3))
}

/// The corner `p` with zeros of one sign, so that equal positions have equal bits.
fn corner(p: Vec3) -> Result<Vec3> {
    if is_good_position(p) { Ok(p + Vec3::ZERO) } else { Err(bad_position(p)) }
}

/// The warning that colours are ignored, by the name of their extension.
fn ignored_colours(extension: &str) -> Error {
    Error::new(ErrorKind::Mesh, format!("{extension} are ignored"))
        .remedy("save the mesh as PLY to keep them")
}

/// The number of triangles according to the header.
fn count(head: &[u8; HEAD]) -> u64 {
    let [.., a, b, c, d] = *head;
    u64::from(u32::from_le_bytes([a, b, c, d]))
}

/// The number of triangles that fit into a file of `length` bytes.
fn room(length: u64) -> u64 {
    length.saturating_sub(HEAD as u64) / TRIANGLE as u64
}

/// Reads the triangles after `head` of a file of `length` bytes.
fn read_binary(
    file: &dyn ReadAt,
    (head, length): (&[u8; HEAD], u64),
    buffer: usize,
    first: Option<u64>,
) -> Result<StlTriangles> {
    let count = count(head);
    if count > room(length) {
        return Err(syntax(format!("the file has room for {} triangles", room(length)))
            .at("the count of triangles")
            .value(count)
            .remedy("the file may be cut off, or this is not an STL file"));
    }
    check_count(count)?;
    if first.is_some_and(|first| first >= count) {
        return Err(faults::no_part());
    }
    let left = length - HEAD as u64 - count * TRIANGLE as u64;
    let mut notes = Vec::new();
    if left > 0 && first.is_none() {
        notes.push(syntax("bytes after the last triangle are ignored").value(left));
    }
    let count = first.unwrap_or(count);
    let mut triangles: Vec<[Vec3; 3]> = bytemuck::zeroed_vec(count as usize);
    let at_once = (buffer / TRIANGLE).max(1);
    let parts = triangles.chunks_mut(at_once).enumerate();
    let read = parallel::map(parts, |(part, into)| read_part(file, part * at_once, into));
    // Report the first error in file order, whichever thread found one first.
    let has_attributes = read.into_iter().try_fold(false, |any, part| part.map(|p| any | p))?;
    if head.windows(COLOR.len()).any(|text| text == COLOR) {
        notes.push(ignored_colours("colours of triangles (Materialise Magics)"));
    } else if has_attributes {
        notes.push(ignored_colours("colours of triangles (VisCAM, SolidView)"));
    }
    Ok((triangles, notes))
}

/// Reads the triangles from the number `first` on; returns true if one has an attribute.
fn read_part(file: &dyn ReadAt, first: usize, into: &mut [[Vec3; 3]]) -> Result<bool> {
    let mut bytes = vec![0; into.len() * TRIANGLE];
    let place = (HEAD + first * TRIANGLE) as u64;
    file.read_exact_at(&mut bytes, place).map_err(read_failure)?;
    let mut has_attribute = false;
    for (i, (row, corners)) in bytes.chunks_exact(TRIANGLE).zip(into).enumerate() {
        for (k, to) in corners.iter_mut().enumerate() {
            let number = |i: usize| part::<4, false>(row, VECTOR * (k + 1) + 4 * i);
            let position = Vec3::from([0, 1, 2].map(|i| f32::from_le_bytes(number(i))));
            *to = corner(position).map_err(|e| e.at(format!("triangle {}", first + i)))?;
        }
        has_attribute |= row[ATTRIBUTE..] != [0, 0];
    }
    Ok(has_attribute)
}

/// Reads a text whose lines end in the byte `end`.
fn read_text(file: &dyn ReadAt, end: u8, buffer: usize) -> Result<StlTriangles> {
    let mut reader = BufReader::with_capacity(buffer, Sequence { file, place: 0 });
    let (mut text, mut bytes, mut number) = (Text::default(), Vec::new(), 0_u64);
    while reader.by_ref().take(LONGEST_LINE).read_until(end, &mut bytes).map_err(read_failure)? > 0
    {
        number += 1;
        let line = bytes.strip_prefix(MARK).filter(|_| number == 1).unwrap_or(&bytes);
        let taken = if line.len() as u64 == LONGEST_LINE && !line.ends_with(&[end]) {
            let error = syntax(format!("a line can have at most {LONGEST_LINE} bytes"));
            Err(error.remedy("check that the file is an STL file"))
        } else {
            text.line(&String::from_utf8_lossy(line))
        };
        taken.map_err(|error| error.at(format!("line {number}")))?;
        bytes.clear();
    }
    if !text.corners.is_empty() {
        let error = syntax("the last triangle is incomplete").value(text.corners.len());
        return Err(error.remedy("the file may be cut off"));
    }
    let notes = text.has_colours.then(|| ignored_colours("colours of triangles"));
    Ok((text.triangles, notes.into_iter().collect()))
}

/// What has been read.
#[derive(Default)]
struct Text {
    triangles: Vec<[Vec3; 3]>,
    /// The corners of the current triangle.
    corners: Vec<Vec3>,
    has_colours: bool,
}

impl Text {
    fn line(&mut self, line: &str) -> Result<()> {
        let mut words = line.split_ascii_whitespace();
        let Some(mut keyword) = words.next().map(str::to_ascii_lowercase) else { return Ok(()) };
        // Some programs write ends as two words.
        if keyword == "end" {
            let of = words.next().unwrap_or_default().to_ascii_lowercase();
            keyword += if ["loop", "facet", "solid"].contains(&&*of) { &of } else { "" };
        }
        match keyword.as_str() {
            "vertex" => self.vertex(words),
            "endloop" => self.end_triangle(),
            "color" => {
                self.has_colours = true;
                Ok(())
            }
            other if FRAME.contains(&other) => Ok(()),
            other => Err(syntax("unknown line")
                .value(format_args!("\"{other}\""))
                .remedy("check that the file is an STL file and is whole")),
        }
    }

    fn vertex<'a>(&mut self, mut words: impl Iterator<Item = &'a str>) -> Result<()> {
        if self.corners.len() == 3 {
            let error = syntax("a triangle has more than three corners");
            return Err(error.remedy("export triangles only, or use PLY or OBJ"));
        }
        let mut number = || {
            let word = words.next().unwrap_or("");
            number::parse(word.as_bytes()).ok_or_else(|| {
                let error = syntax("a corner is three numbers").value(format_args!("\"{word}\""));
                error.remedy("write them as 12 or -0.5e3; the file may be cut off")
            })
        };
        let position = Vec3::new(number()?, number()?, number()?);
        self.corners.push(corner(position)?);
        Ok(())
    }

    fn end_triangle(&mut self) -> Result<()> {
        let [a, b, c] = self.corners[..] else {
            let error = syntax("a triangle needs three corners").value(self.corners.len());
            return Err(error.remedy("complete it, or remove it"));
        };
        self.triangles.push([a, b, c]);
        self.corners.clear();
        check_count(self.triangles.len() as u64)
    }
}

#[cfg(test)]
mod tests;
