//! Settings, random inputs and outcome of a case.

use std::iter::Sum;

use glam::{DMat3, DQuat, DVec3, Vec3};
use rand::RngExt;

use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::random::{Generator, Stream};

/// The number of tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// Few enough for each of many scenes.
    Brief,
    /// Few enough for every test run.
    Quick,
    /// As many as the case's bound states.
    Full,
}

/// The settings of a case.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// The tested precision.
    pub precision: Precision,
    /// The seed of its inputs.
    pub seed: u64,
    /// The number of tests.
    pub count: Count,
}

impl Effort {
    /// `geometry` with a tree of `preset`, in the tested precision.
    pub(super) fn accel(&self, mut geometry: Geometry, preset: Preset) -> Accel {
        geometry.set_precision(self.precision);
        Accel::new(geometry, preset)
    }

    /// One of two numbers, or a hundredth of the first.
    pub(super) fn of(&self, [quick, full]: [usize; 2]) -> usize {
        match self.count {
            Count::Brief => quick / 100,
            Count::Quick => quick,
            Count::Full => full,
        }
    }
}

/// The random numbers of an input: a function of the seed, the case, the input's place in the case,
/// and its number.
#[derive(Clone, Debug)]
pub(super) struct InputRng {
    random: Generator,
    /// The number of the input.
    pub(super) index: usize,
    pub(super) effort: Effort,
}

impl InputRng {
    pub(super) fn new(effort: &Effort, [case, place]: [u32; 2], index: usize) -> Self {
        let Effort { seed, .. } = *effort;
        let stream = Stream { seed, pixel: index as u32, sample: case, bounce: place };
        Self { random: stream.generator(0), index, effort: *effort }
    }

    /// Uniform from 0 to 1.
    pub(super) fn one(&mut self) -> f64 {
        self.random.random()
    }

    /// Uniform from -`size` to `size`.
    pub(super) fn about(&mut self, size: f64) -> f64 {
        (2.0 * self.one() - 1.0) * size
    }

    /// From `low` to `high`, uniform in logarithm.
    pub(super) fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        libm::pow(10.0, libm::log10(low) + self.one() * libm::log10(high / low))
    }

    /// Less than `end`.
    pub(super) fn below(&mut self, end: usize) -> usize {
        self.random.random_range(0..end)
    }

    /// One of these.
    pub(super) fn among<T: Copy, const N: usize>(&mut self, all: [T; N]) -> T {
        all[self.below(N)]
    }

    /// True once in `times`.
    pub(super) fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    /// 1 or -1.
    pub(super) fn sign(&mut self) -> f64 {
        self.among([1.0, -1.0])
    }

    /// The bits of a number.
    pub(super) fn bits(&mut self) -> u32 {
        self.random.random()
    }

    /// Uniform in a triangle.
    pub(super) fn within(&mut self, corners: [Vec3; 3]) -> DVec3 {
        let [a, b, c] = corners.map(|v| v.as_dvec3());
        let (u, v) = (self.one(), self.one());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        a + (b - a) * u + (c - a) * v
    }

    /// On an edge of a triangle: at a corner, just beside one, or anywhere.
    pub(super) fn on_edge(&mut self, [a, b, c]: [Vec3; 3]) -> DVec3 {
        let [p, q] = self.among([[a, b], [b, c], [c, a]]).map(|v| v.as_dvec3());
        let part = [0.0, self.one(), self.magnitude(1e-7, 1.0)][self.below(3)];
        p + (q - p) * part
    }

    /// Uniform on the unit sphere.
    pub(super) fn direction(&mut self) -> DVec3 {
        let (z, turn) = (self.about(1.0), std::f64::consts::TAU * self.one());
        let r = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(r * libm::cos(turn), r * libm::sin(turn), z)
    }

    /// Within a sphere of this `radius`.
    pub(super) fn ball(&mut self, radius: f64) -> DVec3 {
        self.direction() * (radius * self.one())
    }

    pub(super) fn rotation(&mut self) -> DMat3 {
        let angle = std::f64::consts::TAU * self.one();
        DMat3::from_quat(DQuat::from_axis_angle(self.direction(), angle))
    }
}

/// The outcome of a case.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Outcome {
    /// The number of tests.
    pub tried: u64,
    /// The number of tests that broke the bound.
    pub failed: u64,
    /// A description of the first of these.
    pub first: Option<String>,
}

impl Outcome {
    /// Whether anything was tested, and the bound held.
    pub fn holds(&self) -> bool {
        self.tried > 0 && self.failed == 0
    }

    /// The outcome of one test; `failure` describes the error unless it is `right`.
    pub(super) fn of(right: bool, failure: impl FnOnce() -> String) -> Self {
        Self { tried: 1, failed: (!right).into(), first: (!right).then(failure) }
    }

    /// Counts a test; `failure` describes the error unless it is `right`.
    pub(super) fn check(&mut self, right: bool, failure: impl FnOnce() -> String) {
        self.add(Self::of(right, failure));
    }

    /// Adds `context` before the description of the first failure.
    pub(super) fn with_context(self, context: impl Fn() -> String) -> Self {
        Self { first: self.first.map(|first| format!("{}, {first}", context())), ..self }
    }

    /// Adds another outcome.
    pub(super) fn add(&mut self, other: Self) {
        self.tried += other.tried;
        self.failed += other.failed;
        self.first = self.first.take().or(other.first);
    }
}

impl Sum for Outcome {
    fn sum<I: Iterator<Item = Self>>(outcomes: I) -> Self {
        outcomes.fold(Self::default(), |mut all, one| {
            all.add(one);
            all
        })
    }
}
