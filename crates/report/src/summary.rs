//! Robust summaries of repeated measurements: single bad runs do not affect them.
//!
//! Times of a program have a lower limit and a long upper tail: other programs can only slow it
//! down. So the centre is the median, and the spread is given by the median absolute deviation, which
//! tolerates up to half of the runs being disturbed (Hampel, *The Influence Curve and Its Role in
//! Robust Estimation*, 1974).
//!
//! The uncertainty of a median is an interval between two of the measurements themselves, the `k`th
//! smallest and the `k`th largest (Thompson, *On Confidence Ranges for the Median*, Annals of
//! Mathematical Statistics, 1936; Le Boudec, *Performance Evaluation of Computer and Communication
//! Systems*, 2010, section 2.2). The true median is outside only if fewer than `k` of `n`
//! independent measurements are on one side of it, which has twice the probability of fewer than
//! `k` heads in `n` coin tosses. The interval assumes nothing about the distribution and uses no
//! random numbers. It is valid for few measurements too: it is then the whole range, with the
//! corresponding confidence.
//!
//! Of other statistics, such as means and slopes, intervals are percentiles of the bootstrap (Efron,
//! *Bootstrap Methods: Another Look at the Jackknife*, 1979): seeds are resampled with replacement, whole
//! renders at a time, since the values of one image are correlated. For few seeds percentile intervals
//! are too narrow: they are widened by the ratio of Student's distribution to the normal one (Hesterberg,
//! *What Teachers Should Know About the Bootstrap*, 2015, section 5.3).

use rand::RngExt;
use serde::Serialize;

use wavecrest_core::math::random::{Generator, Stream};

/// The smallest confidence of intervals with enough measurements.
pub const CONFIDENCE: f64 = 0.95;

/// The smallest number of measurements whose range contains the median with [`CONFIDENCE`]: 1 -
/// 2^-5 = 0.969.
pub const ENOUGH: usize = 6;

/// A summary of repeated measurements.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The middle one, or the mean of the two in the middle.
    pub median: f64,
    /// Median absolute deviation: the median of the distances to the median.
    pub mad: f64,
    /// Every measurement, in order.
    pub each: Vec<f64>,
}

impl Summary {
    /// Summarises `each`, finite numbers; `None` if it is empty.
    pub fn of(each: &[f64]) -> Option<Self> {
        let center = median(each);
        let distances: Vec<f64> = each.iter().map(|x| (x - center).abs()).collect();
        let summary = Self { median: center, mad: median(&distances), each: each.to_vec() };
        (!each.is_empty()).then_some(summary)
    }

    /// The width of the range around the median with half of the measurements, as a share of it.
    pub fn spread(&self) -> f64 {
        2.0 * self.mad / self.median
    }
}

/// A median with its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MedianInterval {
    /// The median of the measurements.
    pub median: f64,
    /// One end of the interval.
    pub low: f64,
    /// The other end.
    pub high: f64,
    /// The probability that the interval contains the true median: at least [`CONFIDENCE`] for at
    /// least [`ENOUGH`] measurements, and that of the whole range for fewer.
    pub confidence: f64,
}

impl MedianInterval {
    /// The narrowest interval of the module documentation with at least [`CONFIDENCE`], or the
    /// whole range; `None` without measurements.
    pub fn of(each: &[f64]) -> Option<Self> {
        let sorted = sorted(each.to_vec());
        let n = sorted.len();
        let outermost = (1, confidence(n, 1));
        // From the outermost inward, as long as the confidence suffices.
        let (k, confidence) = (2..=n / 2)
            .map(|k| (k, confidence(n, k)))
            .take_while(|(_, confidence)| *confidence >= CONFIDENCE)
            .last()
            .unwrap_or(outermost);
        let (&low, &high) = (sorted.get(k - 1)?, sorted.get(n - k)?);
        Some(Self { median: middle(&sorted), low, high, confidence })
    }
}

/// The median of `each`; 0 if it is empty.
pub fn median(each: &[f64]) -> f64 {
    middle(&sorted(each.to_vec()))
}

/// The probability that the median is between the `k`th smallest and the `k`th largest of `n`: 1 -
/// 2 P(fewer than `k` heads in `n` tosses).
fn confidence(n: usize, k: usize) -> f64 {
    // In logarithms, so that 2^-n does not underflow for large n.
    let mut logarithm = -(n as f64) * std::f64::consts::LN_2;
    let mut below = 0.0;
    for heads in 0..k.min(n) {
        below += libm::exp(logarithm);
        logarithm += libm::log((n - heads) as f64 / (heads + 1) as f64);
    }
    (1.0 - 2.0 * below).max(0.0)
}

fn sorted(mut each: Vec<f64>) -> Vec<f64> {
    each.sort_by(f64::total_cmp);
    each
}

/// The middle value, or the mean of the two in the middle.
fn middle(sorted: &[f64]) -> f64 {
    let half = sorted.len() / 2;
    match sorted.get(half) {
        None => 0.0,
        Some(above) if sorted.len() % 2 == 1 => *above,
        Some(above) => f64::midpoint(sorted[half - 1], *above),
    }
}

/// Number of bootstrap samples.
const RESAMPLES: u32 = 1000;

/// A value with its interval of [`CONFIDENCE`], the share of resampled values within it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Uncertain {
    /// The estimate.
    pub value: f64,
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Uncertain {
    /// As a factor, such as "1.1 times (1.0 to 67.4)".
    pub(crate) fn times(&self) -> String {
        let Self { value, low, high } = self;
        let interval = if low < high { format!(" ({low:.1} to {high:.1})") } else { String::new() };
        format!("{value:.1} times{interval}")
    }
}

/// The random numbers of a seed.
pub(crate) fn generator(seed: u64) -> Generator {
    Stream { seed, pixel: 0, sample: 0, bounce: 0 }.generator(0)
}

/// Half the width of an interval of [`CONFIDENCE`] under the normal distribution, in standard deviations.
const NORMAL: f64 = 1.959_963_984_540_054;

/// The same under Student's distribution with `freedom` degrees of freedom: the number that has the same probability
/// there (Wallace, *Bounds on Normal Approximations to Student's and the Chi-square Distributions*, 1959).
fn student(freedom: f64) -> f64 {
    let normal = NORMAL * (8.0 * freedom + 3.0) / (8.0 * freedom + 1.0);
    (freedom * libm::expm1(normal * normal / freedom)).sqrt()
}

/// The percentile interval of a statistic of seeds, given by their indices. `None` if it is undefined
/// for all seeds.
pub(crate) fn bootstrap(
    seeds: usize,
    statistic: impl Fn(&[usize]) -> Option<f64>,
) -> Option<Uncertain> {
    let value = statistic(&(0..seeds).collect::<Vec<_>>())?;
    let mut random = generator(1);
    let draw =
        |_| statistic(&(0..seeds).map(|_| random.random_range(0..seeds)).collect::<Vec<_>>());
    let resampled = sorted((0..RESAMPLES).filter_map(draw).collect());
    let at = |share: f64| {
        let index = (share * (resampled.len() as f64 - 1.0)).round() as usize;
        resampled.get(index).copied().unwrap_or(value)
    };
    let n = seeds.max(2) as f64;
    let deviations = (n / (n - 1.0)).sqrt() * student(n - 1.0);
    // The part of a normal distribution that is farther from its mean on one side.
    let outside = libm::erfc(deviations / std::f64::consts::SQRT_2) / 2.0;
    Some(Uncertain { value, low: at(outside), high: at(1.0 - outside) })
}

/// The root of the mean squared error, from one squared error for each seed.
pub(crate) fn rmse(mse: &[f64]) -> Uncertain {
    bootstrap(mse.len(), |seeds| Some(mean(seeds, mse).sqrt())).unwrap_or_default()
}

/// The values of these seeds.
pub(crate) fn of_seeds<'a>(
    seeds: &'a [usize],
    values: &'a [f64],
) -> impl Iterator<Item = f64> + 'a {
    seeds.iter().filter_map(|seed| values.get(*seed)).copied()
}

fn mean(seeds: &[usize], values: &[f64]) -> f64 {
    of_seeds(seeds, values).sum::<f64>() / seeds.len() as f64
}

/// The exponent of a power law: the least-squares slope through logarithms.
///
/// `points` are counts with a value for each seed, whose mean is used. `None` for fewer than three
/// points, or if one is not above 0.
pub(crate) fn slope<V: AsRef<[f64]>>(points: &[(f64, V)]) -> Option<Uncertain> {
    let least = points.iter().map(|(_, values)| values.as_ref().len()).min();
    bootstrap(least.filter(|_| points.len() > 2)?, |seeds| {
        let logs = points.iter().map(|(x, values)| [*x, mean(seeds, values.as_ref())]);
        let logs: Vec<[f64; 2]> = logs.map(|log| log.map(libm::log)).collect();
        let n = logs.len() as f64;
        let [mx, my] = [0, 1].map(|axis| logs.iter().map(|log| log[axis]).sum::<f64>() / n);
        let xy: f64 = logs.iter().map(|[x, y]| (x - mx) * (y - my)).sum();
        let xx: f64 = logs.iter().map(|[x, _]| (x - mx) * (x - mx)).sum();
        Some(xy / xx).filter(|slope| slope.is_finite())
    })
}

/// Number of last points that show whether an error falls, and the least steep slope at which it does: at half
/// of that of random points, what the points have no part in makes up half of the squared error.
const LAST: usize = 3;
const LEAST_SLOPE: f64 = -0.5;

/// Whether the error of `points`, in the order of their counts, does not fall any more at the last ones.
pub(crate) fn stays<V: AsRef<[f64]>>(points: &[(f64, V)]) -> bool {
    let last = slope(&points[points.len().saturating_sub(LAST)..]);
    last.is_some_and(|slope| slope.value > LEAST_SLOPE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_medians_and_deviations() {
        let s = Summary::of(&[5.0, 1.0, 4.0, 2.0, 3.0]).unwrap();
        assert_eq!((s.median, s.mad, s.spread()), (3.0, 1.0, 2.0 / 3.0));
        assert_eq!(s.each, [5.0, 1.0, 4.0, 2.0, 3.0], "in the order of the runs");
        let s = Summary::of(&[4.0, 1.0, 2.0, 100.0]).unwrap();
        assert_eq!((s.median, s.mad), (3.0, 1.5), "of 1, 2, 1 and 97");
        // One or none.
        let s = Summary::of(&[2.5]).unwrap();
        assert_eq!((s.median, s.mad), (2.5, 0.0));
        let i = MedianInterval::of(&[2.5]).unwrap();
        assert_eq!((i.median, i.low, i.high, i.confidence), (2.5, 2.5, 2.5, 0.0));
        assert!(Summary::of(&[]).is_none());
        assert!(MedianInterval::of(&[]).is_none());
        assert_eq!(median(&[]), 0.0);
    }

    #[test]
    fn confidences_are_those_of_the_tables() {
        // Le Boudec 2010, appendix A: n, k, confidence.
        for (n, k, expected) in
            [(2, 1, 0.5), (5, 1, 0.9375), (6, 1, 0.96875), (9, 2, 0.961), (31, 10, 0.971)]
        {
            assert!((confidence(n, k) - expected).abs() < 5e-4, "{n} {k}: {}", confidence(n, k));
        }
        assert!(confidence(5, 1) < CONFIDENCE && confidence(ENOUGH, 1) >= CONFIDENCE);
    }

    #[test]
    fn the_interval_is_the_narrowest_that_is_confident() {
        let upto = |n: u32| (1..=n).map(f64::from).collect::<Vec<_>>();
        for (n, low, high) in [(3, 1.0, 3.0), (6, 1.0, 6.0), (9, 2.0, 8.0), (31, 10.0, 22.0)] {
            let found = MedianInterval::of(&upto(n)).unwrap();
            assert_eq!((found.low, found.high), (low, high), "{n}");
        }
        let many = MedianInterval::of(&upto(5000)).unwrap();
        assert!((0.95..0.953).contains(&many.confidence), "{many:?}");
        assert!((many.low - 2431.0).abs() <= 1.0, "{many:?}");
    }

    /// Of many sets of skewed measurements, the share whose interval holds the true median is the
    /// confidence.
    #[test]
    fn intervals_cover_the_true_median_as_often_as_they_say() {
        const SETS: u32 = 4000;
        for n in [3_u32, 6, 10, 25] {
            let mut covered = 0;
            let mut stated = 0.0;
            for set in 0..SETS {
                let time = |i| {
                    let stream = Stream { seed: 11, pixel: set, sample: i, bounce: n };
                    // A lower limit of 1 and a long tail; the median is 1 + 0.5^4 / 0.5.
                    let u = f64::from(stream.uniform(0)[0]);
                    1.0 + u.powi(4) / (1.0 - u)
                };
                let each: Vec<f64> = (0..n).map(time).collect();
                let interval = MedianInterval::of(&each).unwrap();
                covered += u32::from((interval.low..=interval.high).contains(&1.125));
                stated = interval.confidence;
            }
            let share = f64::from(covered) / f64::from(SETS);
            // Four standard deviations of a share of so many sets.
            let chance = 4.0 * (stated * (1.0 - stated) / f64::from(SETS)).sqrt();
            assert!((share - stated).abs() <= chance, "{n}: {share} for {stated}");
        }
    }

    /// Values that fall with a known power, with noise of a known size on each.
    fn falling(power: f64, noise: f64) -> Vec<(f64, Vec<f64>)> {
        let mut rng = generator(9);
        let mut unit = || rng.random_range(0..1_usize << 20) as f64 / f64::from(1 << 20) - 0.5;
        [1.0, 4.0, 16.0, 64.0, 256.0]
            .map(|x: f64| {
                let values = (0..16).map(|_| libm::pow(x, power) * (1.0 + noise * unit()));
                (x, values.collect())
            })
            .to_vec()
    }

    #[test]
    fn slopes_are_found_within_their_intervals() {
        for power in [-1.0, -1.5, -2.0] {
            let exact = slope(&falling(power, 0.0)).unwrap();
            assert!((exact.value - power).abs() < 1e-12 && exact.high - exact.low < 1e-12);
            let noisy = slope(&falling(power, 0.5)).unwrap();
            assert!(noisy.low < power && power < noisy.high, "{noisy:?}");
            assert!(noisy.high - noisy.low < 0.1, "{noisy:?}");
        }
        assert_eq!(slope(&falling(-1.0, 0.0)[..2]), None);
        assert_eq!(slope(&[(1.0, vec![0.0]), (2.0, vec![1.0]), (3.0, vec![1.0])]), None);
    }

    /// Of many experiments with a known mean, the share whose interval holds it is near the confidence.
    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        let mut rng = generator(3);
        let held = (0..1000)
            .filter(|_| {
                let mse: Vec<f64> =
                    (0..16).map(|_| 1.0 + rng.random_range(0..1000_usize) as f64 / 999.0).collect();
                let found = rmse(&mse);
                found.low <= 1.5_f64.sqrt() && 1.5_f64.sqrt() <= found.high
            })
            .count();
        assert!((930..=970).contains(&held), "{held}");
    }

    #[test]
    fn intervals_of_few_are_as_wide_as_students() {
        // 95 per cent lie within 2.131 standard errors with 15 degrees of freedom, within 3.182 with 3.
        for (freedom, expected) in [(15.0, 2.131), (3.0, 3.182)] {
            let found = student(freedom);
            assert!((found - expected).abs() < 0.02 * expected, "{found}");
        }
    }
}
