//! Writes a mesh as a binary little-endian PLY file, with unchanged numbers.

use std::collections::HashMap;
use std::io::{self, Write};

use glam::DVec3;

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
    Attribute { values: which.map(value).collect(), indices: None }
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
