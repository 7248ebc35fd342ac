//! Bounds on rounding errors, after Higham, *Accuracy and Stability of Numerical Algorithms*
//! (2002), chapter 3, as Pharr, Jakob and Humphreys apply it to ray tracing (*Physically Based
//! Rendering*, section 6.8).
//!
//! No constant here is tuned: every tolerance in the renderer is one of these bounds times a
//! magnitude from the computation.

/// The unit roundoff of `f32`: the relative error of one operation is at most this.
pub const UNIT_ROUNDOFF: f32 = f32::EPSILON * 0.5;

/// Bound on the relative error of `n` successive operations: n u / (1 - n u).
pub const fn gamma(n: u32) -> f32 {
    let nu = n as f32 * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}

/// The largest absolute coordinate that a scene may hold, in scene units: 2^40.
///
/// The watertight triangle test forms sums of products of three coordinate differences; up to this
/// size they stay below the largest `f32`.
pub const MAX_COORDINATE: f32 = (1_u64 << 40) as f32;

/// Sixteen roundings in double precision, relative to the rounded numbers.
pub(super) const DOUBLE_ROUNDINGS: f32 = 16.0 * f64::EPSILON as f32;

/// The steepest crease at which an offset origin is still in front of both sides, as the tangent of
/// the angle between their normals.
pub(super) const STEEPEST_CREASE: f32 = 4.0;

/// The distance by which [`Vector::offset_origin`](super::vector::Vector::offset_origin) moves a point, whose
/// coordinates have errors of this sum.
pub const fn offset_of_error(sum: f32) -> f32 {
    sum * STEEPEST_CREASE
}

/// The error of each coordinate for which
/// [`Vector::offset_origin`](super::vector::Vector::offset_origin) moves a point by `distance`.
pub const fn error_of_offset(distance: f32) -> f32 {
    distance / (3.0 * STEEPEST_CREASE)
}
