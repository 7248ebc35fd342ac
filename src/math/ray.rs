//! The ray.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec3A};

/// The points `origin + t direction` with `t_min` < t < `t_max`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Ray {
    /// Where it starts, in world space.
    pub origin: Vec3,
    /// Hits at or before this t do not count.
    pub t_min: f32,
    /// Where it goes. Not necessarily of unit length: t counts in lengths of it.
    pub direction: Vec3,
    /// Hits at or after this t do not count.
    pub t_max: f32,
}

impl Ray {
    /// The whole half-line from `origin`.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f32::INFINITY }
    }

    /// Whether the ray can be traced: finite, and of a direction other than zero.
    #[inline(always)]
    pub fn is_valid(&self) -> bool {
        let (origin, direction) = (Vec3A::from(self.origin), Vec3A::from(self.direction));
        let finite = origin.is_finite_mask() & direction.is_finite_mask();
        finite.all() & (direction != Vec3A::ZERO) & (self.t_min <= self.t_max)
    }
}
