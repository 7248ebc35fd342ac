//! Exact roots of quadratics.

use std::cmp::Ordering;

use super::{Comparable, Expansion};

/// A root of a t^2 - 2 b t + c with real roots, and positive a.
#[derive(Clone, Debug)]
pub struct QuadraticRoot {
    a: Expansion,
    b: Expansion,
    c: Expansion,
    is_far: bool,
}

impl QuadraticRoot {
    /// Both roots, the lesser one first, if they are real.
    pub fn both(a: Expansion, b: Expansion, c: Expansion) -> Option<[Self; 2]> {
        let near = Self { a, b, c, is_far: false };
        let is_real = near.discriminant().sign() != Ordering::Less;
        is_real.then(|| [near.clone(), Self { is_far: true, ..near }])
    }

    /// b^2 - a c.
    fn discriminant(&self) -> Expansion {
        &(&self.b * &self.b) - &(&self.a * &self.c)
    }
}

impl Comparable for QuadraticRoot {
    /// Between the roots the quadratic is negative, and a x - b tells on which side of them x is.
    fn compare(&self, other: f64) -> Ordering {
        let x = Expansion::from(other);
        let middle = &(&self.a * &x) - &self.b;
        let value = || (&(&(&middle - &self.b) * &x) + &self.c).sign();
        match (middle.sign(), self.is_far) {
            (Ordering::Greater, false) => Ordering::Less,
            (Ordering::Less, true) => Ordering::Greater,
            (_, false) => value(),
            (_, true) => value().reverse(),
        }
    }

    fn approximate(&self) -> f64 {
        let (a, b, c) = (self.a.value(), self.b.value(), self.c.value());
        let (b, c, root) = (b / a, c / a, self.discriminant().value().sqrt() / a);
        // Neither root subtracts nearly equal numbers (Press et al., *Numerical Recipes*, section 5.6).
        let one = b + root.copysign(b);
        let other = if one == 0.0 { one } else { c / one };
        if self.is_far == (other < one) { one } else { other }
    }
}
