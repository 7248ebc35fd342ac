//! Image pyramids: each level half as wide and high as the one below, down to a single texel
//! (Williams, *Pyramidal Parametrics*, SIGGRAPH 1983).
//!
//! A texel is the mean of the texels of the level below that it covers, in linear light. Sides are
//! halved and rounded down, as usual. If that leaves a remainder, a texel covers more than two of
//! the level below, some of them in part, each weighted by its area: five texels become two of two
//! and a half each. So the mean of every level is that of the image at any size, and no level
//! appears shifted against another.
//!
//! Levels are in single precision even if the image has 8 bits a channel: rounded to 8 bits, all
//! texels of a checkerboard would err in the same direction. Together they take 4 bytes for each
//! texel of the image: as much again for an 8-bit image, a third for others.

use glam::{DVec3, Vec3};

/// A level above the image itself.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MipLevel {
    /// Width and height in texels, at least 1.
    pub(super) size: [u32; 2],
    /// Row by row, top row first; linear.
    pub(super) texels: Vec<[f32; 3]>,
}

impl MipLevel {
    #[inline]
    pub(super) fn texel(&self, x: u32, y: u32) -> Vec3 {
        Vec3::from(self.texels[y as usize * self.size[0] as usize + x as usize])
    }
}

/// The levels above an image of this size, from the finest to one of a single texel.
pub(super) fn levels(width: u32, height: u32, texel: impl Fn(u32, u32) -> Vec3) -> Vec<MipLevel> {
    let mut levels: Vec<MipLevel> = Vec::new();
    let mut size = [width, height];
    while size != [1, 1] {
        let next = match levels.last() {
            None => coarser(size, &texel),
            Some(level) => coarser(size, |x, y| level.texel(x, y)),
        };
        size = next.size;
        levels.push(next);
    }
    levels
}

/// The level above a level of this size.
fn coarser(size: [u32; 2], texel: impl Fn(u32, u32) -> Vec3) -> MipLevel {
    let half = size.map(|side| (side / 2).max(1));
    let mut texels = Vec::with_capacity(half[0] as usize * half[1] as usize);
    for y in 0..half[1] {
        for x in 0..half[0] {
            let row = |y: u32| mean(x, size[0], half[0], |x| texel(x, y).as_dvec3());
            texels.push(mean(y, size[1], half[1], row).as_vec3().to_array());
        }
    }
    MipLevel { size: half, texels }
}

/// The mean over the `index`th of `half` equal parts of `count` values in a row.
///
/// Areas are counted in units of which each value has `half`, so they are whole numbers. Equal
/// values have exactly their own mean, since an `f32` times such a number is exact in double
/// precision.
fn mean(index: u32, count: u32, half: u32, value: impl Fn(u32) -> DVec3) -> DVec3 {
    let [count, half] = [u64::from(count), u64::from(half)];
    let (start, end) = (u64::from(index) * count, (u64::from(index) + 1) * count);
    let mut sum = DVec3::ZERO;
    for i in start / half..end.div_ceil(half) {
        let area = end.min((i + 1) * half) - start.max(i * half);
        sum += value(i as u32) * area as f64;
    }
    sum / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Stream;

    fn random(x: u32, y: u32) -> Vec3 {
        let [r, g, b, _] = Stream { seed: 3, pixel: x, sample: y, bounce: 0 }.uniform(0);
        Vec3::new(r, g * 100.0, b - 0.5)
    }

    fn mean_of(size: [u32; 2], texel: impl Fn(u32, u32) -> Vec3) -> DVec3 {
        let texels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let sum: DVec3 = texels.map(|(x, y)| texel(x, y).as_dvec3()).sum();
        sum / (f64::from(size[0]) * f64::from(size[1]))
    }

    const SIZES: [[u32; 2]; 10] =
        [[1, 1], [2, 1], [1, 3], [4, 4], [5, 3], [7, 7], [64, 48], [100, 1], [31, 2], [127, 255]];

    #[test]
    fn every_level_has_the_mean_of_the_image() {
        for size in SIZES {
            let expected = mean_of(size, random);
            for level in levels(size[0], size[1], random) {
                let found = mean_of(level.size, |x, y| level.texel(x, y));
                let error = (found - expected).abs().max_element();
                assert!(error < 1e-5, "{size:?} at {:?}: {found} for {expected}", level.size);
            }
        }
    }

    #[test]
    fn texels_of_an_odd_side_weigh_by_their_area() {
        let level = coarser([5, 1], |x, _| Vec3::splat([1.0, 2.0, 8.0, 4.0, 16.0][x as usize]));
        assert_eq!(level.size, [2, 1]);
        // (1 + 2 + 8 / 2) / 2.5 and (8 / 2 + 4 + 16) / 2.5.
        assert_eq!((level.texel(0, 0).x, level.texel(1, 0).x), (2.8, 9.6));
    }
}
