//! A scene that was read.

use hecs::World;

use super::components::Encoding;
use wavecrest_base::error::Warning;

/// A scene, and what its author should know about it.
pub struct LoadedScene {
    /// The entities: see [`components`](super::components).
    pub world: World,
    /// What is odd about the file, in its order; then what is odd about its meshes.
    pub warnings: Vec<Warning>,
    /// What was chosen, where the file does not say: a camera, a light.
    pub notes: Vec<Warning>,
    /// How images of 8 bits are to be written, unless a transfer is requested.
    pub encoding: Encoding,
}
