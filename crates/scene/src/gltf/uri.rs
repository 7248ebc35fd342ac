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

    fn follow(uri: &str) -> std::result::Result<UriTarget, String> {
        let notes = Notes::new(Path::new("a/b.gltf"), false, false);
        let value = serde_json::Value::from(uri);
        target(&Cursor::new(&value, Place::Top, &notes)).map_err(|e| e.to_string())
    }

    #[test]
    fn names_are_decoded_and_stay_beside_the_file() {
        let file = |name: &str| Ok(UriTarget::File(Path::new("a").join(name)));
        assert_eq!(follow("c%20d.bin"), file("c d.bin"));
        assert_eq!(follow("%C3%A9.bin"), file("\u{e9}.bin"));
        assert_eq!(follow("100%.bin"), file("100%.bin"));
        assert_eq!(follow("c/../d.bin"), file("c/../d.bin"));
        for uri in ["../c.bin", "c/%2E%2e/../d.bin", "/etc/passwd", "%2Fetc/passwd"] {
            assert!(follow(uri).unwrap_err().contains("is outside the folder"), "{uri}");
        }
        for uri in ["http://x/y.bin", "file:///y.bin"] {
            assert!(follow(uri).unwrap_err().contains("URLs are not read"), "{uri}");
        }
        assert!(follow("%FF.bin").unwrap_err().contains("not UTF-8"));
        assert!(follow("").unwrap_err().contains("must be a file name or a data: URI"));
    }

    #[test]
    fn data_is_decoded_with_and_without_padding() {
        let bytes = |bytes: &[u8]| Ok(UriTarget::Bytes(bytes.to_vec()));
        assert_eq!(follow("data:application/octet-stream;base64,AAE="), bytes(&[0, 1]));
        assert_eq!(follow("data:;base64,AAE"), bytes(&[0, 1]));
        assert_eq!(follow("data:,a%00b"), bytes(b"a\0b"));
        assert!(follow("data:;base64,A*E=").unwrap_err().contains("not base64"));
        assert!(follow("data:;base64").unwrap_err().contains("comma"));
        assert!(follow("data:a/b;;base64,AA==").unwrap_err().contains("an empty part"));
        assert!(follow("data:,%0").unwrap_err().contains("invalid percent escape"));
    }
}
