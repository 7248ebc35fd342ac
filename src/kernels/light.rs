//! Lights.

/// How the strength of a light falls with the distance d to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Falloff {
    /// 1 / (4 pi d).
    #[default]
    Linear,
    /// 1 / (4 pi d^2).
    InverseSquare,
    /// 1 at every distance.
    None,
}
