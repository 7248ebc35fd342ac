//! Surveys the contents of an OBJ file.

use rayon::prelude::*;

use super::blocks::{BLOCK_BYTES, PIECE_BYTES, cut, each_block};
use super::lines::{Keyword, is_blank, statements};
use crate::mesh::place::ReadAt;
use crate::mesh::survey::Survey;
use wavecrest_base::error::Result;

/// Surveys a file of `length` bytes, in a pass over its text.
pub(in crate::mesh) fn survey(file: &dyn ReadAt, length: u64) -> Result<Survey> {
    let mut all = Survey::default();
    each_block(file, length, BLOCK_BYTES, |text| {
        let parts = cut(text, PIECE_BYTES);
        let found = parts.par_iter().map(|part| of(part)).reduce(Survey::default, plus);
        all = plus(all, found);
        Ok(())
    })?;
    all.colors *= all.positions;
    Ok(all)
}

/// Number of words of a position with a colour.
const WITH_COLOR: usize = 6;

fn words(rest: &[u8]) -> usize {
    rest.split(|&byte| is_blank(byte)).filter(|word| !word.is_empty()).count()
}

fn of(text: &[u8]) -> Survey {
    let mut found = Survey::default();
    for statement in statements(text) {
        match statement.keyword {
            Keyword::Position => {
                found.positions += 1;
                // The first position of a part shows whether all have colours.
                if found.positions == 1 && words(statement.rest) >= WITH_COLOR {
                    found.colors = 1;
                }
            }
            Keyword::Uv => found.uvs += 1,
            Keyword::Normal => found.normals += 1,
            Keyword::Face => face(statement.rest, &mut found),
            Keyword::Material | Keyword::Library | Keyword::Other => {}
        }
    }
    found
}

/// A face has two corners more than triangles. Its first corner shows which indices its corners
/// have.
fn face(rest: &[u8], found: &mut Survey) {
    let mut corners = rest
        .split(|&byte| is_blank(byte))
        .take_while(|word| !word.starts_with(b"#"))
        .filter(|word| !word.is_empty());
    let Some(first) = corners.next() else { return };
    let mut numbers = first.split(|&byte| byte == b'/').skip(1);
    found.uv_indices |= numbers.next().is_some_and(|number| !number.is_empty());
    found.normal_indices |= numbers.next().is_some_and(|number| !number.is_empty());
    found.triangles += (corners.count() as u64).saturating_sub(1);
}

fn plus(a: Survey, b: Survey) -> Survey {
    Survey {
        positions: a.positions + b.positions,
        triangles: a.triangles + b.triangles,
        normals: a.normals + b.normals,
        uvs: a.uvs + b.uvs,
        colors: a.colors | b.colors,
        normal_indices: a.normal_indices || b.normal_indices,
        uv_indices: a.uv_indices || b.uv_indices,
    }
}
