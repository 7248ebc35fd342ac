//! The Python module `wavecrest`: renders a scene, a file or arrays to an array, and traces arrays of
//! rays.
//!
//! The image is that of the command, bit for bit. `wavecrest.pyi` has the types.

mod input;
mod mesh;
mod rays;
mod trimesh;
mod work;

use std::path::PathBuf;

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use wavecrest_api as api;

pyo3::create_exception!(
    wavecrest,
    Error,
    PyValueError,
    "An error in the input: the message names the file, the place in it, the value and the remedy."
);

/// The exception of an error.
fn exception(error: &api::Error) -> PyErr {
    Error::new_err(error.to_string())
}

/// Issues warnings.
fn warn(py: Python<'_>, warnings: Vec<api::Warning>) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    for warning in warnings {
        let text = std::ffi::CString::new(warning.to_string().replace('\0', "\u{fffd}"))?;
        PyErr::warn(py, &category, &text, 1)?;
    }
    Ok(())
}

/// Renders a scene to an array of shape (height, width, 3), top row first.
///
/// scene is the path of a scene file, a glTF file or a mesh (PLY, OBJ, STL); a scene as a dict, with paths relative
/// to the current folder; a mesh of trimesh; or the vertices of a mesh, shape (N, 3), with the vertex indices of its
/// triangles as faces, shape (M, 3), and perhaps the normals and colors of its vertices, of the same shape as these:
/// colours are from 0 to 1, or uint8, with the sRGB curve. A mesh is shown whole under studio lights; view, up, fov, lights and crease change this, like the
/// options of the command. background is a linear colour; precision is "fast" or "exact" (default).
///
/// camera is the name of one in a glTF file, or its pose: a matrix of 4 x 4 numbers from the space of the camera, which
/// looks along -z with y up, to that of the scene.
///
/// With layers, such as ["depth", "normal", "object"], returns the image and a dict of arrays: depth along the view,
/// shape (height, width), shading normals, shape (height, width, 3), numbers of shapes from 1, and others as in the
/// guide. Depth and object are 0 where there is nothing.
///
/// target_error chooses sampler and samples, instead of those of the scene, for an image with at most this error (RMSE
/// of linear values). It is measured, without what one ray through the centre of each pixel misses at edges where
/// points on lights or the lens are chosen; a warning says if it cannot be reached.
///
/// Values are linear red, green and blue; 8-bit formats store 0 to 1. The number of threads does not change them.
///
/// Raises wavecrest.Error if the input cannot be rendered, or if the system refuses the memory that the render is
/// estimated to take; issues warnings. Ctrl-C stops the render.
///
/// >>> image = wavecrest.render(mesh.vertices, mesh.faces, view="iso", width=800, height=600)  # a mesh of trimesh
/// >>> wavecrest.save("mesh.png", image)
#[pyfunction]
#[pyo3(signature = (scene, faces=None, *, width=None, height=None, camera=None, view=None, up=None, fov=None,
                    lights=None, background=None, crease=None, seed=None, target_error=None, precision=None,
                    threads=None, normals=None, colors=None, layers=None))]
#[allow(clippy::too_many_arguments, reason = "they are keywords in Python")]
fn render<'py>(
    py: Python<'py>,
    scene: Bound<'py, PyAny>,
    faces: Option<Bound<'py, PyAny>>,
    width: Option<Bound<'py, PyAny>>,
    height: Option<Bound<'py, PyAny>>,
    camera: Option<Bound<'py, PyAny>>,
    view: Option<Bound<'py, PyAny>>,
    up: Option<Bound<'py, PyAny>>,
    fov: Option<Bound<'py, PyAny>>,
    lights: Option<Bound<'py, PyAny>>,
    background: Option<Bound<'py, PyAny>>,
    crease: Option<Bound<'py, PyAny>>,
    seed: Option<Bound<'py, PyAny>>,
    target_error: Option<Bound<'py, PyAny>>,
    precision: Option<Bound<'py, PyAny>>,
    threads: Option<Bound<'py, PyAny>>,
    normals: Option<Bound<'py, PyAny>>,
    colors: Option<Bound<'py, PyAny>>,
    layers: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let side = |key, value| input::given((key, value), "a whole number of pixels");
    let fov: Option<f64> = input::given(("fov", fov.as_ref()), "a number of degrees")?;
    let seed = input::given(("seed", seed.as_ref()), "a whole number from 0 to 2^64 - 1")?;
    let target_error = input::fitting(
        ("target_error", target_error.as_ref()),
        "a finite number above 0",
        |error: &f64| error.is_finite() && *error > 0.0,
    )?;
    let framing = api::Framing {
        side: input::parsed("view", input::text(("view", view.as_ref()))?)?,
        up: input::named(("up", up.as_ref()))?,
        fov: input::parsed("fov", fov.map(|degrees| degrees.to_string()))?,
        ..api::Framing::default()
    };
    let (camera, pose) = input::camera(camera.as_ref())?;
    let options = api::LoadOptions {
        width: side("width", width.as_ref())?,
        height: side("height", height.as_ref())?,
        camera,
        framing,
        lighting: input::lighting(
            ("lights", lights.as_ref()),
            ("background", background.as_ref()),
            ("crease", crease.as_ref()),
        )?,
        ..api::LoadOptions::default()
    };
    let precision = input::named(("precision", precision.as_ref()))?.unwrap_or_default();
    let attributes = [("normals", normals.as_ref()), ("colors", colors.as_ref())];
    let source = input::Source::new(&scene, faces.as_ref(), attributes)?;
    let named = input::all_named::<api::Layer>(("layers", layers.as_ref()))?;
    let seed = seed.unwrap_or_default();
    let job =
        work::Job { source, options, precision, seed, target_error, pose, layers: named.clone() };
    let threads = work::threads(("threads", threads.as_ref()))?;
    let work::Done { film, channels, warnings } = work::run(py, job, threads)?;
    warn(py, warnings)?;
    let [height, width] = [film.height(), film.width()].map(|side| side as usize);
    let image = film.into_pixels().into_flattened().into_pyarray(py);
    let image = image.reshape([height, width, 3])?.into_any();
    match layers {
        Some(_) => Ok((image, arrays(py, &named, channels, [height, width])?)
            .into_pyobject(py)?
            .into_any()),
        None => Ok(image),
    }
}

/// An array for each layer, by its name.
fn arrays<'py>(
    py: Python<'py>,
    layers: &[api::Layer],
    channels: Vec<api::Channel>,
    size: [usize; 2],
) -> PyResult<Bound<'py, PyDict>> {
    let numpy = py.import("numpy")?;
    let arrays = PyDict::new(py);
    let mut channels = channels.into_iter();
    for layer in api::Layer::ALL.into_iter().filter(|layer| layers.contains(layer)) {
        let own =
            channels.by_ref().take(layer.channels().len()).map(|channel| match channel.values {
                api::Values::Floats(all) => Ok(all.into_pyarray(py).reshape(size)?.into_any()),
                api::Values::Integers(all) => Ok(all.into_pyarray(py).reshape(size)?.into_any()),
            });
        let own = own.collect::<PyResult<Vec<_>>>()?;
        let array = match &own[..] {
            [only] => only.clone(),
            _ => numpy.call_method1("stack", (&own, -1))?,
        };
        arrays.set_item(layer.name(), array)?;
    }
    Ok(arrays)
}

/// Writes an image returned by render to a .png, .ppm, .exr or .pfm file.
///
/// 8-bit formats use the transfer curve "srgb" (default) or "linear"; .exr and .pfm are always linear. An image of
/// uint8 has been through that curve: its values are stored as they are in 8-bit formats.
///
/// Raises wavecrest.Error if the file cannot be written.
#[pyfunction]
#[pyo3(signature = (path, image, *, transfer=None))]
fn save(
    path: Bound<'_, PyAny>,
    image: Bound<'_, PyAny>,
    transfer: Option<Bound<'_, PyAny>>,
) -> PyResult<()> {
    let path: PathBuf = input::needed("path", "a path", &path, |path| path.extract())?;
    let transfer = input::named(("transfer", transfer.as_ref()))?.unwrap_or(api::Transfer::Srgb);
    let film = input::film(&image, transfer)?;
    image.py().detach(|| api::write_image(&film, &path, transfer)).map_err(|e| exception(&e))
}

/// Renders scenes, mesh files and arrays to NumPy arrays: render and save. Queries of rays: Mesh.
#[pymodule]
fn wavecrest(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<trimesh::RayMeshIntersector>()?;
    module.add_function(wrap_pyfunction!(render, module)?)?;
    module.add_function(wrap_pyfunction!(save, module)?)
}
