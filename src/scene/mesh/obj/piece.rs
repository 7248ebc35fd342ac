//! A piece of an OBJ text: its statements, counted and read.

use glam::{Vec2, Vec3};

use super::lines::{Keyword, Statement, statements, words};
use crate::error::{Error, ErrorKind, Result};
use crate::scene::mesh::polygon::{self, Polygon};
use crate::scene::mesh::validate::{bad_index, bad_position, is_good_position};
use crate::scene::mesh::{MAX_COUNT, NO_VALUE};

/// How many lines and values there are in some text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Count {
    pub(super) lines: u64,
    pub(super) positions: u64,
    pub(super) uvs: u64,
    pub(super) normals: u64,
}

impl Count {
    pub(super) fn of(text: &[u8]) -> Self {
        let mut count = Self::default();
        let mut all = statements(text);
        for statement in all.by_ref() {
            count.add(statement.keyword);
        }
        count.lines = all.lines;
        count
    }

    fn add(&mut self, keyword: Keyword) {
        match keyword {
            Keyword::Position => self.positions += 1,
            Keyword::Uv => self.uvs += 1,
            Keyword::Normal => self.normals += 1,
            Keyword::Face | Keyword::Other => {}
        }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            lines: self.lines + other.lines,
            positions: self.positions + other.positions,
            uvs: self.uvs + other.uvs,
            normals: self.normals + other.normals,
        }
    }
}

/// What a piece gives. Indices count from the beginning of the file.
#[derive(Debug, Default)]
pub(super) struct Piece {
    pub(super) positions: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// As many as triangles, if any corner has texture coordinates.
    pub(super) uv_indices: Option<Vec<[u32; 3]>>,
    /// As many as triangles, if any corner has a normal.
    pub(super) normal_indices: Option<Vec<[u32; 3]>>,
    /// Counted from the first triangle of the piece.
    pub(super) polygons: Vec<Polygon>,
}

/// The indices of a face's corners, a list for each kind; [`NO_VALUE`] where there is none.
#[derive(Debug, Default)]
struct Corners {
    positions: Vec<u32>,
    uvs: Vec<u32>,
    normals: Vec<u32>,
}

impl Piece {
    /// Reads a piece that begins after `start`.
    pub(super) fn read(text: &[u8], start: Count) -> Result<Self> {
        let mut piece = Self::default();
        let mut corners = Corners::default();
        let mut count = start;
        for statement in statements(text) {
            piece
                .statement(statement, count, &mut corners)
                .map_err(|error| error.at(format!("line {}", start.lines + statement.line + 1)))?;
            count.add(statement.keyword);
        }
        Ok(piece)
    }

    fn statement(
        &mut self,
        Statement { keyword, rest, .. }: Statement,
        count: Count,
        corners: &mut Corners,
    ) -> Result<()> {
        match keyword {
            Keyword::Position => self.positions.push(position(rest)?),
            Keyword::Uv => {
                let [u, v] = numbers(rest, 1, "vt")?;
                self.uvs.push(Vec2::new(u, v));
            }
            Keyword::Normal => self.normals.push(Vec3::from(numbers::<3>(rest, 3, "vn")?)),
            Keyword::Face => {
                corners.read(rest, count)?;
                self.push_face(corners);
            }
            Keyword::Other => {}
        }
        Ok(())
    }

    fn push_face(&mut self, corners: &Corners) {
        let before = self.triangles.len();
        if corners.positions.len() > 3 {
            // A piece is in memory, so that its triangles are fewer than 2^32; the sum over the
            // pieces is checked where they are joined.
            let (first, corners) = (before as u32, corners.positions.len() as u32);
            self.polygons.push(Polygon { first, corners });
        }
        self.triangles.extend(polygon::fan(&corners.positions));
        push_indices(&mut self.uv_indices, &corners.uvs, before);
        push_indices(&mut self.normal_indices, &corners.normals, before);
    }
}

/// Adds a face's indices of one attribute, of which the triangles `before` had none if there is no
/// list yet.
fn push_indices(to: &mut Option<Vec<[u32; 3]>>, corners: &[u32], before: usize) {
    if to.is_none() && corners.iter().all(|&i| i == NO_VALUE) {
        return;
    }
    to.get_or_insert_with(|| vec![[NO_VALUE; 3]; before]).extend(polygon::fan(corners));
}

impl Corners {
    /// Reads the corners of a face that comes after `count` values.
    fn read(&mut self, rest: &[u8], count: Count) -> Result<()> {
        self.positions.clear();
        self.uvs.clear();
        self.normals.clear();
        for word in words(rest) {
            let mut parts = word.split(|&b| b == b'/');
            let fault =
                || malformed("a corner of a face", word, "write it as 1, 1/2, 1//3 or 1/2/3");
            let position = parts.next().filter(|p| !p.is_empty()).ok_or_else(fault)?;
            self.positions.push(index("vertex", position, count.positions).ok_or_else(fault)??);
            self.uvs
                .push(optional("texture coordinate", parts.next(), count.uvs).ok_or_else(fault)??);
            self.normals.push(optional("normal", parts.next(), count.normals).ok_or_else(fault)??);
            if parts.next().is_some() {
                return Err(fault());
            }
        }
        match self.positions.len() {
            0..3 => Err(Error::new(ErrorKind::Mesh, "a face needs at least 3 vertices")
                .value(self.positions.len())
                .remedy("remove the face")),
            _ => Ok(()),
        }
    }
}

impl Corners {
    /// The error of an index that is not below the count of the `whole` file. Attributes of which
    /// the file has no value are taken as absent.
    fn first_beyond(&self, whole: Count) -> Option<Error> {
        let columns = [
            ("vertex", &self.positions, whole.positions, true),
            ("texture coordinate", &self.uvs, whole.uvs, whole.uvs > 0),
            ("normal", &self.normals, whole.normals, whole.normals > 0),
        ];
        columns.into_iter().filter(|c| c.3).find_map(|(what, indices, count, _)| {
            let bad = |&&i: &&u32| i != NO_VALUE && u64::from(i) >= count;
            let index = u64::from(*indices.iter().find(bad)?) + 1;
            Some(bad_index(what, index, count as usize))
        })
    }
}

/// An index that may be missing: `None` if it is malformed.
fn optional(what: &str, digits: Option<&[u8]>, count: u64) -> Option<Result<u32>> {
    match digits {
        None | Some([]) => Some(Ok(NO_VALUE)),
        Some(digits) => index(what, digits, count),
    }
}

/// The index, from 0, that `digits` name after `count` values: from 1 in the file, or backward
/// from -1, the latest value. `None` if it is malformed.
fn index(what: &str, digits: &[u8], count: u64) -> Option<Result<u32>> {
    let number = whole_number(digits)?;
    let index = match number {
        1.. => number - 1,
        0 => return Some(Err(zero_index(what))),
        // A count is far below the greatest i64.
        _ => count as i64 + number,
    };
    let fits = (0..=MAX_COUNT as i64).contains(&index);
    Some(if fits { Ok(index as u32) } else { Err(bad_index(what, number, count as usize)) })
}

fn zero_index(what: &str) -> Error {
    Error::new(ErrorKind::Mesh, format!("the {what} index is out of range"))
        .value(0)
        .remedy("count from 1, or backward from -1")
}

/// A whole number with an optional sign. One that is too large for an index may come out as some
/// other that is.
fn whole_number(text: &[u8]) -> Option<i64> {
    let (negative, digits) = match text {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] | digits => (false, digits),
    };
    if digits.is_empty() {
        return None;
    }
    let mut number = 0_i64;
    for digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        number = number.saturating_mul(10).saturating_add(i64::from(digit - b'0')).min(1 << 40);
    }
    Some(if negative { -number } else { number })
}

/// A vertex position. What follows the third number is a weight or a colour and is not read.
fn position(rest: &[u8]) -> Result<Vec3> {
    let position = Vec3::from(numbers::<3>(rest, 3, "v")?);
    if is_good_position(position) { Ok(position) } else { Err(bad_position(position)) }
}

/// The first `N` numbers of a statement. The first `needed` must be there, the others are 0 if they
/// are not.
fn numbers<const N: usize>(rest: &[u8], needed: usize, keyword: &str) -> Result<[f32; N]> {
    let mut numbers = [0.0; N];
    let mut found = 0;
    for (number, word) in numbers.iter_mut().zip(words(rest)) {
        let parsed = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        *number = parsed.ok_or_else(|| malformed("a number", word, "write it as 12 or -0.5e3"))?;
        found += 1;
    }
    if found < needed {
        return Err(Error::new(
            ErrorKind::Syntax,
            format!("\"{keyword}\" needs at least {needed} numbers"),
        )
        .value(found)
        .remedy("complete the line; the file may have been cut off"));
    }
    Ok(numbers)
}

fn malformed(what: &str, word: &[u8], remedy: &str) -> Error {
    Error::new(ErrorKind::Syntax, format!("{what} is malformed"))
        .value(format_args!("\"{}\"", String::from_utf8_lossy(word)))
        .remedy(remedy)
}

/// The error of the first face of a text that names a value beyond those of the `whole` file. The
/// text begins after `start`, and [`Piece::read`] has found no fault in it.
pub(super) fn find_bad_face(text: &[u8], start: Count, whole: Count) -> Option<Error> {
    let mut corners = Corners::default();
    let mut count = start;
    for statement in statements(text) {
        if statement.keyword == Keyword::Face && corners.read(statement.rest, count).is_ok() {
            let error = corners.first_beyond(whole);
            if let Some(error) = error {
                return Some(error.at(format!("line {}", start.lines + statement.line + 1)));
            }
        }
        count.add(statement.keyword);
    }
    None
}
