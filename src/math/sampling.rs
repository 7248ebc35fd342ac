//! How sample points are chosen, and the maps from the unit square to the shapes they are chosen on.

/// How a set of sample points is spread over the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sampling {
    /// Each point anywhere, independent of the others.
    Random,
    /// One point in each cell of a grid, anywhere in the cell.
    Jittered,
}
