//! The contents of an OBJ text: of a piece, or of all pieces so far; and the corners of a face.

use std::num::IntErrorKind;

use glam::{DVec3, Vec2, Vec3};

use super::lines::{
    Keyword, Statement, first_word, is_blank, malformed, name, statements, word_length, words,
};
use crate::mesh::data::{MAX_COUNT, NO_VALUE, NamedMaterials};
use crate::mesh::faults::{check_count, syntax};
use crate::mesh::number::{self, leading_whole};
use crate::mesh::origin::relative;
use crate::mesh::polygon::{self, Polygon};
use crate::mesh::validate::{bad_index, bad_position, is_good_position};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::parallel;

/// What indices refer to, in the order of a corner.
const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// The colour of a position without one.
pub(super) const WHITE: Vec3 = Vec3::ONE;

/// The indices of a triangle without an attribute.
pub(super) const NO_VALUES: [u32; 3] = [NO_VALUE; 3];

/// The number of lines and values in some text.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineCounts {
    pub(super) lines: u64,
    /// By [`KINDS`], as are the first keywords.
    pub(super) values: [u64; 3],
}

impl LineCounts {
    fn add(&mut self, Statement { keyword, lines, .. }: Statement<'_>) {
        self.lines += lines;
        if let Some(count) = self.values.get_mut(keyword as usize) {
            *count += 1;
        }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        let values = std::array::from_fn(|kind| self.values[kind] + other.values[kind]);
        Self { lines: self.lines + other.lines, values }
    }

    /// The error of the first index, in the lists of each kind, that is beyond these counts of a
    /// whole file. Attributes without values in the file count as absent.
    pub(super) fn first_beyond(&self, lists: [&[u32]; 3]) -> Option<Error> {
        (0..KINDS.len()).filter(|&kind| kind == 0 || self.values[kind] > 0).find_map(|kind| {
            let count = self.values[kind];
            let is_beyond = |&index: &u32| index != NO_VALUE && u64::from(index) >= count;
            let index = lists[kind][parallel::find_first(lists[kind], is_beyond)?];
            Some(bad_index(KINDS[kind], u64::from(index) + 1, count as usize))
        })
    }
}

/// Arrays, as far as they have been read. Indices count from the beginning of the file.
#[derive(Debug, Default)]
pub(super) struct Contents {
    /// Relative to the origin.
    pub(super) positions: Vec<Vec3>,
    pub(super) origin: DVec3,
    /// Positions beyond the end of this list are [`WHITE`]: it is empty until one has a colour.
    pub(super) colors: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    /// The corners of triangles, by [`KINDS`]. Triangles beyond the end of a list have
    /// [`NO_VALUES`].
    pub(super) indices: [Vec<[u32; 3]>; 3],
    /// Counted from the first of the triangles here.
    pub(super) polygons: Vec<Polygon>,
    /// Counted likewise.
    pub(super) materials: NamedMaterials,
    /// Number of faces with fewer than three corners.
    pub(super) too_few_corners: u64,
    /// Whether there are colours in comments.
    pub(super) has_paint: bool,
}

impl Contents {
    /// Counts a piece, and reads it with positions relative to `origin`. If it is not known what
    /// was counted up to its `start`, no index may count backward, and the line of an error is
    /// wrong. If the `whole` file has been counted, an index beyond is an error.
    pub(super) fn read(
        text: &[u8],
        start: Option<LineCounts>,
        origin: DVec3,
        whole: Option<&LineCounts>,
    ) -> (LineCounts, Result<Self>) {
        let mut piece = Ok(Self { origin, ..Self::default() });
        let mut corners = Default::default();
        let mut count = start.unwrap_or_default();
        for statement in statements(text) {
            let known = start.is_some().then_some(&count);
            // After a failure the rest of the piece is only counted.
            if let Ok(read) = &mut piece
                && let Err(error) = read.statement(statement, known, whole, &mut corners)
            {
                piece = Err(error.at(format!("line {}", count.lines + 1)));
            }
            count.add(statement);
        }
        (count, piece)
    }

    /// Appends the next piece.
    pub(super) fn append(&mut self, piece: Self) -> Result<()> {
        let (vertices, triangles) = (self.positions.len(), self.indices[0].len());
        check_count("triangles", (triangles + piece.indices[0].len()) as u64)?;
        // The count was just checked to fit `u32`.
        let first = triangles as u32;
        let shift = |p: Polygon| Polygon { first: p.first + first, ..p };
        self.polygons.extend(piece.polygons.into_iter().map(shift));
        for (begun, name) in piece.materials.runs {
            self.materials.begin(begun + first, &name);
        }
        for statement in piece.materials.libraries {
            self.materials.add_library(statement);
        }
        self.too_few_corners += piece.too_few_corners;
        self.has_paint |= piece.has_paint;
        append(&mut self.colors, vertices, WHITE, piece.colors);
        for (to, indices) in self.indices.iter_mut().zip(piece.indices) {
            append(to, triangles, NO_VALUES, indices);
        }
        self.positions.extend(piece.positions);
        self.uvs.extend(piece.uvs);
        self.normals.extend(piece.normals);
        Ok(())
    }

    fn statement(
        &mut self,
        Statement { keyword, rest, .. }: Statement,
        count: Option<&LineCounts>,
        whole: Option<&LineCounts>,
        corners: &mut [Vec<u32>; 3],
    ) -> Result<()> {
        match keyword {
            Keyword::Position => self.push_position(rest)?,
            Keyword::Uv => {
                let ([u, v], _) = numbers(rest, 1, "vt")?;
                self.uvs.push(Vec2::new(u, v));
            }
            Keyword::Normal => self.normals.push(Vec3::from(numbers::<3>(rest, 3, "vn")?.0)),
            Keyword::Face => {
                read_corners(rest, count, corners)?;
                let beyond =
                    |whole: &LineCounts| whole.first_beyond(corners.each_ref().map(|c| &c[..]));
                if let Some(error) = whole.and_then(beyond) {
                    return Err(error);
                }
                match corners[0].len() {
                    0..3 => self.too_few_corners += 1,
                    _ => self.push_face(corners),
                }
            }
            // A piece is in memory, so its triangles are fewer than 2^32.
            Keyword::Material => self.materials.begin(self.indices[0].len() as u32, &name(rest)),
            Keyword::Library => self.materials.add_library(name(rest)),
            Keyword::Paint => self.has_paint = true,
            Keyword::Other => {}
        }
        Ok(())
    }

    fn push_position(&mut self, rest: &[u8]) -> Result<()> {
        let words = rest;
        let (position, rest) = numbers::<3>(rest, 3, "v")?;
        let mut position = Vec3::from(position);
        if self.origin != DVec3::ZERO {
            position = relative(exact(words, position), self.origin);
        }
        if !is_good_position(position) {
            return Err(bad_position(position));
        }
        if let Some(color) = first_word(rest).and_then(color) {
            self.colors.resize(self.positions.len(), WHITE);
            self.colors.push(color);
        }
        self.positions.push(position);
        Ok(())
    }

    fn push_face(&mut self, lists: &[Vec<u32>; 3]) {
        let (before, corners) = (self.indices[0].len(), lists[0].len());
        if corners > 3 {
            // A piece is in memory, so its triangles are fewer than 2^32; the sum over the pieces
            // is checked when they are joined.
            self.polygons.push(Polygon { first: before as u32, corners: corners as u32 });
        }
        for (to, corners) in self.indices.iter_mut().zip(lists) {
            if corners.iter().any(|&index| index != NO_VALUE) {
                to.resize(before, NO_VALUES);
                to.extend(polygon::fan(corners));
            }
        }
    }
}

/// Appends the `values` of the items from number `before` on, if there are any; earlier items
/// without a value get the `blank` one.
fn append<T: Clone>(to: &mut Vec<T>, before: usize, blank: T, values: Vec<T>) {
    if !values.is_empty() {
        to.resize(before, blank);
        to.extend(values);
    }
}

/// The first position of a text, if it is valid.
pub(super) fn first_position(text: &[u8]) -> Option<DVec3> {
    let rest = statements(text).find(|statement| statement.keyword == Keyword::Position)?.rest;
    let (rounded, _) = numbers::<3>(rest, 3, "v").ok()?;
    Some(exact(rest, Vec3::from(rounded)))
}

/// The numbers of a position in double precision, given the `rounded` ones.
#[cold]
fn exact(rest: &[u8], rounded: Vec3) -> DVec3 {
    let mut point = rounded.as_dvec3();
    for (axis, word) in words(rest).take(3).enumerate() {
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        point[axis] = number.unwrap_or(point[axis]);
    }
    point
}

/// The colour after a position, if any: three numbers. A single number is a weight.
#[cold]
fn color(rest: &[u8]) -> Option<Vec3> {
    numbers::<3>(rest, 3, "v").ok().map(|(color, _)| Vec3::from(color))
}

/// The first `N` numbers of a statement, and the text after them. The first `needed` are required,
/// the others default to 0.
fn numbers<'a, const N: usize>(
    mut rest: &'a [u8],
    needed: usize,
    keyword: &str,
) -> Result<([f32; N], &'a [u8])> {
    let mut numbers = [0.0; N];
    for (found, number) in numbers.iter_mut().enumerate() {
        let Some(word) = first_word(rest) else {
            if found >= needed {
                break;
            }
            let error = syntax(format!("\"{keyword}\" needs at least {needed} numbers"));
            return Err(error.value(found).remedy("complete the line; the file may be cut off"));
        };
        let is_whole = |&(_, end): &(f32, usize)| word.get(end).is_none_or(|&b| is_blank(b));
        let (value, length) = match number::leading(word).filter(is_whole) {
            Some(found) => found,
            None => {
                let word = &word[..word_length(word)];
                let fault = || malformed("a number", word, "write it as 12 or -0.5e3");
                (number::parse(word).ok_or_else(fault)?, word.len())
            }
        };
        *number = value;
        rest = &word[length..];
    }
    Ok((numbers, rest))
}

/// Reads the indices of a face's corners after `count` values, a list for each of [`KINDS`]; [`NO_VALUE`]
/// for none. If the count is unknown, indices must not count backward.
fn read_corners(
    mut rest: &[u8],
    count: Option<&LineCounts>,
    lists: &mut [Vec<u32>; 3],
) -> Result<()> {
    lists.iter_mut().for_each(Vec::clear);
    while let Some(word) = first_word(rest) {
        let (corner, length) = match quick(word) {
            Some(found) => found,
            None => {
                let length = word_length(word);
                (corner(&word[..length], count)?, length)
            }
        };
        lists.iter_mut().zip(corner).for_each(|(list, index)| list.push(index));
        rest = &word[length..];
    }
    Ok(())
}

/// The corner at the start of `text`, and its length, if it has the common form: short numbers that
/// count from 1.
#[inline]
fn quick(text: &[u8]) -> Option<([u32; 3], usize)> {
    let mut corner = [NO_VALUE; 3];
    let mut at = 0;
    for (number, index) in corner.iter_mut().enumerate() {
        match leading_whole(&text[at..]) {
            Some((value, length)) => {
                *index = value.checked_sub(1)?;
                at += length;
            }
            // Only texture coordinates and normals may be missing.
            None if number == 0 => return None,
            None => {}
        }
        match text.get(at) {
            Some(b'/') if number < 2 => at += 1,
            Some(&next) if !is_blank(next) => return None,
            _ => break,
        }
    }
    Some((corner, at))
}

/// The corner in a `word`, in any form.
fn corner(word: &[u8], count: Option<&LineCounts>) -> Result<[u32; 3]> {
    let fault = || malformed("a corner of a face", word, "write it as 1, 1/2, 1//3 or 1/2/3");
    let mut parts = word.split(|&b| b == b'/');
    let mut corner = [NO_VALUE; 3];
    for (kind, to) in corner.iter_mut().enumerate() {
        let part = parts.next().filter(|part| !part.is_empty());
        // Only texture coordinates and normals may be missing.
        if kind == 0 || part.is_some() {
            let number = part.and_then(whole_number).ok_or_else(fault)?;
            *to = index(KINDS[kind], number, count.map(|count| count.values[kind]))?;
        }
    }
    if parts.next().is_some() { Err(fault()) } else { Ok(corner) }
}

/// The index, from 0, of a `number` after `count` values: from 1 in the file, or backward from -1,
/// the latest value. If the count is unknown, an index that counts backward is an error, which is
/// not reported.
fn index(what: &str, number: i64, count: Option<u64>) -> Result<u32> {
    let index = match number {
        1.. => number - 1,
        0 => {
            return Err(Error::new(ErrorKind::Mesh, format!("the {what} index is out of range"))
                .value(0)
                .remedy("count from 1, or backward from -1"));
        }
        // A count is far below the largest i64.
        _ => count.map_or(-1, |count| count as i64 + number),
    };
    let fits = (0..=MAX_COUNT as i64).contains(&index);
    let fault = || bad_index(what, number, count.unwrap_or(0) as usize);
    if fits { Ok(index as u32) } else { Err(fault()) }
}

/// An integer with an optional sign. One too large for its type is too large for an index.
fn whole_number(text: &[u8]) -> Option<i64> {
    match std::str::from_utf8(text).ok()?.parse() {
        Ok(number) => Some(number),
        Err(error) => match error.kind() {
            IntErrorKind::PosOverflow => Some(i64::MAX),
            IntErrorKind::NegOverflow => Some(i64::MIN),
            _ => None,
        },
    }
}
