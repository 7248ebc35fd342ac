//! Eight rays of a pinhole at a time: the operations of [`Camera::ray`] in each lane, and so the
//! same bits.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::{Vec2, Vec3};

use super::{Camera, DIMENSION};
use crate::math::lanes::Vec3x8;
use crate::math::random::Stream;
use crate::math::simd::Lanes;

impl Camera {
    /// Where all rays start, if they start in one point.
    #[inline]
    pub fn pinhole(&self) -> Option<Vec3> {
        self.lens.is_none().then_some(self.origin)
    }

    /// Where in its pixel, from 0 to 1, the `stream.sample`th ray of a pinhole goes through.
    #[inline(always)]
    pub fn place_of(&self, stream: &Stream) -> Vec2 {
        if self.antialias == 1 {
            return Vec2::splat(0.5);
        }
        self.place_in_pixel(stream, || {
            let [u, v, ..] = stream.uniform(DIMENSION);
            [u, v]
        })
    }

    /// The directions, of unit length, through the places (`x`, `y`) of the image in pixels.
    #[inline(always)]
    pub fn directions<S: Lanes>(&self, simd: S, x: f32x8<S>, y: f32x8<S>) -> Vec3x8<S> {
        let [width, height] = [self.size[0] as f32, self.size[1] as f32];
        let s = x * 2.0 / width - 1.0;
        let t = f32x8::splat(simd, 1.0) - y * 2.0 / height;
        let forward = Vec3x8::splat(simd, self.forward);
        let right = Vec3x8::splat(simd, self.half[0]).scale(s);
        let up = Vec3x8::splat(simd, self.half[1]).scale(t);
        (forward + right + up).normalize()
    }
}
