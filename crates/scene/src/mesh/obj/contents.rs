//! The contents of an OBJ text: of a piece, or of all pieces so far.

use glam::{DVec3, Vec2, Vec3};

use super::corners::Corners;
use super::count::Count;
use super::lines::{
    Keyword, Statement, first_word, is_blank, malformed, name, statements, word_length, words,
};
use crate::mesh::data::{NO_VALUE, NamedMaterials};
use crate::mesh::faults::{check_count, syntax};
use crate::mesh::number;
use crate::mesh::origin::relative;
use crate::mesh::polygon::{self, Polygon};
use crate::mesh::validate::{bad_position, is_good_position};
use wavecrest_base::error::Result;

/// The colour of a position without one.
pub(super) const WHITE: Vec3 = Vec3::ONE;

/// The indices of a triangle without an attribute.
pub(super) const NO_VALUES: [u32; 3] = [NO_VALUE; 3];

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
    pub(super) triangles: Vec<[u32; 3]>,
    /// Triangles beyond the end of this list have [`NO_VALUES`]; likewise for normals.
    pub(super) uv_indices: Vec<[u32; 3]>,
    pub(super) normal_indices: Vec<[u32; 3]>,
    /// Counted from the first of the triangles here.
    pub(super) polygons: Vec<Polygon>,
    /// Counted likewise.
    pub(super) materials: NamedMaterials,
}

impl Contents {
    /// Counts a piece, and reads it with positions relative to `origin`. If it is not known what
    /// was counted up to its `start`, no index may count backward, and the line of an error is
    /// wrong.
    pub(super) fn read(text: &[u8], start: Option<Count>, origin: DVec3) -> (Count, Result<Self>) {
        let mut piece = Ok(Self { origin, ..Self::default() });
        let mut corners = Corners::default();
        let mut count = start.unwrap_or_default();
        let before = count.lines;
        let mut all = statements(text);
        for statement in all.by_ref() {
            let known = start.is_some().then_some(&count);
            // After a failure the rest of the piece is only counted.
            if let Ok(read) = &mut piece
                && let Err(error) = read.statement(statement, known, &mut corners)
            {
                piece = Err(error.at(format!("line {}", before + statement.line + 1)));
            }
            count.add(statement.keyword);
        }
        count.lines = before + all.lines;
        (count, piece)
    }

    /// Appends the next piece.
    pub(super) fn append(&mut self, piece: Self) -> Result<()> {
        let (vertices, triangles) = (self.positions.len(), self.triangles.len());
        check_count("triangles", (triangles + piece.triangles.len()) as u64)?;
        // The count was just checked to fit `u32`.
        let first = triangles as u32;
        let shift = |p: Polygon| Polygon { first: p.first + first, ..p };
        self.polygons.extend(piece.polygons.into_iter().map(shift));
        for (begun, name) in piece.materials.runs {
            self.materials.begin(begun + first, name);
        }
        for statement in piece.materials.libraries {
            self.materials.add_library(statement);
        }
        append(&mut self.colors, vertices, WHITE, piece.colors);
        append(&mut self.uv_indices, triangles, NO_VALUES, piece.uv_indices);
        append(&mut self.normal_indices, triangles, NO_VALUES, piece.normal_indices);
        self.positions.extend(piece.positions);
        self.uvs.extend(piece.uvs);
        self.normals.extend(piece.normals);
        self.triangles.extend(piece.triangles);
        Ok(())
    }

    fn statement(
        &mut self,
        Statement { keyword, rest, .. }: Statement,
        count: Option<&Count>,
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
        if let Some(color) = first_word(rest).and_then(color) {
            self.colors.resize(self.positions.len(), WHITE);
            self.colors.push(color);
        }
        self.positions.push(position);
        Ok(())
    }

    fn push_face(&mut self, Corners([positions, uvs, normals]): &Corners) {
        let before = self.triangles.len();
        if positions.len() > 3 {
            // A piece is in memory, so its triangles are fewer than 2^32; the sum over the pieces
            // is checked when they are joined.
            let (first, corners) = (before as u32, positions.len() as u32);
            self.polygons.push(Polygon { first, corners });
        }
        self.triangles.extend(polygon::fan(positions));
        for (to, corners) in [(&mut self.uv_indices, uvs), (&mut self.normal_indices, normals)] {
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
        let is_whole = |&(_, end): &(f32, usize)| word.get(end).is_none_or(|&b| is_blank(b));
        let (value, length) = match number::leading(word).filter(is_whole) {
            Some(found) => found,
            None => {
                let word = &word[..word_length(word)];
                let fault = || malformed("a number", word, "write it as 12 or -0.5e3");
                (number::parse(word).ok_or_else(fault)?, word.len())
            }
        };
        numbers[found] = value;
        found += 1;
        rest = &word[length..];
    }
    if found < needed {
        return Err(syntax(format!("\"{keyword}\" needs at least {needed} numbers"))
            .value(found)
            .remedy("complete the line; the file may be cut off"));
    }
    Ok((numbers, rest))
}
