//! Errors shared by the readers of all formats.

use super::data::MAX_COUNT;
use wavecrest_base::error::{Error, ErrorKind, Result};

/// A failure of the system while reading the file; the caller names the file.
pub(super) fn read_failure(error: std::io::Error) -> Error {
    Error::new(ErrorKind::Io, format!("cannot read the file: {error}")).because(error)
}

/// The error of a text or of bytes that violate the format.
pub(super) fn syntax(message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Syntax, message)
}

/// The warning that this number of faces have fewer than three corners.
pub(super) fn too_few_corners(faces: u64) -> Option<Error> {
    let message = "faces with fewer than 3 corners are left out";
    let warning = Error::new(ErrorKind::Mesh, message).value(faces);
    (faces > 0).then(|| warning.remedy("they are points and edges, which cannot be seen"))
}

/// The error of a well-formed file without triangles.
pub(super) fn no_triangles() -> Error {
    Error::new(ErrorKind::Mesh, "the mesh has no triangles").remedy("export it with faces")
}

/// Checks that `count` items of the kind `what` can be numbered.
pub(super) fn check_count(what: &str, count: u64) -> Result<()> {
    if count > MAX_COUNT {
        let message = format!("a mesh can have at most {MAX_COUNT} {what}");
        let error = Error::new(ErrorKind::Limit, message).value(count);
        return Err(error.remedy("split the mesh into several files"));
    }
    Ok(())
}

/// A file whose first faces cannot be read alone.
pub(crate) fn no_part() -> Error {
    Error::new(ErrorKind::Mesh, "the file has no part that can be read alone")
}
