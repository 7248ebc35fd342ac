//! Spheres that are far away, huge, grazed, or around the ray's origin.

use super::prelude::*;
use wavecrest_core::geometry::Quadric;

/// A sphere, in double precision.
#[derive(Clone, Copy)]
struct DoubleSphere {
    center: DVec3,
    radius: f64,
}

impl DoubleSphere {
    /// A random one not far from the origin.
    fn any(rng: &mut InputRng) -> Self {
        let center = (rng.direction() * rng.magnitude(1e-3, 1e3)).as_vec3();
        let radius = rng.magnitude(1e-3, 1e3) as f32;
        Self { center: center.as_dvec3(), radius: f64::from(radius) }
    }

    /// A ray that passes the centre at `impact` radii, from `distance` radii away.
    fn passed(&self, rng: &mut InputRng, impact: f64, distance: f64) -> Ray {
        let along = rng.direction();
        let across = along.cross(rng.direction()).normalize();
        let from = self.center + (across * impact - along * distance) * self.radius;
        let length = rng.magnitude(1e-3, 1e3);
        Ray::new(from.as_vec3(), (along * length).as_vec3())
    }

    /// The sphere with rays at it.
    fn world(
        self,
        is_met: Option<bool>,
        aim: impl Fn(&mut InputRng, Self) -> Option<Ray> + Send + Sync + 'static,
    ) -> World {
        let sphere = Quadric::Sphere(self.center.as_vec3(), self.radius as f32);
        let geometry = Geometry { quadrics: vec![sphere], ..Geometry::default() };
        World::new(geometry, is_met, move |rng| aim(rng, self))
    }
}

/// Case 13.
pub(super) fn far_away(rng: &mut InputRng) -> World {
    DoubleSphere::any(rng).world(ALL_HIT, |rng, sphere| {
        let (impact, distance) = (0.98 * rng.one(), rng.magnitude(2.0, 1e5));
        Some(sphere.passed(rng, impact, distance))
    })
}

/// Case 14. Rounding may put the origin below the surface, where the ray meets the far side.
pub(super) fn from_just_above(rng: &mut InputRng) -> World {
    let radius = f64::from(rng.magnitude(1.0, 1e6) as f32);
    DoubleSphere { center: DVec3::ZERO, radius }.world(MIXED, |rng, sphere| {
        let up = rng.direction();
        let origin = (up * (sphere.radius + rng.magnitude(1e-6, 1.0))).as_vec3();
        // Downward, with at most the same amount sideways.
        let aside = up.cross(rng.direction()) * rng.one();
        Some(Ray::new(origin, (aside - up).as_vec3()))
    })
}

/// Case 15.
pub(super) fn grazing(rng: &mut InputRng) -> World {
    DoubleSphere::any(rng).world(MIXED, |rng, sphere| {
        let (impact, distance) = (1.0 + rng.about(1e-6), rng.magnitude(2.0, 100.0));
        Some(sphere.passed(rng, impact, distance))
    })
}

/// Case 16.
pub(super) fn from_inside(rng: &mut InputRng) -> World {
    DoubleSphere::any(rng).world(ALL_HIT, |rng, sphere| {
        // One in four from the exact centre.
        let away = if rng.once_in(4) { 0.0 } else { 0.999 * rng.one() };
        let origin = (sphere.center + rng.direction() * (away * sphere.radius)).as_vec3();
        let length = rng.magnitude(1e-3, 1e3);
        let ray = Ray::new(origin, (rng.direction() * length).as_vec3());
        // Rounding can move the origin out of a sphere far smaller than its distance from zero.
        (origin.as_dvec3().distance(sphere.center) < sphere.radius).then_some(ray)
    })
}
