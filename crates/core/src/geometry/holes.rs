//! Hits within the holes of cut-outs.

use super::cutouts::Cutout;
use super::{Geometry, Primitive, Quadric};
use crate::counters::TestCounts;
use crate::kernels::{Arithmetic, UvMap, quad, surface, texture, triangle};
use crate::math::float::normalize;
use crate::math::{Line, Ray, Vector};

impl Geometry {
    /// The t at which the ray, which meets the primitive at `t`, hits it: that, unless it is in a hole, or
    /// the next one.
    #[inline(always)]
    pub(crate) fn behind_holes<P: Arithmetic>(
        &self,
        number: u32,
        ray: &Ray,
        t: f32,
        tests: &mut TestCounts,
    ) -> Option<f32> {
        let is_hole = |t: f32, tests: &mut _| self.is_hole::<P>(number, ray, t, tests);
        if !is_hole(t, tests) {
            return Some(t);
        }
        let next = match self.primitive(number) {
            Primitive::Quadric(i) => self.quadrics[i].crossings::<P>(ray)[1],
            Primitive::Quad(i) => {
                let halves = quad::halves(&self.quad(i)).map(|half| triangle::meet(ray, &half));
                halves.into_iter().flatten().find(|next| *next > t)
            }
            Primitive::Triangle(_) | Primitive::Instanced(_) => None,
        };
        next.filter(|&next| next > t && !is_hole(next, tests))
    }

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
        !self.cutouts.is_empty() && self.cutout(number).is_some_and(is_hole)
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
        let found = self.uv_at::<P>(cutout, number, ray, t);
        found.is_some_and(|(uv, alpha)| cutout.is_hole(uv, alpha))
    }

    /// The texture coordinates at which a ray meets a primitive at t, if there are any, and the alpha of
    /// vertex colours there.
    #[inline(always)]
    fn uv_at<P: Arithmetic>(
        &self,
        cutout: &Cutout,
        number: u32,
        ray: &Ray,
        t: f32,
    ) -> Option<([f32; 2], f32)> {
        let corners = match self.primitive(number) {
            Primitive::Triangle(i) => self.triangle(i).map(Vector::from),
            Primitive::Quad(i) => {
                let corners = self.quad(i).map(Vector::from);
                surface::quad_halves(&Line::from(ray), t, &corners, 1)
            }
            Primitive::Quadric(i) => {
                return Some((quadric_uv::<P>(&self.quadrics[i], &cutout.map, ray, t)?, 1.0));
            }
            Primitive::Instanced(_) => return None,
        };
        let found = surface::triangle_at::<f32, P>(&Line::from(ray), t, &corners);
        if let UvMap::Planar(map) = &cutout.map {
            return Some((map.uv(found.point), 1.0));
        }
        let mesh = cutout.mesh.as_ref()?;
        let positions = self.triangles.get(number as usize)?;
        let positions = positions.map(|vertex| vertex - mesh.first_position);
        let triangle = (number - mesh.first_triangle) as usize;
        let [y, z] = found.barycentric;
        let mut alpha = 1.0;
        if let Some(alphas) = &mesh.alphas {
            let [a, b, c] = alphas.corners(triangle, positions).unwrap_or([1.0; 3]);
            alpha = a * (1.0 - y - z) + b * y + c * z;
        }
        let uv = match mesh.uvs.corners(triangle, positions) {
            Some([a, b, c]) => (a * (1.0 - y - z) + b * y + c * z).to_array(),
            None if cutout.image.is_none() => [0.0; 2],
            None => return None,
        };
        Some((uv, alpha))
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
