//! STL: triangles in sequence, each with its three corners, as binary numbers or as text.
//!
//! A corner shared by several triangles is repeated for each: corners with equal positions are
//! merged ([`super::join`]), so that the mesh has the neighbours of the surface. The normals of
//! the file are ignored: the order of the corners gives them.
//!
//! Both forms may begin with `solid`. A file is binary if its length fits its count of triangles,
//! or if it has a zero byte where a text has words.

mod ascii;
mod binary;

use super::data::{MeshData, Read};
use super::faults::{self, no_triangles, read_failure, syntax};
use super::join;
use super::place::ReadAt;
use super::survey::Survey;
use super::validate::{bad_position, is_good_position};
use glam::Vec3;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// Buffer size, for each thread in binary files.
const BUFFER: usize = 1 << 17;

/// Length of a binary file's header: a text, and the count of triangles.
const HEAD: usize = 84;

/// Reads a file of `length` bytes.
pub(super) fn read(file: &std::fs::File, length: u64) -> Result<Read> {
    read_from(file, length, BUFFER)
}

pub(super) fn read_from(file: &dyn ReadAt, length: u64, buffer: usize) -> Result<Read> {
    let (corners, notes) = match form(file, length)? {
        Form::Binary(head) => binary::read(file, &head, length, buffer)?,
        Form::Text => ascii::read(file, length, buffer)?,
    };
    if corners.is_empty() {
        return Err(no_triangles());
    }
    let (positions, triangles) = join::join(corners);
    Ok((MeshData { positions, triangles, ..MeshData::default() }, notes))
}

/// Surveys a file of `length` bytes. The number of shared corners is unknown and taken as 0.
pub(super) fn survey(file: &dyn ReadAt, length: u64) -> Result<Survey> {
    let triangles = match form(file, length)? {
        Form::Binary(head) => binary::count(&head).min(binary::room(length)),
        Form::Text => ascii::count(file, length)?,
    };
    Ok(Survey { positions: 3 * triangles, triangles, ..Survey::default() })
}

/// The form of a file.
enum Form {
    /// With its header.
    Binary([u8; HEAD]),
    Text,
}

/// The form of a file of `length` bytes.
fn form(file: &dyn ReadAt, length: u64) -> Result<Form> {
    if length == 0 {
        return Err(syntax("the file is empty").remedy("export it again"));
    }
    let mut head = [0; HEAD];
    let there = length.min(HEAD as u64) as usize;
    file.read_exact_at(&mut head[..there], 0).map_err(read_failure)?;
    let is_whole = there == HEAD && binary::count(&head) == binary::room(length);
    let first = head.trim_ascii_start().get(..5);
    let begins_as_text = first.is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    if begins_as_text && !is_whole && !head[..there].contains(&0) {
        return Ok(Form::Text);
    }
    if there < HEAD {
        let remedy = format!("begin it with \"solid\", or with a binary header of {HEAD} bytes");
        return Err(syntax("the file is too short for STL").value(length).remedy(remedy));
    }
    Ok(Form::Binary(head))
}

/// Checks that the corners of this number of triangles can be numbered.
fn check_count(triangles: u64) -> Result<()> {
    faults::check_count("corners", triangles.saturating_mul(3))
}

/// The corner `p` with zeros of one sign, so that equal positions have equal bits.
fn corner(p: Vec3) -> Result<Vec3> {
    if is_good_position(p) { Ok(p + Vec3::ZERO) } else { Err(bad_position(p)) }
}

/// The warning that colours are ignored, by the name of their extension.
fn ignored_colours(extension: &str) -> Error {
    Error::new(ErrorKind::Mesh, format!("{extension} are ignored"))
        .remedy("save the mesh as PLY to keep them")
}

#[cfg(test)]
mod tests;
