//! Spheres and disks: primitives that are tested one by one, not in lanes of eight.

use glam::{DVec3, Vec3};

use crate::counters::TestCounts;
use crate::kernels::{Aabb, Arithmetic, Disk, disk, sphere};
use crate::math::{Line, Ray, Single};

/// A sphere or a disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quadric {
    /// The centre and the radius of a sphere, in scene units.
    Sphere(Vec3, f32),
    /// A disk.
    Disk(Disk),
}

impl Quadric {
    /// The centre, the radius, and the normal on the front: zero for a sphere.
    #[inline(always)]
    pub fn parts(&self) -> (Vec3, f32, Vec3) {
        match *self {
            Self::Sphere(center, radius) => (center, radius, Vec3::ZERO),
            Self::Disk(Disk { center, normal, radius }) => (center, radius, normal),
        }
    }

    /// The parts as [`surface::quadric_at`](crate::kernels::surface::quadric_at) takes them.
    #[inline(always)]
    pub fn columns(&self) -> [Vec3; 3] {
        let (center, radius, front) = self.parts();
        [center, Vec3::splat(radius), front]
    }

    /// The centre and the radius, if it is a sphere.
    #[inline(always)]
    pub fn sphere(&self) -> Option<(Vec3, f32)> {
        match *self {
            Self::Sphere(center, radius) => Some((center, radius)),
            Self::Disk(_) => None,
        }
    }

    /// The centre, and half the extent along each axis.
    pub fn extent(&self) -> (DVec3, DVec3) {
        match self {
            Self::Sphere(center, radius) => (center.as_dvec3(), DVec3::splat(f64::from(*radius))),
            Self::Disk(disk) => (disk.center.as_dvec3(), disk.half()),
        }
    }

    /// The box around it, whose ends are computed.
    pub fn bounds(&self) -> Aabb {
        let (center, half) = self.extent();
        // The next number covers the roundings of double precision, too.
        let low = (center - half).to_array().map(|x| (x as f32).next_down());
        let high = (center + half).to_array().map(|x| (x as f32).next_up());
        Aabb { low: low.into(), high: high.into() }
    }

    /// The smallest t within (`t_min`, `t_max`) at which each ray meets it, and the lanes that hit.
    #[inline(always)]
    pub(crate) fn meet<F: Single, P: Arithmetic>(
        &self,
        line: &Line<F>,
        range: [F; 2],
    ) -> (F, F::Mask) {
        match self {
            Self::Sphere(center, radius) => sphere::meet::<F, P>(line, *center, *radius, range),
            Self::Disk(disk) => disk::meet::<F, P>(line, disk, range),
        }
    }

    /// Every t within its range at which the ray crosses it: up to two for a sphere.
    pub(crate) fn crossings<P: Arithmetic>(&self, ray: &Ray) -> [Option<f32>; 2] {
        match self {
            Self::Sphere(center, radius) => sphere::crossings::<P>(ray, *center, *radius),
            Self::Disk(_) => [self.hit::<P>(ray), None],
        }
    }

    /// As [`Self::meet`], for one ray.
    #[inline(always)]
    pub(super) fn hit<P: Arithmetic>(&self, ray: &Ray) -> Option<f32> {
        match self {
            _ if !P::IS_REFERENCE => {
                let range = [ray.t_min, ray.t_max];
                let (t, is_hit) = self.meet::<f32, P>(&Line::from(ray), range);
                is_hit.then_some(t)
            }
            Self::Sphere(center, radius) => sphere::intersect_exactly(ray, *center, *radius),
            Self::Disk(disk) => disk::intersect_exactly(ray, disk),
        }
    }

    /// Counts the tests of `rays` rays.
    #[inline(always)]
    pub(crate) fn count(&self, tests: &mut TestCounts, rays: u32) {
        match self {
            Self::Sphere(..) => tests.primitives.spheres += u64::from(rays),
            Self::Disk(_) => tests.primitives.disks += u64::from(rays),
        }
    }
}
