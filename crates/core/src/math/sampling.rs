//! Sample points on the unit square, and the maps from the square to lights and lenses. All maps
//! preserve area: equal cells of the square become equal areas of the shape.

use std::f32::consts::TAU;

use glam::Vec2;

use super::random::Stream;
use super::real::{Real, Single};
use super::sobol;
use super::trigonometry::sin_cos;
use super::vector::Vector;

wavecrest_base::choices! {
    /// How a set of sample points is spread over the unit square.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Sampling {
        /// Each point anywhere, independent of the others.
        Random = "random",
        /// One point in each cell of a grid, anywhere in the cell.
        Jittered = "jittered",
        /// The points of a scrambled Sobol sequence: see [`super::sobol`].
        Sobol = "sobol",
    }
}

impl Sampling {
    /// Point number `index.0` of the `columns` times `rows` points that `stream` has at
    /// `dimension`. Both coordinates are in \[0, 1).
    ///
    /// Random and jittered points use the two numbers `random` of the stream. The Sobol points of
    /// all samples of a pixel form one sequence: `index.1` is the number of the point in it.
    #[inline(always)]
    pub fn point(
        self,
        index: (u32, u32),
        [columns, rows]: [u32; 2],
        random: impl FnOnce() -> [f32; 2],
        seeds: impl FnOnce() -> [u32; 3],
    ) -> Vec2 {
        match self {
            Self::Random => Vec2::from(random()),
            Self::Jittered => {
                let (row, column) = divide(index.0, columns);
                let [x, y] = random();
                Vec2::new(cell(column, columns, x), cell(row, rows, y))
            }
            Self::Sobol => sobol::point(index.1, seeds()),
        }
    }

    /// The point that `point` finds for the pixel and the sample of each lane, by a stream with these.
    /// Coordinates are apart: x, then y.
    #[inline(always)]
    pub fn points<F: Single>(
        self,
        token: F::Token,
        stream: Stream,
        places: [&[u32]; 2],
        point: impl Fn(Self, &Stream) -> Vec2,
    ) -> [F; 2] {
        match self {
            Self::Random => each(token, stream, places, |stream| point(Self::Random, stream)),
            Self::Jittered => each(token, stream, places, |stream| point(Self::Jittered, stream)),
            Self::Sobol => each(token, stream, places, |stream| point(Self::Sobol, stream)),
        }
    }
}

/// See [`Sampling::points`]. With `point` free of branches, compilers use vector instructions.
#[inline(always)]
fn each<F: Single>(
    token: F::Token,
    stream: Stream,
    [pixels, samples]: [&[u32]; 2],
    point: impl Fn(&Stream) -> Vec2,
) -> [F; 2] {
    let [mut x, mut y] = <[F::Row; 2]>::default();
    for lane in 0..F::LANES {
        let stream = Stream { pixel: pixels[lane], sample: samples[lane], ..stream };
        let Vec2 { x: across, y: along } = point(&stream);
        (x.as_mut()[lane], y.as_mut()[lane]) = (across, along);
    }
    [F::load(token, &x), F::load(token, &y)]
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The other maps: `tests/properties/numbers.rs`. A share of heights is one of area.
    #[test]
    fn caps_keep_area_and_lie_on_the_sphere() {
        for height in [0.5, 2.0] {
            for step in 0_u8..=100 {
                let share = f64::from(step) / 100.0;
                let ([x, y], below) = cap([0.3, share as f32], height);
                assert!((below - share * height).abs() < 1e-6, "{below}");
                let radius = x * x + y * y + (1.0 - below) * (1.0 - below);
                assert!((radius - 1.0).abs() < 1e-6, "{radius}");
            }
        }
    }
}
