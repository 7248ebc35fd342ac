//! Sums of products without rounding, after Shewchuk, *Adaptive Precision Floating-Point Arithmetic
//! and Fast Robust Geometric Predicates* (1997).
//!
//! A number is stored as a sum of doubles that do not overlap. Single precision leaves room: in
//! double precision a product of three such numbers neither overflows nor loses bits to underflow,
//! so the results here are exact.

/// The largest number of terms in a sum, two for each product.
const MOST: usize = 96;

/// The exact sum of products of three single-precision numbers.
#[derive(Clone, Copy, Debug)]
pub struct Sum {
    /// In rising order of magnitude, without overlap.
    terms: [f64; MOST],
    count: usize,
}

impl Sum {
    /// The empty sum.
    pub const ZERO: Self = Self { terms: [0.0; MOST], count: 0 };

    /// Adds `x y z`. At most 48 products can be added.
    pub fn add_product(&mut self, x: f32, y: f32, z: f32) {
        // A product of two has 48 bits, which fit into a double.
        let xy = f64::from(x) * f64::from(y);
        let z = f64::from(z);
        let high = xy * z;
        // The rounding error. This is the only fused operation, and every machine computes it
        // alike.
        self.add(xy.mul_add(z, -high));
        self.add(high);
    }

    /// Adds `a . (b x c)`: six products.
    pub fn add_volume(&mut self, a: [f32; 3], b: [f32; 3], c: [f32; 3]) {
        for (k, &x) in a.iter().enumerate() {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            self.add_product(x, b[i], c[j]);
            self.add_product(-x, b[j], c[i]);
        }
    }

    /// Adds another sum.
    pub fn add_sum(&mut self, other: &Self) {
        for &term in &other.terms[..other.count] {
            self.add(term);
        }
    }

    /// Shewchuk's Grow-Expansion, which drops terms of zero.
    fn add(&mut self, mut carried: f64) {
        let mut kept = 0;
        for i in 0..self.count {
            let (sum, rest) = two_sum(carried, self.terms[i]);
            carried = sum;
            if rest != 0.0 {
                self.terms[kept] = rest;
                kept += 1;
            }
        }
        if carried != 0.0 && kept < MOST {
            self.terms[kept] = carried;
            kept += 1;
        }
        self.count = kept;
    }

    /// The sum as a double: within a few ulp, and of the right sign, as the largest term has.
    pub fn value(&self) -> f64 {
        self.terms[..self.count].iter().sum()
    }
}

/// The rounded sum and its rounding error (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_kept = sum - a;
    let a_kept = sum - b_kept;
    (sum, (a - a_kept) + (b - b_kept))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Stream;

    #[test]
    fn what_cancels_leaves_nothing_or_the_last_bit() {
        let mut sum = Sum::ZERO;
        sum.add_product(1e30, 1e30, 1e30);
        sum.add_product(1e-40, 1e-40, 1e-40);
        sum.add_product(-1e30, 1e30, 1e30);
        let tiny = f64::from(1e-40_f32);
        assert!((sum.value() / (tiny * tiny * tiny) - 1.0).abs() < 1e-15);
        sum.add_product(1e-40, -1e-40, 1e-40);
        assert_eq!(sum.value(), 0.0);
    }

    #[test]
    fn volumes_have_the_sign_that_exact_predicates_give() {
        let mut zeros = 0;
        for i in 0..20_000 {
            let stream = Stream { seed: 3, pixel: i, sample: 0, bounce: 0 };
            // Few bits: many of the volumes are zero, and many nearly.
            let at = |k: u32| {
                let [x, y, z, w] = stream.uniform(k);
                [x, y, z].map(|v| (v * 4.0).floor() * if w < 0.3 { 1.000_000_1 } else { 0.1 })
            };
            let [a, b, c] = [at(0), at(1), at(2)];
            let mut volume = Sum::ZERO;
            volume.add_volume(a, b, c);
            let point = |[x, y, z]: [f32; 3]| robust::Coord3D {
                x: f64::from(x),
                y: f64::from(y),
                z: f64::from(z),
            };
            let zero = point([0.0; 3]);
            let expected = robust::orient3d(point(a), point(b), point(c), zero);
            assert_eq!(volume.value() > 0.0, expected > 0.0, "{a:?} {b:?} {c:?}");
            assert_eq!(volume.value() < 0.0, expected < 0.0, "{a:?} {b:?} {c:?}");
            zeros += u32::from(expected == 0.0);
        }
        assert!(zeros > 100, "{zeros}");
    }
}
