//! The input of a render.
//!
//! trimesh writes its scenes, and its meshes with colours or a material, as glTF. A copy is changed before: corners that
//! faces share are divided, so that colours of faces stay crisp; a material without metalness becomes no metal, which its
//! image alone colours; and a mesh that is far from zero is moved there in double precision. Normals are left out, as for
//! any mesh: whether trimesh has computed them must not matter.

use std::path::PathBuf;

use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use wavecrest_api as api;
use wavecrest_api::glam::{DVec3, Vec3};

use super::Error;
use super::arrays::{Points, collected, has_type, mesh};
use super::input::{Argument, needed};

/// The input to render.
pub(crate) enum Source {
    /// A scene file, a glTF file or a mesh.
    File(PathBuf),
    /// A scene as JSON, with paths relative to the current folder.
    Json(String),
    /// A mesh as arrays.
    Mesh(api::MeshData),
    /// A scene of trimesh, or a mesh of it with colours or a material, as a GLB file.
    Glb(Vec<u8>),
}

impl Source {
    /// Of `attributes`, the normals and the colours of vertices.
    pub(crate) fn new(
        scene: &Bound<'_, PyAny>,
        faces: Option<&Bound<'_, PyAny>>,
        attributes: [Argument<'_, '_>; 2],
    ) -> PyResult<Self> {
        let is_plain = faces.is_some() || attributes.iter().any(|(_, value)| value.is_some());
        if !is_plain && let Some(bytes) = glb(scene)? {
            return Ok(Self::Glb(bytes));
        }
        if let Some(mesh) = mesh(scene, faces)? {
            return with_attributes(mesh, attributes).map(Self::Mesh);
        }
        if let Some((key, _)) = attributes.iter().find(|(_, value)| value.is_some()) {
            return Err(Error::new_err(format!("{key}: only for vertices with faces")));
        }
        if scene.is_instance_of::<PyDict>() {
            return json(scene).map(Self::Json);
        }
        let what = "a path, a dict, a mesh, a scene of trimesh, or vertices with faces";
        needed("scene", what, scene, |path| path.extract()).map(Self::File)
    }
}

/// A scene in JSON, from values of JSON and of NumPy.
fn json(scene: &Bound<'_, PyAny>) -> PyResult<String> {
    let py = scene.py();
    let as_list = py.import("operator")?.call_method1("methodcaller", ("tolist",))?;
    let options = [("default", as_list)].into_py_dict(py)?;
    let text = py.import("json")?.call_method("dumps", (scene,), Some(&options));
    text.map_err(|error| Error::new_err(format!("scene: as JSON: {}", error.value(py))))?.extract()
}

/// The mesh with these normals and colours of its vertices.
fn with_attributes(
    mut mesh: api::MeshData,
    [normals, colors]: [Argument<'_, '_>; 2],
) -> PyResult<api::MeshData> {
    let count = mesh.positions.len();
    mesh.normals = by_vertex(normals, count, |normal| normal.is_finite())?
        .map(|values| api::Attribute { values, indices: None });
    mesh.colors =
        by_vertex(colors, count, |color| color.is_finite() && color.min_element() >= 0.0)?;
    if let (Some(colors), Some(value)) = (&mut mesh.colors, colors.1)
        && has_type::<u8>(value)?
    {
        colors.iter_mut().for_each(|color| *color /= f32::from(u8::MAX));
    }
    Ok(mesh)
}

/// An argument with a row for each of so many vertices.
fn by_vertex(
    (key, value): Argument<'_, '_>,
    count: usize,
    is_right: impl Fn(Vec3) -> bool,
) -> PyResult<Option<Vec<Vec3>>> {
    let Some(value) = value else { return Ok(None) };
    let points = Points::new(key, value)?;
    let rows = points.rows()?;
    if rows.len() != count {
        let found = rows.len();
        let message =
            format!("{key}: must have the shape of vertices, [{count}, 3], found [{found}, 3]");
        return Err(Error::new_err(message));
    }
    let row = |i: usize| match rows.get(i).as_vec3() {
        row if is_right(row) => Ok(row),
        row => Err(Error::new_err(format!(
            "{key}[{i}]: must be finite, and colours at least 0, found {row}"
        ))),
    };
    collected((0..count).map(row)).map(Some)
}

/// The bytes of a GLB file with a scene, or with a mesh that has visuals; `None` for anything else.
pub(crate) fn glb(scene: &Bound<'_, PyAny>) -> PyResult<Option<Vec<u8>>> {
    let is_scene = scene.hasattr("graph")? && scene.hasattr("geometry")?;
    if !is_scene && kind(scene)?.is_none() {
        return Ok(None);
    }
    exported(scene, is_scene).map(Some).map_err(|error| match error.value(scene.py()) {
        value if value.is_instance_of::<PyMemoryError>() => error,
        why => Error::new_err(format!("scene: {why}; correct it, or give vertices and faces")),
    })
}

/// Whether a mesh has colours by "vertex" or "face", or a "texture".
fn kind(mesh: &Bound<'_, PyAny>) -> PyResult<Option<String>> {
    let visual = mesh.getattr_opt("visual")?.filter(|_| mesh.hasattr("faces").unwrap_or(false));
    let kind = visual.map(|visual| visual.getattr_opt("kind")).transpose()?.flatten();
    Ok(kind.and_then(|kind| kind.extract().ok()))
}

fn exported(given: &Bound<'_, PyAny>, is_scene: bool) -> PyResult<Vec<u8>> {
    let py = given.py();
    let mut scene = given.call_method0("copy")?;
    if !is_scene {
        let first = scene.getattr("vertices")?.get_item(0)?.extract::<[f64; 3]>()?;
        let origin = api::mesh::origin(DVec3::from(first));
        scene.call_method1("apply_translation", ((-origin).to_array(),))?;
        scene = scene.call_method0("scene")?;
        scene.call_method1("apply_translation", (origin.to_array(),))?;
    }
    // trimesh makes a camera up once it is asked for one.
    scene.setattr("_camera", py.None())?;
    for part in scene.getattr("geometry")?.call_method0("values")?.try_iter()? {
        let part = part?;
        match kind(&part)?.as_deref() {
            Some("face") => divide(&part)?,
            Some("texture") => convert(&part.getattr("visual")?)?,
            _ => {}
        }
    }
    let bounds = scene.getattr("bounds")?.extract::<Option<[[f64; 3]; 2]>>()?;
    if bounds.is_some_and(|ends| !ends.as_flattened().iter().all(|end| end.is_finite())) {
        return Err(Error::new_err("vertices and transforms must be finite"));
    }
    let options = [("include_normals", false)].into_py_dict(py)?;
    scene.call_method("export", (py.None(), "glb"), Some(&options))?.extract()
}

/// Gives each face corners of its own, with its colour.
fn divide(mesh: &Bound<'_, PyAny>) -> PyResult<()> {
    let colors = mesh.getattr("visual")?.getattr("face_colors")?;
    let colors = colors.call_method1("repeat", (3, 0))?;
    mesh.call_method0("unmerge_vertices")?;
    mesh.getattr("visual")?.setattr("vertex_colors", colors)
}

/// Makes a material of diffuse colour and gloss one of metalness and roughness.
fn convert(visual: &Bound<'_, PyAny>) -> PyResult<()> {
    let (material, uvs) = (visual.getattr("material")?, visual.getattr("uv")?);
    for key in IMAGES.split(' ') {
        let image = material.getattr_opt(key)?.filter(|image| !image.is_none());
        if let Some(image) = image.filter(|image| !image.hasattr("save").unwrap_or(false)) {
            let kind = image.get_type();
            return Err(Error::new_err(format!("{key} must be an image of Pillow, found {kind}")));
        }
    }
    let Some(image) = material.getattr_opt("image")? else { return Ok(()) };
    let made = material.call_method0("to_pbr")?;
    made.setattr("metallicFactor", 0.0)?;
    made.setattr("doubleSided", true)?;
    if !image.is_none() && !uvs.is_none() {
        made.setattr("baseColorFactor", [255; 4])?;
    }
    visual.setattr("material", made)
}

/// The images of materials.
const IMAGES: &str = "image baseColorTexture metallicRoughnessTexture normalTexture occlusionTexture emissiveTexture";
