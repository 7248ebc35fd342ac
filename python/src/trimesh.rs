//! The queries of a mesh with the interface of trimesh.

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use wavecrest_api::glam::DVec3;

use super::input;
use super::mesh::{Column, Given, Mesh, Table, table};

/// Ray queries with the names, arguments and results of trimesh.
///
/// mesh is one of trimesh, a wavecrest.Mesh, or whatever wavecrest.Mesh takes. Locations are computed in double
/// precision from a distance of single precision. Hits are in the order of rays, then of distances.
///
/// >>> mesh.ray = wavecrest.RayMeshIntersector(mesh)  # a mesh of trimesh
#[pyclass(frozen, module = "wavecrest")]
pub(crate) struct RayMeshIntersector {
    pub(crate) mesh: Py<Mesh>,
}

/// Faces, rays, and places of hits.
type Hits<'py> = (Column<'py, i64>, Column<'py, i64>, Option<Table<'py, f64>>);

/// Places, rays, and faces of hits.
type Located<'py> = (Option<Table<'py, f64>>, Column<'py, i64>, Column<'py, i64>);

impl RayMeshIntersector {
    /// The hits of rays: at most this many for each, or the closest alone.
    fn hits<'py>(
        &self,
        rays: [&Bound<'py, PyAny>; 2],
        (multiple, max_hits): (bool, Option<&Bound<'py, PyAny>>),
        with_locations: bool,
    ) -> PyResult<Hits<'py>> {
        let (py, mesh) = (rays[0].py(), self.mesh.get());
        let most = input::given(("max_hits", max_hits), "a whole number")?;
        let given = Given::new(NAMES, rays, None)?;
        let (rays, faces, distances) = if multiple {
            mesh.all_of(&given, most.unwrap_or(usize::MAX))?
        } else {
            let (faces, distances) = mesh.closest_of(&given)?;
            let (mut faces, mut distances) = (faces.to_vec()?, distances.to_vec()?);
            let mut rays = input::collected((0..faces.len()).map(|ray| Ok(ray as i64)))?;
            rays.retain(|&ray| faces[ray as usize] >= 0);
            faces.retain(|&face| face >= 0);
            distances.retain(|distance| distance.is_finite());
            (rays, faces, distances)
        };
        let directions = given.directions.as_ref().map(|rows| rows.rows()).transpose()?;
        let locations = match (with_locations, directions) {
            (true, Some(directions)) => {
                let origins = given.origins.rows()?;
                let hits = rays.iter().zip(&distances);
                let place = |(&ray, &t): (&i64, &f32)| {
                    let along: DVec3 = directions.get(ray as usize) * f64::from(t);
                    Ok((origins.get(ray as usize) + along).to_array())
                };
                Some(table(py, input::collected(hits.map(place))?)?)
            }
            _ => None,
        };
        Ok((faces.into_pyarray(py), rays.into_pyarray(py), locations))
    }
}

/// The names of arguments.
const NAMES: [&str; 2] = ["ray_origins", "ray_directions"];

#[pymethods]
impl RayMeshIntersector {
    #[new]
    fn new(py: Python<'_>, mesh: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(mesh) = mesh.cast::<Mesh>() {
            return Ok(Self { mesh: mesh.clone().unbind() });
        }
        Ok(Self { mesh: Py::new(py, Mesh::new(py, mesh, None, None)?)? })
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
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
        multiple_hits: bool,
        max_hits: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Located<'py>> {
        let (rays, most) = ([ray_origins, ray_directions], (multiple_hits, max_hits));
        let (faces, rays, locations) = self.hits(rays, most, true)?;
        Ok((locations, rays, faces))
    }

    /// The first face that each ray hits, or -1.
    fn intersects_first<'py>(
        &self,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
    ) -> PyResult<Column<'py, i64>> {
        let given = Given::new(NAMES, [ray_origins, ray_directions], None)?;
        Ok(self.mesh.get().closest_of(&given)?.0)
    }

    /// Whether each ray hits anything.
    fn intersects_any<'py>(
        &self,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
    ) -> PyResult<Column<'py, bool>> {
        self.mesh.get().any_of(&Given::new(NAMES, [ray_origins, ray_directions], None)?)
    }

    /// Whether each point is inside the mesh.
    fn contains_points<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Column<'py, bool>> {
        self.mesh.get().contains(points)
    }
}
