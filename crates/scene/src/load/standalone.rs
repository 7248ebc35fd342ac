//! A standalone mesh as a scene: adds a camera that sees everything, lights and a plain material.

use std::path::Path;

use glam::DVec3;

use wavecrest_base::error::{Error, ErrorKind, Result};

use super::materials::parts;
use super::staging::{self, Placed, Upward};
use crate::components::{Encoding, Material, Mesh, Shading, VertexColors};
use crate::load::LoadOptions;
use crate::load::framing::Up;
use crate::mesh::{LoadedMesh, crease};
use crate::reader::Notes;
use crate::schema::{Camera, SceneFile, Shape};

/// A light grey with a faint highlight.
const MATERIAL: Material = Material {
    ks: 0.15,
    kd: 0.85,
    specular_exponent: 40.0,
    diffuse_color: DVec3::splat(0.7),
    emission: DVec3::ZERO,
    specular_color: DVec3::ONE,
    kr: 0.0,
};

/// The mesh that `read` returns as a scene, with a description of the choices made for the user.
/// `path` is its file, or a name for it.
///
/// # Errors
/// As [`super::load`].
pub(super) fn scene(
    path: &Path,
    options: &LoadOptions,
    notes: &Notes<'_>,
    read: impl FnOnce() -> Result<LoadedMesh>,
) -> Result<(SceneFile, String)> {
    if let Some(camera) = &options.camera {
        let error = Error::new(ErrorKind::Usage, "a mesh file has no cameras");
        return Err(error.in_file(path).value(camera).remedy("leave out --camera"));
    }
    let LoadedMesh { mut mesh, warnings, materials } = read()?;
    mesh.decode_colors(VertexColors::Srgb);
    notes.pass_on(warnings);
    let crease = options.lighting.crease_degrees;
    if mesh.normals.is_none() && crease > 0.0 {
        mesh.normals = Some(crease::normals(&mesh.positions, &mesh.triangles, crease));
    }
    let world = glam::DAffine3::from_translation(mesh.origin);
    let all = [Placed::new(&mesh.positions, &mesh.triangles, world)];
    let bounds = staging::bounds(&all);
    let staging::Framed { view, path: moves, up, lamp, told: framed } =
        staging::framed(&all, &bounds, usual_up(path), options)?;
    let subject = staging::Subject {
        all: &all,
        bounds: &bounds,
        view: &view,
        path: moves.as_ref(),
        up,
        lamp,
    };
    let staging::Lit { lights, ground, settings, told } =
        staging::lit(&subject, path, &options.lighting);
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let shape = Shape {
        shading: if mesh.normals.is_some() { Shading::Smooth } else { Shading::Flat },
        material: Some(MATERIAL),
        ..Shape::of("the mesh".into(), Some(name), Mesh::default())
    };
    let mut shapes = parts(&shape, mesh, &materials, path, notes);
    shapes.extend(ground);
    let scene = SceneFile {
        settings,
        camera: Camera { view, lens: None, path: moves },
        lights,
        shapes,
        instances: Vec::new(),
        encoding: Encoding::Srgb,
    };
    Ok((scene, format!("{framed}default camera and material; no lights: {told}")))
}

/// The up axis of a mesh, whose format states none.
fn usual_up(path: &Path) -> Upward {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    match extension.to_str() {
        // From CAD programs and for printers.
        Some("stl") => Upward::Guessed(Up::Z),
        // Arrays have no file.
        Some("ply" | "") => Upward::Guessed(Up::Y),
        _ => Upward::Usual(Up::Y),
    }
}
