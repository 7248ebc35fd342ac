//! The weights of the filters, and their application.
//!
//! A filter is a row of weights. Two of them, applied along the rows and then along the columns of
//! an image, make a filter of the plane. The filter for yellow against blue is a sum of two such
//! products, as the eye's contrast sensitivity is a sum of two Gaussians there (section 4.1.1 of
//! the paper, with numbers from Johnson and Fairchild, *On contrast sensitivity in an image
//! difference model*, 2001); detectors of edges and points are derivatives of a Gaussian across the
//! feature and the Gaussian along it (section 4.2).

use std::f64::consts::PI;

/// A term a exp(-b f^2) of a contrast sensitivity, f in cycles per degree.
struct Sensitivity {
    a: f64,
    b: f64,
}

const LIGHTNESS: Sensitivity = Sensitivity { a: 1.0, b: 0.0047 };
const RED_GREEN: Sensitivity = Sensitivity { a: 1.0, b: 0.0053 };
/// The two terms of a sum.
const YELLOW_BLUE: [Sensitivity; 2] =
    [Sensitivity { a: 34.1, b: 0.04 }, Sensitivity { a: 13.5, b: 0.025 }];

/// The width of detected features, in degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// Where weights end, in standard deviations of the widest Gaussian.
const REACH: f64 = 3.0;

/// Number of results summed at a time: as many as fit into registers.
const LANES: usize = 8;

/// All filters for a number of pixels per degree: the contrast sensitivities of lightness, of red
/// against green, and of yellow against blue, a sum of two filters, each applied along rows and
/// columns; then the Gaussian of the detectors, its first derivative, which finds edges, and its
/// second, which finds points.
pub(super) struct Filters(pub(super) [Weights; FILTERS]);

/// The number of filters.
pub(super) const FILTERS: usize = 7;

/// An odd number of weights, the middle one for the pixel itself.
pub(super) struct Weights(Vec<f64>);

impl Filters {
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let [lightness, red_green, first, second] = of_the_eye(pixels_per_degree);
        let [smooth, edge, point] = of_features(0.5 * FEATURE_WIDTH * pixels_per_degree);
        Self([lightness, red_green, first, second, smooth, edge, point])
    }

    /// The reach of the widest filter to each side, in pixels.
    pub(super) fn radius(&self) -> usize {
        self.0.iter().map(Weights::radius).max().unwrap_or(0)
    }
}

impl Weights {
    /// Its reach to each side, in pixels.
    pub(super) fn radius(&self) -> usize {
        self.0.len() / 2
    }

    /// Sums of neighbours: `out[i]` is the sum over all weights `w[k]` of `w[k] * values[i + k *
    /// step]`. Along a row `step` is 1; along columns it is the number of values in a row.
    pub(super) fn apply(&self, values: &[f64], step: usize, out: &mut [f64]) {
        for (block, start) in out.chunks_mut(LANES).zip((0..).step_by(LANES)) {
            let mut sums = [0.0; LANES];
            for (k, &weight) in self.0.iter().enumerate() {
                let values = &values[start + k * step..];
                match values.first_chunk::<LANES>() {
                    Some(lanes) => add(&mut sums, weight, lanes),
                    None => add(&mut sums, weight, values),
                }
            }
            block.copy_from_slice(&sums[..block.len()]);
        }
    }

    /// The values of `of` from `-radius` to `radius`.
    fn sampled(radius: i32, of: impl Fn(f64) -> f64) -> Self {
        Self((-radius..=radius).map(|x| of(f64::from(x))).collect())
    }

    fn scaled(mut self, factor: f64) -> Self {
        self.0.iter_mut().for_each(|weight| *weight *= factor);
        self
    }

    fn sum(&self) -> f64 {
        self.0.iter().sum()
    }

    /// Positive weights divided by their sum, and negative ones by theirs.
    fn balanced(mut self) -> Self {
        let positive: f64 = self.0.iter().filter(|w| **w > 0.0).sum();
        let negative: f64 = self.0.iter().filter(|w| **w < 0.0).sum();
        for weight in &mut self.0 {
            if *weight > 0.0 {
                *weight /= positive;
            } else if *weight < 0.0 {
                *weight /= -negative;
            }
        }
        self
    }
}

/// Adds `weight` times the values to the sums. If `values` is an array, its length is known and the
/// loop becomes a few vector instructions.
#[inline(always)]
fn add(sums: &mut [f64; LANES], weight: f64, values: &[f64]) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
}

impl Sensitivity {
    /// Its inverse Fourier transform at `x` degrees: a sqrt(pi / b) exp(-pi^2 x^2 / b).
    fn at(&self, x: f64) -> f64 {
        self.height() * libm::exp(-PI * PI * x * x / self.b)
    }

    fn height(&self) -> f64 {
        self.a * (PI / self.b).sqrt()
    }

    /// The standard deviation of that transform, in degrees.
    fn deviation(&self) -> f64 {
        (self.b / (2.0 * PI * PI)).sqrt()
    }
}

/// The filters of lightness, red against green, and yellow against blue. All reach as far as the
/// widest; each has the sum 1.
fn of_the_eye(pixels_per_degree: f64) -> [Weights; 4] {
    let widest = YELLOW_BLUE[0].deviation();
    let radius = (REACH * widest * pixels_per_degree).ceil() as i32;
    let single = |part: &Sensitivity| {
        let filter = Weights::sampled(radius, |x| part.at(x / pixels_per_degree));
        let sum = filter.sum();
        filter.scaled(1.0 / sum)
    };
    // Applied along rows and columns, each factor counts twice.
    let double = YELLOW_BLUE.map(|part| {
        let root = part.height().sqrt();
        Weights::sampled(radius, |x| part.at(x / pixels_per_degree) / root)
    });
    let sum = double.iter().map(|filter| filter.sum() * filter.sum()).sum::<f64>().sqrt();
    let [first, second] = double.map(|filter| filter.scaled(1.0 / sum));
    [single(&LIGHTNESS), single(&RED_GREEN), first, second]
}

/// The Gaussian with this standard deviation in pixels and the sum 1, and its first and second
/// derivatives, whose positive weights have the sum 1 and whose negative ones -1.
fn of_features(deviation: f64) -> [Weights; 3] {
    let radius = (REACH * deviation).ceil() as i32;
    let squared = deviation * deviation;
    let gaussian = |x: f64| libm::exp(-x * x / (2.0 * squared));
    let smooth = Weights::sampled(radius, gaussian);
    let sum = smooth.sum();
    let edge = Weights::sampled(radius, |x| -x * gaussian(x));
    let point = Weights::sampled(radius, |x| (x * x / squared - 1.0) * gaussian(x));
    [smooth.scaled(1.0 / sum), edge.balanced(), point.balanced()]
}
