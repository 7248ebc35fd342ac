//! Hits within the holes of cut-outs.

use glam::Vec3;

use super::{Geometry, Primitive};
use crate::counters::TestCounts;
use crate::kernels::precision::Arithmetic;
use crate::kernels::surface;
use crate::kernels::texture::{self, UvMap};
use crate::math::float::normalize;
use crate::math::ray::Ray;
use crate::math::vector::{Line, Vector};

impl Geometry {
    /// Whether the ray, which meets the primitive at t, passes through a hole.
    #[inline(always)]
    pub(crate) fn is_hole<P: Arithmetic>(
        &self,
        number: u32,
        ray: &Ray,
        t: f32,
        tests: &mut TestCounts,
    ) -> bool {
        !self.cutouts.is_empty() && self.passes_hole::<P>(number, ray, t, tests)
    }

    /// As [`Self::is_hole`], for a scene that has cut-outs.
    #[cold]
    #[inline(never)]
    fn passes_hole<P: Arithmetic>(
        &self,
        number: u32,
        ray: &Ray,
        t: f32,
        tests: &mut TestCounts,
    ) -> bool {
        let Some(cutout) = self.cutouts.of(number) else { return false };
        tests.cutouts += 1;
        let line = Line::from(ray);
        let surface_of = |corners: [Vec3; 3]| {
            surface::triangle_at::<f32, P>(&line, t, &corners.map(Vector::from))
        };
        let uv = match (self.primitive(number), &cutout.map, &cutout.mesh) {
            (Primitive::Triangle(i), UvMap::Mesh, Some(mesh)) => {
                let positions = self.triangles[i].map(|vertex| vertex - mesh.first_position);
                let triangle = (number - mesh.first_triangle) as usize;
                // Corners without coordinates have no hole.
                let Some([a, b, c]) = mesh.uvs.corners(triangle, positions) else { return false };
                let [y, z] = surface_of(self.triangle(i)).barycentric;
                (a * (1.0 - y - z) + b * y + c * z).to_array()
            }
            (Primitive::Triangle(i), UvMap::Planar(map), _) => {
                map.uv(surface_of(self.triangle(i)).point)
            }
            (Primitive::Quad(i), UvMap::Planar(map), _) => {
                map.uv(surface_of(surface::quad_half(ray, &self.quad(i))).point)
            }
            (Primitive::Quadric(i), map, _) => match map {
                UvMap::Sphere(to_own) => {
                    let origin = ray.origin.as_dvec3() - self.quadrics[i].parts().0.as_dvec3();
                    let outward = origin + ray.direction.as_dvec3() * f64::from(t);
                    texture::sphere_uv(normalize(*to_own * outward.as_vec3()).into())
                }
                UvMap::Planar(map) => {
                    let columns = self.quadrics[i].columns().map(Vector::from);
                    map.uv(surface::quadric_at::<f32, P>(&line, t, &columns).point)
                }
                UvMap::Mesh => return false,
            },
            _ => return false,
        };
        cutout.is_hole(uv)
    }
}
