//! The test of a ray and a disk: in single precision against the ball around it, which rejects most,
//! then in double precision with bounds, and where that leaves it open in exact arithmetic.
//!
//! With c the centre, n the normal, r the radius and f = o - c, the line of a ray meets the plane
//! where t = -(n . f) / (n . d), at the offset q = f + t d from the centre, and the closed disk if
//! |q| <= r: exactly, if |f (n . d) - d (n . f)|^2 <= (r (n . d))^2. A ray in the plane meets nothing.
//!
//! # The bound
//!
//! With u the unit roundoff of double precision, n . d is off by at most w = 3 u |n| |d|, and n . f by
//! 5 u |n| |f|. Where |n . d| exceeds 64 w, t is off by e = 1.05 (5 u |n| |f| + w |t|) / |n . d| + 2 u
//! |t|, and the length of q by 2 |d| e + 8 u (|f| + |d| |t|).

use std::cmp::Ordering;

use glam::{DVec3, Vec3};

use super::Arithmetic;
use super::sphere::{Roots, passes_by, settled};
use crate::math::exact::{Comparable, Expansion, Quotient, dot, exact};
use crate::math::float::normalize_f64;
use crate::math::{Line, Mask, Ray, Real, Single, Vector};

/// A disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// The centre, in scene units.
    pub center: Vec3,
    /// The unit normal on its front, rounded once.
    pub normal: Vec3,
    /// The radius, in scene units.
    pub radius: f32,
}

impl Disk {
    /// Two orthogonal unit vectors in its plane, so that with the normal they are right-handed: for a
    /// disk that faces +z those along +x and +y, and for one that faces up those along +x and -z.
    pub fn axes(normal: DVec3) -> [DVec3; 2] {
        let normal = normalize_f64(normal);
        let across = DVec3::Y.cross(normal);
        let along = if across == DVec3::ZERO { DVec3::X } else { normalize_f64(across) };
        [along, normal.cross(along)]
    }

    /// Half the extent of the disk along each axis.
    pub fn half(&self) -> DVec3 {
        let DVec3 { x, y, z } = self.normal.as_dvec3() * self.normal.as_dvec3();
        // Without 1 - x, which would cancel.
        let share = DVec3::new(y + z, z + x, x + y) / (x + y + z);
        share.map(f64::sqrt) * f64::from(self.radius)
    }
}

/// The t within the ray's range at which the ray meets the disk, in exact arithmetic.
#[cold]
#[inline(never)]
pub fn intersect_exactly(ray: &Ray, disk: &Disk) -> Option<f32> {
    let (direction, normal) = (exact(ray.direction), exact(disk.normal));
    let (origin, center) = (exact(ray.origin), exact(disk.center));
    let from = [0, 1, 2].map(|k| &origin[k] - &center[k]);
    let (along, height) = (dot(&normal, &direction), dot(&normal, &from));
    let scaled = [0, 1, 2].map(|k| &(&from[k] * &along) - &(&direction[k] * &height));
    let reach = &along * &Expansion::from(disk.radius);
    if (&dot(&scaled, &scaled) - &(&reach * &reach)).sign() == Ordering::Greater {
        return None;
    }
    let t = Quotient::new(-height, along)?;
    t.is_within([ray.t_min, ray.t_max]).then(|| t.rounded())
}

/// A disk in each lane, and from it the vectors to the origins of lines, in double precision.
struct Plane<D: Real> {
    normal: Vector<D>,
    direction: Vector<D>,
    from: Vector<D>,
    /// n . d and n . f.
    along: D,
    height: D,
}

impl<D: Real<Element = f64>> Plane<D> {
    #[inline(always)]
    fn new<F: Single<Double = D>>(line: &Line<F>, center: Vector<F>, normal: Vector<F>) -> Self {
        let (normal, direction) = (normal.widen(), line.direction.widen());
        let from = line.origin.widen() - center.widen();
        Self { normal, direction, from, along: normal.dot(direction), height: normal.dot(from) }
    }

    /// Where lines meet a disk of this `radius`: once.
    #[inline(always)]
    fn roots(&self, radius: D) -> Roots<D> {
        const U: f64 = f64::EPSILON / 2.0;
        let length = |v: Vector<D>| v.dot(v).sqrt();
        let (n, d, f) = (length(self.normal), length(self.direction), length(self.from));
        let t = -self.height / self.along;
        let w = (n * d).times(3.0 * U);
        let error = ((n * f).times(5.0 * U) + w * t.abs()).times(1.05) / self.along.abs()
            + t.abs().times(2.0 * U);
        let distance = length(self.from + self.direction.scale(t));
        let aside = (d * error).times(2.0) + (f + d * t.abs()).times(8.0 * U);
        let is_sound = self.along.abs().gt(w.times(64.0));
        Roots {
            near: t,
            near_error: error,
            far: t,
            far_error: error,
            known: is_sound & (distance + aside).lt(radius),
            miss: is_sound & (distance - aside).gt(radius),
        }
    }
}

/// Bounds on the t at which a ray meets a disk; comparisons with unknown ones are false.
pub(crate) fn interval(ray: &Ray, disk: &Disk) -> [f64; 2] {
    let plane = Plane::new(&Line::<f32>::from(ray), disk.center.into(), disk.normal.into());
    plane.roots(f64::from(disk.radius)).interval()
}

/// The offsets from the centre at which lines meet disks: at `t`, where double precision does not
/// find it. The offsets lie in the plane up to the rounding of double precision.
#[inline(always)]
pub(super) fn offset<F: Single>(
    line: &Line<F>,
    t: F,
    center: Vector<F>,
    normal: Vector<F>,
) -> Vector<F::Double> {
    let plane = Plane::new(line, center, normal);
    let own = -plane.height / plane.along;
    let t = t.widen();
    let near = (own - t).abs().le(t.abs().times(f64::from(f32::EPSILON)));
    let offset = plane.from + plane.direction.scale(Real::select(near, own, t));
    let normal = plane.normal;
    offset - normal.scale(normal.dot(offset) / normal.dot(normal))
}

/// The t within (`t_min`, `t_max`) at which each ray meets the disk, and the lanes that hit.
#[inline(always)]
pub fn meet<F: Single, P: Arithmetic>(line: &Line<F>, disk: &Disk, range: [F; 2]) -> (F, F::Mask) {
    let token = range[0].token();
    let (center, normal) = (Vector::splat(token, disk.center), Vector::splat(token, disk.normal));
    let radius = F::splat(token, disk.radius);
    if P::IS_FAST {
        let from = line.origin - center;
        let t = -normal.dot_in_order(from) / normal.dot_in_order(line.direction);
        let offset = from + line.direction.scale(t);
        let is_near = offset.dot_in_order(offset).le(radius * radius);
        return (t, is_near & t.gt(range[0]) & t.lt(range[1]));
    }
    let passes = passes_by(line, center, radius);
    if !(!passes).any() {
        return (range[1], !passes);
    }
    let roots = Plane::new(line, center, normal).roots(radius.widen());
    settled(line, &roots, range, |ray| intersect_exactly(ray, disk))
}
