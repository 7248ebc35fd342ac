//! Where the image of a texture is: a file, or bytes within the scene file.

use std::hash::{Hash, Hasher};
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use wavecrest_base::read::open;
use wavecrest_image::decoder::Content;

/// The source of a texture's image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextureSource {
    /// A separate file: the path, already joined to the scene file's folder.
    File(PathBuf),
    /// Within the scene file.
    Embedded {
        /// The place in the file, such as `images[2]`: unique for each image.
        place: String,
        /// An image file of any format.
        bytes: Arc<[u8]>,
    },
}

impl TextureSource {
    /// Its path, or its place in the scene file.
    pub fn name(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Embedded { place, .. } => place.clone(),
        }
    }

    /// The separate file, if it is one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Embedded { .. } => None,
        }
    }

    /// The number of bytes of the image file; 0 if the file cannot be found.
    pub(crate) fn length(&self) -> u64 {
        match self {
            Self::File(path) => path.metadata().map_or(0, |file| file.len()),
            Self::Embedded { bytes, .. } => bytes.len() as u64,
        }
    }

    /// Opens the image file.
    pub(crate) fn open(&self) -> io::Result<Box<dyn Content + '_>> {
        Ok(match self {
            Self::File(path) => Box::new(BufReader::new(open(path)?.0)),
            Self::Embedded { bytes, .. } => Box::new(io::Cursor::new(bytes)),
        })
    }
}

/// Without the bytes: no two images have the same name.
impl Hash for TextureSource {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name().hash(state);
    }
}
