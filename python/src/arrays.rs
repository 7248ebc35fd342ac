//! Meshes, points and arrays from Python values.

use std::collections::TryReserveError;

use numpy::{Element, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyMemoryError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use wavecrest_api as api;
use wavecrest_api::glam::{DVec3, Vec3};

use super::Error;
use super::input::Argument;

/// A mesh from arrays of the shapes (N, 3) and (M, 3), or from an object that has them, such as one of
/// trimesh; `None` for anything else.
pub(crate) fn mesh(
    vertices: &Bound<'_, PyAny>,
    faces: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<api::MeshData>> {
    let Some([vertices, faces]) = arrays(vertices, faces)? else { return Ok(None) };
    from_arrays(Points::new("vertices", &vertices)?.rows()?, &faces).map(Some)
}

/// The arrays of a mesh, as [`mesh`].
pub(crate) fn arrays<'py>(
    vertices: &Bound<'py, PyAny>,
    faces: Option<&Bound<'py, PyAny>>,
) -> PyResult<Option<[Bound<'py, PyAny>; 2]>> {
    Ok(match faces {
        Some(faces) => Some([vertices.clone(), faces.clone()]),
        None if vertices.hasattr("faces")? => {
            Some([vertices.getattr("vertices")?, vertices.getattr("faces")?])
        }
        None => None,
    })
}

/// As [`mesh`]. Coordinates in double precision that are far from zero are kept relative to an origin,
/// as those of files.
pub(crate) fn from_arrays(vertices: Rows<'_>, faces: &Bound<'_, PyAny>) -> PyResult<api::MeshData> {
    let origin = match vertices {
        Rows::Double([first, ..]) => api::mesh::origin(DVec3::from(*first)),
        _ => DVec3::ZERO,
    };
    let position = |i| Ok(api::mesh::relative(vertices.get(i), origin));
    let positions = collected((0..vertices.len()).map(position))?;
    let faces = array::<i64>("faces", faces, "int64", "(M, 3)")?;
    let count = positions.len();
    let triangle = |(number, face): (usize, &[i64; 3])| {
        let index = |i: i64| u32::try_from(i).ok().filter(|&i| (i as usize) < count).ok_or(i);
        let wrong = |i| {
            Error::new_err(format!(
                "faces[{number}]: must be indices from 0 to {}, of the {count} vertices, found {i}",
                count as i64 - 1
            ))
        };
        let [a, b, c] = face.map(index);
        Ok([a.map_err(wrong)?, b.map_err(wrong)?, c.map_err(wrong)?])
    };
    let triangles = collected(rows(&faces)?.iter().enumerate().map(triangle))?;
    Ok(api::MeshData { positions, origin, triangles, ..api::MeshData::default() })
}

/// Values of the vertices of a mesh, with the shape (N, K), or of the corners of its faces, (M, 3, K).
pub(crate) fn attribute<T: From<[f32; K]>, const K: usize>(
    (name, value): Argument<'_, '_>,
    mesh: &api::MeshData,
) -> PyResult<Option<api::Attribute<T>>> {
    let Some(value) = value else { return Ok(None) };
    let array: PyReadonlyArrayDyn<'_, f32> = converted(name, value, "float32")?;
    let (vertices, faces) = (mesh.positions.len(), mesh.triangles.len());
    let indices = match array.shape() {
        shape if shape == [vertices, K] => None,
        shape if shape == [faces, 3, K] => {
            Some(collected((0..faces as u32).map(|face| Ok([0, 1, 2].map(|k| 3 * face + k))))?)
        }
        shape => {
            return Err(Error::new_err(format!(
                "{name}: must have the shape [{vertices}, {K}], for vertices, or [{faces}, 3, {K}], for \
                 corners of faces, found {shape:?}"
            )));
        }
    };
    let values = rows(&array)?.iter().map(|&value| Ok(T::from(value)));
    Ok(Some(api::Attribute { values: collected(values)?, indices }))
}

/// Points or vectors in an array of the shape (N, 3).
pub(crate) enum Points<'py> {
    Single(PyReadonlyArrayDyn<'py, f32>),
    Double(PyReadonlyArrayDyn<'py, f64>),
}

impl<'py> Points<'py> {
    /// Those of anything that NumPy accepts: float32 and float64 as they are, others as float64. One may
    /// have the shape (3,), and an empty list is none.
    pub(crate) fn new(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let mut value = value.py().import("numpy")?.call_method1("asarray", (value,))?;
        if matches!(value.getattr("shape")?.extract::<Vec<usize>>()?[..], [0 | 3]) {
            value = value.call_method1("reshape", (-1, 3))?;
        }
        Ok(match has_type::<f32>(&value)? {
            true => Self::Single(array(name, &value, "float32", "(N, 3)")?),
            false => Self::Double(array(name, &value, "float64", "(N, 3)")?),
        })
    }

    pub(crate) fn rows(&self) -> PyResult<Rows<'_>> {
        Ok(match self {
            Self::Single(array) => Rows::Single(rows(array)?),
            Self::Double(array) => Rows::Double(rows(array)?),
        })
    }
}

/// The values of [`Points`].
#[derive(Clone, Copy)]
pub(crate) enum Rows<'a> {
    Single(&'a [[f32; 3]]),
    Double(&'a [[f64; 3]]),
}

impl Rows<'_> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Single(rows) => rows.len(),
            Self::Double(rows) => rows.len(),
        }
    }

    pub(crate) fn is_single(&self) -> bool {
        matches!(self, Self::Single(_))
    }

    /// The row with this number, or the only one.
    #[inline]
    pub(crate) fn get(&self, i: usize) -> DVec3 {
        match self {
            Self::Single(rows) => Vec3::from(rows[i.min(rows.len() - 1)]).as_dvec3(),
            Self::Double(rows) => DVec3::from(rows[i.min(rows.len() - 1)]),
        }
    }
}

/// An array from anything that NumPy accepts, with elements of the type `kind` and a shape such as
/// "(N, 3)".
pub(crate) fn array<'py, T: Element>(
    name: &str,
    value: &Bound<'py, PyAny>,
    kind: &str,
    expected: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let array: PyReadonlyArrayDyn<'py, T> = converted(name, value, kind)?;
    let shape = array.shape();
    if shape.len() != expected.split(',').count() || shape.last() != Some(&3) {
        let message = format!("{name}: must have the shape {expected}, found {shape:?}");
        return Err(Error::new_err(message));
    }
    Ok(array)
}

/// An array of any shape, without rounding floats to integers.
fn converted<'py, T: Element>(
    name: &str,
    value: &Bound<'py, PyAny>,
    kind: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let py = value.py();
    let rules = [("casting", "same_kind"), ("order", "C")].into_py_dict(py)?;
    rules.set_item("copy", false)?;
    let array = py.import("numpy")?.call_method1("asarray", (value,))?;
    let cast = array.call_method("astype", (kind,), Some(&rules));
    let wrong = |error: PyErr| match error.is_instance_of::<PyTypeError>(py) {
        true => PyTypeError::new_err(format!("{name}: {}", error.value(py))),
        false => error,
    };
    cast.map_err(wrong)?.extract()
}

/// The rows of an array with a last dimension of this length.
pub(crate) fn rows<'a, T: Element, const K: usize>(
    array: &'a PyReadonlyArrayDyn<'_, T>,
) -> PyResult<&'a [[T; K]]> {
    Ok(array.as_slice()?.as_chunks().0)
}

/// The values as a list, or an exception if the system refuses the memory.
pub(crate) fn collected<T>(values: impl ExactSizeIterator<Item = PyResult<T>>) -> PyResult<Vec<T>> {
    let mut list = Vec::new();
    let refused = |error: TryReserveError| PyMemoryError::new_err(error.to_string());
    list.try_reserve_exact(values.len()).map_err(refused)?;
    for value in values {
        list.push(value?);
    }
    Ok(list)
}

/// Whether it is an array of these elements for NumPy.
pub(crate) fn has_type<T: Element>(value: &Bound<'_, PyAny>) -> PyResult<bool> {
    let array = value.py().import("numpy")?.call_method1("asarray", (value,))?;
    Ok(array.extract::<PyReadonlyArrayDyn<'_, T>>().is_ok())
}
