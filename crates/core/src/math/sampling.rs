//! Sample points on the unit square, and the maps from the square to lights and lenses. All maps
//! preserve area: equal cells of the square become equal areas of the shape.

use std::f32::consts::TAU;

use super::random::unit_interval;
use super::trigonometry::sin_cos;
use super::{Real, Single, Stream, Vector, sobol};

wavecrest_base::choices! {
    /// How a set of sample points is spread over the unit square.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Sampling {
        /// Each point anywhere, independent of the others.
        Random = "random",
        /// One point in each cell of a grid, anywhere in the cell.
        Jittered = "jittered",
        /// The points of a scrambled Sobol sequence: see [`super::sobol`].
        Sobol = "sobol",
    }
}

/// Where points take their random numbers from.
#[derive(Clone, Copy, Debug)]
pub struct Draw {
    /// The dimension of the [`Stream`] with the numbers of random and jittered points.
    pub dimension: u32,
    /// The first of its four numbers to use, 0 or 2.
    pub first: usize,
    /// The dimension that scrambles Sobol points.
    pub scramble: u32,
    /// Columns and rows of the grid of jittered points.
    pub grid: [u32; 2],
}

impl Sampling {
    /// A point for the pixel and the sample of each lane, by a stream with these: x and y, each in
    /// \[0, 1). `index` returns for a sample the number of its point in the grid, and in the sequence
    /// that the Sobol points of all samples of a pixel form.
    // Loops of their own, each free of branches, so that compilers use vector instructions.
    #[inline(always)]
    pub fn points<F: Single>(
        self,
        token: F::Token,
        stream: Stream,
        [pixels, samples]: [&[u32]; 2],
        draw: Draw,
        index: impl Fn(u32) -> (u32, u32),
    ) -> [F; 2] {
        let mut places = <[F::Integers; 2]>::default();
        places[0].as_mut().copy_from_slice(&pixels[..F::LANES]);
        places[1].as_mut().copy_from_slice(&samples[..F::LANES]);
        let mut square = <[F::Row; 2]>::default();
        let [x, y] = &mut square;
        if self == Self::Sobol {
            // Of a sample that no camera ray has: all samples of the pixel share the sequence.
            let [a, b, c, _] =
                words::<F>(Stream { sample: u32::MAX, ..stream }, &places, true, draw.scramble);
            for lane in 0..F::LANES {
                let (_, number) = index(places[1].as_ref()[lane]);
                let seeds = [a.as_ref()[lane], b.as_ref()[lane], c.as_ref()[lane]];
                let point = sobol::point(number, seeds);
                (x.as_mut()[lane], y.as_mut()[lane]) = (point.x, point.y);
            }
            return [F::load(token, x), F::load(token, y)];
        }
        let words = words::<F>(stream, &places, false, draw.dimension);
        let (across, along) = (words[draw.first], words[draw.first + 1]);
        for lane in 0..F::LANES {
            x.as_mut()[lane] = unit_interval(across.as_ref()[lane]);
            y.as_mut()[lane] = unit_interval(along.as_ref()[lane]);
        }
        if self == Self::Jittered {
            let [columns, rows] = draw.grid;
            for lane in 0..F::LANES {
                let (row, column) = divide(index(places[1].as_ref()[lane]).0, columns);
                x.as_mut()[lane] = cell(column, columns, x.as_ref()[lane]);
                y.as_mut()[lane] = cell(row, rows, y.as_ref()[lane]);
            }
        }
        [F::load(token, x), F::load(token, y)]
    }
}

/// The four random words of the dimension, for the pixel of each lane, and for its sample unless that of
/// the stream is `shared`.
#[inline(always)]
fn words<F: Single>(
    stream: Stream,
    [pixels, samples]: &[F::Integers; 2],
    shared: bool,
    dimension: u32,
) -> [F::Integers; 4] {
    let mut words = <[F::Integers; 4]>::default();
    let [a, b, c, d] = &mut words;
    for lane in 0..F::LANES {
        let sample = if shared { stream.sample } else { samples.as_ref()[lane] };
        let stream = Stream { pixel: pixels.as_ref()[lane], sample, ..stream };
        let found = stream.words(dimension);
        (a.as_mut()[lane], b.as_mut()[lane]) = (found[0], found[1]);
        (c.as_mut()[lane], d.as_mut()[lane]) = (found[2], found[3]);
    }
    words
}

/// Quotient and remainder of numbers up to 2^24, which single precision holds: vectors have its division.
/// A quotient of integers is at least 1 / `by` below the next integer, more than half an ulp.
#[inline(always)]
pub fn divide(number: u32, by: u32) -> (u32, u32) {
    let quotient = (number as f32 / by as f32) as i32 as u32;
    (quotient, number - quotient * by)
}

/// A set of points on the unit square: their number and how they are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Points {
    /// Distribution.
    pub sampling: Sampling,
    /// Its square is the number of points, with or without a grid.
    pub side: u32,
}

impl Points {
    /// The number of points.
    pub fn count(self) -> u32 {
        self.side * self.side
    }
}

/// The point at `fraction` of the `index`th of `count` equal parts of \[0, 1).
#[inline(always)]
fn cell(index: u32, count: u32, fraction: f32) -> f32 {
    let x = (index as f32 + fraction) / count as f32;
    // The sum or quotient of the last cell may round up to 1.
    x.min(1.0_f32.next_down())
}

/// A point of the unit disk: x of the square is the angle, y the share of the area closer to the
/// centre.
#[inline(always)]
pub fn disk<F: Single>([x, y]: [F; 2]) -> [F; 2] {
    let (sin, cos) = sin_cos(x.times(TAU));
    let radius = y.sqrt();
    [cos * radius, sin * radius]
}

/// A point of the unit sphere: x of the square is the angle about +y, y the share of the area below it
/// (Archimedes: equal heights cut equal areas).
#[inline(always)]
pub fn sphere<F: Single>([x, y]: [F; 2]) -> Vector<F> {
    let one = x.same(1.0);
    let height = y.times(2.0) - one;
    let radius = (one - height * height).max(x.zero()).sqrt();
    let (sin, cos) = sin_cos(x.times(TAU));
    Vector::new(radius * sin, height, radius * cos)
}

/// A point of the spherical cap of this `height` on the unit sphere: its offset across the axis, at
/// the angle x of the square, and its depth below the top, y times the height.
#[inline(always)]
pub fn cap<F: Single>([x, y]: [F; 2], height: f64) -> ([F::Double; 2], F::Double) {
    let below = y.widen().times(height);
    // The root of 1 - (1 - below)^2, without a difference of nearly equal numbers.
    let radius = (below * (below.same(2.0) - below)).sqrt();
    let (sin, cos) = sin_cos(x.times(TAU));
    ([cos.widen() * radius, sin.widen() * radius], below)
}

/// The second and third barycentric coordinate of a point of a triangle (Turk 1990).
#[inline(always)]
pub fn triangle<F: Single>([x, y]: [F; 2]) -> [F; 2] {
    let root = x.sqrt();
    [root * (x.same(1.0) - y), root * y]
}
