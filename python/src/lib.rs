//! The native part of the Python module `wavecrest`: trees, queries of rays, renders and image files.
//!
//! What users see, and its documentation, is in `wavecrest/__init__.py`: it checks and converts arrays, and makes the
//! others of the answers. Arrays are contiguous here, with the types that functions name, and indices within range.

mod arrays;
mod base;
mod input;
mod plane;
mod queries;
mod rays;
mod render;
mod shapes;

use std::path::PathBuf;

use numpy::{PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use wavecrest_api as api;

use arrays::vectors;
use base::{Error, exception, on_threads};
use input::Options;

/// The origin of a mesh with this first vertex: zero unless that is far from it.
#[pyfunction]
fn origin(first: [f64; 3]) -> [f64; 3] {
    api::mesh::origin(first.into()).into()
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
    let transfer = Options(options).named("transfer")?.unwrap_or(api::Transfer::Srgb);
    let side = |i: usize| u32::try_from(image.shape()[i]).unwrap_or(u32::MAX);
    let film = api::Film::from_pixels(side(1), side(0), vectors(&image)?).map_err(exception)?;
    let has_alpha = api::Format::from_path(&path).is_ok_and(api::Format::has_alpha);
    if alpha.is_some() && !has_alpha {
        return Err(Error::new_err("path: an image with alpha needs .png or .exr"));
    }
    let name = api::Layer::Alpha.channels()[0].to_owned();
    let alpha = alpha.map(|alpha| alpha.as_slice().map(<[f32]>::to_vec)).transpose()?;
    let channel = alpha.map(|alpha| api::Channel { name, values: api::Values::Floats(alpha) });
    let extras = api::Extras { channels: channel.as_slice(), ..Default::default() };
    let write = || api::write_image_with(&film, &path, transfer, &extras);
    on_threads(py, write)?.map_err(exception)
}

/// The name, of `names`, that was likely meant by a word.
#[pyfunction]
fn did_you_mean(word: &str, names: Vec<String>) -> Option<String> {
    api::did_you_mean(word, names.iter().map(String::as_str)).map(str::to_owned)
}

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::render::render;
    #[pymodule_export]
    use super::shapes::{load, mesh, scene};
    #[pymodule_export]
    use super::{Error, did_you_mean, origin, save, srgb_levels};

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    const MOST_SAMPLES: u32 = super::api::MOST_SAMPLES;
    #[pymodule_export]
    const MOST_STOPS: f32 = super::api::Develop::MOST_STOPS;
}
