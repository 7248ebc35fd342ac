//! A standalone mesh as a scene: with a camera that sees all of it, a light and a plain material.

use std::path::Path;

use glam::DVec3;
use hecs::World;

use wavecrest_base::error::{Error, ErrorKind, Result, Warning};

use super::components::{Encoding, JsonPath, Material, Mesh, Name, Order, Pinhole, Shading, Sides};
use super::loaded::LoadedScene;
use super::mesh;
use super::options::LoadOptions;
use super::staging::{self, Placed};

/// A light grey with a faint highlight.
const MATERIAL: Material = Material {
    ks: 0.15,
    kd: 0.85,
    specular_exponent: 40.0,
    diffuse_color: DVec3::splat(0.7),
    kr: 0.0,
};

/// Reads the mesh at `path`.
///
/// # Errors
/// As [`super::load::load`].
pub(super) fn load(path: &Path, options: &LoadOptions) -> Result<LoadedScene> {
    if let Some(camera) = &options.camera {
        let error = Error::new(ErrorKind::Usage, "a mesh has no cameras to choose from");
        return Err(error.in_file(path).value(camera).remedy("leave --camera out"));
    }
    let loaded = mesh::load(path)?;
    let points = &loaded.mesh.positions;
    let bounds = staging::bounds(&[Placed { points, world: glam::DAffine3::IDENTITY }]);
    let view = staging::framed(&bounds, options)?;
    let mut world = World::new();
    world.spawn((staging::settings(path, 1),));
    world.spawn((Order(0), JsonPath("the light".to_owned()), staging::light(&view, &bounds)));
    world.spawn((view, Pinhole));
    let shading = if loaded.mesh.normals.is_some() { Shading::Smooth } else { Shading::Flat };
    let mesh = Mesh { data: loaded.mesh, file: Some(path.to_owned()) };
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let shape = (Order(0), JsonPath("the mesh".to_owned()), Name(name), Sides::Both, shading);
    let shape = world.spawn(shape);
    // The entity is there: it was just made.
    let _ = world.insert(shape, (MATERIAL, mesh));
    let message = "a standalone mesh: camera, light and material are chosen";
    let note = Error::new(ErrorKind::Scene, message).in_file(path);
    Ok(LoadedScene {
        world,
        warnings: loaded.warnings,
        notes: vec![Warning::from_error(&note)],
        encoding: Encoding::Srgb,
    })
}
