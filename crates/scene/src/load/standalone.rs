//! A standalone mesh as a scene: adds a camera that sees everything, lights and a plain material.

use std::path::Path;

use glam::DVec3;
use hecs::World;

use wavecrest_base::error::{Error, ErrorKind, Result};

use super::materials::split;
use crate::components::{JsonPath, Material, Name, Order, Shading, Sides, VertexColors};
use crate::format::Notes;
use crate::mesh::{LoadedMesh, crease};
use crate::options::LoadOptions;
use crate::options::framing::Up;
use crate::staging::{self, Placed, Scenery, Upward};

/// A light grey with a faint highlight.
const MATERIAL: Material = Material {
    ks: 0.15,
    kd: 0.85,
    specular_exponent: 40.0,
    diffuse_color: DVec3::splat(0.7),
    ..Material::MATTE
};

/// The mesh that `read` returns as a scene, with a description of the choices made for the user.
/// `path` is its file, or a name for it.
///
/// # Errors
/// As [`super::load`].
pub(super) fn world(
    path: &Path,
    options: &LoadOptions,
    notes: &Notes<'_>,
    read: impl FnOnce() -> Result<LoadedMesh>,
) -> Result<(World, String)> {
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
    let contents = Scenery::new(vec![Placed::new(&mesh.positions, &mesh.triangles, world)]);
    let framed = staging::framed(&contents, usual_up(path), options)?;
    let mut world = World::new();
    let (settings, told) = staging::light(&mut world, &contents, &framed, path, &options.lighting);
    let told = framed.told.clone() + told;
    world.spawn((settings,));
    framed.spawn(&mut world);
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let shading = if mesh.normals.is_some() { Shading::Smooth } else { Shading::Flat };
    let place = JsonPath("the mesh".into());
    let shape = world.spawn((Order(0), place, Name(name), MATERIAL, Sides::Both, shading));
    split(&mut world, shape, mesh, &materials, path, notes);
    staging::allow_for_glass(&mut world);
    Ok((world, told))
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
