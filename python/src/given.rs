//! Rays as given, and arrays of answers.

use std::ops::Range;

use numpy::{Element, PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;
use wavecrest_api as api;

use super::arrays::Points;
use super::input::{self, Argument};
use super::rays::Rays;
use super::shapes::Shapes;
use super::{Error, exception, work};

/// An array of one value for each ray or hit.
pub(crate) type Column<'py, T> = Bound<'py, PyArray1<T>>;

/// The names of rays in queries.
pub(crate) const NAMES: [&str; 2] = ["origins", "directions"];

/// Rays as given, or points.
pub(crate) struct Given<'py> {
    pub(crate) py: Python<'py>,
    origins: Points<'py>,
    directions: Option<Points<'py>>,
    pub(crate) count: usize,
    range: [f64; 2],
    /// Whether answers are in double precision for numbers of single precision too.
    is_double: bool,
}

impl<'py> Given<'py> {
    /// Rays from `t_min` to `t_max` from arrays with these names. One origin or direction is that of all.
    pub(crate) fn new(
        [origins, directions]: [&str; 2],
        [from, along]: [&Bound<'py, PyAny>; 2],
        [t_min, t_max]: [Option<&Bound<'py, PyAny>>; 2],
    ) -> PyResult<Self> {
        let py = from.py();
        let (from, along) = (Points::new(origins, from)?, Points::new(directions, along)?);
        let count = match [from.rows()?.len(), along.rows()?.len()] {
            [1, count] | [count, 1] => count,
            [count, other] if count == other => count,
            [expected, found] => {
                return Err(Error::new_err(format!(
                    "{directions}: must have the shape of {origins}, [{expected}, 3], or be one, found \
                     [{found}, 3]"
                )));
            }
        };
        let range = [
            end(("t_min", t_min))?.unwrap_or(0.0),
            end(("t_max", t_max))?.unwrap_or(f64::INFINITY),
        ];
        Ok(Self { py, origins: from, directions: Some(along), count, range, is_double: false })
    }

    pub(crate) fn in_double(self) -> Self {
        Self { is_double: true, ..self }
    }

    /// Points.
    pub(crate) fn points(points: &Bound<'py, PyAny>) -> PyResult<Self> {
        let origins = Points::new("points", points)?;
        let (py, count) = (points.py(), origins.rows()?.len());
        Ok(Self {
            py,
            origins,
            directions: None,
            count,
            range: [0.0, f64::INFINITY],
            is_double: false,
        })
    }

    pub(crate) fn rays<'a>(&'a self, shapes: &'a Shapes) -> PyResult<Rays<'a>> {
        let origins = self.origins.rows()?;
        let directions = self.directions.as_ref().map(Points::rows).transpose()?;
        let is_single = !self.is_double
            && origins.is_single()
            && directions.is_none_or(|rows| rows.is_single())
            && shapes.meshes.iter().all(|mesh| mesh.is_single);
        Ok(Rays { shapes, count: self.count, origins, directions, range: self.range, is_single })
    }
}

fn end(argument: Argument<'_, '_>) -> PyResult<Option<f64>> {
    input::fitting(argument, "a number of at least 0", |t: &f64| *t >= 0.0)
}

/// Rays traced between two checks for Ctrl-C: a fraction of a second.
const STRETCH: usize = 1 << 20;

/// Does `work` for parts of `count` rays or hits, on all threads and without the GIL.
pub(crate) fn in_stretches(
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

/// An array that NumPy makes: "zeros", or "empty", which is left for threads to write first.
pub(crate) fn column<'py, T: Element>(
    py: Python<'py>,
    how: &str,
    count: usize,
) -> PyResult<Column<'py, T>> {
    let array = py.import("numpy")?.call_method1(how, (count, T::get_dtype(py)))?;
    Ok(array.cast_into()?)
}

/// Items that a thread computes at once.
const TOGETHER: usize = 1 << 12;

/// An array of so many rows, which are computed on all threads: of the shape (count,) if they have one
/// value, or else (count, K).
pub(crate) fn table<'py, T: Element + Send, const K: usize>(
    py: Python<'py>,
    count: usize,
    row: impl Fn(usize) -> [T; K] + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let array = column::<T>(py, "empty", count * K)?;
    let mut values = array.readwrite();
    let rows = values.as_slice_mut()?.as_chunks_mut().0;
    in_stretches(py, count, |part| {
        let rows = rows[part.clone()].par_iter_mut().zip(part).with_min_len(TOGETHER);
        rows.for_each(|(into, number)| *into = row(number));
        Ok(())
    })?;
    drop(values);
    if K == 1 { Ok(array.into_any()) } else { Ok(array.reshape([count, K])?.into_any()) }
}
