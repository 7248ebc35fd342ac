//! What rays are traced against: a mesh, or several that are placed in a scene.

use std::sync::Arc;

use wavecrest_api::glam::{DAffine3, DVec3, Vec2, Vec3};
use wavecrest_api::{Accel, Attribute, Geometry, NO_VALUE, Primitive};

/// What a mesh has beside the positions and faces that are traced.
pub(crate) struct Arrays {
    /// The origin of the positions.
    pub(crate) origin: DVec3,
    /// The vertices as given, where positions are rounded.
    pub(crate) vertices: Option<Vec<DVec3>>,
    pub(crate) normals: Option<Attribute<Vec3>>,
    pub(crate) uvs: Option<Attribute<Vec2>>,
    /// Whether the vertices were given in single precision.
    pub(crate) is_single: bool,
}

impl Arrays {
    /// A vertex of the mesh, whose positions are those of `geometry`.
    #[inline(always)]
    pub(crate) fn vertex(&self, geometry: &Geometry, number: usize) -> DVec3 {
        match &self.vertices {
            Some(vertices) => vertices[number],
            None => geometry.positions[number].as_dvec3() + self.origin,
        }
    }
}

/// Meshes with their search trees.
pub(crate) struct Shapes {
    /// With the triangles of one mesh, or with each as a prototype.
    pub(crate) accel: Accel,
    /// The origin of its space.
    pub(crate) origin: DVec3,
    pub(crate) meshes: Vec<Arc<Arrays>>,
    /// Where instances are; none for one mesh.
    pub(crate) places: Vec<DAffine3>,
}

/// A face that is hit.
#[derive(Clone, Copy)]
pub(crate) struct Face<'a> {
    pub(crate) number: usize,
    pub(crate) instance: Option<usize>,
    /// The number of its mesh.
    pub(crate) mesh: usize,
    /// The vertices of its corners.
    vertices: [u32; 3],
    arrays: &'a Arrays,
    geometry: &'a Geometry,
}

impl Shapes {
    /// The face with the number of this primitive.
    #[inline(always)]
    pub(crate) fn face(&self, primitive: u32) -> Face<'_> {
        let geometry = self.accel.geometry();
        let (geometry, number, instance, mesh) = match geometry.primitive(primitive) {
            Primitive::Instanced(instanced) => {
                let (instance, prototype) = geometry.instance(instanced);
                let number = instanced.instance as usize;
                (prototype, instanced.triangle as usize, Some(number), instance.prototype())
            }
            _ => (geometry, primitive as usize, None, 0),
        };
        let (vertices, arrays) = (geometry.triangles[number], &*self.meshes[mesh]);
        Face { number, instance, mesh, vertices, arrays, geometry }
    }

    /// The corners of a face.
    // Written out: `map` passes them through memory in pieces.
    #[inline(always)]
    pub(crate) fn corners(&self, face: Face<'_>) -> [DVec3; 3] {
        let [a, b, c] = face.vertices;
        let [a, b, c] = [face.vertex(a), face.vertex(b), face.vertex(c)];
        let Some(instance) = face.instance else { return [a, b, c] };
        let place = &self.places[instance];
        [place.transform_point3(a), place.transform_point3(b), place.transform_point3(c)]
    }

    /// The unit normal at a point of a face with these barycentric coordinates, from those of its
    /// corners; `None` if they have none.
    pub(crate) fn normal(&self, face: Face<'_>, weights: [f64; 3]) -> Option<DVec3> {
        let normals = face.values(face.arrays.normals.as_ref()?)?;
        let normals = normals.map(|normal| normal.as_dvec3().normalize_or_zero());
        let normal = normals.into_iter().zip(weights).map(|(normal, weight)| normal * weight);
        let mut normal = normal.sum::<DVec3>();
        if let Some(instance) = face.instance {
            let instance = &self.accel.geometry().instances[instance];
            normal = instance.shading_normal(normal.as_vec3()).as_dvec3();
        }
        normal.try_normalize()
    }
}

impl Face<'_> {
    #[inline(always)]
    fn vertex(&self, number: u32) -> DVec3 {
        self.arrays.vertex(self.geometry, number as usize)
    }

    /// The texture coordinates at a point with these barycentric coordinates.
    pub(crate) fn uv(&self, weights: [f64; 3]) -> Option<[f64; 2]> {
        let uvs = self.values(self.arrays.uvs.as_ref()?)?.into_iter().zip(weights);
        let uv = uvs.map(|(uv, weight)| uv.as_dvec2() * weight).reduce(|sum, uv| sum + uv)?;
        Some(uv.into())
    }

    /// The values of its corners, if each has one.
    fn values<T: Copy>(&self, of: &Attribute<T>) -> Option<[T; 3]> {
        let corners = of.indices.as_ref().map_or(self.vertices, |indices| indices[self.number]);
        corners.iter().all(|&i| i != NO_VALUE).then(|| corners.map(|i| of.values[i as usize]))
    }
}
