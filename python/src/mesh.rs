//! The class `Mesh`: queries of many rays at once.

use std::ops::Range;
use std::path::{Path, PathBuf};

use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use wavecrest_api::glam::DVec3;
use wavecrest_api::memory::{build_bytes, check_room};
use wavecrest_api::{self as api, Accel, Geometry, MeshData, Preset};

use super::input::{self, Points};
use super::rays::{Crossings, Rays};
use super::trimesh::RayMeshIntersector;
use super::{Error, exception, work};

/// A mesh of triangles, for queries of rays and points.
///
/// Mesh(vertices, faces) takes arrays of the shapes (N, 3) and (M, 3), Mesh(mesh) one of trimesh or another object
/// with vertices and faces, Mesh(path) and Mesh.load(path) a file (PLY, OBJ, STL). bvh is the quality of the search
/// tree, "fast" by default: "fastest" is built sooner, "on-demand" pays for fewer rays than faces.
///
/// Coordinates have single precision, as do rays: float64 is rounded once. If the first vertex, in float64, is more
/// than 1024 from zero, vertices and origins are moved there first, in double precision.
///
/// Hits are exact for these numbers: no ray slips between two faces. Faces have two sides. Only hits after the origin
/// and before t_max count. A distance is in lengths of the direction, rounded once to float32. Rays that are not
/// finite or have no direction hit nothing. Work is done on all cores, without the GIL.
///
/// >>> mesh = wavecrest.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
/// >>> faces, distances = mesh.closest([[0.2, 0.2, 5]], [[0, 0, -1]])
/// >>> print(faces, distances)
/// [0] [5.]
#[pyclass(frozen, module = "wavecrest")]
pub(crate) struct Mesh {
    accel: Accel,
    /// The origin of the vertices.
    origin: DVec3,
}

/// An array of one value for each ray or hit.
pub(crate) type Column<'py, T> = Bound<'py, PyArray1<T>>;

/// An array of points.
pub(crate) type Table<'py, T> = Bound<'py, PyArray2<T>>;

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (vertices, faces=None, *, bvh=None))]
    pub(crate) fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: Option<&Bound<'_, PyAny>>,
        bvh: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let Some(mesh) = input::mesh(vertices, faces)? else {
            return Self::load(py, vertices, bvh);
        };
        api::mesh::validate(&mesh, Path::new("vertices and faces")).map_err(|e| exception(&e))?;
        Self::build(py, mesh, bvh)
    }

    /// The mesh of a file: PLY, OBJ or STL.
    #[staticmethod]
    #[pyo3(signature = (path, *, bvh=None))]
    fn load(
        py: Python<'_>,
        path: &Bound<'_, PyAny>,
        bvh: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let what = "a path, a mesh, or vertices with faces";
        let path: PathBuf = input::needed("vertices", what, path, |path| path.extract())?;
        let load = || {
            let found = api::mesh::survey(&path)?;
            check_room(found.geometry() + found.attributes, "the mesh")?;
            api::mesh::load(&path)
        };
        let pool = work::pool()?;
        let loaded = py.detach(|| pool.install(load)).map_err(|e| exception(&e))?;
        super::warn(py, loaded.warnings)?;
        Self::build(py, loaded.mesh, bvh)
    }

    /// The vertices, shape (N, 3).
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Table<'py, f64>> {
        let positions = self.accel.geometry().positions.iter();
        let position = |p: &api::glam::Vec3| Ok((p.as_dvec3() + self.origin).to_array());
        table(py, input::collected(positions.map(position))?)
    }

    /// The vertex indices of the faces, shape (M, 3).
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Table<'py, i64>> {
        let triangles = self.accel.geometry().triangles.iter();
        table(py, input::collected(triangles.map(|face| Ok(face.map(i64::from))))?)
    }

    /// The same queries with the names, arguments and results of trimesh.
    #[getter]
    fn ray(this: Bound<'_, Self>) -> RayMeshIntersector {
        RayMeshIntersector { mesh: this.unbind() }
    }

    /// The closest hits of rays: faces and distances. A miss has the face -1 and the distance inf.
    ///
    /// Of faces at the same exact distance, as at an edge, the one with the lowest number is hit.
    #[pyo3(signature = (origins, directions, *, t_max=None))]
    fn closest<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        t_max: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Column<'py, i64>, Column<'py, f32>)> {
        self.closest_of(&Given::new(NAMES, [origins, directions], t_max)?)
    }

    /// Whether rays hit anything.
    #[pyo3(signature = (origins, directions, *, t_max=None))]
    fn any<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        t_max: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Column<'py, bool>> {
        self.any_of(&Given::new(NAMES, [origins, directions], t_max)?)
    }

    /// Every surface on rays, once: for each the number of the ray, the face and the distance, in the order of rays,
    /// then of exact distances, then of faces.
    ///
    /// A ray that meets an edge or a corner crosses those of the faces around it that it would cross if its origin
    /// were moved by an infinitesimal step, the same for all rays: one where it passes through a surface, none or two
    /// where it only touches one. So a closed mesh is left as often as it is entered. Where closest reports another
    /// face around that edge, the distance is the same. Of dozens of copies of a face, one may count for all.
    #[pyo3(signature = (origins, directions, *, t_max=None))]
    fn all<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        t_max: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Column<'py, i64>, Column<'py, i64>, Column<'py, f32>)> {
        let py = origins.py();
        let given = Given::new(NAMES, [origins, directions], t_max)?;
        let (rays, faces, distances) = self.all_of(&given, usize::MAX)?;
        Ok((rays.into_pyarray(py), faces.into_pyarray(py), distances.into_pyarray(py)))
    }

    /// Whether points are inside a closed mesh: rays from there cross it an odd number of times, as all counts. Points
    /// on the surface are inside or outside.
    pub(crate) fn contains<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Column<'py, bool>> {
        let origins = Points::new("points", points)?;
        let given = Given { py: points.py(), origins, directions: None, t_max: f32::INFINITY };
        self.answers(&given, |rays, part, inside| rays.contains(part, inside))
    }
}

impl Mesh {
    fn build(py: Python<'_>, mesh: MeshData, bvh: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let preset = input::named(("bvh", bvh))?.unwrap_or(Preset::Fast);
        let MeshData { positions, origin, triangles, .. } = mesh;
        let count = triangles.len() as u64;
        let geometry = Geometry { positions, triangles, ..Geometry::default() };
        let build = || {
            check_room(build_bytes(preset, count), "the search tree")?;
            Ok(Accel::new(geometry, preset))
        };
        let pool = work::pool()?;
        let accel = py.detach(|| pool.install(build)).map_err(|e| exception(&e))?;
        Ok(Self { accel, origin })
    }

    /// The closest hits: faces and distances.
    pub(crate) fn closest_of<'py>(
        &self,
        given: &Given<'py>,
    ) -> PyResult<(Column<'py, i64>, Column<'py, f32>)> {
        let rays = given.rays(self)?;
        let faces = column(given.py, "empty", rays.len())?;
        let distances = column(given.py, "empty", rays.len())?;
        let (mut into, mut at) = (faces.readwrite(), distances.readwrite());
        let (into, at) = (into.as_slice_mut()?, at.as_slice_mut()?);
        in_stretches(given.py, rays.len(), |part| {
            rays.closest(part.clone(), &mut into[part.clone()], &mut at[part]);
            Ok(())
        })?;
        Ok((faces, distances))
    }

    pub(crate) fn any_of<'py>(&self, given: &Given<'py>) -> PyResult<Column<'py, bool>> {
        self.answers(given, |rays, part, found| rays.any(part, found))
    }

    /// The answer of a query for each ray.
    fn answers<'py>(
        &self,
        given: &Given<'py>,
        query: impl Fn(&Rays<'_>, Range<usize>, &mut [bool]) + Sync,
    ) -> PyResult<Column<'py, bool>> {
        let rays = given.rays(self)?;
        // Bytes other than 0 and 1 are no bools, even before they are written.
        let answers = column(given.py, "zeros", rays.len())?;
        let mut into = answers.readwrite();
        let into = into.as_slice_mut()?;
        in_stretches(given.py, rays.len(), |part| {
            query(&rays, part.clone(), &mut into[part]);
            Ok(())
        })?;
        Ok(answers)
    }

    /// Crossings, for each ray at most this many.
    pub(crate) fn all_of(&self, given: &Given<'_>, most: usize) -> PyResult<Crossings> {
        let rays = given.rays(self)?;
        let mut found = Crossings::default();
        in_stretches(given.py, rays.len(), |part| rays.all(part, most, &mut found))?;
        Ok(found)
    }
}

/// The names of arguments.
const NAMES: [&str; 2] = ["origins", "directions"];

/// Rays as given, or points.
pub(crate) struct Given<'py> {
    py: Python<'py>,
    pub(crate) origins: Points<'py>,
    pub(crate) directions: Option<Points<'py>>,
    t_max: f32,
}

impl<'py> Given<'py> {
    /// Rays up to `t_max` from arrays with these names.
    pub(crate) fn new(
        [origins, directions]: [&str; 2],
        [from, along]: [&Bound<'py, PyAny>; 2],
        t_max: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let py = from.py();
        let (from, along) = (Points::new(origins, from)?, Points::new(directions, along)?);
        let counts = [from.rows()?.len(), along.rows()?.len()];
        if counts[0] != counts[1] {
            let [expected, found] = counts.map(|count| format!("[{count}, 3]"));
            let message = format!(
                "{directions}: must have the shape of {origins}, {expected}, found {found}"
            );
            return Err(Error::new_err(message));
        }
        let is_far = |t_max: &f64| *t_max >= 0.0;
        let t_max = input::fitting(("t_max", t_max), "a number of at least 0", is_far)?;
        let t_max = t_max.map_or(f32::INFINITY, |t_max| t_max as f32);
        Ok(Self { py, origins: from, directions: Some(along), t_max })
    }

    fn rays<'a>(&'a self, mesh: &'a Mesh) -> PyResult<Rays<'a>> {
        let directions = self.directions.as_ref().map(Points::rows).transpose()?;
        let (origins, t_max) = (self.origins.rows()?, self.t_max);
        Ok(Rays { accel: &mesh.accel, origins, directions, t_max, from: mesh.origin })
    }
}

/// Rays traced between two checks for Ctrl-C: a fraction of a second.
const STRETCH: usize = 1 << 20;

/// Does `work` for parts of `count` rays or hits, on all threads and without the GIL.
fn in_stretches(
    py: Python<'_>,
    count: usize,
    mut work: impl FnMut(Range<usize>) -> api::Result<()> + Send,
) -> PyResult<()> {
    let pool = work::pool()?;
    for start in (0..count).step_by(STRETCH) {
        let part = start..count.min(start + STRETCH);
        py.detach(|| pool.install(|| work(part))).map_err(|e| exception(&e))?;
        py.check_signals()?;
    }
    Ok(())
}

/// An array with rows of three.
pub(crate) fn table<'py, T: Element>(
    py: Python<'py>,
    rows: Vec<[T; 3]>,
) -> PyResult<Table<'py, T>> {
    let count = rows.len();
    rows.into_flattened().into_pyarray(py).reshape([count, 3])
}

/// An array that NumPy makes: "zeros", or "empty", which is left for threads to write first.
fn column<'py, T: Element>(py: Python<'py>, how: &str, count: usize) -> PyResult<Column<'py, T>> {
    let array = py.import("numpy")?.call_method1(how, (count, T::get_dtype(py)))?;
    Ok(array.cast_into()?)
}
