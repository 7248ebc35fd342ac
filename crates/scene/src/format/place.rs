//! The place of a JSON value, as a chain of steps from the top.

use std::fmt;

/// A JSON path: it reads `scene.shapes[3].radius`, and nothing at the top.
#[derive(Clone, Copy)]
pub(crate) enum Place<'a> {
    /// The whole file.
    Top,
    /// Under a key of an object.
    Key(&'a Place<'a>, &'a str),
    /// An element of an array.
    Index(&'a Place<'a>, usize),
}

impl fmt::Display for Place<'_> {
    // As deep as the JSON, which serde_json limits to 128.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Top => Ok(()),
            Self::Key(Self::Top, key) => f.write_str(key),
            Self::Key(parent, key) => write!(f, "{parent}.{key}"),
            Self::Index(parent, index) => write!(f, "{parent}[{index}]"),
        }
    }
}
