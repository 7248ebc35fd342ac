//! Spheres that are far away, huge, grazed, or around the ray's origin.

use glam::{DVec3, Vec3};

use super::case::{Effort, Outcome};
use super::ways::{Numbers, every_way, inputs};
use wavecrest_core::accel::Hit;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::math::ray::Ray;

/// Spheres of a case, with equally many rays each.
const SPHERES: usize = 100;

/// A sphere, as the tests have it.
#[derive(Clone, Copy)]
struct Sphere {
    center: Vec3,
    radius: f32,
}

impl Sphere {
    fn new(center: DVec3, radius: f64) -> Self {
        Self { center: center.as_vec3(), radius: radius as f32 }
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
}

/// Rays of a case.
const RAYS: usize = 1_000_000;

/// Tests `SPHERES` spheres, with rays from `ray` for each. `judge` describes the error of an
/// answer, if any.
fn each_sphere(
    effort: &Effort,
    case: u32,
    sphere: impl Fn(&mut Numbers) -> Sphere,
    ray: impl Fn(&mut Numbers, &Sphere) -> Ray,
    judge: impl Fn(&Sphere, &Ray, Hit) -> Option<String> + Sync,
) -> Outcome {
    let mut outcome = Outcome::default();
    let count = effort.of(RAYS) / SPHERES;
    for s in 0..SPHERES {
        let sphere = sphere(&mut Numbers::new(effort, case, usize::MAX - s));
        let rays: Vec<Ray> = inputs(effort, case, s * count..(s + 1) * count)
            .map(|mut numbers| ray(&mut numbers, &sphere))
            .collect();
        let spheres = vec![(sphere.center, sphere.radius)];
        let accel = effort.accel(Geometry { spheres, ..Geometry::default() }, Preset::VeryFast);
        let context =
            |failure| format!("centre {}, radius {}: {failure}", sphere.center, sphere.radius);
        outcome.add(every_way(accel, &rays, |_, ray, hit| judge(&sphere, ray, hit).map(context)));
    }
    outcome
}

/// One ulp in single precision at `size`.
fn ulp(size: f64) -> f64 {
    let size = size as f32;
    f64::from(size.next_up()) - f64::from(size)
}

/// A random sphere not far from the origin.
fn any_sphere(numbers: &mut Numbers) -> Sphere {
    let center = numbers.direction() * numbers.magnitude(1e-3, 1e3);
    Sphere::new(center, numbers.magnitude(1e-3, 1e3))
}

/// A ray that passes the centre at `impact` radii, from `distance` radii away.
fn passing(numbers: &mut Numbers, sphere: &Sphere, impact: f64, distance: f64) -> Ray {
    let along = numbers.direction();
    let across = along.cross(numbers.direction()).normalize();
    let radius = f64::from(sphere.radius);
    let from = sphere.center.as_dvec3() + (across * impact - along * distance) * radius;
    let length = numbers.magnitude(1e-3, 1e3);
    Ray::new(from.as_vec3(), (along * length).as_vec3())
}

/// Case 13.
pub(super) fn far_away(effort: &Effort) -> Outcome {
    let ray = |numbers: &mut Numbers, sphere: &Sphere| {
        let (impact, distance) = (numbers.one(), numbers.magnitude(2.0, 1e5));
        passing(numbers, sphere, impact, distance)
    };
    each_sphere(effort, 13, any_sphere, ray, |sphere, ray, hit| {
        // The ray after rounding, with margin for the rounding of double precision.
        if sphere.impact(ray) > 0.99 {
            return None;
        }
        let exact = sphere.meets(ray, 0.0, sphere.nearest(ray));
        let is_right = (f64::from(hit.t) - exact).abs() <= 4.0 * ulp(exact);
        (!is_right).then(|| format!("t is {} and not {exact}", hit.t))
    })
}

/// Case 14.
pub(super) fn from_just_above(effort: &Effort) -> Outcome {
    let sphere = |numbers: &mut Numbers| Sphere::new(DVec3::ZERO, numbers.magnitude(1.0, 1e6));
    let ray = |numbers: &mut Numbers, sphere: &Sphere| {
        let up = numbers.direction();
        let height = numbers.magnitude(1e-6, 1.0);
        let origin = (up * (f64::from(sphere.radius) + height)).as_vec3();
        // Downward, with at most the same amount sideways.
        let aside = up.cross(numbers.direction()) * numbers.one();
        Ray::new(origin, (aside - up).as_vec3())
    };
    each_sphere(effort, 14, sphere, ray, |sphere, ray, hit| {
        if sphere.impact(ray) > 0.99 {
            return None;
        }
        let nearest = sphere.nearest(ray);
        // Rounding may have put the origin below the surface, where the ray meets the far side.
        let is_outside = sphere.height(ray, 0.0) > 0.0;
        let (low, high) = if is_outside { (0.0, nearest) } else { (nearest, 3.0 * nearest) };
        let exact = sphere.meets(ray, low, high);
        let length = f64::from(ray.direction.length());
        let bound = 4.0 * ulp((exact * length).max(f64::from(sphere.radius))) / length;
        let is_right = (f64::from(hit.t) - exact).abs() <= bound;
        (!is_right).then(|| format!("t is {} and not {exact}", hit.t))
    })
}

/// Case 15.
pub(super) fn grazing(effort: &Effort) -> Outcome {
    let ray = |numbers: &mut Numbers, sphere: &Sphere| {
        let (impact, distance) = (0.999_999 + 2e-6 * numbers.one(), numbers.magnitude(2.0, 100.0));
        passing(numbers, sphere, impact, distance)
    };
    each_sphere(effort, 15, any_sphere, ray, |_, _, hit| {
        let is_right = hit.is_miss() || (hit.t.is_finite() && hit.t > 0.0);
        (!is_right).then(|| format!("t is {}", hit.t))
    })
}

/// Case 16.
pub(super) fn from_inside(effort: &Effort) -> Outcome {
    let ray = |numbers: &mut Numbers, sphere: &Sphere| {
        // One in four from the exact centre.
        let away = if numbers.below(4) == 0 { 0.0 } else { 0.999 * numbers.one() };
        let from = numbers.direction() * (away * f64::from(sphere.radius));
        let direction = numbers.direction() * numbers.magnitude(1e-3, 1e3);
        Ray::new((sphere.center.as_dvec3() + from).as_vec3(), direction.as_vec3())
    };
    each_sphere(effort, 16, any_sphere, ray, |sphere, ray, hit| {
        if sphere.height(ray, 0.0) >= 0.0 {
            // Rounding moved the origin out of a sphere far smaller than its distance from zero.
            return None;
        }
        let off = sphere.height(ray, f64::from(hit.t)).abs();
        let is_right = off <= 4.0 * ulp(f64::from(sphere.radius));
        (!is_right).then(|| format!("t is {}, which is {off} off the sphere", hit.t))
    })
}
