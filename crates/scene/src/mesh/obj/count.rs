//! Counts of an OBJ text.

use super::lines::{Keyword, statements};

/// The number of lines and values in some text.
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

    pub(super) fn add(&mut self, keyword: Keyword) {
        match keyword {
            Keyword::Position => self.positions += 1,
            Keyword::Uv => self.uvs += 1,
            Keyword::Normal => self.normals += 1,
            Keyword::Face | Keyword::Material | Keyword::Library | Keyword::Other => {}
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
