//! Bounds on rounding errors, after Higham, *Accuracy and Stability of Numerical Algorithms*
//! (2002), chapter 3, as Pharr, Jakob and Humphreys apply it to ray tracing (*Physically Based
//! Rendering*, section 6.8).
//!
//! Nothing here is a tuned constant: every tolerance in the renderer is one of these bounds times
//! a magnitude that the computation met.

/// The unit roundoff of `f32`: one operation is off by at most this factor of its result.
pub const UNIT_ROUNDOFF: f32 = f32::EPSILON * 0.5;

/// Bound on the relative error of `n` operations in a row: n u / (1 - n u).
pub const fn gamma(n: u32) -> f32 {
    let nu = n as f32 * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}

/// The largest absolute coordinate that a scene may hold, in scene units: 2^40.
///
/// The watertight triangle test forms sums of products of three coordinate differences; up to this
/// size they stay below the largest `f32`.
pub const MAX_COORDINATE: f32 = (1_u64 << 40) as f32;

/// Sixteen roundings of double precision, as a factor of the numbers that are rounded.
pub(super) const DOUBLE_ROUNDINGS: f32 = 16.0 * f64::EPSILON as f32;

/// The steepest crease, as the tangent of the angle between the normals on its sides, at which a
/// moved origin is still in front of both.
pub(super) const STEEPEST_CREASE: f32 = 4.0;

/// The error of each coordinate that a point is moved off its surface by `distance` for, see
/// [`Vector::offset_origin`](super::vector::Vector::offset_origin).
pub const fn error_of_offset(distance: f32) -> f32 {
    distance / (3.0 * STEEPEST_CREASE)
}
