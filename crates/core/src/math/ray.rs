//! The ray.

use std::fmt;

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec3A};

/// The largest magnitude of a coordinate of a ray's origin: 2^127. An origin moved by its rounding
/// error, and its distance to a plane, are then still finite. This matters for absent boxes, whose
/// planes are infinite: an infinite origin would give infinity minus infinity, a NaN.
pub const FARTHEST_ORIGIN: f32 = (1_u128 << 127) as f32;

/// The points `origin + t direction` with `t_min` < t < `t_max`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Ray {
    /// The origin, in world space.
    pub origin: Vec3,
    /// Hits at or before this t do not count.
    pub t_min: f32,
    /// The direction, of any length; t is in units of it.
    pub direction: Vec3,
    /// Hits at or after this t do not count.
    pub t_max: f32,
}

impl fmt::Display for Ray {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { origin: o, direction: d, t_min, t_max } = self;
        write!(f, "a ray from {}, {}, {} along {}, {}, {}", o.x, o.y, o.z, d.x, d.y, d.z)?;
        match (*t_min, *t_max) {
            (0.0, f32::INFINITY) => Ok(()),
            (t_min, t_max) => write!(f, " for t from {t_min} to {t_max}"),
        }
    }
}

impl Ray {
    /// The whole ray from `origin`.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f32::INFINITY }
    }

    /// Whether the ray can be traced: it is finite, its origin lies within [`FARTHEST_ORIGIN`], and
    /// its direction is not zero.
    #[inline(always)]
    pub fn is_valid(&self) -> bool {
        let (origin, direction) = (Vec3A::from(self.origin), Vec3A::from(self.direction));
        // A NaN compares false, so this test rejects it too.
        let near = origin.abs().cmple(Vec3A::splat(FARTHEST_ORIGIN));
        let finite = near & direction.is_finite_mask();
        finite.all() & (direction != Vec3A::ZERO) & (self.t_min <= self.t_max)
    }
}
