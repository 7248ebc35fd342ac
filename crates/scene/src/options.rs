//! How a scene is to be read.

/// How a scene file is to be read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// Whether a key that the format does not have is an error rather than a warning.
    pub strict: bool,
    /// The width of the image in pixels, in place of the file's.
    pub width: Option<u32>,
    /// The height of the image in pixels, in place of the file's.
    pub height: Option<u32>,
    /// The camera to take of a file that may have several, by its name or its number.
    pub camera: Option<String>,
}
