//! Whether a light adds more than its ambient part to a surface.
//!
//! A light is skipped only if every hit on every surface certainly rejects it: because the material
//! reflects none of its colour, or because it is behind a surface that is lit from the front only.
//! The light's whole extent counts, as its box, and so do the rounding errors of the shading step.
//! In doubt a light reaches.

use glam::{DVec3, Vec3};

use wavecrest_core::geometry::{Geometry, Primitive};
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::camera::Camera;
use wavecrest_core::kernels::light::{Emitter, Light};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::kernels::{quad, triangle};
use wavecrest_core::math::float::UNIT_ROUNDOFF;
use wavecrest_core::prepared::Shape;

/// How far behind a plane a light must be for all hits to find it there, relative to its distance
/// and the largest coordinate.
///
/// A hit and a point of a light are off by less than 4 roundings of the largest coordinate in each
/// direction (`math::float::rounding_error`); the normal, the direction to the light and their
/// product add fewer than 8 roundings of the distance. This is sixteen times their sum.
const BEHIND: f64 = 256.0 * UNIT_ROUNDOFF as f64;

/// Largest number of primitives tested for all lights together. Beyond them, lights count as
/// reaching: nearly all do, and show it at one of the first.
const MOST_TESTS: u64 = 1 << 22;

/// A surface that does not belong to a light.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// What it is made of.
    pub material: &'a Material,
    /// Whether it may have a texture, of any colour.
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

/// Whether any of the light's colour is reflected: as in the shading step, a product of zero adds
/// nothing.
fn reflects(surface: &Surface<'_>, light: &Light) -> bool {
    let &Material { ks, kd, color, .. } = surface.material;
    // Infinite power adds something, if only a NaN.
    let shines = light.power.cmpgt(Vec3::ZERO);
    let colored = color.cmpgt(Vec3::ZERO) & shines;
    !light.power.is_finite()
        || shines.any() && (ks > 0.0 || kd > 0.0 && (surface.textured || colored.any()))
}

/// Whether any point of the light may be in front of any point of the shape.
pub(super) fn faces(shape: &Shape, light: &Extent, geometry: &Geometry, tests: &mut u64) -> bool {
    // Fast precision has no error bounds, so nothing is certain.
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
        // In doubt: its points have one more rounding.
        Primitive::Instanced(_) => geometry.is_degenerate(number),
        // Triangles without area are not hit.
        Primitive::Triangle(i) => geometry.is_degenerate(number) || behind(&geometry.triangle(i)),
        Primitive::Quad(i) => quad::halves(&geometry.quad(i)).iter().all(behind),
        Primitive::Sphere(i) => {
            let (center, radius) = geometry.spheres[i];
            light.is_within(center, radius)
        }
    }
}

/// The extent of a light: the points within `radius` of a box, or a distant patch.
pub(super) struct Extent {
    /// For a distant light, the unit vector towards it.
    center: DVec3,
    half: DVec3,
    /// For a distant light, the sine of its angular radius.
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
            // The dark part outside a cone counts as reached.
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

    /// The origins of a camera's rays.
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

    /// Bound on the coordinates of its points.
    fn size(&self) -> f64 {
        (self.center.abs() + self.half).max_element() + self.radius
    }

    /// Bound on the distance of its points from `point`.
    fn farthest(&self, point: DVec3) -> f64 {
        ((self.center - point).abs() + self.half).length() + self.radius
    }

    /// Whether all of it is certainly behind a triangle, whose front is on the side of the unit
    /// vector `normal`.
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

    /// Whether all of it is certainly inside a sphere, behind every point of its outside.
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
