//! The ray.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

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
    #[inline]
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite()
            && self.direction.is_finite()
            && self.direction != Vec3::ZERO
            && self.t_min <= self.t_max
    }
}
