//! The queries of a mesh with the interface of trimesh.

use numpy::IntoPyArray;
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
    mesh: Py<Mesh>,
}

/// Faces, rays, and places of hits.
type Hits<'py> = (Column<'py, i64>, Column<'py, i64>, Option<Table<'py, f64>>);

/// Places, rays, and faces of hits.
type Located<'py> = (Option<Table<'py, f64>>, Column<'py, i64>, Column<'py, i64>);

impl RayMeshIntersector {
    pub(crate) fn of(mesh: Py<Mesh>) -> Self {
        Self { mesh }
    }

    fn hits<'py>(
        &self,
        given: &Given<'py>,
        most: Option<usize>,
        (py, with_locations): (Python<'py>, bool),
    ) -> PyResult<Hits<'py>> {
        let mesh = self.mesh.get();
        let (rays, faces, distances) = match most {
            Some(most) => mesh.all_of(py, given, most)?,
            None => {
                let (mut faces, mut distances) = mesh.closest_of(py, given)?;
                let mut rays = input::collected((0..faces.len()).map(|ray| Ok(ray as i64)))?;
                rays.retain(|&ray| faces[ray as usize] >= 0);
                faces.retain(|&face| face >= 0);
                distances.retain(|distance| distance.is_finite());
                (rays, faces, distances)
            }
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

fn given<'py>(origins: &Bound<'py, PyAny>, directions: &Bound<'py, PyAny>) -> PyResult<Given<'py>> {
    Given::new(["ray_origins", "ray_directions"], origins, directions)
}

/// The number of hits of a ray; `None` for the closest alone.
fn most(multiple: bool, max_hits: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    let most = input::given(("max_hits", max_hits), "a whole number", |value| value.extract())?;
    Ok(multiple.then(|| most.unwrap_or(usize::MAX)))
}

#[pymethods]
impl RayMeshIntersector {
    #[new]
    fn new(py: Python<'_>, mesh: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(mesh) = mesh.cast::<Mesh>() {
            return Ok(Self::of(mesh.clone().unbind()));
        }
        Ok(Self::of(Py::new(py, Mesh::new(py, mesh, None, None)?)?))
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
        let most = most(multiple_hits, max_hits)?;
        let given = given(ray_origins, ray_directions)?;
        match self.hits(&given, most, (py, return_locations))? {
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
    ) -> PyResult<Located<'py>> {
        let most = most(multiple_hits, max_hits)?;
        let given = given(ray_origins, ray_directions)?;
        let (faces, rays, locations) = self.hits(&given, most, (py, true))?;
        Ok((locations, rays, faces))
    }

    /// The first face that each ray hits, or -1.
    fn intersects_first<'py>(
        &self,
        py: Python<'py>,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
    ) -> PyResult<Column<'py, i64>> {
        let given = given(ray_origins, ray_directions)?;
        Ok(self.mesh.get().closest_of(py, &given)?.0.into_pyarray(py))
    }

    /// Whether each ray hits anything.
    fn intersects_any<'py>(
        &self,
        py: Python<'py>,
        ray_origins: &Bound<'py, PyAny>,
        ray_directions: &Bound<'py, PyAny>,
    ) -> PyResult<Column<'py, bool>> {
        let given = given(ray_origins, ray_directions)?;
        Ok(self.mesh.get().any_of(py, &given)?.into_pyarray(py))
    }

    /// Whether each point is inside the mesh.
    fn contains_points<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Column<'py, bool>> {
        self.mesh.get().contains_of(py, "points", points)
    }
}
