//! The order of surfaces along a ray: by exact t; of equal t, those that shadow rays pass come before
//! others; then by number. So what a picture shows where a pane lies on a wall does not depend on
//! which of them the scene file names first.
//!
//! The rounded t of hits tell nearly all apart. Where they are equal, bounds in double precision do,
//! and at last exact arithmetic. Fast precision knows no exact t: there, numbers decide.
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
use crate::kernels::{Disk, Precision, disk, quad, sphere};
use crate::math::Ray;
use crate::math::exact::{Algebraic, Comparable, Quotient, exact};

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
        let [one, other] = [one, other].map(|hit| Tied::new(self, ray, hit, false));
        one.order(&other)
    }

    /// Puts what a ray crosses in order.
    pub(super) fn sort(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.primitive.cmp(&b.primitive)));
        // Lists hold a quad for each of its halves; a sphere may be touched, which counts twice.
        let is_quad = |hit: &Hit| matches!(self.primitive(hit.primitive), Primitive::Quad(_));
        hits.dedup_by(|a, b| a == b && is_quad(a));
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
        for (i, &hit) in hits.iter().enumerate() {
            let next = Tied::new(self, ray, hit, i > 0 && hits[i - 1] == hit);
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
    shape: TiedShape,
}

/// The shape of a primitive, as exact arithmetic takes it.
#[derive(Clone, Copy, PartialEq)]
enum TiedShape {
    Triangle([Vec3; 3]),
    Disk(Disk),
    /// Centre and radius, and whether it was met before at a t that rounds alike.
    Sphere(Vec3, f32, bool),
}

impl Tied {
    /// A `hit` of `ray`; of a sphere the first one with this t, or the second.
    fn new(geometry: &Geometry, ray: &Ray, hit: Hit, is_second: bool) -> Self {
        let is_passed = geometry.is_passed(hit.primitive);
        let mut carried = *ray;
        let shape = match geometry.primitive(hit.primitive) {
            Primitive::Triangle(i) => TiedShape::Triangle(geometry.triangle(i)),
            Primitive::Quad(i) => TiedShape::Triangle(half_met(ray, &geometry.quad(i), hit.t)),
            Primitive::Quadric(i) => match geometry.quadrics[i] {
                Quadric::Disk(disk) => TiedShape::Disk(disk),
                Quadric::Sphere(center, radius) => TiedShape::Sphere(center, radius, is_second),
            },
            Primitive::Instanced(instanced) => {
                let (instance, prototype) = geometry.instance(instanced);
                carried = instance.carried(ray);
                TiedShape::Triangle(prototype.triangle(instanced.triangle as usize))
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
        if self.ray == other.ray && self.shape.coincides(&other.shape) {
            return Ordering::Equal;
        }
        let ([start, end], [other_start, other_end]) = (self.interval(), other.interval());
        if end < other_start {
            return Ordering::Less;
        }
        if other_end < start {
            return Ordering::Greater;
        }
        let both = self.exact().zip(other.exact());
        both.map_or(Ordering::Equal, |(one, other)| one.order(&other))
    }

    /// Bounds on t in double precision; comparisons with unknown ones are false.
    fn interval(&self) -> [f64; 2] {
        match &self.shape {
            TiedShape::Triangle(corners) => settle::interval(&self.ray, corners),
            TiedShape::Disk(disk) => disk::interval(&self.ray, disk),
            TiedShape::Sphere(center, radius, is_second) => {
                let [near, far] = sphere::intervals(&self.ray, *center, *radius);
                // Of which only one rounds to t.
                match self.hit.t {
                    t if t > near[1] as f32 => far,
                    t if !is_second && t < far[0] as f32 => near,
                    _ => [f64::NAN; 2],
                }
            }
        }
    }

    /// The exact t, which every hit has.
    fn exact(&self) -> Option<Algebraic> {
        let ray = &self.ray;
        match &self.shape {
            TiedShape::Triangle(corners) => {
                triangle::exact::plane(ray, corners).map(Algebraic::Quotient)
            }
            TiedShape::Disk(Disk { center, normal, .. }) => {
                Quotient::at_plane(ray, &exact(*normal), *center).map(Algebraic::Quotient)
            }
            TiedShape::Sphere(center, radius, is_second) => {
                let [near, far] = sphere::roots(ray, *center, *radius)?;
                let is_near = !is_second
                    && near.is_within([ray.t_min, ray.t_max])
                    && near.rounded() == self.hit.t;
                Some(Algebraic::Root(if is_near { near } else { far }))
            }
        }
    }
}

impl TiedShape {
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
