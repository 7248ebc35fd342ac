//! The class `Scene`: meshes in several places.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use wavecrest_api::glam::{DAffine3, DMat4, DVec3, DVec4, Vec3};
use wavecrest_api::{self as api, Aabb, Geometry, Instance, MAX_COORDINATE, Preset};

use super::Error;
use super::given::{Column, Given, NAMES};
use super::input;
use super::mesh::{Mesh, build};
use super::shapes::Shapes;

/// Meshes in several places, for queries of rays.
///
/// Scene([mesh, (mesh, transform), ...]) takes meshes, each perhaps with a matrix of 4 x 4 numbers from its space to
/// that of the scene. Each is an instance, numbered in this order. A mesh may be there several times: it is stored
/// once, and geometries, the distinct meshes, are numbered in the order in which they first appear.
///
/// Which face is hit is exact in the space of its mesh: the ray, rounded once, is transformed there in double precision
/// and rounded again. Distances and locations follow from the corners, transformed in double precision.
/// Otherwise queries are those of Mesh. A scene has search trees of its own.
#[pyclass(frozen, module = "wavecrest")]
pub(crate) struct Scene {
    shapes: Shapes,
    /// What it was made of.
    instances: Vec<(Py<Mesh>, [[f64; 4]; 4])>,
}

#[pymethods]
impl Scene {
    #[new]
    fn new(py: Python<'_>, instances: &Bound<'_, PyAny>) -> PyResult<Self> {
        let instances = instances.try_iter()?.enumerate();
        let instances = instances.map(|(number, one)| instance(number, &one?));
        let instances = instances.collect::<PyResult<Vec<_>>>()?;
        let mut distinct: Vec<&Py<Mesh>> = Vec::new();
        let (mut geometry, mut places) = (Geometry::default(), Vec::new());
        let (mut origin, mut first, mut preset) = (DVec3::ZERO, 0_u32, Preset::Fast);
        for (number, (mesh, rows)) in instances.iter().enumerate() {
            let wrong = |what| Err(Error::new_err(format!("instances[{number}]: {what}")));
            let Mesh { shapes, preset: own } = mesh.get();
            let Geometry { positions, triangles, .. } = shapes.accel.geometry();
            let known = distinct.iter().position(|other| other.is(mesh));
            if known.is_none() {
                let (positions, triangles) = (positions.clone(), triangles.clone());
                geometry.prototypes.push(Geometry { positions, triangles, ..Geometry::default() });
                distinct.push(mesh);
                preset = *own;
            }
            let prototype = known.unwrap_or(distinct.len() - 1) as u32;
            let place = DAffine3::from_mat4(DMat4::from_cols_array_2d(rows).transpose());
            let to_scene = place * DAffine3::from_translation(shapes.origin);
            if number == 0 {
                let vertex = positions.first().map_or(DVec3::ZERO, |vertex| vertex.as_dvec3());
                origin = api::mesh::origin(to_scene.transform_point3(vertex));
            }
            let to_scene = DAffine3::from_translation(-origin) * to_scene;
            let bounds =
                positions.iter().map(|&p| Aabb::around([p])).fold(Aabb::EMPTY, Aabb::union);
            let instance = Instance::new(prototype, first, to_scene, &bounds);
            let limits =
                Aabb { low: Vec3::splat(-MAX_COORDINATE), high: Vec3::splat(MAX_COORDINATE) };
            let fits = positions.is_empty() || limits.contains(&instance.bounds(&[bounds]));
            if !(fits && to_scene.inverse().is_finite()) {
                return wrong("the transform is singular, or moves the mesh beyond 2^40");
            }
            geometry.instances.push(instance);
            places.push(place);
            first = match first.checked_add(triangles.len() as u32) {
                Some(next) if next < api::NO_PRIMITIVE => next,
                _ => return wrong("there are more than 2^32 - 2 faces"),
            };
        }
        let meshes = distinct.iter().map(|mesh| Arc::clone(&mesh.get().shapes.meshes[0])).collect();
        let count = geometry.held() as u64;
        let accel = build(py, geometry, preset, count)?;
        let shapes = Shapes { accel, origin, meshes, places };
        Ok(Self { shapes, instances })
    }

    /// The closest hits, as Mesh.cast returns them, with the number of the geometry and that of the instance besides,
    /// geometries and instances, both -1 for a miss. Normals are those in the space of the scene.
    #[pyo3(signature = (origins, directions, *, t_min=None, t_max=None))]
    fn cast<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        t_min: Option<&Bound<'py, PyAny>>,
        t_max: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        self.shapes.cast(Given::new(NAMES, [origins, directions], [t_min, t_max])?, true)
    }

    /// Whether rays hit anything.
    #[pyo3(signature = (origins, directions, *, t_min=None, t_max=None))]
    fn any<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        t_min: Option<&Bound<'py, PyAny>>,
        t_max: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Column<'py, bool>> {
        self.shapes.any(&Given::new(NAMES, [origins, directions], [t_min, t_max])?)
    }

    fn __repr__(&self) -> String {
        let [geometries, instances] = [self.shapes.meshes.len(), self.shapes.places.len()];
        format!("<wavecrest.Scene(geometries={geometries}, instances={instances})>")
    }

    /// For pickle and copy: the arguments that make the scene again.
    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>,)> {
        let instances = self.instances.iter().map(|(mesh, rows)| (mesh.clone_ref(py), *rows));
        Ok((instances.collect::<Vec<_>>().into_pyobject(py)?,))
    }
}

/// A mesh with the rows of its transform.
fn instance(number: usize, value: &Bound<'_, PyAny>) -> PyResult<(Py<Mesh>, [[f64; 4]; 4])> {
    let key = format!("instances[{number}]");
    let what =
        "a wavecrest.Mesh, or a tuple of one and a 4 x 4 matrix whose last row is 0, 0, 0, 1";
    input::needed(&key, what, value, |value| {
        if let Ok(mesh) = value.extract() {
            return Ok((mesh, DMat4::IDENTITY.to_cols_array_2d()));
        }
        let (mesh, rows): (Py<Mesh>, [[f64; 4]; 4]) = value.extract()?;
        let is_right =
            DMat4::from_cols_array_2d(&rows).is_finite() && rows[3] == DVec4::W.to_array();
        is_right.then_some((mesh, rows)).ok_or_else(|| Error::new_err(""))
    })
}
