//! Reports as files.

use serde::Serialize;

use wavecrest_base::error::{Error, ErrorKind, Result};
pub use wavecrest_base::replace::write_text;

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
