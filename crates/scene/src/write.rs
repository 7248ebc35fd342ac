//! Writes a world of entities as a scene file, with its meshes and images beside it.
//!
//! A scene that is written and read again is the same to the last bit: numbers are written as the
//! shortest text that reads back to the same value, meshes as binary PLY, images as their original
//! bytes. A mesh without a file is written into the scene file itself.

use std::collections::HashMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{check_replaceable, replace_file, write_error, write_text};

use crate::components::{Mesh, TextureSource};
use crate::folder::Folder;
use crate::format::Beside;
use crate::load::LoadedScene;
use crate::mesh::{Attribute, MeshData, NO_VALUE};
use crate::query;
use crate::scene_file;

/// Writes `scene` to the scene file `path`, with its meshes and images beside it. Returns the
/// files, the scene last. Existing files are replaced only if `replaces`.
///
/// # Errors
/// If a file exists already, is a file that the scene was read from, or cannot be written; or if an image is outside the folder of the file that the scene was
/// read from, unless it was read with [`allow_outside`](crate::load::LoadOptions::allow_outside).
pub fn write(scene: &LoadedScene, path: &Path, replaces: bool) -> Result<Vec<PathBuf>> {
    let mut beside = Beside::new(path);
    let value = scene_file::write(&scene.world, &mut beside)?;
    let Beside { meshes, images, .. } = beside;
    let names = meshes.iter().map(|(name, _)| name).chain(images.iter().map(|(name, _)| name));
    let mut all: Vec<PathBuf> = names.cloned().collect();
    all.push(path.to_owned());
    for file in &all {
        scene.check_apart(file)?;
        check_free(file, replaces)?;
    }
    images.iter().try_for_each(|(_, source)| check_source(source, &scene.folder))?;
    for (file, entity) in meshes {
        let mesh = scene.world.get::<&Mesh>(entity).map_err(|_| query::missing("Mesh"))?;
        replace_file(&file, |sink| write_ply(&mesh.data, sink).map_err(|e| write_error(&file, e)))?;
    }
    for (file, source) in images {
        replace_file(&file, |sink| {
            let copied = source.open().and_then(|mut content| io::copy(&mut content, sink));
            copied.map(drop).map_err(|e| copy_error(&source, &file, e))
        })?;
    }
    // Last, so that an existing scene file refers to existing files.
    write_text(path, &format!("{value:#}\n"))?;
    Ok(all)
}

/// Checks whether the file could currently be written, and exists only if it `replaces` another.
///
/// # Errors
/// If it cannot.
pub fn check_free(file: &Path, replaces: bool) -> Result<()> {
    if !replaces && file.symlink_metadata().is_ok() {
        let error = Error::new(ErrorKind::Usage, "the file exists already").in_file(file);
        return Err(error.remedy("choose another name, or use --force to replace it"));
    }
    check_replaceable(file)
}

/// Checks that an image may be copied, and is one.
fn check_source(source: &TextureSource, folder: &Folder) -> Result<()> {
    match source {
        TextureSource::File(path) if path.exists() && !folder.holds(path) => {
            let message = "the image is outside the folder of the file that is converted";
            let error = Error::new(ErrorKind::Usage, message).value(path.display());
            Err(error.remedy("copy it there, or allow others with --allow-outside"))
        }
        TextureSource::File(_) => Ok(()),
        TextureSource::Embedded { place, bytes } => {
            image::guess_format(bytes).map(drop).map_err(|e| {
                let message = format!("cannot tell the format of the image: {e}");
                Error::new(ErrorKind::Texture, message).at(place).because(e)
            })
        }
    }
}

fn copy_error(source: &TextureSource, file: &Path, error: io::Error) -> Error {
    match source.file() {
        None => write_error(file, error),
        Some(path) => {
            let message = format!("cannot copy {}: {error}", path.display());
            Error::new(ErrorKind::Io, message).in_file(file).because(error)
        }
    }
}

/// Writes a mesh as a binary little-endian PLY file, with unchanged numbers.
///
/// # Errors
/// Those of the sink.
pub fn write_ply(mesh: &MeshData, sink: &mut impl Write) -> io::Result<()> {
    let is_by_vertex = mesh.normals.as_ref().is_none_or(|n| n.indices.is_none())
        && mesh.uvs.as_ref().is_none_or(|uvs| uvs.indices.is_none());
    let mesh = if is_by_vertex { mesh } else { &with_vertices(mesh) };
    let names = [
        mesh.normals.as_ref().map(|_| "nx ny nz"),
        mesh.uvs.as_ref().map(|_| "s t"),
        mesh.colors.as_ref().map(|_| "red green blue"),
    ];
    let is_near = mesh.origin == DVec3::ZERO;
    let counts = [mesh.positions.len() as u64, mesh.triangles.len() as u64];
    let scalar = if is_near { "float" } else { "double" };
    sink.write_all(ply_header("", counts, scalar, names, "uint").as_bytes())?;
    let mut row = Vec::new();
    for (i, position) in mesh.positions.iter().enumerate() {
        row.clear();
        if is_near {
            row.extend(position.to_array().map(f32::to_le_bytes).as_flattened());
        } else {
            let point = mesh.origin + position.as_dvec3();
            row.extend(point.to_array().map(f64::to_le_bytes).as_flattened());
        }
        let normal = mesh.normals.iter().flat_map(|normals| normals.values[i].to_array());
        let uv = mesh.uvs.iter().flat_map(|uvs| uvs.values[i].to_array());
        let color = mesh.colors.iter().flat_map(|colors| colors[i].to_array());
        row.extend(normal.chain(uv).chain(color).flat_map(f32::to_le_bytes));
        sink.write_all(&row)?;
    }
    for triangle in &mesh.triangles {
        sink.write_all(&[3])?;
        sink.write_all(triangle.map(u32::to_le_bytes).as_flattened())?;
    }
    Ok(())
}

/// The header of a binary PLY file with these numbers of vertices and triangles: coordinates of the
/// type `scalar`, the properties of some `groups` in single precision, indices of the type `index`.
pub(crate) fn ply_header(
    comment: &str,
    [vertices, triangles]: [u64; 2],
    scalar: &str,
    groups: [Option<&str>; 3],
    index: &str,
) -> String {
    let of = |kind: &str, names: &str| -> String {
        names.split(' ').map(|name| format!("property {kind} {name}\n")).collect()
    };
    let position = of(scalar, "x y z");
    let others: String = groups.into_iter().flatten().map(|names| of("float", names)).collect();
    format!(
        "ply\nformat binary_little_endian 1.0\n{comment}element vertex {vertices}\n\
         {position}{others}element face {triangles}\n\
         property list uchar {index} vertex_indices\nend_header\n"
    )
}

/// The mesh with a vertex for each combination of position, normal and texture coordinates at a
/// corner. A triangle that lacks a value at one corner has none at all, as in shading: zero vectors
/// are then unknown normals, and zeros the coordinates.
fn with_vertices(mesh: &MeshData) -> MeshData {
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let mut which: Vec<[u32; 3]> = Vec::new();
    let mut vertex = |key: [u32; 3]| {
        *known.entry(key).or_insert_with(|| {
            which.push(key);
            which.len() as u32 - 1
        })
    };
    let triangles = (0..mesh.triangles.len()).map(|t| {
        let positions = mesh.triangles[t];
        let normals = values_of(mesh.normals.as_ref(), t, positions);
        let uvs = values_of(mesh.uvs.as_ref(), t, positions);
        [0, 1, 2].map(|k| vertex([positions[k], normals[k], uvs[k]]))
    });
    let triangles = triangles.collect();
    let values = |part: usize| which.iter().map(move |key| key[part] as usize);
    MeshData {
        positions: values(0).map(|i| mesh.positions[i]).collect(),
        origin: mesh.origin,
        triangles,
        normals: mesh.normals.as_ref().map(|normals| by_vertex(normals, values(1))),
        uvs: mesh.uvs.as_ref().map(|uvs| by_vertex(uvs, values(2))),
        colors: mesh.colors.as_ref().map(|colors| values(0).map(|i| colors[i]).collect()),
        alphas: None,
    }
}

/// The attribute with a value for each vertex, zero if there is none.
fn by_vertex<T: Copy + Default>(
    attribute: &Attribute<T>,
    which: impl Iterator<Item = usize>,
) -> Attribute<T> {
    let value = |i| attribute.values.get(i).copied().unwrap_or_default();
    which.map(value).collect::<Vec<T>>().into()
}

/// The values of a triangle's corners: [`NO_VALUE`] for all if one has none.
fn values_of<T>(
    attribute: Option<&Attribute<T>>,
    triangle: usize,
    positions: [u32; 3],
) -> [u32; 3] {
    let Some(attribute) = attribute else { return [NO_VALUE; 3] };
    let values = attribute.indices.as_ref().map_or(positions, |indices| indices[triangle]);
    if values.contains(&NO_VALUE) { [NO_VALUE; 3] } else { values }
}
