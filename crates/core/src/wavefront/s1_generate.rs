//! Pass 1: camera rays.

mod order;

use std::array::from_fn;
use std::ops::Range;

use super::batch::room;
use super::{Batch, Wavefront};
use crate::accel::Hit;
use crate::kernels::Arithmetic;
use crate::math::{AnyWidth, LANES, Single, Stream, dispatch_any_width};
use crate::prepared::PreparedScene;
use crate::tile::{Tile, Unit};
use order::TileWalk;

impl<P: Arithmetic> Wavefront<P> {
    /// Fills the batch with the camera rays of the unit's `paths`, at most its capacity, numbered by
    /// pixel in the order of [`TileWalk`] and by sample within a pixel.
    pub(super) fn generate(&mut self, scene: &PreparedScene, unit: &Unit, paths: Range<u64>) {
        let Self { seed, batch, counters, .. } = self;
        batch.paths.provide();
        batch.rays.provide();
        batch.hits.resize(room(batch.capacity()), Hit::default());
        batch.paths.clear();
        batch.rays.clear();
        batch.carried.clear();
        let (tile, count) = (&unit.tile, (paths.end - paths.start) as usize);
        let next = NextPaths::new(unit, paths.start);
        let generate = Generate { scene, tile, seed: *seed, count, next, batch };
        dispatch_any_width(scene.accel.level, generate);
        counters.rays.primary += count as u64;
        counters.samples.lens += if scene.camera.has_lens() { count as u64 } else { 0 };
    }
}

/// The next paths, computed by incrementing: divisions would take longer than the ray.
struct NextPaths {
    walk: TileWalk,
    /// The next one's sample in the pixel.
    sample: u32,
    samples: Range<u32>,
}

impl NextPaths {
    fn new(unit: &Unit, path: u64) -> Self {
        let Unit { tile, samples } = unit;
        let each = samples.len() as u64;
        let walk = TileWalk::new([tile.width, tile.height], (path / each) as u32);
        let sample = samples.start + (path % each) as u32;
        Self { walk, sample, samples: samples.clone() }
    }

    /// Column and row in the tile, and the sample, of the next `count` paths.
    #[inline(always)]
    fn take(&mut self, count: usize) -> [[u32; LANES]; 3] {
        let [column, row] = self.walk.pixel;
        let mut next = [[column; LANES], [row; LANES], from_fn(|lane| self.sample + lane as u32)];
        // At once where they are in one pixel: a vector of values stored one by one would wait for them.
        let run = count.min((self.samples.end - self.sample) as usize);
        self.skip(run as u32);
        let [columns, rows, samples] = &mut next;
        let left = columns.iter_mut().zip(rows).zip(samples).take(count).skip(run);
        for ((column, row), sample) in left {
            [*column, *row] = self.walk.pixel;
            *sample = self.sample;
            self.skip(1);
        }
        next
    }

    /// Moves on by samples of this pixel.
    #[inline(always)]
    fn skip(&mut self, samples: u32) {
        self.sample += samples;
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
    next: NextPaths,
    batch: &'a mut Batch,
}

impl AnyWidth for Generate<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Single>(mut self, token: F::Token) {
        let camera = &self.scene.camera;
        let stream = Stream { seed: self.seed, pixel: 0, sample: 0, bounce: 0 };
        let (tile, width) = (self.tile, camera.size()[0]);
        for first in (0..self.count).step_by(F::LANES) {
            let count = F::LANES.min(self.count - first);
            let [columns, rows, samples] = self.next.take(count);
            let pixel_of_tile: [u32; LANES] =
                from_fn(|lane| rows[lane] * tile.width + columns[lane]);
            let pixel: [u32; LANES] =
                from_fn(|lane| (tile.y + rows[lane]) * width + tile.x + columns[lane]);
            let [mut x, mut y] = <[F::Row; 2]>::default();
            for lane in 0..F::LANES {
                x.as_mut()[lane] = (tile.x + columns[lane]) as f32;
                y.as_mut()[lane] = (tile.y + rows[lane]) as f32;
            }
            let corner = [F::load(token, &x), F::load(token, &y)];
            let rays = camera.rays(corner, stream, [&pixel, &samples]);
            self.batch.paths.push_lanes::<F>(token, [&pixel, &samples, &pixel_of_tile], count);
            self.batch.rays.push_camera(&rays, first as u32, count);
        }
    }
}
