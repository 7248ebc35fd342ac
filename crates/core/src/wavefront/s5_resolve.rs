//! Pass 5: sums finished paths into pixels.

use super::Wavefront;
use crate::counters::Sample;
use crate::kernels::Arithmetic;
use crate::tile::add_sample;

impl<P: Arithmetic> Wavefront<P> {
    /// Adds the radiance of every path to its pixel's sum. Paths are in the order of samples.
    pub(super) fn resolve(&mut self, sums: &mut [[f64; 3]]) {
        let Self { batch, counters, .. } = self;
        for path in 0..batch.paths.len() {
            let pixel = batch.paths.pixel_of_tile[path] as usize;
            let radiance = batch.paths.radiance.get(path).to_array();
            let sample =
                Sample { pixel: batch.paths.pixel[path], sample: batch.paths.sample[path] };
            add_sample(&mut sums[pixel], radiance, sample, counters);
        }
    }
}
