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
    fn any(numbers: &mut Numbers) -> Self {
        let center = (numbers.direction() * numbers.magnitude(1e-3, 1e3)).as_vec3();
        let radius = numbers.magnitude(1e-3, 1e3) as f32;
        Self { center: center.as_dvec3(), radius: f64::from(radius) }
    }

    fn is_around(&self, point: Vec3) -> bool {
        point.as_dvec3().distance(self.center) < self.radius
    }

    /// The t of the first hit; `None` if the ray passes near the edge, where rounding counts.
    fn meets(&self, ray: &Ray) -> Option<f64> {
        let d = ray.direction.as_dvec3();
        let to_center = self.center - ray.origin.as_dvec3();
        let impact = to_center.cross(d).length() / d.length();
        let nearest = to_center.dot(d) / d.length_squared();
        let half = (self.radius * self.radius - impact * impact).sqrt() / d.length();
        let t = if self.is_around(ray.origin) { nearest + half } else { nearest - half };
        (impact <= 0.99 * self.radius).then_some(t)
    }

    /// A ray that passes the centre at `impact` radii, from `distance` radii away.
    fn passed(&self, numbers: &mut Numbers, impact: f64, distance: f64) -> Ray {
        let along = numbers.direction();
        let across = along.cross(numbers.direction()).normalize();
        let from = self.center + (across * impact - along * distance) * self.radius;
        let length = numbers.magnitude(1e-3, 1e3);
        Ray::new(from.as_vec3(), (along * length).as_vec3())
    }

    /// The sphere with rays at it.
    fn world(
        self,
        aim: impl Fn(&mut Numbers, Self) -> Option<(Ray, ExpectedHit)> + Send + Sync + 'static,
    ) -> World {
        let sphere = Quadric::Sphere(self.center.as_vec3(), self.radius as f32);
        let geometry = Geometry { quadrics: vec![sphere], ..Geometry::default() };
        World::new(geometry, move |numbers| aim(numbers, self))
    }
}

/// Case 13.
pub(super) fn far_away(numbers: &mut Numbers) -> World {
    DoubleSphere::any(numbers).world(|numbers, sphere| {
        let (impact, distance) = (numbers.one(), numbers.magnitude(2.0, 1e5));
        let ray = sphere.passed(numbers, impact, distance);
        let t = sphere.meets(&ray)?;
        Some((ray, ExpectedHit::near(t, 4.0 * ulp(t))))
    })
}

/// Case 14. Rounding may put the origin below the surface, where the ray meets the far side.
pub(super) fn from_just_above(numbers: &mut Numbers) -> World {
    let radius = f64::from(numbers.magnitude(1.0, 1e6) as f32);
    DoubleSphere { center: DVec3::ZERO, radius }.world(|numbers, sphere| {
        let up = numbers.direction();
        let origin = (up * (sphere.radius + numbers.magnitude(1e-6, 1.0))).as_vec3();
        // Downward, with at most the same amount sideways.
        let aside = up.cross(numbers.direction()) * numbers.one();
        let ray = Ray::new(origin, (aside - up).as_vec3());
        let (t, length) = (sphere.meets(&ray)?, f64::from(ray.direction.length()));
        let largest = (t * length).max(sphere.radius);
        Some((ray, ExpectedHit::near(t, 4.0 * ulp(largest) / length)))
    })
}

/// Case 15.
pub(super) fn grazing(numbers: &mut Numbers) -> World {
    DoubleSphere::any(numbers).world(|numbers, sphere| {
        let (impact, distance) = (1.0 + numbers.about(1e-6), numbers.magnitude(2.0, 100.0));
        let t = [f64::MIN_POSITIVE, f64::MAX];
        let expected = ExpectedHit { or_nothing: true, t, ..ExpectedHit::ANYTHING };
        Some((sphere.passed(numbers, impact, distance), expected))
    })
}

/// Case 16.
pub(super) fn from_inside(numbers: &mut Numbers) -> World {
    DoubleSphere::any(numbers).world(|numbers, sphere| {
        // One in four from the exact centre.
        let away = if numbers.once_in(4) { 0.0 } else { 0.999 * numbers.one() };
        let origin = (sphere.center + numbers.direction() * (away * sphere.radius)).as_vec3();
        let length = numbers.magnitude(1e-3, 1e3);
        let ray = Ray::new(origin, (numbers.direction() * length).as_vec3());
        let off = 4.0 * ulp(sphere.radius) / f64::from(ray.direction.length());
        let expected = ExpectedHit::near(sphere.meets(&ray)?, off);
        // Rounding can move the origin out of a sphere far smaller than its distance from zero.
        sphere.is_around(origin).then_some((ray, expected))
    })
}
