//! The Python module `wavecrest`: renders a scene, a file or arrays to an array.
//!
//! The image is that of the command, bit for bit. `wavecrest.pyi` has the types.

mod input;
mod mesh;
mod rays;
mod trimesh;
mod work;

use std::path::PathBuf;

use numpy::{IntoPyArray, PyArray3, PyArrayMethods};
use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;
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
/// to the current folder; or the vertices of a mesh, shape (N, 3), with the vertex indices of its triangles as faces,
/// shape (M, 3). A mesh is shown whole under studio lights; view, up, fov, lights and crease change this, like the
/// options of the command. background is a linear colour; precision is "fast" or "exact" (default).
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
                    lights=None, background=None, crease=None, seed=None, precision=None, threads=None))]
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
    precision: Option<Bound<'py, PyAny>>,
    threads: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let side = |key, value| {
        input::given((key, value), "a whole number of pixels", |value| value.extract())
    };
    let fov =
        input::given(("fov", fov.as_ref()), "a number of degrees", |value| value.extract::<f64>())?;
    let seed =
        input::given(("seed", seed.as_ref()), "a whole number from 0 to 2^64 - 1", |value| {
            value.extract()
        })?;
    let framing = api::Framing {
        side: input::parsed("view", input::text(("view", view.as_ref()))?)?,
        up: input::named(("up", up.as_ref()))?,
        fov: input::parsed("fov", fov.map(|degrees| degrees.to_string()))?,
        ..api::Framing::default()
    };
    let options = api::LoadOptions {
        width: side("width", width.as_ref())?,
        height: side("height", height.as_ref())?,
        camera: input::text(("camera", camera.as_ref()))?,
        framing,
        lighting: input::lighting(
            ("lights", lights.as_ref()),
            ("background", background.as_ref()),
            ("crease", crease.as_ref()),
        )?,
        ..api::LoadOptions::default()
    };
    let precision = input::named(("precision", precision.as_ref()))?.unwrap_or_default();
    let source = input::Source::new(&scene, faces.as_ref())?;
    let job = work::Job { source, options, precision, seed: seed.unwrap_or_default() };
    let threads = work::threads(("threads", threads.as_ref()))?;
    let work::Done { film, warnings } = work::run(py, job, threads)?;
    warn(py, warnings)?;
    let [height, width] = [film.height(), film.width()].map(|side| side as usize);
    film.into_pixels().into_flattened().into_pyarray(py).reshape([height, width, 3])
}

/// Writes an image returned by render to a .png, .ppm, .exr or .pfm file.
///
/// 8-bit formats use the transfer curve "srgb" (default) or "linear"; .exr and .pfm are always linear.
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
    let film = input::film(&image)?;
    image.py().detach(|| api::write_image(&film, &path, transfer)).map_err(|e| exception(&e))
}

/// Renders scenes, mesh files and arrays to NumPy arrays: render and save.
#[pymodule]
fn wavecrest(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<trimesh::RayMeshIntersector>()?;
    module.add_function(wrap_pyfunction!(render, module)?)?;
    module.add_function(wrap_pyfunction!(save, module)?)
}
