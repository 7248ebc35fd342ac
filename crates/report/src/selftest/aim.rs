//! Rays at any geometry: from where, at what, and the surface that is there.

use super::prelude::*;
use wavecrest_core::accel::Traversal;
use wavecrest_core::geometry::Primitive;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::kernels::surface::SurfacePoint;
use wavecrest_core::prepared::surface;
use wavecrest_core::with_precision;

/// The number of rays: as [`Effort::of`], but 0 without primitives.
pub(super) fn rays(geometry: &Geometry, effort: &Effort, counts: [usize; 2]) -> usize {
    if geometry.is_empty() { 0 } else { effort.of(counts) }
}

/// The centre of a geometry's box, and half of its diagonal.
pub(super) struct BoundingBall {
    middle: DVec3,
    half: f64,
}

/// The box around the primitives of a geometry, without those of instances.
pub(super) fn around(geometry: &Geometry) -> Aabb {
    let own = (0..geometry.own() as u32).map(|number| geometry.bounds(number));
    own.fold(Aabb::EMPTY, Aabb::union)
}

impl BoundingBall {
    pub(super) fn of(geometry: &Geometry) -> Self {
        let of_prototypes: Vec<Aabb> = geometry.prototypes.iter().map(around).collect();
        let instances = geometry.instances.iter();
        let instances = instances.map(|one| one.bounds(&[of_prototypes[one.prototype()]]));
        let all = instances.fold(around(geometry), Aabb::union);
        let (low, high) = (all.low.as_dvec3(), all.high.as_dvec3());
        Self { middle: (low + high) / 2.0, half: (high - low).length() / 2.0 }
    }

    /// A random point around the geometry.
    pub(super) fn around(&self, rng: &mut InputRng) -> Vec3 {
        let direction = rng.direction();
        (self.middle + direction * (self.half * (0.1 + 2.0 * rng.one()))).as_vec3()
    }
}

/// The corners of any primitive. For spheres and disks, points on the surface.
pub(super) fn any_corners(geometry: &Geometry, rng: &mut InputRng) -> [Vec3; 3] {
    let number = rng.below(geometry.len()) as u32;
    match geometry.primitive(number) {
        Primitive::Quad(i) => rng.among(halves(&geometry.quad(i))),
        Primitive::Quadric(i) => {
            let (center, radius, front) = geometry.quadrics[i].parts();
            [(); 3].map(|()| {
                let towards = rng.direction().as_vec3();
                center + (towards - front * front.dot(towards)) * radius
            })
        }
        _ => geometry.mesh_triangle(number).unwrap_or_default(),
    }
}

/// A ray at a point of a primitive, from a random point around them all.
pub(super) fn at_any(geometry: &Geometry, extent: &BoundingBall, rng: &mut InputRng) -> Ray {
    let corners = any_corners(geometry, rng);
    let (target, from) = (rng.within(corners).as_vec3(), extent.around(rng));
    Ray::new(from, normalize(target - from))
}

/// The primitive that a ray meets, and the point, its error and the normal there; see
/// [`surface_at`].
pub(super) fn met(accel: &Accel, ray: &Ray, traversal: &mut Traversal) -> Option<(u32, [Vec3; 3])> {
    let hit = Some(accel.closest(ray, traversal)).filter(|hit| !hit.is_miss())?;
    Some((hit.primitive, surface_at(accel.geometry(), ray, hit)?.vectors()))
}

pub(super) fn is_outside(point: Vec3, (center, radius): (Vec3, f32)) -> bool {
    point.as_dvec3().distance(center.as_dvec3()) > f64::from(radius)
}

/// The greatest angle between the halves of a quad that counts as flat, in radians: more than the roundings of its corners to
/// single precision, of 2^-24, bend one that is 1000 times as long as wide.
const FLAT: f64 = 1e-4;

/// The surface point of a hit; `None` inside of spheres and on quads that are not flat, which a ray
/// can leave and meet again.
pub(super) fn surface_at(geometry: &Geometry, ray: &Ray, hit: Hit) -> Option<SurfacePoint<f32>> {
    let is_left_for_good = match geometry.primitive(hit.primitive) {
        Primitive::Quad(i) => {
            let [p, q] = halves(&geometry.quad(i)).map(|half| {
                let [a, b, c] = half.map(|v| v.as_dvec3());
                (b - a).cross(c - a).normalize()
            });
            p.distance(q) < FLAT
        }
        Primitive::Quadric(i) => {
            let sphere = geometry.quadrics[i].sphere();
            sphere.is_none_or(|sphere| is_outside(ray.origin, sphere))
        }
        Primitive::Triangle(_) | Primitive::Instanced(_) => true,
    };
    let surface = || with_precision!(geometry.precision, P => surface::<P>(geometry, ray, &hit));
    is_left_for_good.then(surface)
}
