//! Converts Python values for the library.

use std::collections::TryReserveError;
use std::path::PathBuf;
use std::str::FromStr;

use numpy::{Element, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyMemoryError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use wavecrest_api::glam::{DVec3, Vec3};
use wavecrest_api::{self as api, Choice};

use super::{Error, exception};

/// The input to render.
pub(crate) enum Source {
    /// A scene file, a glTF file or a mesh.
    File(PathBuf),
    /// A scene as JSON, with paths relative to the current folder.
    Json(String),
    /// A mesh as arrays.
    Mesh(api::MeshData),
}

impl Source {
    pub(crate) fn new(
        scene: &Bound<'_, PyAny>,
        faces: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        if let Some(mesh) = mesh(scene, faces)? {
            return Ok(Self::Mesh(mesh));
        }
        if scene.is_instance_of::<PyDict>() {
            let json = scene.py().import("json")?.call_method1("dumps", (scene,))?;
            return Ok(Self::Json(json.extract()?));
        }
        needed("scene", "a path, a dict, a mesh, or vertices with faces", scene, |path| {
            path.extract()
        })
        .map(Self::File)
    }
}

/// A mesh from arrays of the shapes (N, 3) and (M, 3), or from an object that has them, such as one of
/// trimesh; `None` for anything else.
pub(crate) fn mesh(
    vertices: &Bound<'_, PyAny>,
    faces: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<api::MeshData>> {
    match faces {
        Some(faces) => from_arrays(vertices, faces).map(Some),
        None if vertices.hasattr("faces")? => {
            from_arrays(&vertices.getattr("vertices")?, &vertices.getattr("faces")?).map(Some)
        }
        None => Ok(None),
    }
}

/// As [`mesh`]. Coordinates in double precision that are far from zero are kept relative to an origin,
/// as those of files.
fn from_arrays(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<api::MeshData> {
    let vertices = Points::new("vertices", vertices)?;
    let vertices = vertices.rows()?;
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

/// Points or vectors in an array of the shape (N, 3).
pub(crate) enum Points<'py> {
    Single(PyReadonlyArrayDyn<'py, f32>),
    Double(PyReadonlyArrayDyn<'py, f64>),
}

impl<'py> Points<'py> {
    /// Those of anything that NumPy accepts: float32 and float64 as they are, others as float64.
    pub(crate) fn new(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let is_single = value.extract::<PyReadonlyArrayDyn<'_, f32>>().is_ok();
        Ok(match is_single {
            true => Self::Single(array(name, value, "float32", "(N, 3)")?),
            false => Self::Double(array(name, value, "float64", "(N, 3)")?),
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

    #[inline]
    pub(crate) fn get(&self, i: usize) -> DVec3 {
        match self {
            Self::Single(rows) => Vec3::from(rows[i]).as_dvec3(),
            Self::Double(rows) => DVec3::from(rows[i]),
        }
    }
}

/// An array from anything that NumPy accepts, with elements of the type `kind`, without rounding
/// floats to integers, and with a shape such as "(N, 3)".
fn array<'py, T: Element>(
    name: &str,
    value: &Bound<'py, PyAny>,
    kind: &str,
    expected: &str,
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
    let array: PyReadonlyArrayDyn<'py, T> = cast.map_err(wrong)?.extract()?;
    let shape = array.shape();
    if shape.len() != expected.split(',').count() || shape.last() != Some(&3) {
        let message = format!("{name}: must have the shape {expected}, found {shape:?}");
        return Err(Error::new_err(message));
    }
    Ok(array)
}

/// The rows of an array whose last dimension is 3.
fn rows<'a, T: Element>(array: &'a PyReadonlyArrayDyn<'_, T>) -> PyResult<&'a [[T; 3]]> {
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

/// An array of linear colours as an image.
pub(crate) fn film(image: &Bound<'_, PyAny>) -> PyResult<api::Film> {
    let array = array::<f32>("image", image, "float32", "(height, width, 3)")?;
    let side = |i: usize| u32::try_from(array.shape()[i]).unwrap_or(u32::MAX);
    let pixels = collected(rows(&array)?.iter().map(|&row| Ok(row)))?;
    api::Film::from_pixels(side(1), side(0), pixels).map_err(|e| exception(&e))
}

/// An optional argument: its name, and its value.
pub(crate) type Argument<'a, 'py> = (&'static str, Option<&'a Bound<'py, PyAny>>);

/// The value of an argument as `read` converts it; `what` describes it.
pub(crate) fn given<'py, T>(
    (key, value): Argument<'_, 'py>,
    what: &str,
    read: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
) -> PyResult<Option<T>> {
    value.map(|value| needed(key, what, value, read)).transpose()
}

/// As [`given`], for an argument that is not optional.
pub(crate) fn needed<'py, T>(
    key: &str,
    what: &str,
    value: &Bound<'py, PyAny>,
    read: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
) -> PyResult<T> {
    read(value).map_err(|error| {
        let found: String = value.repr().map_or_else(|_| "?".into(), |text| text.to_string());
        let found: String = found.chars().take(LONGEST_VALUE).collect();
        let message = format!("{key}: must be {what}, found {found}");
        match error.is_instance_of::<PyTypeError>(value.py()) {
            true => PyTypeError::new_err(message),
            false => Error::new_err(message),
        }
    })
}

/// Messages quote no more characters of a value.
const LONGEST_VALUE: usize = 80;

/// A text.
pub(crate) fn text(argument: Argument<'_, '_>) -> PyResult<Option<String>> {
    given(argument, "a text", |value| value.extract())
}

/// The value with that name.
pub(crate) fn named<T: Choice>(argument: Argument<'_, '_>) -> PyResult<Option<T>> {
    let (key, Some(name)) = (argument.0, text(argument)?) else { return Ok(None) };
    let names = || T::VALUES.iter().map(|value| value.name()).collect::<Vec<_>>().join(", ");
    let wrong = || Error::new_err(format!("{key}: must be one of {}, found {name:?}", names()));
    T::by_name(&name).map(Some).ok_or_else(wrong)
}

/// The value of the text.
pub(crate) fn parsed<T: FromStr<Err = String>>(
    key: &str,
    text: Option<String>,
) -> PyResult<Option<T>> {
    let Some(text) = text else { return Ok(None) };
    let wrong = |remedy| Error::new_err(format!("{key}: {remedy}, found {text:?}"));
    text.parse().map(Some).map_err(wrong)
}

/// The lighting of a file without lights.
pub(crate) fn lighting(
    lights: Argument<'_, '_>,
    background: Argument<'_, '_>,
    crease: Argument<'_, '_>,
) -> PyResult<api::Lighting> {
    let usual = api::Lighting::USUAL;
    let crease = given(crease, "a number of degrees", |value| value.extract())?;
    let crease_degrees = crease.unwrap_or(usual.crease_degrees);
    if !(0.0..=180.0).contains(&crease_degrees) {
        let message = format!("crease: must be from 0 to 180 degrees, found {crease_degrees}");
        return Err(Error::new_err(message));
    }
    let read = |value: &Bound<'_, PyAny>| value.extract::<[f64; 3]>();
    let background = given(background, "three numbers", read)?.map(DVec3::from);
    if let Some(color) =
        background.filter(|color| !(color.is_finite() && color.min_element() >= 0.0))
    {
        let message = format!("background: must be three numbers of at least 0, found {color}");
        return Err(Error::new_err(message));
    }
    Ok(api::Lighting {
        replaces: lights.1.is_some(),
        rig: named(lights)?.unwrap_or(usual.rig),
        background: background.map(api::Background::Color),
        crease_degrees,
    })
}
