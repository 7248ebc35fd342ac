//! Arrays of NumPy: contiguous ones as given, and those of answers.

use numpy::ndarray::Dimension;
use numpy::{Element, PyArray1, PyArrayMethods, PyReadonlyArray, PyReadonlyArray2};
use pyo3::prelude::*;
use wavecrest_api as api;
use wavecrest_api::glam::{DVec3, Vec3};
use wavecrest_api::memory::reserve;
use wavecrest_api::parallel;

use super::base::{Any, exception, in_stretches};

/// Points or vectors, shape (N, 3).
#[derive(FromPyObject)]
pub(crate) enum Points<'py> {
    Single(PyReadonlyArray2<'py, f32>),
    Double(PyReadonlyArray2<'py, f64>),
}

impl Points<'_> {
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

    /// The row with this number, or the only one.
    #[inline]
    pub(crate) fn get(&self, i: usize) -> DVec3 {
        match self {
            Self::Single(rows) => Vec3::from(rows[i.min(rows.len() - 1)]).as_dvec3(),
            Self::Double(rows) => DVec3::from(rows[i.min(rows.len() - 1)]),
        }
    }
}

/// The rows of an array with a last dimension of this length.
fn rows<'a, T: Element, D: Dimension, const K: usize>(
    array: &'a PyReadonlyArray<'_, T, D>,
) -> PyResult<&'a [[T; K]]> {
    Ok(array.as_slice()?.as_chunks().0)
}

/// A mesh: positions, (N, 3), relative to an origin, faces, (M, 3), with the vertex indices of triangles, and perhaps
/// normals and colours of vertices, (N, 3).
#[derive(FromPyObject)]
pub(crate) struct Mesh<'py>(
    PyReadonlyArray2<'py, f32>,
    [f64; 3],
    PyReadonlyArray2<'py, u32>,
    [Option<PyReadonlyArray2<'py, f32>>; 2],
);

impl Mesh<'_> {
    pub(crate) fn data(&self) -> PyResult<api::MeshData> {
        let Self(positions, origin, faces, [normals, colors]) = self;
        let normals = normals.as_ref().map(vectors).transpose()?;
        Ok(api::MeshData {
            positions: vectors(positions)?.into(),
            origin: (*origin).into(),
            triangles: vectors(faces)?.into(),
            normals: normals.map(api::Attribute::from),
            colors: colors.as_ref().map(vectors).transpose()?.map(Into::into),
            ..api::MeshData::default()
        })
    }
}

/// The rows of an array as a list, or an exception if the system refuses the memory.
pub(crate) fn vectors<T: From<[E; K]>, E: Element + Copy, D: Dimension, const K: usize>(
    array: &PyReadonlyArray<'_, E, D>,
) -> PyResult<Vec<T>> {
    let rows = rows(array)?;
    let mut list = reserve(rows.len(), "a copy of an array").map_err(exception)?;
    list.extend(rows.iter().map(|&row| T::from(row)));
    Ok(list)
}

/// An array of one value for each ray or hit.
pub(crate) type Column<'py, T> = Bound<'py, PyArray1<T>>;

/// An array that NumPy makes: "zeros", or "empty", which is left for threads to write first.
pub(crate) fn column<'py, T: Element>(
    py: Python<'py>,
    how: &str,
    count: usize,
) -> PyResult<Column<'py, T>> {
    let array = py.import("numpy")?.call_method1(how, (count, T::get_dtype(py)))?;
    Ok(array.cast_into()?)
}

/// An array of so many rows, which are computed on all threads: of the shape (count,) if they have one
/// value, or else (count, K).
pub(crate) fn table<'py, T: Element + Send, const K: usize>(
    py: Python<'py>,
    count: usize,
    row: impl Fn(usize) -> [T; K] + Sync,
) -> PyResult<Any<'py>> {
    let array = column::<T>(py, "empty", count * K)?;
    let mut values = array.readwrite();
    let rows = values.as_slice_mut()?.as_chunks_mut().0;
    in_stretches(py, count, |part| {
        let first = part.start;
        parallel::each_mut(&mut rows[part], |index, into| *into = row(first + index));
    })?;
    drop(values);
    if K == 1 { Ok(array.into_any()) } else { Ok(array.reshape([count, K])?.into_any()) }
}
