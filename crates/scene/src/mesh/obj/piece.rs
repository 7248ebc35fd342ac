//! Pieces of an OBJ text, counted and read.

use glam::{DVec3, Vec2, Vec3};

use super::corners::Corners;
use super::count::Count;
use super::lines::{Keyword, Statement, first_word, is_blank, malformed, name, statements};
use crate::mesh::data::{NO_VALUE, NamedMaterials};
use crate::mesh::number;
use crate::mesh::origin::relative;
use crate::mesh::polygon::{self, Polygon};
use crate::mesh::validate::{bad_position, is_good_position};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The contents of a piece. Indices count from the beginning of the file.
#[derive(Debug, Default)]
pub(super) struct Piece {
    /// Relative to the origin.
    pub(super) positions: Vec<Vec3>,
    origin: DVec3,
    /// One for each position, if any has a colour.
    pub(super) colors: Option<Vec<Vec3>>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// One for each triangle, if any corner has texture coordinates.
    pub(super) uv_indices: Option<Vec<[u32; 3]>>,
    /// One for each triangle, if any corner has a normal.
    pub(super) normal_indices: Option<Vec<[u32; 3]>>,
    /// Counted from the first triangle of the piece.
    pub(super) polygons: Vec<Polygon>,
    /// Counted likewise.
    pub(super) materials: NamedMaterials,
}

impl Piece {
    /// Reads a piece that begins after `start`, with positions relative to `origin`.
    pub(super) fn read(text: &[u8], start: Count, origin: DVec3) -> Result<Self> {
        let mut piece = Self { origin, ..Self::default() };
        let mut corners = Corners::default();
        let mut count = start;
        for statement in statements(text) {
            piece
                .statement(statement, Some(count), &mut corners)
                .map_err(|error| error.at(format!("line {}", start.lines + statement.line + 1)))?;
            count.add(statement.keyword);
        }
        Ok(piece)
    }

    /// Counts the contents of a piece, and reads it if that needs no knowledge of earlier pieces:
    /// if no index counts backward, and there is no error whose line is needed.
    pub(super) fn read_anywhere(text: &[u8], origin: DVec3) -> (Count, Option<Self>) {
        let mut piece = Some(Self { origin, ..Self::default() });
        let mut corners = Corners::default();
        let mut count = Count::default();
        let mut all = statements(text);
        for statement in all.by_ref() {
            // After a failure the rest of the piece is only counted.
            if let Some(read) = &mut piece
                && read.statement(statement, None, &mut corners).is_err()
            {
                piece = None;
            }
            count.add(statement.keyword);
        }
        count.lines = all.lines;
        (count, piece)
    }

    fn statement(
        &mut self,
        Statement { keyword, rest, .. }: Statement,
        count: Option<Count>,
        corners: &mut Corners,
    ) -> Result<()> {
        match keyword {
            Keyword::Position => self.push_position(rest)?,
            Keyword::Uv => {
                let ([u, v], _) = numbers(rest, 1, "vt")?;
                self.uvs.push(Vec2::new(u, v));
            }
            Keyword::Normal => self.normals.push(Vec3::from(numbers::<3>(rest, 3, "vn")?.0)),
            Keyword::Face => {
                corners.read(rest, count)?;
                self.push_face(corners);
            }
            // A piece is in memory, so its triangles are fewer than 2^32.
            Keyword::Material => self.materials.begin(self.triangles.len() as u32, name(rest)),
            Keyword::Library => self.materials.add_library(name(rest)),
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
        let color = first_word(rest).and_then(color);
        if color.is_some() || self.colors.is_some() {
            let before = self.positions.len();
            let colors = self.colors.get_or_insert_with(|| vec![Vec3::ONE; before]);
            colors.push(color.unwrap_or(Vec3::ONE));
        }
        self.positions.push(position);
        Ok(())
    }

    fn push_face(&mut self, corners: &Corners) {
        let before = self.triangles.len();
        if corners.positions.len() > 3 {
            // A piece is in memory, so its triangles are fewer than 2^32; the sum over the pieces
            // is checked when they are joined.
            let (first, corners) = (before as u32, corners.positions.len() as u32);
            self.polygons.push(Polygon { first, corners });
        }
        self.triangles.extend(polygon::fan(&corners.positions));
        push_indices(&mut self.uv_indices, &corners.uvs, before);
        push_indices(&mut self.normal_indices, &corners.normals, before);
    }
}

/// Appends a face's indices of one attribute; if there is no list yet, the triangles `before` had
/// none.
fn push_indices(to: &mut Option<Vec<[u32; 3]>>, corners: &[u32], before: usize) {
    if to.is_none() && corners.iter().all(|&i| i == NO_VALUE) {
        return;
    }
    to.get_or_insert_with(|| vec![[NO_VALUE; 3]; before]).extend(polygon::fan(corners));
}

/// The first position of a text, if it is valid.
pub(super) fn first_position(text: &[u8]) -> Option<DVec3> {
    let rest = statements(text).find(|statement| statement.keyword == Keyword::Position)?.rest;
    let (rounded, _) = numbers::<3>(rest, 3, "v").ok()?;
    Some(exact(rest, Vec3::from(rounded)))
}

/// The numbers of a position in double precision, given the `rounded` ones.
#[cold]
fn exact(mut rest: &[u8], rounded: Vec3) -> DVec3 {
    let mut point = rounded.as_dvec3();
    for axis in 0..3 {
        let Some(word) = first_word(rest) else { break };
        let length = word.iter().position(|&b| is_blank(b)).unwrap_or(word.len());
        let number = std::str::from_utf8(&word[..length]).ok().and_then(|word| word.parse().ok());
        point[axis] = number.unwrap_or(point[axis]);
        rest = &word[length..];
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
    rest: &'a [u8],
    needed: usize,
    keyword: &str,
) -> Result<([f32; N], &'a [u8])> {
    let mut numbers = [0.0; N];
    let mut found = 0;
    let mut rest = rest;
    while found < N
        && let Some(word) = first_word(rest)
    {
        let (value, length) = match number::leading(word) {
            Some((value, length)) if word.get(length).is_none_or(|&b| is_blank(b)) => {
                (value, length)
            }
            _ => {
                let length = word.iter().position(|&b| is_blank(b)).unwrap_or(word.len());
                let word = &word[..length];
                let fault = || malformed("a number", word, "write it as 12 or -0.5e3");
                (number::parse(word).ok_or_else(fault)?, length)
            }
        };
        numbers[found] = value;
        found += 1;
        rest = &word[length..];
    }
    if found < needed {
        return Err(Error::new(
            ErrorKind::Syntax,
            format!("\"{keyword}\" needs at least {needed} numbers"),
        )
        .value(found)
        .remedy("complete the line; the file may be cut off"));
    }
    Ok((numbers, rest))
}

/// The error of the first face of a text that refers to a value beyond those of the `whole` file.
/// The text begins after `start`, and [`Piece::read`] found no error in it.
pub(super) fn find_bad_face(text: &[u8], start: Count, whole: Count) -> Option<Error> {
    let mut corners = Corners::default();
    let mut count = start;
    for statement in statements(text) {
        if statement.keyword == Keyword::Face && corners.read(statement.rest, Some(count)).is_ok() {
            let error = corners.first_beyond(whole);
            if let Some(error) = error {
                return Some(error.at(format!("line {}", start.lines + statement.line + 1)));
            }
        }
        count.add(statement.keyword);
    }
    None
}
