//! The class `Mesh`: queries of many rays at once.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use wavecrest_api::glam::DVec3;
use wavecrest_api::memory::{build_bytes, check_room};
use wavecrest_api::{self as api, Accel, Attribute, Geometry, MeshData, NO_VALUE, Preset};

use super::arrays::{self, Points};
use super::given::{Column, Given, NAMES, table};
use super::input;
use super::shapes::{Arrays, Shapes};
use super::surface::number;
use super::trimesh::RayMeshIntersector;
use super::{Error, exception, work};

/// A mesh of triangles, for queries of rays and points.
///
/// Mesh(vertices, faces) takes arrays of the shapes (N, 3) and (M, 3), Mesh(mesh) one of trimesh or another object
/// with vertices and faces, Mesh(path) and Mesh.load(path) a file (PLY, OBJ, STL). normals and uvs are those of
/// vertices, (N, 3) and (N, 2), or of the corners of faces, (M, 3, 3) and (M, 3, 2); files have their own, and a mesh
/// of trimesh its texture coordinates. bvh is the quality of the search tree, "fast" by default: "fastest" is built
/// sooner, "on-demand" pays for fewer rays than faces.
///
/// A mesh is a copy that does not change. It can be pickled.
///
/// Which face is hit is decided with vertices and rays rounded once to single precision. If the first vertex, in
/// float64, is more than 1024 from zero, vertices and origins are moved there first, in double precision. For these
/// numbers hits are exact: no ray slips between two faces. Distances and locations are then those of the ray and the
/// face as given: within 1e-12 of the size of coordinates, as float64; or if all arrays are float32, the distance
/// rounded once to float32.
///
/// Faces have two sides. Only hits after t_min, by default 0, and before t_max count. A distance is in lengths of the
/// direction, which may be any finite number above zero. Rays that are not finite or have no direction hit nothing.
/// One origin or direction, of the shape (3,) or (1, 3), is that of all rays. Work is done on all cores, without the GIL.
///
/// >>> mesh = wavecrest.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
/// >>> faces, distances = mesh.closest([[0.2, 0.2, 5]], [[0, 0, -1]])
/// >>> print(faces, distances)
/// [0] [5.]
#[pyclass(frozen, module = "wavecrest")]
pub(crate) struct Mesh {
    pub(crate) shapes: Shapes,
    pub(crate) preset: Preset,
}

/// Two arrays.
type Pair<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (vertices, faces=None, *, normals=None, uvs=None, bvh=None))]
    pub(crate) fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: Option<&Bound<'_, PyAny>>,
        normals: Option<&Bound<'_, PyAny>>,
        uvs: Option<&Bound<'_, PyAny>>,
        bvh: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let Some([points, faces]) = arrays::arrays(vertices, faces)? else {
            if normals.is_some() || uvs.is_some() {
                return Err(Error::new_err("normals, uvs: only for vertices with faces"));
            }
            return Self::load(py, vertices, bvh);
        };
        let points = Points::new("vertices", &points)?;
        let rows = points.rows()?;
        let mut mesh = arrays::from_arrays(rows, &faces)?;
        mesh.normals = arrays::attribute(("normals", normals), &mesh)?;
        mesh.uvs = arrays::attribute(("uvs", uvs), &mesh)?;
        let own = vertices.getattr("visual").and_then(|visual| visual.getattr("uv"));
        if let (None, Ok(own)) = (&mesh.uvs, own) {
            // Those of other things than vertices are left out.
            mesh.uvs = arrays::attribute(("uvs", Some(&own)), &mesh).unwrap_or(None);
        }
        api::mesh::validate(&mesh, Path::new("vertices and faces")).map_err(|e| exception(&e))?;
        let is_rounded =
            |(i, p): (usize, &api::glam::Vec3)| p.as_dvec3() + mesh.origin != rows.get(i);
        let given = match mesh.positions.iter().enumerate().any(is_rounded) {
            true => Some(arrays::collected((0..rows.len()).map(|i| Ok(rows.get(i))))?),
            false => None,
        };
        Self::build(py, mesh, (given, rows.is_single()), bvh)
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
        let is_single = loaded.mesh.origin == DVec3::ZERO;
        Self::build(py, loaded.mesh, (None, is_single), bvh)
    }

    /// The vertices, shape (N, 3), as they were given.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (arrays, geometry) = (&self.shapes.meshes[0], self.shapes.accel.geometry());
        let vertex = |i| arrays.vertex(geometry, i).to_array();
        table(py, geometry.positions.len(), vertex)
    }

    /// The vertex indices of the faces, shape (M, 3).
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let triangles = &self.shapes.accel.geometry().triangles;
        table(py, triangles.len(), |i| triangles[i].map(i64::from))
    }

    /// The normals of vertices, (N, 3), or of the corners of faces, (M, 3, 3), or None.
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        attribute(py, self.shapes.meshes[0].normals.as_ref())
    }

    /// The texture coordinates of vertices, (N, 2), or of the corners of faces, (M, 3, 2), or None.
    #[getter]
    fn uvs<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        attribute(py, self.shapes.meshes[0].uvs.as_ref())
    }

    /// The same queries with the names, arguments and results of trimesh.
    #[getter]
    fn ray(this: Bound<'_, Self>) -> RayMeshIntersector {
        RayMeshIntersector::of(this)
    }

    /// The closest hits of rays: faces and distances. A miss has the face -1 and the distance inf.
    ///
    /// Of faces at the same exact distance, as at an edge, the one with the lowest number is hit.
    #[pyo3(signature = (origins, directions, *, t_min=None, t_max=None))]
    fn closest<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        t_min: Option<&Bound<'py, PyAny>>,
        t_max: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Column<'py, i64>, Bound<'py, PyAny>)> {
        self.shapes.closest(&Given::new(NAMES, [origins, directions], [t_min, t_max])?)
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

    /// Every surface on rays, once: for each the number of the ray, the face and the distance, in the order of rays,
    /// then of distances, then of faces.
    ///
    /// A ray that meets an edge or a corner crosses those of the faces around it that it would cross if its origin
    /// were moved by an infinitesimal step, the same for all rays: one where it passes through a surface, none or two
    /// where it only touches one. So a closed mesh is left as often as it is entered. Where closest reports another
    /// face around that edge, the distance is the same. Of dozens of copies of a face, one may count for all.
    #[pyo3(signature = (origins, directions, *, t_min=None, t_max=None))]
    fn all<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        t_min: Option<&Bound<'py, PyAny>>,
        t_max: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let py = origins.py();
        let given = Given::new(NAMES, [origins, directions], [t_min, t_max])?;
        let (rays, found) = (given.rays(&self.shapes)?, self.shapes.all(&given, usize::MAX)?);
        let distance = |i: usize| rays.distance(found[i]);
        let distances = match rays.is_single {
            true => table(py, found.len(), |i| [distance(i) as f32])?,
            false => table(py, found.len(), |i| [distance(i)])?,
        };
        let numbers = table(py, found.len(), |i| [found[i].ray as i64])?;
        Ok((numbers, table(py, found.len(), |i| [number(found[i])])?, distances))
    }

    /// The closest hits as arrays by name, of which each has a row for each ray:
    ///
    /// - faces, -1 for a miss; distances, inf for a miss
    /// - locations, and barycentrics, the weights of the three corners there
    /// - normals of faces, of unit length, on the side from which corners run counter-clockwise
    /// - shading_normals, interpolated between those of the corners, or that of the face where there are none
    /// - uvs, texture coordinates, if the mesh has them
    ///
    /// Numbers are float64; for a miss, nan.
    #[pyo3(signature = (origins, directions, *, t_min=None, t_max=None))]
    fn cast<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        t_min: Option<&Bound<'py, PyAny>>,
        t_max: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        self.shapes.cast(Given::new(NAMES, [origins, directions], [t_min, t_max])?, false)
    }

    /// Whether points are inside a closed mesh. Rays from there cross it, as all counts, by the rule "parity" an odd
    /// number of times; by "winding", from inside to outside more or less often than the other way, so that what is in
    /// several closed parts that overlap is inside too. Points on the surface are inside or outside.
    #[pyo3(signature = (points, rule=None))]
    pub(crate) fn contains<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        rule: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Column<'py, bool>> {
        let wound = match input::text(("rule", rule))?.as_deref() {
            None | Some("parity") => false,
            Some("winding") => true,
            Some(found) => {
                let message = format!("rule: must be one of parity, winding, found {found:?}");
                return Err(Error::new_err(message));
            }
        };
        let given = Given::points(points)?;
        self.shapes.answers(&given, |rays, part, inside| rays.contains(part, wound, inside))
    }

    fn __repr__(&self) -> String {
        let Geometry { positions, triangles, .. } = self.shapes.accel.geometry();
        let (vertices, faces, bvh) = (positions.len(), triangles.len(), self.preset.name());
        format!(
            "<wavecrest.Mesh(vertices.shape=({vertices}, 3), faces.shape=({faces}, 3), bvh={bvh:?})>"
        )
    }

    /// What a mesh does not change, a copy shares.
    fn __copy__(this: Py<Self>) -> Py<Self> {
        this
    }

    fn __deepcopy__(this: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        this
    }

    /// For pickle: the arguments that make the mesh again.
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<(Pair<'py>, Bound<'py, PyDict>)> {
        let mut vertices = self.vertices(py)?;
        if self.shapes.meshes[0].is_single {
            vertices = vertices.call_method1("astype", ("float32",))?;
        }
        let named = [("normals", self.normals(py)?), ("uvs", self.uvs(py)?)].into_py_dict(py)?;
        named.set_item("bvh", self.preset.name())?;
        Ok(((vertices, self.faces(py)?), named))
    }
}

impl Mesh {
    /// The mesh with its vertices as given, if positions are rounded, and whether they were single.
    fn build(
        py: Python<'_>,
        mesh: MeshData,
        (vertices, is_single): (Option<Vec<DVec3>>, bool),
        bvh: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let preset = input::named(("bvh", bvh))?.unwrap_or(Preset::Fast);
        let MeshData { positions, origin, triangles, normals, uvs, .. } = mesh;
        let arrays = Arrays { origin, vertices, normals, uvs, is_single };
        let count = triangles.len() as u64;
        let geometry = Geometry { positions, triangles, ..Geometry::default() };
        let accel = build(py, geometry, preset, count)?;
        let shapes = Shapes { accel, origin, meshes: vec![Arc::new(arrays)], places: Vec::new() };
        Ok(Self { shapes, preset })
    }
}

/// The search tree over so many triangles.
pub(crate) fn build(
    py: Python<'_>,
    geometry: Geometry,
    preset: Preset,
    count: u64,
) -> PyResult<Accel> {
    let build = || {
        check_room(build_bytes(preset, count), "the search tree")?;
        Ok(Accel::new(geometry, preset))
    };
    let pool = work::pool()?;
    py.detach(|| pool.install(build)).map_err(|e| exception(&e))
}

/// The values of vertices or of the corners of faces, nan for those without.
fn attribute<'py, T: Copy + Into<[f32; K]> + Sync, const K: usize>(
    py: Python<'py>,
    attribute: Option<&Attribute<T>>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
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
