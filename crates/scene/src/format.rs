//! Which format of scene a file has.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::gltf;

/// The formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FileFormat {
    /// JSON of our own.
    Scene,
    /// glTF, as text or binary.
    Gltf,
    /// A standalone mesh.
    Mesh,
}

impl FileFormat {
    /// The format of a file, by the ending of its name, and by what it begins with.
    pub(super) fn of(path: &Path) -> Self {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        match extension.to_ascii_lowercase().as_str() {
            "gltf" | "glb" => Self::Gltf,
            "ply" | "obj" => Self::Mesh,
            _ if begins_as_glb(path) => Self::Gltf,
            _ => Self::Scene,
        }
    }
}

/// Whether a regular file is a GLB file under another name.
fn begins_as_glb(path: &Path) -> bool {
    let mut start = [0; 4];
    path.is_file()
        && File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok()
        && gltf::is_binary(&start)
}
