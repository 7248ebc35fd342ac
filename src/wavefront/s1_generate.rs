//! Pass 1: camera rays.

use std::ops::Range;

use glam::Vec3;

use super::batch::Batch;
use crate::counters::Counters;
use crate::math::random::Stream;
use crate::prepared::PreparedScene;
use crate::tile::Tile;

/// Fills the batch with the camera rays of the tile's `paths`, which are numbered pixel by pixel
/// and, within a pixel, sample by sample.
pub(super) fn run(
    scene: &PreparedScene,
    tile: &Tile,
    seed: u64,
    paths: Range<u64>,
    batch: &mut Batch,
    counters: &mut Counters,
) {
    let samples = u64::from(scene.camera.rays_per_pixel());
    let width = scene.camera.size()[0];
    batch.paths.clear();
    batch.rays.clear();
    for (number, path) in paths.clone().enumerate() {
        let (place, sample) = ((path / samples) as u32, (path % samples) as u32);
        let (x, y) = tile.pixel(place);
        let pixel = y * width + x;
        let ray = scene.camera.ray(x, y, &Stream { seed, pixel, sample, bounce: 0 });
        batch.rays.push(&ray, Vec3::ONE, number as u32);
        batch.paths.push(pixel, sample, place);
    }
    let count = paths.end - paths.start;
    counters.primary_rays += count;
    counters.lens_samples += if scene.camera.has_lens() { count } else { 0 };
}
