//! Stanford PLY: a text header that declares elements and their properties, then the elements, as
//! text or as binary numbers of either byte order.
//!
//! Any header is supported: properties in any order and of any type, elements of any name. Unused
//! ones are skipped. [`header`] reads the declarations and [`layout`] finds the properties of a
//! mesh; [`Numbers`] yields the numbers of the body, from text or binary; [`body`] reads the
//! elements.
//!
//! Binary rows have fast paths that read many rows at once on all threads: [`vertices`] for rows of
//! constant length, [`faces`] if all faces have the same number of corners. A fast path stops at
//! the first invalid row; [`body`] reads that row again, number by number, and reports the error.
//! So errors have a single source, and the first one is reported whatever the threads did.
//!
//! No crate is used: the existing ones return every property of every row, where the common form is
//! better read as a block, and their errors do not name the element and its number.

mod body;
mod faces;
mod header;
mod layout;
mod numbers;
mod survey;
mod vertices;

use super::data::Read;
use super::place::ReadAt;
use numbers::Numbers;
use wavecrest_base::error::Result;

pub(super) use survey::survey;

/// Reads a file of `length` bytes.
pub(super) fn read(file: &dyn ReadAt, length: u64, buffer: usize) -> Result<Read> {
    let header = header::read(file, length, buffer)?;
    body::read(&header, Numbers::new(file, &header, length, buffer))
}

#[cfg(test)]
mod tests;
