//! The first two dimensions of Sobol's sequence, with Owen's scrambling.
//!
//! The sequence is a (0, 2)-sequence in base 2: each aligned run of 2^m points has one point in
//! every box of area 2^-m whose sides come from repeated halving of \[0, 1). Owen's scrambling
//! (*Randomly permuted (t,m,s)-nets and (t,s)-sequences*, 1995) preserves that and makes each point
//! uniform, so that a mean over the points is unbiased. For smooth integrands the error then falls
//! as n^-3/2 (Owen, *Scrambled net variance for integrals of smooth functions*, 1997).
//!
//! Hashes scramble the points and shuffle their order, so that pairs of dimensions can be combined:
//! Burley, *Practical Hash-based Owen Scrambling*, JCGT 9(4), 2020, with constants that Vegdahl
//! found to mix better (*Building a Better LK Hash*, 2021).

use glam::Vec2;

use super::random::unit_interval;

/// Point `index` of the set scrambled by `seeds`, each coordinate in \[0, 1). The first seed
/// shuffles the order, the second scrambles x, the third y.
#[inline(always)]
pub fn point(index: u32, seeds: [u32; 3]) -> Vec2 {
    // The reversed bits of the shuffled index: van der Corput's sequence.
    let first = permute(index.reverse_bits(), seeds[0]);
    let second = second_dimension(first.reverse_bits());
    Vec2::new(
        unit_interval(permute(first.reverse_bits(), seeds[1]).reverse_bits()),
        unit_interval(permute(second, seeds[2]).reverse_bits()),
    )
}

/// The second dimension of Sobol's sequence, in units of 2^-32, with reversed bits. Its direction
/// numbers are the rows of Pascal's triangle modulo 2: a polynomial with the bits of the index, at
/// 1 + x in place of x. As (1 + x)^16 is 1 + x^16, its upper half is added to its lower half, and so
/// on in each half.
#[inline(always)]
fn second_dimension(mut index: u32) -> u32 {
    index ^= index >> 16;
    index ^= index >> 8 & 0x00FF_00FF;
    index ^= index >> 4 & 0x0F0F_0F0F;
    index ^= index >> 2 & 0x3333_3333;
    index ^ (index >> 1 & 0x5555_5555)
}

/// A permutation in which each bit depends only on lower bits (Laine and Karras, *Stratified
/// Sampling for Stochastic Transparency*, 2011). Applied to a fraction with reversed bits it is
/// Owen's scrambling.
#[inline(always)]
fn permute(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3D20_ADEA);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6C56);
    x ^ x.wrapping_mul(0x53A2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Stream;

    fn seeds(pixel: u32) -> [u32; 3] {
        let [a, b, c, _] = Stream { seed: 5, pixel, sample: 0, bounce: 0 }.words(0);
        [a, b, c]
    }

    /// Every aligned run of 2^m points has one point in each box of area 2^-m, for all shapes of
    /// boxes.
    #[test]
    fn every_run_is_a_net() {
        for pixel in 0..20 {
            for (m, run) in [(3, 0), (5, 1), (8, 3), (10, 0), (10, 7)] {
                let points: Vec<Vec2> =
                    (0..1 << m).map(|i| point((run << m) + i, seeds(pixel))).collect();
                for columns in 0..=m {
                    let mut seen = vec![false; 1 << m];
                    for p in &points {
                        let column = (p.x * (1_u32 << columns) as f32) as usize;
                        let row = (p.y * (1_u32 << (m - columns)) as f32) as usize;
                        let cell = (row << columns) + column;
                        assert!(!std::mem::replace(&mut seen[cell], true), "{m} {columns}");
                    }
                }
            }
        }
    }

    /// The mean over pixels of one point of the set is that of uniform numbers, and so is the covariance.
    #[test]
    fn every_point_is_uniform() {
        let pixels = 20_000;
        for index in [0, 1, 2, 17] {
            let points: Vec<_> =
                (0..pixels).map(|pixel| point(index, seeds(pixel)).as_dvec2() - 0.5).collect();
            let mean = points.iter().sum::<glam::DVec2>() / f64::from(pixels);
            let product = points.iter().map(|p| p.x * p.y).sum::<f64>() / f64::from(pixels);
            // Five standard errors: the variances are 1/12, and 1/144 for the product.
            let n = f64::from(pixels);
            assert!(mean.abs().max_element() < 5.0 / (12.0 * n).sqrt(), "{index}: {mean}");
            assert!(product.abs() < 5.0 / (144.0 * n).sqrt(), "{index}: {product}");
        }
    }
}
