//! Surveys the contents of a glTF file from its JSON alone.
//!
//! Errors of the file are reported when it is loaded: here a missing number counts as none. The
//! counts that the file claims are limited by the length of its buffers.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde_json::Value;

use super::container::{GLB_START, json_length};
use super::images;
use crate::load::{LoadOptions, notes, staging};
use crate::mesh;
use crate::survey::{Survey, SurveyedMesh};
use wavecrest_base::error::{Error, Result};

/// Surveys the file at `path`.
///
/// # Errors
/// If it cannot be read.
pub(crate) fn survey(path: &Path, options: &LoadOptions) -> Result<Survey> {
    let text = json(path).map_err(|e| Error::io("cannot read the scene", path, e))?;
    let length = path.metadata().map_or(0, |metadata| metadata.len());
    let value: Value = serde_json::from_slice(&text).unwrap_or_default();
    let (width, height) = staging::size(options, None)?;
    let raw = length.saturating_add(sizes(&value, "buffers", "byteLength"));
    let mut survey = Survey {
        text: text.len() as u64,
        raw,
        size: [width, height],
        rays_per_pixel: staging::rays_per_pixel(),
        light_samples: staging::samples(),
        bounces: true,
        ..Survey::default()
    };
    for (number, mesh) in items(&value, "meshes").iter().enumerate() {
        let is_use = |node: &&Value| node["mesh"].as_u64() == Some(number as u64);
        let uses = items(&value, "nodes").iter().filter(is_use).count() as u64;
        for primitive in items(mesh, "primitives") {
            survey.meshes.push(SurveyedMesh {
                holds: holds(&value, primitive, raw),
                normals: true,
                uvs: true,
                tangents: has_normal_map(&value, primitive),
                uses,
            });
        }
        survey.instances = survey.instances.saturating_add(uses);
    }
    survey.embedded = images::survey(&value, &notes(path, options));
    Ok(survey)
}

/// The JSON of a file of either format.
fn json(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let mut start = Vec::new();
    file.by_ref().take(GLB_START as u64).read_to_end(&mut start)?;
    match json_length(&start) {
        Some(length) => {
            let mut text = Vec::new();
            file.take(length.into()).read_to_end(&mut text)?;
            Ok(text)
        }
        None => {
            file.read_to_end(&mut start)?;
            Ok(start)
        }
    }
}

/// Whether a primitive's material has a texture of normals.
fn has_normal_map(value: &Value, primitive: &Value) -> bool {
    let material = primitive["material"].as_u64();
    let material = material.and_then(|index| value["materials"].get(index as usize));
    material.is_some_and(|material| material["normalTexture"].is_object())
}

pub(super) fn items<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().map_or(&[], Vec::as_slice)
}

/// The sum of a number over all items of a list.
fn sizes(value: &Value, list: &str, key: &str) -> u64 {
    items(value, list).iter().filter_map(|item| item[key].as_u64()).fold(0, u64::saturating_add)
}

/// The contents of a primitive, of at most `most` numbers.
fn holds(value: &Value, primitive: &Value, most: u64) -> mesh::Survey {
    let count = |accessor: &Value| {
        let accessor = accessor.as_u64().and_then(|index| value["accessors"].get(index as usize));
        accessor.and_then(|accessor| accessor["count"].as_u64()).map(|count| count.min(most))
    };
    let attribute = |name: &str| count(&primitive["attributes"][name]).unwrap_or(0);
    let positions = attribute("POSITION");
    let corners = count(&primitive["indices"]).unwrap_or(positions);
    let triangles = match primitive["mode"].as_u64() {
        None | Some(4) => corners / 3,
        Some(5 | 6) => corners.saturating_sub(2),
        Some(_) => 0,
    };
    mesh::Survey {
        positions,
        triangles,
        normals: attribute("NORMAL"),
        uvs: attribute("TEXCOORD_0"),
        colors: attribute("COLOR_0"),
        ..mesh::Survey::default()
    }
}
