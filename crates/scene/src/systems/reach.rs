//! Whether a light can add anything to a surface, besides its ambient part.
//!
//! A light is left out only where every hit on every surface is certain to turn it down: because the
//! material reflects none of its colour, or because it is behind, on a surface whose back lights do not
//! reach. Its whole extent is looked at, as the box around it; and so is the rounding of what the shading
//! step computes. Whatever is in doubt is reached.

use glam::{DVec3, Vec3};

use wavecrest_core::accel::geometry::{Geometry, Primitive};
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::camera::Camera;
use wavecrest_core::kernels::light::{Emitter, Light};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::kernels::{quad, triangle};
use wavecrest_core::math::float::UNIT_ROUNDOFF;
use wavecrest_core::prepared::Shape;

/// How far behind a plane a light must be for all hits to find it there, in parts of its distance and of
/// the largest coordinate.
///
/// A hit and a point of a light are off by less than 4 roundings of the largest coordinate in each
/// direction (`math::float::rounding_error`); the normal, the direction to the light and their product add
/// fewer than 8 roundings of the distance. This is sixteen times as much.
const BEHIND: f64 = 256.0 * UNIT_ROUNDOFF as f64;

/// Primitives that are looked at for all lights together. Beyond them, lights are taken to reach: nearly all
/// do, and show it at one of the first.
const MOST_TESTS: u64 = 1 << 22;

/// A surface that is not a light's.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// What it is made of.
    pub material: &'a Material,
    /// Whether it may wear a texture, which may be of any colour.
    pub textured: bool,
}

/// Whether each of `lights` reaches any of `surfaces`.
pub fn run(lights: &[&Light], surfaces: &[Surface<'_>], geometry: &Geometry) -> Vec<bool> {
    let mut tests = 0;
    let reaches = |light: &&Light| {
        let extent = Extent::of(&light.emitter);
        let mut reflecting = surfaces.iter().filter(|surface| reflects(surface, light));
        reflecting.any(|surface| faces(surface.shape, &extent, geometry, &mut tests))
    };
    lights.iter().map(reaches).collect()
}

/// Whether any of the light's colour comes back: as in the shading step, a product that is zero adds
/// nothing.
fn reflects(surface: &Surface<'_>, light: &Light) -> bool {
    let &Material { ks, kd, color, .. } = surface.material;
    // What is infinite adds something, if only a NaN.
    let shines = light.power.cmpgt(Vec3::ZERO);
    let colored = color.cmpgt(Vec3::ZERO) & shines;
    !light.power.is_finite()
        || shines.any() && (ks > 0.0 || kd > 0.0 && (surface.textured || colored.any()))
}

/// Whether any point of the light may be in front of any point of the shape.
pub(super) fn faces(shape: &Shape, light: &Extent, geometry: &Geometry, tests: &mut u64) -> bool {
    // Fast arithmetic has no bounds on its errors, so that nothing is certain.
    if shape.two_sided || geometry.precision == Precision::Fast {
        return true;
    }
    shape.primitives.clone().any(|number| {
        *tests += 1;
        *tests > MOST_TESTS || !is_behind(shape, light, geometry, number)
    })
}

/// Whether all of the light is certainly behind all of the primitive.
fn is_behind(shape: &Shape, light: &Extent, geometry: &Geometry, number: u32) -> bool {
    let behind = |corners: &[Vec3; 3]| {
        let normal = triangle::normal(corners);
        light.is_behind(if shape.flipped { -normal } else { normal }, corners)
    };
    match geometry.primitive(number) {
        // In doubt: its points are rounded once more than others.
        Primitive::Instanced(_) => geometry.is_degenerate(number),
        // What has no area is not hit.
        Primitive::Triangle(i) => geometry.is_degenerate(number) || behind(&geometry.triangle(i)),
        Primitive::Quad(i) => quad::halves(&geometry.quad(i)).iter().all(behind),
        Primitive::Sphere(i) => {
            let (center, radius) = geometry.spheres[i];
            light.is_within(center, radius)
        }
    }
}

/// Where a light is: the points within `radius` of a box, or infinitely far away.
pub(super) struct Extent {
    /// Of a light that is infinitely far away, of unit length, towards it.
    center: DVec3,
    half: DVec3,
    /// Of such a light, the sine of the angle within which it is.
    radius: f64,
    is_distant: bool,
}

impl Extent {
    fn of(emitter: &Emitter) -> Self {
        let point = |center: Vec3, radius: f32| Self {
            center: center.as_dvec3(),
            half: DVec3::ZERO,
            radius: f64::from(radius),
            is_distant: false,
        };
        match emitter {
            // All that the cone leaves in the dark counts as reached.
            Emitter::Point(position) | Emitter::Spot(position, _) => point(*position, 0.0),
            Emitter::Distant(distant) => Self {
                center: distant.towards(),
                half: DVec3::ZERO,
                radius: distant.spread(),
                is_distant: true,
            },
            Emitter::Sphere { center, radius } => point(*center, *radius),
            Emitter::Triangles(triangles) => {
                let corners = triangles.corners().iter().map(|corners| Aabb::around(*corners));
                Self::of_box(&corners.fold(Aabb::EMPTY, Aabb::union))
            }
        }
    }

    /// Where the rays of a camera start.
    pub(super) fn of_pupil(camera: &Camera) -> Self {
        let (center, radius) = camera.pupil();
        Self { center, half: DVec3::ZERO, radius, is_distant: false }
    }

    /// A box.
    pub(super) fn of_box(bounds: &Aabb) -> Self {
        let (low, high) = (bounds.low.as_dvec3(), bounds.high.as_dvec3());
        let (center, half) = ((low + high) / 2.0, (high - low) / 2.0);
        Self { center, half, radius: 0.0, is_distant: false }
    }

    /// No coordinate of any of its points is larger.
    fn size(&self) -> f64 {
        (self.center.abs() + self.half).max_element() + self.radius
    }

    /// No point of it is farther from `point`.
    fn farthest(&self, point: DVec3) -> f64 {
        ((self.center - point).abs() + self.half).length() + self.radius
    }

    /// Whether all of it is certainly behind a triangle, whose front the unit vector `normal` is on.
    fn is_behind(&self, normal: DVec3, corners: &[Vec3; 3]) -> bool {
        let reach = normal.abs().dot(self.half) + self.radius;
        if self.is_distant {
            return normal.dot(self.center) + reach < -BEHIND;
        }
        corners.iter().map(|corner| corner.as_dvec3()).all(|corner| {
            let height = normal.dot(self.center - corner) + reach;
            let size = self.size().max(corner.abs().max_element());
            height < -BEHIND * (size + self.farthest(corner))
        })
    }

    /// Whether all of it is certainly within a sphere, behind every point of its outside.
    pub(super) fn is_within(&self, center: Vec3, radius: f32) -> bool {
        if self.is_distant {
            return false;
        }
        let (center, radius) = (center.as_dvec3(), f64::from(radius));
        let size = self.size().max(center.abs().max_element() + radius);
        self.farthest(center) - radius < -BEHIND * (size + 2.0 * radius)
    }

    /// Whether all of it is certainly outside a sphere.
    pub(super) fn is_beyond(&self, center: Vec3, radius: f32) -> bool {
        let (center, radius) = (center.as_dvec3(), f64::from(radius));
        let nearest = ((self.center - center).abs() - self.half).max(DVec3::ZERO).length();
        let size = self.size().max(center.abs().max_element() + radius);
        nearest - self.radius - radius > BEHIND * (size + 2.0 * radius)
    }
}

#[cfg(test)]
mod tests;
