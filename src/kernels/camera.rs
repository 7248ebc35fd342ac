//! Camera rays.

/// The side of the image across which the angle of view is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FovAxis {
    /// The width.
    X,
    /// The height.
    Y,
    /// The shorter side.
    #[default]
    Smaller,
    /// The longer side.
    Larger,
}
