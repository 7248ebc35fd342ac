//! Triangle edges as lines of constant width in pixels.
//!
//! The distance of a point from an edge in pixels follows from its distance in the scene, and from
//! its change between pixels, the ray's differential. So nothing is projected, and edges behind the
//! camera need no care.

use glam::Vec3;

use crate::camera_rays::Gather;
use wavecrest_core::accel::Hit;
use wavecrest_core::geometry::Primitive;
use wavecrest_core::kernels::precision::Arithmetic;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::prepared::PreparedScene;

/// Half the width of a line in pixels: each side of an edge draws its half.
const HALF_WIDTH: f32 = 0.6;
/// A line fades over one pixel, half of it on either side of its border.
const BORDER: f32 = 0.5;
/// Triangles with a smaller height in pixels have fainter lines, so that fine meshes are not black.
const FAINT_BELOW: f32 = 6.0;

/// Draws edges: sums the coverage of a pixel's samples by lines.
pub(super) struct Wires<'a> {
    pub(super) scene: &'a PreparedScene,
}

impl Gather for Wires<'_> {
    type Sums = f64;

    fn add<P: Arithmetic>(&self, ray: &Ray, hit: &Hit, _: bool, sums: &mut f64) {
        if !hit.is_miss() {
            *sums += f64::from(self.covered(ray, hit));
        }
    }
}

impl Wires<'_> {
    /// The coverage of the hit by a line, from 0 to 1.
    fn covered(&self, ray: &Ray, hit: &Hit) -> f32 {
        let geometry = self.scene.accel.geometry();
        if let Some(corners) = geometry.mesh_triangle(hit.primitive) {
            return self.line(ray, hit.t, &corners);
        }
        match geometry.primitive(hit.primitive) {
            // A quad has four edges; its diagonal is not one.
            Primitive::Quad(index) => self.line(ray, hit.t, &geometry.quad(index)),
            _ => 0.0,
        }
    }

    /// The same for the polygon with these corners.
    fn line(&self, ray: &Ray, t: f32, corners: &[Vec3]) -> f32 {
        let [a, b, c] = [corners[0], corners[1], corners[2]];
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return 0.0 };
        let steps = self.scene.camera.differential(ray.direction).at(ray, t, normal);
        let point = ray.origin + ray.direction * t;
        let ends = |i: usize| (corners[i], corners[(i + 1) % corners.len()]);
        let (mut nearest, mut lowest) = (f32::INFINITY, f32::INFINITY);
        for i in 0..corners.len() {
            let (from, to) = ends(i);
            let across = (to - from).cross(normal).normalize_or_zero();
            let step = steps.map(|step| step.dot(across));
            let a_pixel = step[0].hypot(step[1]);
            if a_pixel > 0.0 {
                let (_, beyond) = ends((i + 1) % corners.len());
                nearest = nearest.min((point - from).dot(across).abs() / a_pixel);
                lowest = lowest.min((beyond - from).dot(across).abs() / a_pixel);
            }
        }
        let covered = (HALF_WIDTH + BORDER - nearest).clamp(0.0, 1.0);
        covered * (lowest / FAINT_BELOW).min(1.0)
    }
}
