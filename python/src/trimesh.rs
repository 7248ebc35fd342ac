//! The queries of a mesh with the interface of trimesh.

use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::given::{Column, Given, table};
use super::input;
use super::mesh::Mesh;
use super::surface::number;

/// Ray queries with the names, arguments and results of trimesh.
///
/// mesh is one of trimesh, a wavecrest.Mesh, or whatever wavecrest.Mesh takes. The search tree of a mesh of trimesh is
/// made at the first query, and made anew when the mesh has changed: its hash is compared at every query. Hits are in
/// the order of rays, then of distances. Those at the origin of a ray do not count.
///
/// >>> mesh.ray = wavecrest.RayMeshIntersector(mesh)  # a mesh of trimesh
#[pyclass(frozen, module = "wavecrest")]
pub(crate) struct RayMeshIntersector {
    /// What queries are about.
    #[pyo3(get)]
    mesh: Py<PyAny>,
    /// It as it was when it had this hash.
    known: Mutex<Option<(isize, Py<Mesh>)>>,
}

/// Index_tri, index_ray, and locations of hits.
type Hits<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Option<Bound<'py, PyAny>>);

impl RayMeshIntersector {
    pub(crate) fn of(mesh: Bound<'_, Mesh>) -> Self {
        Self { mesh: mesh.into_any().unbind(), known: Mutex::default() }
    }

    /// The mesh as it is now.
    fn current(&self, py: Python<'_>) -> PyResult<Py<Mesh>> {
        let mesh = self.mesh.bind(py);
        if let Ok(mesh) = mesh.cast::<Mesh>() {
            return Ok(mesh.clone().unbind());
        }
        // What has no hash counts as changed.
        let hash = mesh.hash().ok();
        // Held for a moment only: whoever holds it longer may wait for the interpreter.
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, mesh)) = &*known()
            && Some(*of) == hash
        {
            return Ok(mesh.clone_ref(py));
        }
        let made = Py::new(py, Mesh::new(py, mesh, None, None, None, None)?)?;
        let before = hash.and_then(|hash| known().replace((hash, made.clone_ref(py))));
        drop(before);
        Ok(made)
    }

    /// The hits of rays: at most this many for each, or the closest alone.
    fn hits<'py>(
        &self,
        rays: [&Bound<'py, PyAny>; 2],
        (multiple, max_hits): (bool, Option<&Bound<'py, PyAny>>),
        with_locations: bool,
    ) -> PyResult<Hits<'py>> {
        let (py, mesh) = (rays[0].py(), self.current(rays[0].py())?);
        let shapes = &mesh.get().shapes;
        let most = input::given(("max_hits", max_hits), "a whole number")?;
        let given = Given::new(NAMES, rays, [None; 2])?.in_double();
        let found = if multiple {
            shapes.all(&given, most.unwrap_or(usize::MAX))?
        } else {
            let mut found = shapes.first(&given)?;
            found.retain(|found| !found.is_miss());
            found
        };
        let (rays, count) = (given.rays(shapes)?, found.len());
        let locations = match with_locations {
            true => Some(table(py, count, |i| rays.place(found[i]).to_array())?),
            false => None,
        };
        let faces = table(py, count, |i| [number(found[i])])?;
        Ok((faces, table(py, count, |i| [found[i].ray as i64])?, locations))
    }
}

/// The names of arguments.
const NAMES: [&str; 2] = ["ray_origins", "ray_directions"];

#[pymethods]
impl RayMeshIntersector {
    #[new]
    fn new(py: Python<'_>, mesh: &Bound<'_, PyAny>) -> PyResult<Self> {
        // Also before a pickled mesh has its arrays.
        let has_faces = mesh.get_type().hasattr("faces")? || mesh.hasattr("faces")?;
        let mesh = match has_faces {
            true => mesh.clone().unbind(),
            false => Py::new(py, Mesh::new(py, mesh, None, None, None, None)?)?.into_any(),
        };
        Ok(Self { mesh, known: Mutex::default() })
    }

    /// The hits of rays: index_tri, index_ray, and with return_locations the locations.
    ///
    /// Without multiple_hits, only the closest hit of each ray. max_hits limits the hits of a ray; all by default.
    #[pyo3(signature = (ray_origins, ray_directions, multiple_hits=true, max_hits=None, return_locations=false))]
    fn intersects_id<'py>(
        &self,
        py: Python<'py>,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
        multiple_hits: bool,
        max_hits: Option<&Bound<'py, PyAny>>,
        return_locations: bool,
    ) -> PyResult<Bound<'py, PyTuple>> {
        let (rays, most) = ([ray_origins, ray_directions], (multiple_hits, max_hits));
        match self.hits(rays, most, return_locations)? {
            (faces, rays, Some(locations)) => (faces, rays, locations).into_pyobject(py),
            (faces, rays, None) => (faces, rays).into_pyobject(py),
        }
    }

    /// The locations of hits, and for each the index of the ray and of the face.
    #[pyo3(signature = (ray_origins, ray_directions, multiple_hits=true, max_hits=None))]
    fn intersects_location<'py>(
        &self,
        py: Python<'py>,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
        multiple_hits: bool,
        max_hits: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        let (rays, most) = ([ray_origins, ray_directions], (multiple_hits, max_hits));
        let (faces, rays, locations) = self.hits(rays, most, true)?;
        (locations, rays, faces).into_pyobject(py)
    }

    /// The first face that each ray hits, or -1.
    fn intersects_first<'py>(
        &self,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
    ) -> PyResult<Column<'py, i64>> {
        let given = Given::new(NAMES, [ray_origins, ray_directions], [None; 2])?;
        Ok(self.current(given.py)?.get().shapes.closest(&given)?.0)
    }

    /// Whether each ray hits anything.
    fn intersects_any<'py>(
        &self,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
    ) -> PyResult<Column<'py, bool>> {
        let given = Given::new(NAMES, [ray_origins, ray_directions], [None; 2])?;
        self.current(given.py)?.get().shapes.any(&given)
    }

    /// Whether each point is inside the mesh, by parity.
    fn contains_points<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Column<'py, bool>> {
        self.current(points.py())?.get().contains(points, None)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<wavecrest.RayMeshIntersector({})>", self.mesh.bind(py).repr()?))
    }

    /// For pickle and copy: the argument that makes it again.
    fn __getnewargs__(&self, py: Python<'_>) -> (Py<PyAny>,) {
        (self.mesh.clone_ref(py),)
    }
}
