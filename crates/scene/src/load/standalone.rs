//! A standalone mesh as a scene: adds a camera that sees everything, lights and a plain material.

use std::path::Path;

use glam::{DAffine3, DVec3};
use hecs::{EntityBuilder, World};

use wavecrest_base::error::{Error, ErrorKind, Result};

use super::materials::split;
use crate::components::{
    Channels, CutOut, Encoding, Filter, JsonPath, LookUp, Maps, Material, Mesh, Name, Order,
    Shading, Sides, TextureRef, TextureSource, Wrap,
};
use crate::format::{Declaration, Notes};
use crate::image_file::Head;
use crate::mesh::LoadedMesh;
use crate::options::LoadOptions;
use crate::options::framing::Up;
use crate::staging::{self, Scenery, Upward, VisibleMesh};
use crate::systems::cutouts::Masks;

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
    let around = options.environment.as_deref().map(surroundings).transpose()?;
    let LoadedMesh { mut mesh, warnings, materials } = read()?;
    mesh.complete(options.lighting.crease_degrees, false);
    notes.pass_on(warnings);
    let origin = DAffine3::from_translation(mesh.origin);
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let shading = if mesh.normals.is_some() { Shading::Smooth } else { Shading::Flat };
    let usual = staging::MATERIAL;
    let own = Material { diffuse_color: options.color.unwrap_or(usual.diffuse_color), ..usual };
    let begin = |surface: &[Declaration]| {
        let mut part = EntityBuilder::new();
        let place = JsonPath("the mesh".into());
        part.add_bundle((Order(0), place, Name(name.clone()), Sides::Both, shading));
        if !surface.is_empty() {
            part.add(own);
        }
        part
    };
    let mut parts = split(begin, mesh, &materials, path, notes);
    let mut images = Masks::of_scene(path);
    let shown = parts.iter().filter_map(|part| {
        let surface = (part.get::<&CutOut>(), part.get::<&Maps>().unwrap_or(&Maps::NONE));
        Some(VisibleMesh::of_uses(&part.get::<&Mesh>()?.data, surface, 1, &mut images))
    });
    let shown: Vec<VisibleMesh<'_>> = shown.collect();
    let instances = shown.iter().flat_map(|shown| shown.instances([&origin]));
    let contents = Scenery::new(instances.collect());
    // The format states no up axis: in files from CAD programs and for printers it is mostly z.
    let is_stl = path.extension().is_some_and(|name| name.eq_ignore_ascii_case("stl"));
    let up = Upward::Guessed(if is_stl { Up::Z } else { Up::Y });
    let framed = staging::framed(&contents, up, options).map_err(|error| error.in_file(path))?;
    let mut world = World::new();
    let lighting = &options.lighting;
    let (settings, told) = match around {
        Some(image) => staging::surround(&mut world, &framed, path, image, lighting),
        None => staging::light(&mut world, &contents, &framed, path, lighting),
    };
    // Nothing is seen of the choices without a mesh.
    let told = if shown.is_empty() { String::new() } else { framed.told.clone() + told };
    world.spawn((settings,));
    framed.spawn(&mut world);
    for part in &mut parts {
        world.spawn(part.build());
    }
    staging::allow_for_surfaces(&mut world);
    Ok((world, told))
}

/// The image of an environment, whose bytes are those of a photograph, and other numbers light.
fn surroundings(path: &Path) -> Result<TextureRef> {
    let source = TextureSource::File(path.to_owned());
    let head = Head::of(&source).map_err(|error| error.in_file(path))?;
    let encoding = if head.is_bytes { Encoding::Srgb } else { Encoding::Linear };
    let look_up = LookUp { source, filter: Filter::Bilinear, wrap: Wrap::Repeat, placing: None };
    Ok(TextureRef { look_up, encoding, tint: DVec3::ONE, channels: Channels::Color })
}
