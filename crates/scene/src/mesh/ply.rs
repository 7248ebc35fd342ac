//! Stanford PLY: a text header that declares elements and their properties, then the elements, as
//! text or as binary numbers of either byte order.
//!
//! Any header is supported: properties in any order and of any type, elements of any name. Unused
//! ones are skipped. [`header`] reads the declarations and [`layout`] finds the properties of a
//! mesh; [`Numbers`] yields the rows of the body, from text or binary; [`vertices`] and [`faces`]
//! store them in the arrays of the mesh, and [`body`] leads through the elements.
//!
//! Binary rows of constant length are read in blocks on all threads: vertices, and faces as long as
//! they are triangles. Blocks stop at the first invalid row; that row is read again, number by
//! number, which reports the error. So errors have a single source, and the first one is reported
//! whatever the threads did.
//!
//! No crate is used: the existing ones return every property of every row, where the common form is
//! better read as a block, and their errors do not name the element and its number.

mod body;
mod faces;
mod header;
mod layout;
mod numbers;
mod vertices;

use super::data::Read;
use super::faults::no_part;
use super::place::ReadAt;
use header::{BodyEncoding, Element};
use numbers::Numbers;
use wavecrest_base::error::Result;

/// Reads a file of `length` bytes, up to so many `faces` if their number is given: of a binary file with more.
pub(super) fn read(
    file: &dyn ReadAt,
    length: u64,
    buffer: usize,
    faces: Option<u64>,
) -> Result<Read> {
    let mut header = header::read(file, length)?;
    if let Some(most) = faces {
        let is_longer = |element: &Element| element.name == "face" && element.count > most;
        let longer = header.elements.iter().position(is_longer);
        let longer = longer.filter(|_| header.encoding != BodyEncoding::Ascii);
        let longer = longer.ok_or_else(no_part)?;
        header.elements[longer].count = most;
        header.elements.truncate(longer + 1);
    }
    body::read(&header, Numbers::new(file, &header, length, buffer), faces.is_some())
}

#[cfg(test)]
mod tests;
