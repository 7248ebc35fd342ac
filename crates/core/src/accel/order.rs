//! The order of surfaces along a ray: by exact t; of equal t, those that shadow rays pass come before
//! others; then by number. So what a picture shows where a pane lies on a wall does not depend on
//! which of them the scene file names first.
//!
//! The rounded t of hits tell nearly all apart. Where they are equal, bounds in double precision do,
//! and at last exact arithmetic. Spheres have no exact t: where theirs round to that of other hits, they come before
//! flat shapes, and among themselves as those of equal t. Nor has fast precision: there, numbers decide.
//!
//! Nothing else needs to know the exact t. Rounding keeps order: of two hits, one with the greater
//! rounded t has the greater exact t, and so has one with a bound of single precision above the rounded t
//! of the other. What searches skip on these grounds, beyond the closest hit so far, never comes first.

use std::cmp::Ordering;

use glam::Vec3;
use robust::{Coord3D, orient3d};

use super::Hit;
use crate::geometry::{Geometry, Primitive, Quadric};
use crate::kernels::triangle::{self, settle};
use crate::kernels::{Disk, Precision, disk, quad};
use crate::math::Ray;
use crate::math::exact::{Quotient, exact};

impl Geometry {
    /// Which of two hits of `ray` comes first.
    #[inline]
    pub(super) fn order(&self, ray: &Ray, one: Hit, other: Hit) -> Ordering {
        let by_t = one.t.total_cmp(&other.t);
        if by_t.is_eq() { self.order_of_tied(ray, one, other) } else { by_t }
    }

    /// As [`Self::order`], of hits with the same rounded t.
    #[cold]
    #[inline(never)]
    fn order_of_tied(&self, ray: &Ray, one: Hit, other: Hit) -> Ordering {
        if self.precision == Precision::Fast || one.primitive == other.primitive {
            return one.primitive.cmp(&other.primitive);
        }
        let [one, other] = [one, other].map(|hit| Tied::new(self, ray, hit));
        one.order(&other)
    }

    /// Puts what a ray crosses in order.
    pub(super) fn sort(&self, ray: &Ray, hits: &mut [Hit]) {
        hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.primitive.cmp(&b.primitive)));
        if self.precision != Precision::Fast {
            let tied = hits.chunk_by_mut(|a, b| a.t == b.t).filter(|tied| tied.len() > 1);
            tied.for_each(|tied| self.sort_tied(ray, tied));
        }
    }

    /// As [`Self::sort`], of hits with the same rounded t in the order of numbers: by insertion, as
    /// they mostly are in order.
    #[cold]
    #[inline(never)]
    fn sort_tied(&self, ray: &Ray, hits: &mut [Hit]) {
        let mut sorted: Vec<Tied> = Vec::with_capacity(hits.len());
        for &hit in hits.iter() {
            let next = Tied::new(self, ray, hit);
            let is_before = |other: &Tied| other.order(&next).is_le();
            let place = match sorted.last() {
                Some(last) if !is_before(last) => sorted.partition_point(is_before),
                _ => sorted.len(),
            };
            sorted.insert(place, next);
        }
        hits.iter_mut().zip(&sorted).for_each(|(hit, tied)| *hit = tied.hit);
    }
}

/// A hit whose rounded t is that of another one.
struct Tied {
    hit: Hit,
    is_passed: bool,
    /// The ray in the space of the shape.
    ray: Ray,
    /// None of spheres.
    shape: Option<Flat>,
}

/// The flat shape of a primitive, as exact arithmetic takes it.
#[derive(Clone, Copy, PartialEq)]
enum Flat {
    Triangle([Vec3; 3]),
    Disk(Disk),
}

impl Tied {
    /// A `hit` of `ray`.
    fn new(geometry: &Geometry, ray: &Ray, hit: Hit) -> Self {
        let is_passed = geometry.is_passed(hit.primitive);
        let mut carried = *ray;
        let shape = match geometry.primitive(hit.primitive) {
            Primitive::Triangle(i) => Some(Flat::Triangle(geometry.triangle(i))),
            Primitive::Quad(i) => Some(Flat::Triangle(half_met(ray, &geometry.quad(i), hit.t))),
            Primitive::Quadric(i) => match geometry.quadrics[i] {
                Quadric::Disk(disk) => Some(Flat::Disk(disk)),
                Quadric::Sphere(..) => None,
            },
            Primitive::Instanced(instanced) => {
                let (instance, prototype) = geometry.instance(instanced);
                carried = instance.carried(ray);
                Some(Flat::Triangle(prototype.triangle(instanced.triangle as usize)))
            }
        };
        Self { hit, is_passed, ray: carried, shape }
    }

    fn order(&self, other: &Self) -> Ordering {
        let by_number = || self.hit.primitive.cmp(&other.hit.primitive);
        self.order_of_t(other).then(other.is_passed.cmp(&self.is_passed)).then_with(by_number)
    }

    /// By exact t.
    fn order_of_t(&self, other: &Self) -> Ordering {
        let (Some(one), Some(another)) = (self.shape, other.shape) else {
            return self.shape.is_some().cmp(&other.shape.is_some());
        };
        if self.ray == other.ray && one.coincides(&another) {
            return Ordering::Equal;
        }
        let [start, end] = one.interval(&self.ray);
        let [other_start, other_end] = another.interval(&other.ray);
        if end < other_start {
            return Ordering::Less;
        }
        if other_end < start {
            return Ordering::Greater;
        }
        let both = one.exact(&self.ray).zip(another.exact(&other.ray));
        both.map_or(Ordering::Equal, |(one, other)| one.order(&other))
    }
}

impl Flat {
    /// Bounds on t in double precision; comparisons with unknown ones are false.
    fn interval(&self, ray: &Ray) -> [f64; 2] {
        match self {
            Self::Triangle(corners) => settle::interval(ray, corners),
            Self::Disk(disk) => disk::interval(ray, disk),
        }
    }

    /// The exact t, which every hit has.
    fn exact(&self, ray: &Ray) -> Option<Quotient> {
        match self {
            Self::Triangle(corners) => triangle::exact::plane(ray, corners),
            Self::Disk(Disk { center, normal, .. }) => {
                Quotient::at_plane(ray, &exact(*normal), *center)
            }
        }
    }

    /// Whether any ray that meets both does so at one t: they are the same, or lie in one plane.
    fn coincides(&self, other: &Self) -> bool {
        match (self, other) {
            _ if self == other => true,
            (Self::Triangle(one), Self::Triangle(other)) => {
                let is_level =
                    |axis: usize| one.iter().chain(other).all(|v| v[axis] == one[0][axis]);
                let point = |v: &Vec3| Coord3D { x: v.x, y: v.y, z: v.z };
                let [a, b, c] = one.each_ref().map(point);
                let is_in_plane = |v| one.contains(v) || orient3d(a, b, c, point(v)) == 0.0;
                (0..3).any(is_level) || other.iter().all(is_in_plane)
            }
            _ => false,
        }
    }
}

/// The half of a quad that a ray meets at a t that rounds to this one; of both the first.
fn half_met(ray: &Ray, corners: &[Vec3; 4], t: f32) -> [Vec3; 3] {
    let [first, second] = quad::halves(corners);
    let is_met = |half| triangle::meet(ray, half) == Some(t);
    let exact = |half| triangle::exact::plane(ray, half);
    let is_second = is_met(&second)
        && (!is_met(&first)
            || exact(&second).zip(exact(&first)).is_some_and(|(t, s)| t.order(&s).is_lt()));
    if is_second { second } else { first }
}
