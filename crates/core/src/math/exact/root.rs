//! Exact roots of quadratics, and their order among each other and among quotients.

use std::cmp::Ordering;

use super::{Comparable, Expansion, Quotient};

/// A root of a t^2 - 2 b t + c with real roots, and positive a.
#[derive(Clone, Debug)]
pub struct QuadraticRoot {
    a: Expansion,
    b: Expansion,
    c: Expansion,
    is_far: bool,
}

/// The exact t of a hit.
#[derive(Clone, Debug)]
pub enum Algebraic {
    /// On a plane.
    Quotient(Quotient),
    /// On a sphere.
    Root(QuadraticRoot),
}

impl Algebraic {
    /// Its order relative to another one; of roots, if both have the same a.
    pub fn order(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::Quotient(one), Self::Quotient(other)) => one.order(other),
            (Self::Quotient(one), Self::Root(other)) => other.order_to(one).reverse(),
            (Self::Root(one), Self::Quotient(other)) => one.order_to(other),
            (Self::Root(one), Self::Root(other)) => one.order(other),
        }
    }
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

    /// Its order relative to a quotient p / q.
    fn order_to(&self, Quotient { numerator: p, denominator: q }: &Quotient) -> Ordering {
        let (ap, bq) = (&self.a * p, &self.b * q);
        let middle = &ap - &bq;
        self.order_by(&middle, &(&(&(&middle - &bq) * p) + &(&(&self.c * q) * q)))
    }

    /// Its order relative to an x, given a x - b and the value of the quadratic there, times positive
    /// numbers: between the roots the value is negative, and the former tells on which side of them
    /// x is.
    fn order_by(&self, middle: &Expansion, value: &Expansion) -> Ordering {
        match (middle.sign(), self.is_far) {
            (Ordering::Greater, false) => Ordering::Less,
            (Ordering::Less, true) => Ordering::Greater,
            (_, false) => value.sign(),
            (_, true) => value.sign().reverse(),
        }
    }

    /// Its order relative to a root with the same a: the sign of p + x, where p is the difference of
    /// both b and x that of the roots of both discriminants d and e, each with its sign. If those of
    /// p and x are opposite, the larger size decides: p^2 - x^2 = p^2 - d - e + 2 sqrt(d e), or with
    /// minus if one root is near and one far.
    fn order(&self, other: &Self) -> Ordering {
        let p = &self.b - &other.b;
        let (d, e) = (self.discriminant(), other.discriminant());
        let is_like = self.is_far == other.is_far;
        let x = if is_like { (&d - &e).sign() } else { d.sign().max(e.sign()) };
        let x = if self.is_far { x } else { x.reverse() };
        if p.sign() != x.reverse() {
            return p.sign().then(x);
        }
        let rest = &(&(&p * &p) - &d) - &e;
        let product = &d * &e;
        match order_to_root(&rest, &(&product * &Expansion::from(4.0_f64)), is_like) {
            Ordering::Greater => p.sign(),
            Ordering::Less => x,
            Ordering::Equal => Ordering::Equal,
        }
    }
}

/// The order of `x` relative to the root of `square`, or to its negative.
fn order_to_root(x: &Expansion, square: &Expansion, is_negative: bool) -> Ordering {
    let root = if is_negative { square.sign().reverse() } else { square.sign() };
    let sizes = || (&(x * x) - square).sign();
    x.sign().cmp(&root).then_with(|| if is_negative { sizes().reverse() } else { sizes() })
}

impl Comparable for QuadraticRoot {
    fn compare(&self, other: f64) -> Ordering {
        let x = Expansion::from(other);
        let middle = &(&self.a * &x) - &self.b;
        self.order_by(&middle, &(&(&(&middle - &self.b) * &x) + &self.c))
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
