//! Counts of an OBJ text, and its survey.

use rayon::prelude::*;

use super::lines::{BLOCK, Keyword, cut, each_block, statements, words};
use crate::mesh::BUFFER;
use crate::mesh::place::ReadAt;
use crate::mesh::survey::Survey;
use wavecrest_base::error::Result;

/// What indices refer to, in the order of a corner.
pub(super) const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// Number of words of a position with a colour.
const WITH_COLOR: usize = 6;

/// The number of lines and values in some text.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Count {
    pub(super) lines: u64,
    /// Triangles, colours and what corners have are counted for a survey alone.
    holds: Survey,
}

impl Count {
    pub(super) fn add(&mut self, keyword: Keyword) {
        match keyword {
            Keyword::Position => self.holds.positions += 1,
            Keyword::Uv => self.holds.uvs += 1,
            Keyword::Normal => self.holds.normals += 1,
            Keyword::Face | Keyword::Material | Keyword::Library | Keyword::Other => {}
        }
    }

    /// The numbers of values, by [`KINDS`].
    pub(super) fn values(&self) -> [u64; 3] {
        [self.holds.positions, self.holds.uvs, self.holds.normals]
    }

    pub(super) fn plus(self, other: Self) -> Self {
        let (a, b) = (self.holds, other.holds);
        let holds = Survey {
            positions: a.positions + b.positions,
            triangles: a.triangles + b.triangles,
            normals: a.normals + b.normals,
            uvs: a.uvs + b.uvs,
            colors: a.colors | b.colors,
            normal_indices: a.normal_indices || b.normal_indices,
            uv_indices: a.uv_indices || b.uv_indices,
        };
        Self { lines: self.lines + other.lines, holds }
    }
}

/// Surveys a file of `length` bytes, in a pass over its text.
pub(in crate::mesh) fn survey(file: &dyn ReadAt, length: u64) -> Result<Survey> {
    let mut all = Count::default();
    each_block(file, length, BLOCK, |text| {
        let parts = cut(text, BUFFER);
        let found = parts.par_iter().map(|part| surveyed(part)).reduce(Count::default, Count::plus);
        all = all.plus(found);
        Ok(())
    })?;
    Ok(Survey { colors: all.holds.colors * all.holds.positions, ..all.holds })
}

fn surveyed(text: &[u8]) -> Count {
    let mut found = Count::default();
    for statement in statements(text) {
        found.add(statement.keyword);
        let holds = &mut found.holds;
        match statement.keyword {
            // The first position of a part shows whether all have colours.
            Keyword::Position if holds.positions == 1 => {
                holds.colors = u64::from(words(statement.rest).count() >= WITH_COLOR);
            }
            Keyword::Face => face(statement.rest, holds),
            _ => {}
        }
    }
    found
}

/// A face has two corners more than triangles. Its first corner shows which indices its corners
/// have.
fn face(rest: &[u8], found: &mut Survey) {
    let mut corners = words(rest).take_while(|word| !word.starts_with(b"#"));
    let Some(first) = corners.next() else { return };
    let mut numbers = first.split(|&byte| byte == b'/').skip(1);
    found.uv_indices |= numbers.next().is_some_and(|number| !number.is_empty());
    found.normal_indices |= numbers.next().is_some_and(|number| !number.is_empty());
    found.triangles += (corners.count() as u64).saturating_sub(1);
}
