//! Files to read.

use std::fs::File;
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

/// Opens a regular file, and returns its length in bytes. Others are refused: the length of a pipe or a device is
/// meaningless, and opening one can wait forever.
///
/// # Errors
/// If it is no regular file, or cannot be opened.
pub fn open(path: &Path) -> Result<(File, u64)> {
    let data = path.metadata()?;
    if data.is_dir() {
        return Err(Error::new(ErrorKind::IsADirectory, "it is a folder"));
    }
    if !data.is_file() {
        return Err(Error::new(ErrorKind::NotSeekable, "it is not a regular file"));
    }
    Ok((File::open(path)?, data.len()))
}
