//! The stages of a render.

wavecrest_base::choices! {
    /// A stage of a render. Names are those in lines of progress and in the log.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Stage {
        /// Reading the scene and its meshes.
        Load = "load",
        /// Building the tree.
        Build = "build",
        /// Following rays.
        Trace = "trace",
        /// Writing files.
        Write = "write",
        /// Nothing any more.
        Done = "done",
    }
}
