//! Numbers without rounding error, after Shewchuk, *Adaptive Precision Floating-Point Arithmetic and
//! Fast Robust Geometric Predicates* (1997).
//!
//! A number is a sum of doubles that do not overlap. Numbers of single precision leave room: up to
//! the sixth degree, their products neither overflow in double precision nor lose bits to underflow,
//! so sums, differences and products are exact. They take microseconds: kernels ask only for what
//! double precision leaves open.
//!
//! To compare a root with another t takes the eighth degree, of which two or four factors are
//! components of the ray's direction. That is exact for coordinates of any size if those components
//! are zero or from 2^-67 to 2^116 in size: the least bit is then at least 6 * -149 - 2 * 90 = -1074,
//! and the greatest number below 2^1023.

mod root;

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

use glam::Vec3;

pub use root::QuadraticRoot;

use super::ray::Ray;

/// An exact number: a sum of doubles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expansion {
    /// In rising order of magnitude, without overlap and without zeros.
    terms: Vec<f64>,
}

impl From<f64> for Expansion {
    fn from(value: f64) -> Self {
        let mut sum = Self::default();
        sum.grow(value);
        sum
    }
}

impl From<f32> for Expansion {
    fn from(value: f32) -> Self {
        Self::from(f64::from(value))
    }
}

impl Expansion {
    /// Shewchuk's Grow-Expansion, which drops terms of zero.
    fn grow(&mut self, mut carried: f64) {
        if carried == 0.0 {
            return;
        }
        let mut kept = 0;
        for i in 0..self.terms.len() {
            let (sum, rest) = two_sum(carried, self.terms[i]);
            carried = sum;
            if rest != 0.0 {
                self.terms[kept] = rest;
                kept += 1;
            }
        }
        self.terms.truncate(kept);
        if carried != 0.0 {
            self.terms.push(carried);
        }
    }

    /// Adds the product of three numbers, times `sign`. This is what determinants consist of, and
    /// takes no memory in between.
    pub fn add_product(&mut self, sign: f64, [a, b, c]: [&Self; 3]) {
        for &a in &a.terms {
            for &b in &b.terms {
                let (high, low) = two_product(sign * a, b);
                for &c in &c.terms {
                    for part in [low, high] {
                        let (high, low) = two_product(part, c);
                        self.grow(low);
                        self.grow(high);
                    }
                }
            }
        }
    }

    /// The number as a double: within a few ulp, and of the right sign, as the largest term has.
    pub fn value(&self) -> f64 {
        self.terms.iter().fold(0.0, |sum, term| sum + term)
    }

    /// Its order relative to zero.
    pub fn sign(&self) -> Ordering {
        self.terms.last().map_or(Ordering::Equal, |last| last.total_cmp(&0.0))
    }
}

impl Add for &Expansion {
    type Output = Expansion;

    fn add(self, other: Self) -> Expansion {
        let mut sum = self.clone();
        other.terms.iter().for_each(|&term| sum.grow(term));
        sum
    }
}

impl Neg for Expansion {
    type Output = Self;

    fn neg(mut self) -> Self {
        self.terms.iter_mut().for_each(|term| *term = -*term);
        self
    }
}

impl Sub for &Expansion {
    type Output = Expansion;

    fn sub(self, other: Self) -> Expansion {
        self + &-other.clone()
    }
}

impl Mul for &Expansion {
    type Output = Expansion;

    fn mul(self, other: Self) -> Expansion {
        let mut sum = Expansion::default();
        for &a in &self.terms {
            for &b in &other.terms {
                let (product, rest) = two_product(a, b);
                sum.grow(rest);
                sum.grow(product);
            }
        }
        sum
    }
}

/// The exact coordinates of a vector.
pub fn exact(v: Vec3) -> [Expansion; 3] {
    v.to_array().map(Expansion::from)
}

/// The exact scalar product.
pub fn dot(u: &[Expansion; 3], v: &[Expansion; 3]) -> Expansion {
    &(&(&u[0] * &v[0]) + &(&u[1] * &v[1])) + &(&u[2] * &v[2])
}

/// The exact cross product.
pub fn cross(u: &[Expansion; 3], v: &[Expansion; 3]) -> [Expansion; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &(&u[i] * &v[j]) - &(&u[j] * &v[i]))
}

/// The exact determinant of three columns.
pub fn determinant(u: &[Expansion; 3], v: &[Expansion; 3], w: &[Expansion; 3]) -> Expansion {
    let mut sum = Expansion::default();
    for (i, w) in w.iter().enumerate() {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        sum.add_product(1.0, [&u[j], &v[k], w]);
        sum.add_product(-1.0, [&u[k], &v[j], w]);
    }
    sum
}

/// The exact quotient of two numbers, the second not zero.
#[derive(Clone, Debug)]
pub struct Quotient {
    numerator: Expansion,
    /// Positive.
    denominator: Expansion,
}

impl Quotient {
    /// The quotient, or `None` if `denominator` is zero.
    pub fn new(numerator: Expansion, denominator: Expansion) -> Option<Self> {
        match denominator.sign() {
            Ordering::Equal => None,
            Ordering::Greater => Some(Self { numerator, denominator }),
            Ordering::Less => Some(Self { numerator: -numerator, denominator: -denominator }),
        }
    }

    /// The t at which the line of a ray meets the plane through a point with this normal, of any
    /// length; `None` if they are parallel.
    pub fn at_plane(ray: &Ray, normal: &[Expansion; 3], point: Vec3) -> Option<Self> {
        let (origin, point) = (exact(ray.origin), exact(point));
        let away = [0, 1, 2].map(|k| &point[k] - &origin[k]);
        Self::new(dot(normal, &away), dot(normal, &exact(ray.direction)))
    }

    /// Its order relative to another one.
    pub fn order(&self, other: &Self) -> Ordering {
        let [here, there] =
            [&self.numerator * &other.denominator, &other.numerator * &self.denominator];
        (&here - &there).sign()
    }
}

/// A real number that can be compared with doubles without rounding.
pub trait Comparable {
    /// Its order relative to a double with at most 26 significant bits.
    fn compare(&self, other: f64) -> Ordering;

    /// The number as a double, within 16 ulp.
    fn approximate(&self) -> f64;

    /// Whether it lies strictly between `t_min` and `t_max`, of which infinite ones stand for the
    /// largest finite numbers.
    fn is_within(&self, [t_min, t_max]: [f32; 2]) -> bool {
        let [t_min, t_max] = [t_min, t_max].map(|end| f64::from(end.clamp(f32::MIN, f32::MAX)));
        self.compare(t_min) == Ordering::Greater && self.compare(t_max) == Ordering::Less
    }

    /// The nearest number of single precision, to even if two are equally near. The number must not
    /// exceed the largest one.
    fn rounded(&self) -> f32 {
        let near = self.approximate();
        let error = near.abs() * (32.0 * f64::EPSILON);
        let (low, high) = ((near - error) as f32, (near + error) as f32);
        if low == high {
            // Without a negative zero.
            return low + 0.0;
        }
        // Neighbours: the middle has one bit more.
        let middle = (f64::from(low) + f64::from(high)) / 2.0;
        match self.compare(middle) {
            Ordering::Less => low,
            Ordering::Greater => high,
            Ordering::Equal => middle as f32,
        }
    }
}

impl Comparable for Quotient {
    fn compare(&self, other: f64) -> Ordering {
        (&self.numerator - &(&self.denominator * &Expansion::from(other))).sign()
    }

    fn approximate(&self) -> f64 {
        self.numerator.value() / self.denominator.value()
    }
}

/// The rounded product and its rounding error, which every machine computes alike.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

/// The rounded sum and its rounding error (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_kept = sum - a;
    let a_kept = sum - b_kept;
    (sum, (a - a_kept) + (b - b_kept))
}
