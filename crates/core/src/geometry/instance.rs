//! Instances: meshes that are stored once and shown many times.
//!
//! An instance has no triangles of its own. A ray that may meet it is transformed into the space of
//! its prototype, where it keeps its t, and is searched there. Primitives of instances have numbers
//! like others: each instance has a range as long as its prototype's list of triangles, behind the
//! scene's own.
//!
//! # The bound
//!
//! Transforms are applied in double precision and rounded once, with unit roundoff u. With M the
//! matrix to the world, T its translation, o and o' the origin of the ray in both spaces, and S the
//! largest coordinate of the prototype, a point of the transformed ray near the prototype is off by
//! at most 4 u (S + |o'|): one rounding of the origin, and one of the direction over the distance
//! from there. The test in the prototype's space is off by [`PADDING`] (S + |o'|), so the sum of
//! both is below twice that.
//!
//! In maximum norms |o'| is at most |M^-1| (|o| + |T|). In world space that is |M| times as much.
//! The part that is independent of the ray is added to the instance's box once; the rest is
//! [`Instance::widening`] times the |o| by which the origin of a ray is moved for every other box
//! too.

use glam::{DAffine3, DVec3, Vec3, Vec4};

use crate::kernels::slab::PADDING;
use crate::kernels::{Aabb, SurfacePoint};
use crate::math::Ray;
use crate::math::float::{UNIT_ROUNDOFF, max_abs, normalize_f64};

/// An instance of a prototype.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The prototype's index.
    prototype: u32,
    /// The number of its first primitive.
    first: u32,
    to_world: DAffine3,
    to_prototype: DAffine3,
    /// Additional error bound of points of its surface in the world, for each coordinate, on top of
    /// their error in the prototype's space.
    error: Vec3,
}

/// A primitive of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instanced {
    /// Index of the instance.
    pub instance: u32,
    /// Index of the triangle in its prototype.
    pub triangle: u32,
}

impl Instance {
    /// An instance of prototype number `prototype`, whose coordinates lie in `bounds`, transformed
    /// by `to_world`; its primitives start with the number `first`.
    pub fn new(prototype: u32, first: u32, to_world: DAffine3, bounds: &Aabb) -> Self {
        let to_prototype = to_world.inverse();
        let farthest = bounds.low.abs().max(bounds.high.abs()).as_dvec3();
        // One rounding of the point itself in the prototype's space, and one of the origin of
        // the next ray.
        let error = rows(&to_world).map(|row| 2.0 * f64::from(UNIT_ROUNDOFF) * row.dot(farthest));
        Self { prototype, first, to_world, to_prototype, error: DVec3::from_array(error).as_vec3() }
    }

    /// The prototype's index.
    #[inline]
    pub fn prototype(&self) -> usize {
        self.prototype as usize
    }

    /// The number of its first primitive.
    #[inline]
    pub fn first(&self) -> u32 {
        self.first
    }

    /// The transform from the prototype's space to the world.
    pub fn to_world(&self) -> &DAffine3 {
        &self.to_world
    }

    /// `ray` in the prototype's space, with the same t.
    #[inline]
    pub fn carried(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.to_prototype.transform_point3(ray.origin.as_dvec3()).as_vec3(),
            direction: self.to_prototype.transform_vector3(ray.direction.as_dvec3()).as_vec3(),
            ..*ray
        }
    }

    /// A point of the prototype, in the world.
    #[inline]
    pub fn point(&self, point: Vec3) -> Vec3 {
        self.to_world.transform_point3(point.as_dvec3()).as_vec3()
    }

    /// A unit normal of the prototype, in the world. It stays on the side given by the winding:
    /// mirroring reverses the winding, and the normal with it.
    #[inline]
    pub fn normal(&self, normal: Vec3) -> Vec3 {
        let [x, y, z] = cofactors(&self.to_world);
        let n = normal.as_dvec3();
        normalize_f64(x * n.x + y * n.y + z * n.z).as_vec3()
    }

    /// A shading normal of the prototype, in the world, of unit length, on the same side of the
    /// surface.
    #[inline]
    pub fn shading_normal(&self, normal: Vec3) -> Vec3 {
        let turned = self.normal(normal);
        if self.is_mirrored() { -turned } else { turned }
    }

    /// A unit tangent of the prototype, in the world, with its sign, which keeps the bitangent on
    /// the same side of the surface.
    pub fn tangent(&self, tangent: Vec4) -> Vec4 {
        let along = self.to_world.transform_vector3(tangent.truncate().as_dvec3());
        let sign = if self.is_mirrored() { -tangent.w } else { tangent.w };
        normalize_f64(along).as_vec3().extend(sign)
    }

    /// Whether the transform reverses the winding.
    #[inline]
    fn is_mirrored(&self) -> bool {
        self.to_world.matrix3.determinant() < 0.0
    }

    /// A point of the prototype's surface, in the world, with its error bound.
    #[inline]
    pub fn surface(&self, surface: &SurfacePoint<f32>) -> SurfacePoint<f32> {
        let point = Vec3::from(surface.point).as_dvec3();
        let point = self.to_world.transform_point3(point).as_vec3();
        let error = Vec3::from(surface.error).as_dvec3();
        let carried = rows(&self.to_world).map(|row| row.dot(error));
        // Rounding the sum down by an ulp is far less than the margin given to the origin of the
        // next ray.
        let rounded = 2.0 * UNIT_ROUNDOFF * point.abs();
        let error = DVec3::from_array(carried).as_vec3() + self.error + rounded;
        let normal = self.normal(surface.normal.into()).into();
        let barycentric = surface.barycentric;
        SurfacePoint { point: point.into(), error: error.into(), normal, barycentric }
    }

    /// The padded box around the prototype, which lies in `boxes`, for rays that start at the
    /// origin.
    pub fn bounds(&self, boxes: &[Aabb]) -> Aabb {
        let mut world = Aabb::EMPTY;
        let mut size = 0.0;
        for bounds in boxes {
            // The smallest box in the world around this box of the prototype.
            let (low, high) = (bounds.low.as_dvec3(), bounds.high.as_dvec3());
            let center = self.to_world.transform_point3((low + high) / 2.0);
            let half = rows(&self.to_world).map(|row| row.dot((high - low) / 2.0));
            let half = DVec3::from_array(half);
            let (low, high) = ((center - half).as_vec3(), (center + half).as_vec3());
            world = world.union(Aabb { low, high });
            size = f64::max(size, f64::from(max_abs(bounds.low).max(max_abs(bounds.high))));
        }
        let far = norm(&self.to_prototype) * self.to_world.translation.abs().max_element();
        let pad = 2.0 * f64::from(PADDING) * norm(&self.to_world) * (size + far);
        let pad = (pad * GENEROUS) as f32 + PADDING * max_abs(world.low).max(max_abs(world.high));
        Aabb { low: world.low - pad, high: world.high + pad }
    }

    /// The factor, relative to other boxes, by which the origin of a ray is moved for the
    /// instance's box.
    pub fn widening(&self) -> f32 {
        (2.0 * GENEROUS * norm(&self.to_world) * norm(&self.to_prototype)).max(1.0) as f32
    }
}

/// For the roundings of the bounds themselves.
const GENEROUS: f64 = 1.0 + 1.0 / 1024.0;

/// The absolute values of the rows of the matrix.
#[inline]
fn rows(transform: &DAffine3) -> [DVec3; 3] {
    let m = &transform.matrix3;
    [0, 1, 2].map(|i| m.row(i).abs())
}

/// The largest factor by which the maximum norm of a vector can grow.
fn norm(transform: &DAffine3) -> f64 {
    rows(transform).into_iter().map(|row| row.element_sum()).fold(0.0, f64::max)
}

/// The columns of the matrix of cofactors, which transforms normals: the inverse transpose without
/// its division.
#[inline]
pub fn cofactors(transform: &DAffine3) -> [DVec3; 3] {
    let m = &transform.matrix3;
    [m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)]
}
