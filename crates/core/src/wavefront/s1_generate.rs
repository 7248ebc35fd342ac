//! Pass 1: camera rays.

mod order;

use std::ops::Range;

use super::batch::Batch;
use crate::counters::Counters;
use crate::math::random::Stream;
use crate::math::real::Single;
use crate::math::simd::{LANES, Pass, dispatch_pass};
use crate::prepared::PreparedScene;
use crate::tile::{Tile, Unit};
use order::TileWalk;

/// Fills the batch with the camera rays of the unit's `paths`, numbered by pixel in the order of
/// [`TileWalk`] and by sample within a pixel.
pub(super) fn run(
    scene: &PreparedScene,
    unit: &Unit,
    seed: u64,
    paths: Range<u64>,
    batch: &mut Batch,
    counters: &mut Counters,
) {
    batch.paths.provide();
    batch.rays.provide();
    batch.hits.provide();
    batch.paths.clear();
    batch.rays.clear();
    let count = paths.end - paths.start;
    let next = NextPath::new(unit, paths.start);
    let tile = &unit.tile;
    dispatch_pass(
        scene.accel.level,
        Generate { scene, tile, seed, count: count as usize, next, batch },
    );
    counters.primary_rays += count;
    counters.lens_samples += if scene.camera.has_lens() { count } else { 0 };
}

/// The next path, computed by incrementing: divisions would take longer than the ray.
struct NextPath {
    walk: TileWalk,
    /// Its sample in the pixel.
    sample: u32,
    samples: Range<u32>,
}

impl NextPath {
    fn new(unit: &Unit, path: u64) -> Self {
        let Unit { tile, samples } = unit;
        let each = samples.len() as u64;
        let walk = TileWalk::new([tile.width, tile.height], (path / each) as u32);
        let sample = samples.start + (path % each) as u32;
        Self { walk, sample, samples: samples.clone() }
    }

    #[inline(always)]
    fn advance(&mut self) {
        self.sample += 1;
        if self.sample == self.samples.end {
            self.sample = self.samples.start;
            self.walk.advance();
        }
    }
}

struct Generate<'a> {
    scene: &'a PreparedScene,
    tile: &'a Tile,
    seed: u64,
    count: usize,
    next: NextPath,
    batch: &'a mut Batch,
}

impl Pass for Generate<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Single>(mut self, token: F::Token) {
        let camera = &self.scene.camera;
        let stream = Stream { seed: self.seed, pixel: 0, sample: 0, bounce: 0 };
        for first in (0..self.count).step_by(F::LANES) {
            let count = F::LANES.min(self.count - first);
            let [mut x, mut y] = <[F::Row; 2]>::default();
            let mut places = [[0; LANES]; 2];
            for lane in 0..count {
                let [column, row] = self.path(lane, &mut places);
                (x.as_mut()[lane], y.as_mut()[lane]) = (column as f32, row as f32);
            }
            let corner = [F::load(token, &x), F::load(token, &y)];
            let rays = camera.rays(corner, stream, [&places[0], &places[1]]);
            self.batch.rays.push_camera(&rays, first as u32, count);
        }
    }
}

impl Generate<'_> {
    /// Appends the next path. Returns its pixel, of which it adds number and sample to `places`.
    #[inline(always)]
    fn path(&mut self, lane: usize, places: &mut [[u32; LANES]; 2]) -> [u32; 2] {
        let NextPath { walk, sample, .. } = &self.next;
        let sample = *sample;
        let [x, y] = [self.tile.x + walk.pixel[0], self.tile.y + walk.pixel[1]];
        let pixel = y * self.scene.camera.size()[0] + x;
        self.batch.paths.push(pixel, sample, walk.place());
        self.next.advance();
        (places[0][lane], places[1][lane]) = (pixel, sample);
        [x, y]
    }
}
