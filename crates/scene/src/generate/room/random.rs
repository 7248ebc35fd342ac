//! Random numbers of furniture.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::generate::noise::mix;

/// A sequence of random numbers.
#[derive(Clone, Copy)]
pub(super) struct Random(u64);

impl Random {
    /// Sequence `which` of `seed`.
    pub(super) fn new(seed: u64, which: u64) -> Self {
        Self(mix(mix(seed) ^ which))
    }

    /// Uniform in \[0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = mix(self.0);
        // The 53 bits of a mantissa.
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform between two numbers.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// One of several, equally likely.
    pub(super) fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.unit() * all.len() as f64) as usize]
    }

    /// Uniform on the unit sphere.
    pub(super) fn direction(&mut self) -> DVec3 {
        let y = self.between(-1.0, 1.0);
        let (sin, cos) = libm::sincos(self.between(0.0, TAU));
        let radius = (1.0 - y * y).sqrt();
        DVec3::new(radius * cos, y, radius * sin)
    }
}
