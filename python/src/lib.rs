//! The native part of the Python module `wavecrest`: trees, queries of rays, renders and image files.
//!
//! What users see, and its documentation, is in `wavecrest/__init__.py`: it checks and converts arrays, and makes the
//! others of the answers. Arrays are contiguous here, with the types that functions name, and indices within range.

mod arrays;
mod input;
mod plane;
mod queries;
mod rays;
mod scene;
mod shapes;
mod work;

use std::path::PathBuf;

use numpy::{
    IntoPyArray, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use wavecrest_api as api;

use arrays::vectors;
use input::Options;

pyo3::create_exception!(
    wavecrest,
    Error,
    PyValueError,
    "An error in the input: the message names the file, the place in it, the value and the remedy."
);

/// A value of Python.
type Any<'py> = Bound<'py, PyAny>;

/// The exception of an error.
#[expect(clippy::needless_pass_by_value, reason = "for map_err")]
fn exception(error: api::Error) -> PyErr {
    Error::new_err(error.to_string())
}

/// The origin of a mesh with this first vertex: zero unless that is far from it.
#[pyfunction]
fn origin(first: [f64; 3]) -> [f64; 3] {
    api::mesh::origin(first.into()).into()
}

/// A layer: its name, and its channels.
type NamedChannels<'py> = (&'static str, Vec<Any<'py>>);

/// Renders the source, of a kind as in [`work::Source`], with the arguments of wavecrest.render by name. Returns the
/// image, (height, width, 3), layers, each channel of the shape (height, width), and warnings.
#[pyfunction]
fn render<'py>(
    py: Python<'py>,
    kind: &str,
    source: &Any<'py>,
    options: Bound<'py, PyDict>,
) -> PyResult<(Any<'py>, Vec<NamedChannels<'py>>, Vec<String>)> {
    let options = Options(options);
    let job = work::Job::new((kind, source), &options)?;
    let layers = job.layers.clone();
    let (film, channels, warnings) = work::run(py, job, &options)?;
    let size = [film.height(), film.width()].map(|side| side as usize);
    let image = film.into_pixels().into_flattened().into_pyarray(py);
    let image = image.reshape([size[0], size[1], 3])?.into_any();
    let mut channels = channels.into_iter().map(|channel| match channel.values {
        api::Values::Floats(all) => Ok(all.into_pyarray(py).reshape(size)?.into_any()),
        api::Values::Integers(all) => Ok(all.into_pyarray(py).reshape(size)?.into_any()),
    });
    let layers = api::Layer::ALL.into_iter().filter(|layer| layers.contains(layer)).map(|layer| {
        let own: PyResult<_> = channels.by_ref().take(layer.channels().len()).collect();
        Ok((layer.name(), own?))
    });
    let warnings = warnings.iter().map(ToString::to_string).collect();
    Ok((image, layers.collect::<PyResult<_>>()?, warnings))
}

/// The linear values of the 8-bit levels of sRGB.
#[pyfunction]
fn srgb_levels() -> Vec<f32> {
    (0..=u8::MAX).map(|level| api::srgb_decode(f32::from(level) / f32::from(u8::MAX))).collect()
}

/// Writes an image of linear values, (height, width, 3), perhaps with its coverage, (height, width), to a file.
#[pyfunction]
fn save(
    py: Python<'_>,
    path: PathBuf,
    image: PyReadonlyArray3<'_, f32>,
    alpha: Option<PyReadonlyArray2<'_, f32>>,
    options: Bound<'_, PyDict>,
) -> PyResult<()> {
    let transfer = Options(options).get("transfer", input::named)?.unwrap_or(api::Transfer::Srgb);
    let side = |i: usize| u32::try_from(image.shape()[i]).unwrap_or(u32::MAX);
    let film = api::Film::from_pixels(side(1), side(0), vectors(&image)?).map_err(exception)?;
    let has_alpha =
        matches!(api::Format::from_path(&path), Ok(api::Format::Png | api::Format::Exr));
    if alpha.is_some() && !has_alpha {
        return Err(Error::new_err("path: an image with alpha needs .png or .exr"));
    }
    let name = api::Layer::Alpha.channels()[0].to_owned();
    let alpha = alpha.map(|alpha| alpha.to_vec()).transpose()?;
    let channel = alpha.map(|alpha| api::Channel { name, values: api::Values::Floats(alpha) });
    let extras = api::Extras { channels: channel.as_slice(), ..Default::default() };
    let written = py.detach(|| api::write_image_with(&film, &path, transfer, &extras));
    written.map_err(exception)
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_function(wrap_pyfunction!(shapes::mesh, module)?)?;
    module.add_function(wrap_pyfunction!(shapes::load, module)?)?;
    module.add_function(wrap_pyfunction!(origin, module)?)?;
    module.add_function(wrap_pyfunction!(scene::scene, module)?)?;
    module.add_function(wrap_pyfunction!(render, module)?)?;
    module.add_function(wrap_pyfunction!(srgb_levels, module)?)?;
    module.add_function(wrap_pyfunction!(save, module)?)
}
