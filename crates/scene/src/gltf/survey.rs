//! Surveys the contents of a glTF file from its JSON, without its buffers.
//!
//! Errors of the file are reported when it is loaded, which then ends with its buffers: here they
//! count alone. The counts that the file claims are limited by the length of its buffers.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde_json::Value;

use super::buffer::Buffer;
use super::container::{BINARY_START, GLB_START, json_length};
use super::document::Document;
use super::fields::Fields;
use super::material::Surface;
use super::primitive::{COLORS, Mode, Primitive};
use crate::components::{Channels, Filter};
use crate::mesh;
use crate::options::LoadOptions;
use crate::survey::{Survey, SurveyedMesh, staged};
use crate::systems::textures;
use wavecrest_base::error::{Error, Result};

/// Surveys the file at `path`.
///
/// # Errors
/// If it cannot be read.
pub(crate) fn survey(path: &Path, options: &LoadOptions) -> Result<Survey> {
    let (text, is_binary) = json(path).map_err(|e| Error::io("cannot read the scene", path, e))?;
    let staged = staged(options)?;
    let value: Value = serde_json::from_slice(&text).unwrap_or_default();
    let buffers = value["buffers"].as_array().into_iter().flatten();
    let lengths = buffers.filter_map(|buffer| buffer["byteLength"].as_u64());
    let length = path.metadata().map_or(0, |metadata| metadata.len());
    let survey = Survey {
        text: text.len() as u64,
        raw: lengths.fold(length, u64::saturating_add),
        ..staged
    };
    let notes = options.notes(path);
    let binary = is_binary.then(|| Buffer::unread(path.to_owned(), BINARY_START + text.len()));
    let document =
        Fields::top(&value, &notes).and_then(|top| Document::read(&top, binary.as_ref(), false));
    Ok(match document {
        Ok(document) => of(&document, survey),
        Err(_) => survey,
    })
}

/// The JSON of a file, and whether that is a GLB file.
fn json(path: &Path) -> std::io::Result<(Vec<u8>, bool)> {
    let mut file = File::open(path)?;
    let mut start = Vec::new();
    file.by_ref().take(GLB_START as u64).read_to_end(&mut start)?;
    let length = json_length(&start);
    let mut text = if length.is_some() { Vec::new() } else { start };
    file.take(length.map_or(u64::MAX, u64::from)).read_to_end(&mut text)?;
    Ok((text, length.is_some()))
}

/// Adds the contents of a file to its survey.
fn of(document: &Document, mut survey: Survey) -> Survey {
    let mut uses = vec![0; document.meshes.len()];
    document.nodes.iter().filter_map(|node| node.mesh).for_each(|mesh| uses[mesh] += 1);
    let mut images = BTreeMap::new();
    for (mesh, uses) in document.meshes.iter().zip(uses) {
        for primitive in &mesh.primitives {
            let surface = primitive.material.map(|material| &document.materials[material]);
            if let Some(surface) = surface {
                add_images(document, surface, &mut images);
            }
            survey.meshes.push(SurveyedMesh {
                holds: holds(document, primitive),
                normals: true,
                uvs: true,
                tangents: surface.is_some_and(|surface| surface.normal.is_some()),
                uses,
            });
        }
        survey.instances += uses;
    }
    // They are read in turn, and none is kept.
    let bytes = |((image, made), filter): ((usize, Option<String>), Filter)| {
        let source = document.textures.source(image, &document.storage)?;
        let channels = if made.is_some() { Channels::Color } else { Channels::Alpha };
        Some(textures::survey(&source, filter, channels))
    };
    survey.embedded = images.into_iter().filter_map(bytes).collect();
    survey
}

/// The images to decode: by their numbers, and what is made of them, or `None` for their alpha.
type ImageUses = BTreeMap<(usize, Option<String>), Filter>;

/// Adds the visible images of a surface.
fn add_images(document: &Document, surface: &Surface, images: &mut ImageUses) {
    let textures = &document.textures;
    surface.textures(|info, encoding, tint| {
        let filter = textures.filter(info);
        let key = (textures.image(info)?, Some(format!("{encoding:?}{tint:?}")));
        let known = images.entry(key).or_insert(filter);
        if filter == Filter::Trilinear {
            *known = filter;
        }
        None
    });
    let is_cut = surface.threshold().is_some_and(|threshold| threshold > 0.0);
    let mask = surface.texture.as_ref().filter(|_| is_cut);
    if let Some(image) = mask.and_then(|info| textures.image(info)) {
        images.insert((image, None), Filter::Bilinear);
    }
}

/// The contents of a primitive.
fn holds(document: &Document, primitive: &Primitive) -> mesh::Survey {
    let count = |index: usize| document.storage.accessors[index].count as u64;
    let attribute = |name: &str| primitive.attributes.get(name).map_or(0, |&index| count(index));
    let positions = attribute("POSITION");
    let corners = primitive.indices.map_or(positions, count);
    let triangles = match primitive.mode {
        Some(Mode::Triangles) => corners / 3,
        Some(Mode::Strip | Mode::Fan) => corners.saturating_sub(2),
        None => 0,
    };
    mesh::Survey {
        positions,
        triangles,
        normals: attribute("NORMAL"),
        uvs: attribute("TEXCOORD_0"),
        colors: attribute(COLORS),
        ..mesh::Survey::default()
    }
}
