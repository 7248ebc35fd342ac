//! The corners of a face of an OBJ text.

use super::count::Count;
use super::lines::{first_word, is_blank, malformed};
use crate::mesh::data::{MAX_COUNT, NO_VALUE};
use crate::mesh::number::leading_whole;
use crate::mesh::validate::bad_index;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The indices of a face's corners, a list for each kind; [`NO_VALUE`] for none.
#[derive(Debug, Default)]
pub(super) struct Corners {
    pub(super) positions: Vec<u32>,
    pub(super) uvs: Vec<u32>,
    pub(super) normals: Vec<u32>,
}

impl Corners {
    /// Reads the corners of a face after `count` values; if the count is unknown, indices must not
    /// count backward.
    pub(super) fn read(&mut self, mut rest: &[u8], count: Option<Count>) -> Result<()> {
        self.positions.clear();
        self.uvs.clear();
        self.normals.clear();
        while let Some(word) = first_word(rest) {
            let ([position, uv, normal], length) = match quick(word) {
                Some(found) => found,
                None => {
                    let end = word.iter().position(|&b| is_blank(b)).unwrap_or(word.len());
                    (corner(&word[..end], count)?, end)
                }
            };
            self.positions.push(position);
            self.uvs.push(uv);
            self.normals.push(normal);
            rest = &word[length..];
        }
        match self.positions.len() {
            0..3 => Err(Error::new(ErrorKind::Mesh, "a face needs at least 3 vertices")
                .value(self.positions.len())
                .remedy("remove the face")),
            _ => Ok(()),
        }
    }
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
fn corner(word: &[u8], count: Option<Count>) -> Result<[u32; 3]> {
    let mut parts = word.split(|&b| b == b'/');
    let fault = || malformed("a corner of a face", word, "write it as 1, 1/2, 1//3 or 1/2/3");
    let [positions, uvs, normals] =
        count.map_or([None; 3], |c| [c.positions, c.uvs, c.normals].map(Some));
    let position = parts.next().filter(|p| !p.is_empty()).ok_or_else(fault)?;
    let position = index("vertex", position, positions).ok_or_else(fault)??;
    let uv = optional("texture coordinate", parts.next(), uvs).ok_or_else(fault)??;
    let normal = optional("normal", parts.next(), normals).ok_or_else(fault)??;
    if parts.next().is_some() {
        return Err(fault());
    }
    Ok([position, uv, normal])
}

impl Corners {
    /// The error of the first index beyond the counts of the `whole` file. Attributes without
    /// values in the file count as absent.
    pub(super) fn first_beyond(&self, whole: Count) -> Option<Error> {
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

/// An optional index: `None` if it is malformed.
fn optional(what: &str, digits: Option<&[u8]>, count: Option<u64>) -> Option<Result<u32>> {
    match digits {
        None | Some([]) => Some(Ok(NO_VALUE)),
        Some(digits) => index(what, digits, count),
    }
}

/// The index, from 0, in `digits` after `count` values: from 1 in the file, or backward from -1,
/// the latest value. `None` if it is malformed. If the count is unknown, an index that counts
/// backward is an error, which is not reported.
fn index(what: &str, digits: &[u8], count: Option<u64>) -> Option<Result<u32>> {
    let number = whole_number(digits)?;
    let index = match number {
        1.. => number - 1,
        0 => return Some(Err(zero_index(what))),
        // A count is far below the largest i64.
        _ => count.map_or(-1, |count| count as i64 + number),
    };
    let fits = (0..=MAX_COUNT as i64).contains(&index);
    let fault = || bad_index(what, number, count.unwrap_or(0) as usize);
    Some(if fits { Ok(index as u32) } else { Err(fault()) })
}

fn zero_index(what: &str) -> Error {
    Error::new(ErrorKind::Mesh, format!("the {what} index is out of range"))
        .value(0)
        .remedy("count from 1, or backward from -1")
}

/// An integer with an optional sign. One too large for an index may wrap to another that is too
/// large.
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
