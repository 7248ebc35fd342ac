//! Means and slopes, each with its interval.
//!
//! Intervals are percentiles of the bootstrap (Efron, *Bootstrap Methods: Another Look at the
//! Jackknife*, 1979): seeds are resampled with replacement, whole renders at a time, since the
//! values of one image are correlated. For few seeds percentile intervals are too narrow: they are
//! widened by the ratio of Student's distribution to the normal one (Hesterberg, *What Teachers
//! Should Know About the Bootstrap*, 2015, section 5.3).

use rand::RngExt;
use serde::Serialize;

use crate::summary::CONFIDENCE;
use wavecrest_core::math::random::{Generator, Stream};

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

/// The random numbers of a seed.
pub fn generator(seed: u64) -> Generator {
    Stream { seed, pixel: 0, sample: 0, bounce: 0 }.generator(0)
}

/// The number of standard deviations with the same probability under the normal distribution as `t`
/// under Student's with `freedom` degrees of freedom (Wallace, *Bounds on Normal Approximations to
/// Student's and the Chi-square Distributions*, 1959).
fn normal_of(t: f64, freedom: f64) -> f64 {
    let ratio = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    ratio * (freedom * libm::log1p(t * t / freedom)).sqrt()
}

/// The probability that a normal value is farther from its mean than this many standard deviations,
/// on either side.
fn chance_beyond(deviations: f64) -> f64 {
    libm::erfc(deviations / std::f64::consts::SQRT_2)
}

/// Half the width of an interval in standard errors, if the true value is outside with this
/// `chance`.
fn student(chance: f64, freedom: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e3);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        let is_inside = chance_beyond(normal_of(middle, freedom)) > chance;
        *(if is_inside { &mut low } else { &mut high }) = middle;
    }
    high
}

/// The percentile interval of a statistic of seeds, given by their indices. `None` if it is undefined
/// for all seeds.
pub fn bootstrap(seeds: usize, statistic: impl Fn(&[usize]) -> Option<f64>) -> Option<Uncertain> {
    let value = statistic(&(0..seeds).collect::<Vec<_>>())?;
    let mut random = generator(1);
    let draw =
        |_| statistic(&(0..seeds).map(|_| random.random_range(0..seeds)).collect::<Vec<_>>());
    let mut resampled: Vec<f64> = (0..RESAMPLES).filter_map(draw).collect();
    resampled.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let index = (share * (resampled.len() as f64 - 1.0)).round() as usize;
        resampled.get(index).copied().unwrap_or(value)
    };
    let n = seeds.max(2) as f64;
    let deviations = (n / (n - 1.0)).sqrt() * student(1.0 - CONFIDENCE, n - 1.0);
    let outside = chance_beyond(deviations) / 2.0;
    Some(Uncertain { value, low: at(outside), high: at(1.0 - outside) })
}

/// The root of the mean squared error, from one squared error for each seed.
pub fn rmse(mse: &[f64]) -> Uncertain {
    bootstrap(mse.len(), |seeds| Some(mean(seeds, mse).sqrt())).unwrap_or_default()
}

/// The values of these seeds.
pub fn of<'a>(seeds: &'a [usize], values: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    seeds.iter().filter_map(|seed| values.get(*seed)).copied()
}

fn mean(seeds: &[usize], values: &[f64]) -> f64 {
    of(seeds, values).sum::<f64>() / seeds.len() as f64
}

/// The exponent of a power law: the least-squares slope through logarithms.
///
/// `points` are counts with a value for each seed, whose mean is used. `None` for fewer than three
/// points, or if one is not above 0.
pub fn slope<V: AsRef<[f64]>>(points: &[(f64, V)]) -> Option<Uncertain> {
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
pub fn stays<V: AsRef<[f64]>>(points: &[(f64, V)]) -> bool {
    let last = slope(&points[points.len().saturating_sub(LAST)..]);
    last.is_some_and(|slope| slope.value > LEAST_SLOPE)
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let found = student(0.05, freedom);
            assert!((found - expected).abs() < 0.02 * expected, "{found}");
        }
    }
}
