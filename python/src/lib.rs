//! The Python module `wavecrest`: renders a scene, a file or arrays to an array, and traces arrays of
//! rays.
//!
//! The image is that of the command, bit for bit. `wavecrest.pyi` has the types.

mod arrays;
mod given;
mod input;
mod mesh;
mod plane;
mod rays;
mod scene;
mod shapes;
mod source;
mod surface;
mod trimesh;
mod work;

use std::path::PathBuf;

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use wavecrest_api as api;

use source::Source;

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
/// to the current folder, and values or arrays of NumPy; a mesh or a scene of trimesh, with its colours, textures and
/// materials; or the vertices of a mesh, shape (N, 3), with the vertex indices of its triangles as faces, shape (M, 3), and
/// perhaps the normals and colors of its vertices, of the same shape as these: colours are from 0 to 1, or uint8, with the
/// sRGB curve. With normals or colors, those of a mesh of trimesh are left out.
///
/// A mesh is shown whole under studio lights; view, up, fov, fit, lights and crease change this, like the options of the
/// command. view is the name of a side, such as "iso", or its azimuth and elevation in degrees, such as (30, 20). samples is
/// the number of rays in a pixel, rounded up to a square; precision is "fast" or "exact" (default).
///
/// background is a linear colour, a text such as "#ff8000" in sRGB, or "transparent": then the image has the shape (height,
/// width, 4), with the coverage of the pixel from 0 to 1 as its last channel, by which the colours are multiplied.
///
/// camera is the name of one in a glTF file, or its pose: a matrix of 4 x 4 numbers from the space of the camera, which
/// looks along -z with y up, to that of the scene.
///
/// With layers, such as ["depth", "normal", "object"], returns the image and a dict of arrays: depth along the view,
/// shape (height, width), shading normals, shape (height, width, 3), numbers of shapes from 1, and others as in the
/// guide. Depth and object are 0 where there is nothing. A transparent background adds the layer "alpha".
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
                    fit=None, lights=None, background=None, crease=None, seed=None, samples=None, target_error=None,
                    precision=None, threads=None, normals=None, colors=None, layers=None))]
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
    fit: Option<Bound<'py, PyAny>>,
    lights: Option<Bound<'py, PyAny>>,
    background: Option<Bound<'py, PyAny>>,
    crease: Option<Bound<'py, PyAny>>,
    seed: Option<Bound<'py, PyAny>>,
    samples: Option<Bound<'py, PyAny>>,
    target_error: Option<Bound<'py, PyAny>>,
    precision: Option<Bound<'py, PyAny>>,
    threads: Option<Bound<'py, PyAny>>,
    normals: Option<Bound<'py, PyAny>>,
    colors: Option<Bound<'py, PyAny>>,
    layers: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    if samples.is_some() && target_error.is_some() {
        return Err(Error::new_err("samples: leave it out, or target_error"));
    }
    let side = |key, value| input::given((key, value), "a whole number of pixels");
    let seed = input::given(("seed", seed.as_ref()), "a whole number from 0 to 2^64 - 1")?;
    let target_error = input::fitting(
        ("target_error", target_error.as_ref()),
        "a finite number above 0",
        |error: &f64| error.is_finite() && *error > 0.0,
    )?;
    let framing = api::Framing {
        side: input::view(("view", view.as_ref()))?,
        up: input::named(("up", up.as_ref()))?,
        fov: input::number(("fov", fov.as_ref()), "a number of degrees")?,
        fit: input::number(("fit", fit.as_ref()), "a share of the image")?,
        ..api::Framing::default()
    };
    let (camera, pose) = input::camera(camera.as_ref())?;
    let lighting = input::lighting(
        ("lights", lights.as_ref()),
        ("background", background.as_ref()),
        ("crease", crease.as_ref()),
    )?;
    let is_transparent = lighting.background == Some(api::Background::Transparent);
    let options = api::LoadOptions {
        width: side("width", width.as_ref())?,
        height: side("height", height.as_ref())?,
        antialias: input::antialias(("samples", samples.as_ref()))?,
        camera,
        framing,
        lighting,
        ..api::LoadOptions::default()
    };
    let precision = input::named(("precision", precision.as_ref()))?.unwrap_or_default();
    let attributes = [("normals", normals.as_ref()), ("colors", colors.as_ref())];
    let source = Source::new(&scene, faces.as_ref(), attributes)?;
    let mut named = input::all_named::<api::Layer>(("layers", layers.as_ref()))?;
    named.extend(is_transparent.then_some(api::Layer::Alpha));
    let seed = seed.unwrap_or_default();
    let job =
        work::Job { source, options, precision, seed, target_error, pose, layers: named.clone() };
    let threads = work::threads(("threads", threads.as_ref()))?;
    let work::Done { film, channels, warnings } = work::run(py, job, threads)?;
    warn(py, warnings)?;
    let [height, width] = [film.height(), film.width()].map(|side| side as usize);
    let image = film.into_pixels().into_flattened().into_pyarray(py);
    let mut image = image.reshape([height, width, 3])?.into_any();
    let arrays = arrays(py, &named, channels, [height, width])?;
    if is_transparent {
        let alpha = api::Layer::Alpha.name();
        image = py.import("numpy")?.call_method1("dstack", ((image, arrays.get_item(alpha)?),))?;
    }
    match layers {
        Some(_) => Ok((image, arrays).into_pyobject(py)?.into_any()),
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

/// Writes an image returned by render to a .png, .ppm, .exr or .pfm file; with alpha to a .png, whose colours are not
/// multiplied by it, or an .exr, whose colours are.
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
    let py = image.py();
    let (image, channels) = with_alpha(image)?;
    let film = input::film(&image, transfer)?;
    let has_alpha =
        matches!(api::Format::from_path(&path), Ok(api::Format::Png | api::Format::Exr));
    if !channels.is_empty() && !has_alpha {
        return Err(Error::new_err("path: an image with alpha needs .png or .exr"));
    }
    let extras = api::Extras { channels: &channels, ..Default::default() };
    let written = py.detach(|| api::write_image_with(&film, &path, transfer, &extras));
    written.map_err(|e| exception(&e))
}

/// The colours of an image, and its coverage as a channel if it has one.
fn with_alpha(image: Bound<'_, PyAny>) -> PyResult<(Bound<'_, PyAny>, Vec<api::Channel>)> {
    let numpy = image.py().import("numpy")?;
    let shape: Vec<usize> = numpy.call_method1("shape", (&image,))?.extract()?;
    if !matches!(shape[..], [_, _, 4]) || arrays::has_type::<u8>(&image)? {
        return Ok((image, Vec::new()));
    }
    let [colors, alpha]: [Bound<'_, PyAny>; 2] =
        numpy.call_method1("split", (image, [3], -1))?.extract()?;
    let alpha = alpha.call_method1("astype", ("float32",))?.call_method0("ravel")?;
    let values = api::Values::Floats(alpha.extract()?);
    let name = api::Layer::Alpha.channels()[0].to_owned();
    Ok((colors, vec![api::Channel { name, values }]))
}

/// Renders scenes, mesh files and arrays to NumPy arrays: render and save. Queries of rays: Mesh and Scene.
#[pymodule]
fn wavecrest(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<trimesh::RayMeshIntersector>()?;
    module.add_function(wrap_pyfunction!(render, module)?)?;
    module.add_function(wrap_pyfunction!(save, module)?)
}
