//! The stages of a render.

/// What a render is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::render) enum Stage {
    /// Reading the scene and its meshes.
    Load,
    /// Building the tree.
    Build,
    /// Following rays.
    Trace,
    /// Writing files.
    Write,
    /// Nothing any more.
    Done,
}

impl Stage {
    /// Its name in lines of progress and in the log.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Load => "load",
            Self::Build => "build",
            Self::Trace => "trace",
            Self::Write => "write",
            Self::Done => "done",
        }
    }
}
