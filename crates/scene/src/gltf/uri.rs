//! What a URI of a glTF file leads to: bytes within the file itself, or a file beside it.
//!
//! A name is relative to the glTF file, and may have characters written as `%20`. It must refer to
//! a file beside the glTF file or below, unless the user allows others; of a path of another machine
//! that is its last part. A scheme such as `http:` is never followed.

use std::path::PathBuf;

use base64::Engine as _;
use base64::engine::general_purpose::{STANDARD, STANDARD_NO_PAD};

use crate::folder::{Denied, translated};
use crate::format::Cursor;
use wavecrest_base::error::Result;

#[derive(Debug, PartialEq, Eq)]
pub(super) enum UriTarget {
    /// A file.
    File(PathBuf),
    /// The content of a data URI.
    Bytes(Vec<u8>),
}

/// Resolves the URI in the value of `cursor`.
pub(super) fn target(cursor: &Cursor<'_>) -> Result<UriTarget> {
    let uri = cursor.text("a file name or a data: URI")?;
    if let Some(data) = uri.strip_prefix("data:") {
        return data_uri(cursor, data).map(UriTarget::Bytes);
    }
    // An invalid % is kept.
    let name = percent_bytes(uri).map_or_else(|| Ok(uri.to_owned()), String::from_utf8);
    let name =
        name.map_err(|_| cursor.error("is not UTF-8 after decoding").remedy("rename the file"))?;
    if scheme(uri) {
        let error = cursor.error("URLs are not read");
        return Err(error.remedy("copy the file beside the glTF file and use its name"));
    }
    let folder = cursor.notes().folder();
    let find = |name: &str| folder.find(folder.path(), name);
    let of_another_machine = |denied| {
        let path = find(&translated(&name)).map_err(|_| denied)?;
        cursor.warn("there is no such file here", &format!("{} is used", path.display()));
        Ok(path)
    };
    // Some exporters do not escape %.
    match find(&name).or_else(|denied| find(uri).or_else(|_| of_another_machine(denied))) {
        Ok(path) => Ok(UriTarget::File(path)),
        // Reading it reports the error.
        Err(Denied::Missing) => Ok(UriTarget::File(folder.path().join(name))),
        Err(Denied::Outside) => {
            let error = cursor.error("is outside the folder of the glTF file");
            Err(error.remedy("copy it there, or allow others with --allow-outside"))
        }
    }
}

/// Whether a URI begins with a scheme. A single letter is a drive.
fn scheme(uri: &str) -> bool {
    let Some((scheme, _)) = uri.split_once(':') else { return false };
    scheme.len() > 1 && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
}

/// The bytes of a data URI, given the part after `data:`.
fn data_uri(cursor: &Cursor<'_>, data: &str) -> Result<Vec<u8>> {
    let Some((kind, text)) = data.split_once(',') else {
        return Err(cursor.error("a data URI needs a comma before its data"));
    };
    if kind.split(';').skip(1).any(str::is_empty) {
        return Err(cursor.error("the media type of the data URI has an empty part"));
    }
    if !kind.ends_with(";base64") {
        return percent_bytes(text).ok_or_else(|| cursor.error("has an invalid percent escape"));
    }
    let engine = if text.ends_with('=') { STANDARD } else { STANDARD_NO_PAD };
    engine.decode(text).map_err(|e| {
        let error = cursor.error(format!("the data is not base64: {e}"));
        error.remedy("check that the file is whole, or export it again")
    })
}

/// The bytes of a text with `%20` in it, if every `%` is valid.
fn percent_bytes(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    let digit = |byte: Option<u8>| char::from(byte?).to_digit(16);
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            // Both are below 16, so the result is a byte.
            b'%' => (digit(rest.next())? * 16 + digit(rest.next())?) as u8,
            plain => plain,
        });
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::format::{Notes, Place};
    use crate::tests::approved;

    /// Names are decoded and stay beside the file, and data is decoded with and without padding.
    #[test]
    fn what_is_at_each_address() {
        let notes = Notes::new(Path::new("a/b.gltf"), false, false);
        approved::compare("src/gltf/uri.txt", |uri| {
            let value = serde_json::Value::from(uri.trim_matches('"'));
            match target(&Cursor::new(&value, Place::Top, &notes)) {
                Ok(found) => format!("{found:?}"),
                Err(error) => error.to_string(),
            }
        });
    }
}
