//! What rays are traced against: a mesh, or several that are placed in a scene.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use wavecrest_api::glam::{DAffine3, DMat4, DVec3, Vec3};
use wavecrest_api::memory::check_room;
use wavecrest_api::{
    self as api, Aabb, Accel, Attribute, Geometry, Instance, MAX_COORDINATE, NO_VALUE, Preset,
    Primitive,
};

use super::arrays::{Mesh, table, vectors};
use super::base::{Any, Error, exception, on_threads};
use super::input;

/// What a mesh has beside the positions and faces that are traced.
pub(crate) struct Corners {
    /// The origin of the positions.
    origin: DVec3,
    /// The vertices as given, where positions are rounded.
    vertices: Option<Vec<DVec3>>,
}

/// Meshes with their search trees.
#[pyclass(frozen)]
pub(crate) struct Shapes {
    /// With the triangles of one mesh, or with each as a prototype.
    pub(crate) accel: Accel,
    /// The origin of its space.
    pub(crate) origin: DVec3,
    pub(crate) meshes: Vec<Arc<Corners>>,
    /// Where instances are; none for one mesh.
    pub(crate) places: Vec<DAffine3>,
}

/// A face that is hit.
pub(crate) struct Face {
    /// The number of its mesh.
    mesh: usize,
    /// Its number in its mesh.
    pub(crate) number: usize,
    pub(crate) instance: Option<usize>,
}

impl Shapes {
    /// The face with the number of this primitive.
    #[inline(always)]
    pub(crate) fn face(&self, primitive: u32) -> Face {
        let geometry = self.accel.geometry();
        let Primitive::Instanced(of) = geometry.primitive(primitive) else {
            return Face { mesh: 0, number: primitive as usize, instance: None };
        };
        let mesh = geometry.instance(of).0.prototype();
        Face { mesh, number: of.triangle as usize, instance: Some(of.instance as usize) }
    }

    /// The corners of a face.
    // Written out: `map` passes them through memory in pieces.
    #[inline(always)]
    pub(crate) fn corners(&self, Face { mesh, number, instance }: Face) -> [DVec3; 3] {
        let own = self.accel.geometry();
        let geometry = instance.map_or(own, |_| &own.prototypes[mesh]);
        let Corners { origin, vertices } = &*self.meshes[mesh];
        let vertex = |number: u32| match vertices {
            Some(vertices) => vertices[number as usize],
            None => geometry.positions[number as usize].as_dvec3() + *origin,
        };
        let [a, b, c] = geometry.triangles[number];
        let [a, b, c] = [vertex(a), vertex(b), vertex(c)];
        let Some(instance) = instance else { return [a, b, c] };
        let place = &self.places[instance];
        [place.transform_point3(a), place.transform_point3(b), place.transform_point3(c)]
    }
}

/// A mesh, with its vertices as given, if positions are rounded.
#[pyfunction]
pub(crate) fn mesh(
    py: Python<'_>,
    mesh: Mesh<'_>,
    vertices: Option<PyReadonlyArray2<'_, f64>>,
    bvh: Option<&str>,
) -> PyResult<Shapes> {
    let mesh = mesh.data()?;
    let name = Path::new("vertices and faces");
    on_threads(py, || api::mesh::validate(&mesh, name))?.map_err(exception)?;
    let vertices = vertices.map(|vertices| vectors(&vertices)).transpose()?;
    let api::MeshData { positions, origin, triangles, .. } = mesh;
    let geometry = Geometry { positions, triangles, ..Geometry::default() };
    let accel = build(py, geometry, bvh)?;
    let meshes = vec![Arc::new(Corners { origin, vertices })];
    Ok(Shapes { accel, origin, meshes, places: Vec::new() })
}

/// The distinct meshes in the places of instances: for each the number of its mesh, and its transform, of which last
/// rows are left out.
#[pyfunction]
pub(crate) fn scene(
    py: Python<'_>,
    meshes: Vec<Py<Shapes>>,
    instances: Vec<(u32, PyReadonlyArray2<'_, f64>)>,
    bvh: Option<&str>,
) -> PyResult<Shapes> {
    let mut scene = Geometry::default();
    for mesh in &meshes {
        let Geometry { positions, triangles, .. } = mesh.get().accel.geometry();
        let (positions, triangles) = (positions.clone(), triangles.clone());
        scene.prototypes.push(Geometry { positions, triangles, ..Geometry::default() });
    }
    let (mut origin, mut first, mut places) = (DVec3::ZERO, 0_u32, Vec::new());
    for (number, (mesh, place)) in instances.iter().enumerate() {
        let wrong = |what| Err(Error::new_err(format!("instances[{number}]: {what}")));
        let Geometry { positions, triangles, .. } = &scene.prototypes[*mesh as usize];
        let place = DAffine3::from_mat4(DMat4::from_cols_slice(place.as_slice()?).transpose());
        let to_scene = place * DAffine3::from_translation(meshes[*mesh as usize].get().origin);
        if number == 0 {
            let vertex = positions.first().map_or(DVec3::ZERO, |vertex| vertex.as_dvec3());
            origin = api::mesh::origin(to_scene.transform_point3(vertex));
        }
        let to_scene = DAffine3::from_translation(-origin) * to_scene;
        let bounds = positions.iter().map(|&p| Aabb::around([p])).fold(Aabb::EMPTY, Aabb::union);
        let instance = Instance::new(*mesh, first, to_scene, &bounds);
        let limit = Vec3::splat(MAX_COORDINATE);
        let within = |corner: Vec3| corner.abs().cmple(limit).all();
        let Aabb { low, high } = instance.bounds(&[bounds]);
        let fits = positions.is_empty() || within(low) && within(high);
        if !(fits && to_scene.inverse().is_finite()) {
            return wrong("the transform is singular, or moves the mesh beyond 2^40");
        }
        places.push(place);
        first = match first.checked_add(triangles.len() as u32) {
            Some(next) if next < api::NO_PRIMITIVE => next,
            _ => return wrong("there are more than 2^32 - 2 faces"),
        };
        scene.instances.push(instance);
    }
    let corners = meshes.iter().map(|mesh| Arc::clone(&mesh.get().meshes[0])).collect();
    let accel = build(py, scene, bvh)?;
    Ok(Shapes { accel, origin, meshes: corners, places })
}

/// The search tree, of the quality `bvh`.
fn build(py: Python<'_>, geometry: Geometry, bvh: Option<&str>) -> PyResult<Accel> {
    let preset = bvh.map(|name| input::named("bvh", name)).transpose()?.unwrap_or(Preset::Fast);
    let build = || {
        check_room(tree_bytes(geometry.held()), "the search tree")?;
        Ok(Accel::new(geometry, preset))
    };
    on_threads(py, build)?.map_err(exception)
}

/// Bytes that a tree over so many primitives takes: measured up to 80 each for grids.
pub(crate) fn tree_bytes(primitives: usize) -> u64 {
    80 * primitives as u64
}

/// Positions, faces, normals and texture coordinates, each an array or `None`.
type Parts<'py> = [Option<Any<'py>>; 4];

/// The mesh of a file: its parts, the origin of positions, and warnings. Normals and texture coordinates are those of
/// vertices, or of the corners of faces.
#[pyfunction]
pub(crate) fn load(py: Python<'_>, path: PathBuf) -> PyResult<(Parts<'_>, [f64; 3], Vec<String>)> {
    let loaded = on_threads(py, || api::mesh::load(&path))?.map_err(exception)?;
    let warnings = loaded.warnings.iter().map(ToString::to_string).collect();
    let api::MeshData { positions, origin, triangles, normals, uvs, .. } = loaded.mesh;
    let positions = table(py, positions.len(), |i| positions[i].to_array())?;
    let faces = table(py, triangles.len(), |i| triangles[i])?;
    let parts = [Some(positions), Some(faces), attribute(py, normals)?, attribute(py, uvs)?];
    Ok((parts, origin.into(), warnings))
}

/// The values of vertices, (N, K), or of the corners of faces, (M, 3, K), nan for those without.
fn attribute<T: Copy + Into<[f32; K]> + Send + Sync, const K: usize>(
    py: Python<'_>,
    attribute: Option<Attribute<T>>,
) -> PyResult<Option<Any<'_>>> {
    let Some(Attribute { values, indices }) = attribute else { return Ok(None) };
    let Some(indices) = indices else {
        return table(py, values.len(), |i| values[i].into()).map(Some);
    };
    let corner = |i: usize| match indices[i / 3][i % 3] {
        NO_VALUE => [f32::NAN; K],
        value => values[value as usize].into(),
    };
    let corners = table(py, 3 * indices.len(), corner)?;
    corners.call_method1("reshape", (indices.len(), 3, K)).map(Some)
}
