//! `--memory-limit`: refuses scenes whose estimated or actual memory exceeds it.

use std::path::Path;

use bytesize::ByteSize;

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_scene::memory::{self, Estimate};

/// Refuses a scene whose estimated peak is above `limit`.
pub(crate) fn check(scene: &Path, estimated: &Estimate, limit: ByteSize) -> Result<()> {
    if estimated.total() <= limit.as_u64() {
        return Ok(());
    }
    let e = estimated;
    let uses = [
        ("reading", e.loading),
        ("geometry", e.geometry),
        ("normals and textures", e.appearance),
        ("building the tree", e.build),
        ("the tree", e.tree),
        ("the image", e.film),
        ("batches", e.batches),
        ("decoding images", e.decoding),
        ("writing files", e.writing),
    ];
    let uses = uses.map(|(name, bytes)| format!("{name} {}", in_words(bytes)));
    let message = format!("the render needs more memory than {}", in_words(limit.as_u64()));
    Err(Error::new(ErrorKind::Limit, message)
        .in_file(scene)
        .value(format!("about {}", in_words(estimated.total())))
        .remedy(format!(
            "raise --memory-limit, or use a smaller scene or image (peaks: {})",
            uses.join(", ")
        )))
}

/// A number of bytes in words.
fn in_words(bytes: u64) -> String {
    ByteSize::b(bytes).display().iec().to_string()
}

/// Fails if the process has used more than `limit`, if the system reports its peak.
pub(crate) fn check_taken(scene: &Path, limit: ByteSize) -> Result<()> {
    let taken = memory::peak().unwrap_or(0);
    if taken <= limit.as_u64() {
        return Ok(());
    }
    let message = format!("the scene uses more memory than {}", in_words(limit.as_u64()));
    let error = Error::new(ErrorKind::Limit, message).in_file(scene).value(in_words(taken));
    Err(error.remedy("raise --memory-limit, or use a smaller scene"))
}

/// A number of bytes, with or without a unit.
pub(crate) fn bytes(text: &str) -> std::result::Result<ByteSize, String> {
    let size: std::result::Result<ByteSize, _> = text.parse();
    size.ok().filter(|size| size.as_u64() > 0).ok_or_else(|| {
        "write a number of bytes above 0, such as 8GiB, 500MB or 1000000000".to_owned()
    })
}
