//! The corners of a face of an OBJ text.

use super::count::{Count, KINDS};
use super::lines::{first_word, is_blank, malformed, word_length};
use crate::mesh::data::{MAX_COUNT, NO_VALUE};
use crate::mesh::faults::too_few_corners;
use crate::mesh::number::leading_whole;
use crate::mesh::validate::bad_index;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The indices of a face's corners, a list for each of [`KINDS`]; [`NO_VALUE`] for none.
#[derive(Debug, Default)]
pub(super) struct Corners(pub(super) [Vec<u32>; 3]);

impl Corners {
    /// Reads the corners of a face after `count` values; if the count is unknown, indices must not
    /// count backward.
    pub(super) fn read(&mut self, mut rest: &[u8], count: Option<&Count>) -> Result<()> {
        self.0.iter_mut().for_each(Vec::clear);
        while let Some(word) = first_word(rest) {
            let (corner, length) = match quick(word) {
                Some(found) => found,
                None => {
                    let length = word_length(word);
                    (corner(&word[..length], count)?, length)
                }
            };
            self.0.iter_mut().zip(corner).for_each(|(list, index)| list.push(index));
            rest = &word[length..];
        }
        match self.0[0].len() {
            few @ 0..3 => Err(too_few_corners(few)),
            _ => Ok(()),
        }
    }

    /// The error of the first index beyond the counts of the `whole` file.
    pub(super) fn first_beyond(&self, whole: &Count) -> Option<Error> {
        first_beyond(whole, |kind, count| {
            self.0[kind].iter().copied().find(|&index| is_beyond(index, count))
        })
    }
}

/// The error of the first index that `find` finds for the number of one of [`KINDS`] and the count
/// of its values. Attributes without values in the file count as absent.
pub(super) fn first_beyond(
    whole: &Count,
    find: impl Fn(usize, u64) -> Option<u32>,
) -> Option<Error> {
    let given = |&(kind, count): &(usize, u64)| kind == 0 || count > 0;
    whole.values().into_iter().enumerate().filter(given).find_map(|(kind, count)| {
        let index = u64::from(find(kind, count)?) + 1;
        Some(bad_index(KINDS[kind], index, count as usize))
    })
}

/// Whether there is an index, but none of `count` values.
pub(super) fn is_beyond(index: u32, count: u64) -> bool {
    index != NO_VALUE && u64::from(index) >= count
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
fn corner(word: &[u8], count: Option<&Count>) -> Result<[u32; 3]> {
    let fault = || malformed("a corner of a face", word, "write it as 1, 1/2, 1//3 or 1/2/3");
    let mut parts = word.split(|&b| b == b'/');
    let mut corner = [NO_VALUE; 3];
    for (kind, to) in corner.iter_mut().enumerate() {
        let part = parts.next().filter(|part| !part.is_empty());
        // Only texture coordinates and normals may be missing.
        if kind == 0 || part.is_some() {
            let number = part.and_then(whole_number).ok_or_else(fault)?;
            *to = index(KINDS[kind], number, count.map(|count| count.values()[kind]))?;
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
        0 => return Err(zero_index(what)),
        // A count is far below the largest i64.
        _ => count.map_or(-1, |count| count as i64 + number),
    };
    let fits = (0..=MAX_COUNT as i64).contains(&index);
    let fault = || bad_index(what, number, count.unwrap_or(0) as usize);
    if fits { Ok(index as u32) } else { Err(fault()) }
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
