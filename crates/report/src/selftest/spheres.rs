//! Spheres that are far away, huge, grazed, or around the ray's origin.

use super::prelude::*;

/// A sphere, as the tests have it.
#[derive(Clone, Copy)]
struct Sphere {
    center: Vec3,
    radius: f32,
}

impl Sphere {
    /// A random one not far from the origin.
    fn any(numbers: &mut Numbers) -> Self {
        let center = numbers.direction() * numbers.magnitude(1e-3, 1e3);
        Self { center: center.as_vec3(), radius: numbers.magnitude(1e-3, 1e3) as f32 }
    }

    /// The distance of the line of `ray` from the centre, in radii.
    fn impact(&self, ray: &Ray) -> f64 {
        let d = ray.direction.as_dvec3();
        let across = (ray.origin.as_dvec3() - self.center.as_dvec3()).cross(d);
        across.length() / (d.length() * f64::from(self.radius))
    }

    /// The distance of the ray at `t` outside the sphere; negative inside.
    fn height(&self, ray: &Ray, t: f64) -> f64 {
        let p = ray.origin.as_dvec3() + ray.direction.as_dvec3() * t;
        p.distance(self.center.as_dvec3()) - f64::from(self.radius)
    }

    /// The t of the first hit, between `low` and `high`, by bisection.
    fn meets(&self, ray: &Ray, mut low: f64, mut high: f64) -> f64 {
        let is_outside = self.height(ray, low) > 0.0;
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if (self.height(ray, middle) > 0.0) == is_outside {
                low = middle
            } else {
                high = middle
            }
        }
        0.5 * (low + high)
    }

    /// The t at which the ray is nearest to the centre.
    fn nearest(&self, ray: &Ray) -> f64 {
        let d = ray.direction.as_dvec3();
        (self.center.as_dvec3() - ray.origin.as_dvec3()).dot(d) / d.length_squared()
    }

    /// A ray that passes the centre at `impact` radii, from `distance` radii away.
    fn passed(&self, numbers: &mut Numbers, impact: f64, distance: f64) -> Ray {
        let along = numbers.direction();
        let across = along.cross(numbers.direction()).normalize();
        let radius = f64::from(self.radius);
        let from = self.center.as_dvec3() + (across * impact - along * distance) * radius;
        let length = numbers.magnitude(1e-3, 1e3);
        Ray::new(from.as_vec3(), (along * length).as_vec3())
    }

    /// The sphere with rays at it.
    fn world(
        self,
        aim: impl Fn(&mut Numbers, Self) -> Option<(Ray, Expected)> + Send + Sync + 'static,
    ) -> World {
        let geometry =
            Geometry { spheres: vec![(self.center, self.radius)], ..Geometry::default() };
        World::new(geometry, &[Preset::VeryFast], move |numbers| aim(numbers, self))
    }
}

/// One ulp in single precision at `size`.
fn ulp(size: f64) -> f64 {
    let size = size as f32;
    f64::from(size.next_up()) - f64::from(size)
}

/// The ray, if it passes clear of the edge of the sphere after rounding, with margin for the
/// rounding of double precision.
fn clear(
    sphere: &Sphere,
    ray: Ray,
    expected: impl FnOnce(&Ray) -> Expected,
) -> Option<(Ray, Expected)> {
    (sphere.impact(&ray) <= 0.99).then(|| (ray, expected(&ray)))
}

/// Case 13.
pub(super) fn far_away(numbers: &mut Numbers) -> World {
    Sphere::any(numbers).world(|numbers, sphere| {
        let (impact, distance) = (numbers.one(), numbers.magnitude(2.0, 1e5));
        clear(&sphere, sphere.passed(numbers, impact, distance), |ray| {
            let t = sphere.meets(ray, 0.0, sphere.nearest(ray));
            Expected::near(t, 4.0 * ulp(t))
        })
    })
}

/// Case 14.
pub(super) fn from_just_above(numbers: &mut Numbers) -> World {
    let sphere = Sphere { center: Vec3::ZERO, radius: numbers.magnitude(1.0, 1e6) as f32 };
    sphere.world(|numbers, sphere| {
        let up = numbers.direction();
        let height = numbers.magnitude(1e-6, 1.0);
        let origin = (up * (f64::from(sphere.radius) + height)).as_vec3();
        // Downward, with at most the same amount sideways.
        let aside = up.cross(numbers.direction()) * numbers.one();
        clear(&sphere, Ray::new(origin, (aside - up).as_vec3()), |ray| {
            let nearest = sphere.nearest(ray);
            // Rounding may have put the origin below the surface, where the ray meets the far side.
            let is_outside = sphere.height(ray, 0.0) > 0.0;
            let [low, high] = if is_outside { [0.0, nearest] } else { [nearest, 3.0 * nearest] };
            let t = sphere.meets(ray, low, high);
            let length = f64::from(ray.direction.length());
            let largest = (t * length).max(f64::from(sphere.radius));
            Expected::near(t, 4.0 * ulp(largest) / length)
        })
    })
}

/// Case 15.
pub(super) fn grazing(numbers: &mut Numbers) -> World {
    let expected = Expected::such(|_, hit| Some(hit.is_miss() || hit.t.is_finite() && hit.t > 0.0));
    Sphere::any(numbers).world(move |numbers, sphere| {
        let (impact, distance) = (1.0 + numbers.about(1e-6), numbers.magnitude(2.0, 100.0));
        Some((sphere.passed(numbers, impact, distance), expected.clone()))
    })
}

/// Case 16.
pub(super) fn from_inside(numbers: &mut Numbers) -> World {
    let sphere = Sphere::any(numbers);
    let expected = Expected::such(move |ray, hit| {
        let off = sphere.height(ray, f64::from(hit.t)).abs();
        Some(off <= 4.0 * ulp(f64::from(sphere.radius)))
    });
    sphere.world(move |numbers, sphere| {
        // One in four from the exact centre.
        let away = if numbers.once_in(4) { 0.0 } else { 0.999 * numbers.one() };
        let from = numbers.direction() * (away * f64::from(sphere.radius));
        let direction: DVec3 = numbers.direction() * numbers.magnitude(1e-3, 1e3);
        let origin = (sphere.center.as_dvec3() + from).as_vec3();
        let ray = Ray::new(origin, direction.as_vec3());
        // Rounding can move the origin out of a sphere far smaller than its distance from zero.
        (sphere.height(&ray, 0.0) < 0.0).then(|| (ray, expected.clone()))
    })
}
