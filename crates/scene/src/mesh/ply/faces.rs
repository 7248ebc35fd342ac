//! Binary faces that are all triangles, read on all threads.
//!
//! Such rows have one length, if what else is in them has, so that the place of each is known
//! without reading those before. That all are triangles shows only as they are read: a row that is
//! no triangle of the mesh's vertices ends the short cut.

use rayon::prelude::*;

use super::header::Scalar;
use super::layout::stride;
use super::source::FaceRows;
use super::vertices::part;
use crate::mesh::place::ReadAt;

/// How many corners such a face has.
const CORNERS: usize = 3;

/// Where in a row the numbers are.
#[derive(Clone, Copy, Debug)]
struct Row {
    stride: usize,
    /// Where the list begins.
    list: usize,
    /// No index is this or greater.
    limit: u32,
}

impl Row {
    /// `None` where rows vary in length even if their lists of corners do not, and where indices
    /// are not whole numbers.
    fn of(FaceRows { element, layout, .. }: FaceRows<'_>, vertices: usize) -> Option<Self> {
        let (before, rest) = element.properties.split_at_checked(layout.property)?;
        let list = stride(before)?;
        let after = stride(rest.get(1..)?)?;
        let length = layout.count.size() + CORNERS * layout.item.size();
        greatest(layout.count)?;
        Some(Self { stride: list + length + after, list, limit: limit(layout.item, vertices)? })
    }
}

/// The greatest whole number of this type; `None` for types of other numbers too.
pub(super) fn greatest(kind: Scalar) -> Option<u32> {
    match kind {
        Scalar::I8 => Some(i8::MAX as u32),
        Scalar::U8 => Some(u32::from(u8::MAX)),
        Scalar::I16 => Some(i16::MAX as u32),
        Scalar::U16 => Some(u32::from(u16::MAX)),
        Scalar::I32 => Some(i32::MAX as u32),
        Scalar::U32 => Some(u32::MAX),
        Scalar::F32 | Scalar::F64 => None,
    }
}

/// What an index of this type is below, where it is read as if it had no sign: a negative number
/// is then one that is too large.
pub(super) fn limit(kind: Scalar, vertices: usize) -> Option<u32> {
    let beyond = u64::from(greatest(kind)?) + 1;
    // Both fit: there are fewer vertices than `u32::MAX`.
    Some(beyond.min(vertices as u64) as u32)
}

/// The number of `N` bytes at `offset`, read as if it had no sign.
#[inline(always)]
pub(super) fn number<const N: usize, const BIG: bool>(row: &[u8], offset: usize) -> u32 {
    let mut bytes = [0; 4];
    bytes[..N].copy_from_slice(&part::<N, BIG>(row, offset));
    u32::from_le_bytes(bytes)
}

/// Reads the faces from `place` on, all `count` of them if they are triangles; else as many as come
/// before the first that is not. `None` where there is no such short cut: where rows are of
/// other types, or the `left` bytes cannot hold so many triangles. A thread reads about `block`
/// bytes at once.
pub(super) fn read<F: ReadAt + ?Sized, const BIG: bool>(
    file: &F,
    place: u64,
    left: u64,
    rows: FaceRows<'_>,
    vertices: usize,
    block: usize,
) -> Option<(Vec<[u32; 3]>, u64)> {
    let row = Row::of(rows, vertices)?;
    if (row.stride as u64).checked_mul(rows.element.count)? > left {
        return None;
    }
    let decode = decoder::<BIG>(rows.layout.count, rows.layout.item)?;
    let count = usize::try_from(rows.element.count).ok()?;
    let mut triangles = vec![[0; CORNERS]; count];
    let per_task = (block / row.stride).max(1);
    let stops = triangles.par_chunks_mut(per_task).enumerate().map_init(
        Vec::new,
        |buffer: &mut Vec<u8>, (number, triangles)| {
            let first = number * per_task;
            buffer.resize(triangles.len() * row.stride, 0);
            let from = place + (first * row.stride) as u64;
            // What cannot be read is read again number by number, and told there.
            let read = file.read_exact_at(buffer, from).is_ok();
            let good = if read { decode(buffer, row, triangles) } else { 0 };
            (good < triangles.len()).then_some(first + good)
        },
    );
    let good = stops.find_first(Option::is_some).flatten().unwrap_or(count);
    triangles.truncate(good);
    Some((triangles, good as u64 * row.stride as u64))
}

/// Reads rows; returns how many come before the first that is no triangle.
type Decode = fn(&[u8], Row, &mut [[u32; CORNERS]]) -> usize;

/// The function for numbers of these types.
fn decoder<const BIG: bool>(count: Scalar, item: Scalar) -> Option<Decode> {
    Some(match (count.size(), item.size()) {
        (1, 1) => decode::<1, 1, BIG>,
        (1, 2) => decode::<1, 2, BIG>,
        (1, 4) => decode::<1, 4, BIG>,
        (2, 1) => decode::<2, 1, BIG>,
        (2, 2) => decode::<2, 2, BIG>,
        (2, 4) => decode::<2, 4, BIG>,
        (4, 1) => decode::<4, 1, BIG>,
        (4, 2) => decode::<4, 2, BIG>,
        (4, 4) => decode::<4, 4, BIG>,
        _ => return None,
    })
}

fn decode<const C: usize, const I: usize, const BIG: bool>(
    rows: &[u8],
    row: Row,
    to: &mut [[u32; CORNERS]],
) -> usize {
    // Where a row is the list and no more, the compiler knows every offset.
    let packed = Row { stride: C + CORNERS * I, list: 0, ..row };
    if row.stride == packed.stride {
        decode_rows::<C, I, BIG>(rows, packed, to)
    } else {
        decode_rows::<C, I, BIG>(rows, row, to)
    }
}

#[inline(always)]
fn decode_rows<const C: usize, const I: usize, const BIG: bool>(
    rows: &[u8],
    Row { stride, list, limit }: Row,
    to: &mut [[u32; CORNERS]],
) -> usize {
    let mut all_good = true;
    let is_good = |row: &[u8], triangle: &[u32; CORNERS]| {
        let greatest = triangle.iter().fold(0, |a, b| a.max(*b));
        (number::<C, BIG>(row, list) == CORNERS as u32) & (greatest < limit)
    };
    for (to, row) in to.iter_mut().zip(rows.chunks_exact(stride)) {
        *to = [0, 1, 2].map(|i| number::<I, BIG>(row, list + C + i * I));
        all_good &= is_good(row, to);
    }
    if all_good {
        return to.len();
    }
    let mut both = to.iter().zip(rows.chunks_exact(stride));
    both.position(|(triangle, row)| !is_good(row, triangle)).unwrap_or(to.len())
}
