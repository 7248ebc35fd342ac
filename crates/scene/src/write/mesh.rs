//! Writes a mesh as a binary little-endian PLY file, with unchanged numbers.

use std::collections::HashMap;
use std::io::{self, Write};

use glam::{DVec3, Vec2, Vec3};

use crate::mesh::{Attribute, MeshData, NO_VALUE};

/// Writes a mesh.
///
/// # Errors
/// Those of the sink.
pub fn write_ply(mesh: &MeshData, sink: &mut impl Write) -> io::Result<()> {
    let is_by_vertex = mesh.normals.as_ref().is_none_or(|n| n.indices.is_none())
        && mesh.uvs.as_ref().is_none_or(|uvs| uvs.indices.is_none());
    if is_by_vertex {
        return write_by_vertex(mesh, sink);
    }
    write_by_vertex(&with_vertices(mesh), sink)
}

fn write_by_vertex(mesh: &MeshData, sink: &mut impl Write) -> io::Result<()> {
    sink.write_all(header(mesh).as_bytes())?;
    for (i, position) in mesh.positions.iter().enumerate() {
        if mesh.origin == DVec3::ZERO {
            sink.write_all(position.to_array().map(f32::to_le_bytes).as_flattened())?;
        } else {
            let point = mesh.origin + position.as_dvec3();
            sink.write_all(point.to_array().map(f64::to_le_bytes).as_flattened())?;
        }
        if let Some(normals) = &mesh.normals {
            sink.write_all(normals.values[i].to_array().map(f32::to_le_bytes).as_flattened())?;
        }
        if let Some(uvs) = &mesh.uvs {
            sink.write_all(uvs.values[i].to_array().map(f32::to_le_bytes).as_flattened())?;
        }
        if let Some(colors) = &mesh.colors {
            sink.write_all(colors[i].to_array().map(f32::to_le_bytes).as_flattened())?;
        }
    }
    for triangle in &mesh.triangles {
        sink.write_all(&[3])?;
        sink.write_all(triangle.map(u32::to_le_bytes).as_flattened())?;
    }
    Ok(())
}

fn header(mesh: &MeshData) -> String {
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n");
    let scalar = if mesh.origin == DVec3::ZERO { "float" } else { "double" };
    ["x", "y", "z"].iter().for_each(|name| header += &format!("property {scalar} {name}\n"));
    let mut names = Vec::new();
    if mesh.normals.is_some() {
        names.extend(["nx", "ny", "nz"]);
    }
    if mesh.uvs.is_some() {
        names.extend(["s", "t"]);
    }
    if mesh.colors.is_some() {
        names.extend(["red", "green", "blue"]);
    }
    names.iter().for_each(|name| header += &format!("property float {name}\n"));
    header += &format!("element face {triangles}\nproperty list uchar uint vertex_indices\n");
    header + "end_header\n"
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
    let zero = |v: Option<&Vec3>| v.copied().unwrap_or(Vec3::ZERO);
    let normals = mesh.normals.as_ref().map(|n| values(1).map(|i| zero(n.values.get(i))).collect());
    let uv = |v: Option<&Vec2>| v.copied().unwrap_or(Vec2::ZERO);
    let uvs = mesh.uvs.as_ref().map(|uvs| values(2).map(|i| uv(uvs.values.get(i))).collect());
    MeshData {
        positions: values(0).map(|i| mesh.positions[i]).collect(),
        origin: mesh.origin,
        triangles,
        normals: normals.map(|values| Attribute { values, indices: None }),
        uvs: uvs.map(|values| Attribute { values, indices: None }),
        colors: mesh.colors.as_ref().map(|colors| values(0).map(|i| colors[i]).collect()),
    }
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
