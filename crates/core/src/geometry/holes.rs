//! Hits within the holes of cut-outs.

use super::cutouts::Cutout;
use super::{Geometry, Primitive, Quadric};
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
        let is_hole = |cutout: &_| self.is_hole_of::<P>(cutout, number, ray, t, tests);
        !self.cutouts.is_empty() && self.cutouts.of(number).is_some_and(is_hole)
    }

    /// As [`Self::is_hole`], for a primitive with this cut-out.
    #[inline(never)]
    pub(crate) fn is_hole_of<P: Arithmetic>(
        &self,
        cutout: &Cutout,
        number: u32,
        ray: &Ray,
        t: f32,
        tests: &mut TestCounts,
    ) -> bool {
        tests.cutouts += 1;
        // Corners without coordinates have no hole.
        self.uv_at::<P>(cutout, number, ray, t).is_some_and(|uv| cutout.is_hole(uv))
    }

    /// The texture coordinates at which a ray meets a primitive at t, if there are any.
    #[inline(always)]
    fn uv_at<P: Arithmetic>(
        &self,
        cutout: &Cutout,
        number: u32,
        ray: &Ray,
        t: f32,
    ) -> Option<[f32; 2]> {
        let corners = match self.primitive(number) {
            Primitive::Triangle(i) => self.triangle(i).map(Vector::from),
            Primitive::Quad(i) => {
                let corners = self.quad(i).map(Vector::from);
                surface::quad_halves(&Line::from(ray), &corners, 1, |_| *ray)
            }
            Primitive::Quadric(i) => {
                return quadric_uv::<P>(&self.quadrics[i], &cutout.map, ray, t);
            }
            Primitive::Instanced(_) => return None,
        };
        let found = surface::triangle_at::<f32, P>(&Line::from(ray), t, &corners);
        if let UvMap::Planar(map) = &cutout.map {
            return Some(map.uv(found.point));
        }
        let mesh = cutout.mesh.as_ref()?;
        let positions = self.triangles.get(number as usize)?;
        let positions = positions.map(|vertex| vertex - mesh.first_position);
        let triangle = (number - mesh.first_triangle) as usize;
        let [a, b, c] = mesh.uvs.corners(triangle, positions)?;
        let [y, z] = found.barycentric;
        Some((a * (1.0 - y - z) + b * y + c * z).to_array())
    }
}

/// The texture coordinates at which a ray meets a quadric at t.
fn quadric_uv<P: Arithmetic>(
    quadric: &Quadric,
    map: &UvMap,
    ray: &Ray,
    t: f32,
) -> Option<[f32; 2]> {
    match map {
        UvMap::Sphere(to_own) => {
            let origin = ray.origin.as_dvec3() - quadric.parts().0.as_dvec3();
            let outward = origin + ray.direction.as_dvec3() * f64::from(t);
            Some(texture::sphere_uv(normalize(*to_own * outward.as_vec3()).into()))
        }
        UvMap::Planar(map) => {
            let columns = quadric.columns().map(Vector::from);
            let found = surface::quadric_at::<f32, P>(&Line::from(ray), t, &columns);
            Some(map.uv(found.point))
        }
        UvMap::Mesh => None,
    }
}
