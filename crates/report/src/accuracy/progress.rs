//! Progress of a sweep.

/// Receives how far a sweep has come.
pub trait Progress {
    /// The next stage begins, of so many steps.
    fn stage(&self, name: &str, steps: u64);
    /// One of its steps is done.
    fn step(&self);
}
