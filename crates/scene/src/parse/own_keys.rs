//! Keys that one kind of shape has: spheres, planes, triangles, and the three kinds of meshes.

use crate::reader::Key;

/// What one kind of shape has that others have not.
pub(crate) struct OwnKeys {
    /// Its name in messages.
    pub(crate) name: &'static str,
    /// What it is, for editors.
    pub(crate) about: &'static str,
    /// Its own keys.
    pub(crate) keys: &'static [&'static [Key]],
}
