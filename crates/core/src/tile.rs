//! Tiles, the units of work of a thread, and the trait of tracers with the clock of their passes.

use std::ops::Range;
use std::time::Instant;

use crate::counters::{Counters, Sample};
use crate::kernels::texture::decoding;
use crate::prepared::PreparedScene;

wavecrest_base::choices! {
    /// The passes that are timed, in order, by their names in statistics.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum TimedPass {
        /// Making camera rays.
        Generate = "generate",
        /// Finding closest hits.
        Intersect = "intersect",
        /// Shading hits on plain surfaces, shapes of lights and nothing.
        Shade = "shade",
        /// Shading hits on surfaces with maps, or that let light through.
        Maps = "maps",
        /// The light that arrives at lit points.
        Shadow = "shadow",
        /// Summing paths into pixels.
        Resolve = "resolve",
        /// Decoding images at their first look-up, in whichever pass that is.
        Decode = "decode",
    }
}

/// Seconds in each pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PassClock {
    seconds: [f64; TimedPass::ALL.len()],
    /// When the last pass ended, and the seconds of decoding by then.
    last: Instant,
    decoded: f64,
}

impl PassClock {
    pub(crate) fn new() -> Self {
        Self { seconds: Default::default(), last: Instant::now(), decoded: 0.0 }
    }

    /// Starts the first pass.
    #[inline]
    pub(crate) fn start(&mut self) {
        (self.last, self.decoded) = (Instant::now(), decoding());
    }

    /// Ends a pass, and starts the next.
    #[inline]
    pub(crate) fn lap(&mut self, pass: TimedPass) {
        let (now, decoded) = (Instant::now(), decoding());
        let decoding = decoded - self.decoded;
        self.seconds[pass as usize] += (now - self.last).as_secs_f64() - decoding;
        self.seconds[TimedPass::Decode as usize] += decoding;
        (self.last, self.decoded) = (now, decoded);
    }

    /// The seconds by the names of the passes.
    pub(crate) fn by_name(&self) -> Vec<(&'static str, f64)> {
        TimedPass::ALL.map(TimedPass::name).into_iter().zip(self.seconds).collect()
    }
}

/// A rectangle of pixels of the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// The column of its left pixels.
    pub x: u32,
    /// The row of its top pixels.
    pub y: u32,
    /// Its width in pixels.
    pub width: u32,
    /// Its height in pixels.
    pub height: u32,
}

impl Tile {
    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Whether it has no pixels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Column and row, in the image, of its `index`th pixel, counted row by row.
    #[inline]
    pub fn pixel(&self, index: u32) -> (u32, u32) {
        (self.x + index % self.width, self.y + index / self.width)
    }
}

/// The unit of work of a tracer: a rectangle of pixels, and a range of samples of each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unit {
    /// The pixels.
    pub tile: Tile,
    /// The samples of each pixel, by number.
    pub samples: Range<u32>,
}

impl Unit {
    /// Number of paths: one for each sample of each pixel.
    pub fn paths(&self) -> u64 {
        self.tile.len() as u64 * self.samples.len() as u64
    }
}

/// An order in which the kernels are called, with all memory for one thread. Every tracer returns the same sums, bit for
/// bit.
pub trait Tracer: Send {
    /// Adds the unit's samples of each pixel to `sums`, in the order of the samples: red, green and
    /// blue, in linear radiance. There is one sum for each pixel of its tile, row by row.
    ///
    /// Whether it is `cancelled` is asked every some thousand rays. Returns whether it was finished:
    /// without that, sums have no meaning.
    fn render(
        &mut self,
        scene: &PreparedScene,
        unit: &Unit,
        sums: &mut [[f64; 3]],
        cancelled: &dyn Fn() -> bool,
    ) -> bool;

    /// Bytes of its columns.
    fn bytes(&self) -> u64;

    /// The work done so far.
    fn counters(&self) -> Counters;

    /// Seconds so far in each pass, by the pass's name ([`TimedPass`]); of none if it has no passes.
    fn pass_seconds(&self) -> Vec<(&'static str, f64)>;
}

/// Adds the radiance of a sample to its pixel's sum. A sample that is not finite counts as black
/// and is counted.
#[inline]
pub fn add_sample(sum: &mut [f64; 3], radiance: [f32; 3], sample: Sample, counters: &mut Counters) {
    if radiance.iter().all(|c| c.is_finite()) {
        for (sum, value) in sum.iter_mut().zip(radiance) {
            *sum += f64::from(value);
        }
    } else {
        counters.add_invalid(1, Some(sample));
    }
}
