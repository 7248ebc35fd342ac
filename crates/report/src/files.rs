//! Reports as files.

use std::io::Write as _;
use std::path::Path;

use serde::Serialize;

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{replace_file, write_error};

/// A value as indented JSON.
///
/// # Errors
/// If it contains a path that is not Unicode.
pub fn to_json(value: &impl Serialize) -> Result<String> {
    let json = serde_json::to_string_pretty(value).map_err(|e| {
        let error = Error::new(ErrorKind::Io, format!("cannot write JSON: {e}")).because(e);
        error.remedy("use files whose names are in Unicode")
    })?;
    Ok(json + "\n")
}

/// Writes `text` to `file` atomically.
///
/// # Errors
/// If it cannot be written.
pub fn write_text(file: &Path, text: &str) -> Result<()> {
    replace_file(file, |sink| sink.write_all(text.as_bytes()).map_err(|e| write_error(file, e)))
}
