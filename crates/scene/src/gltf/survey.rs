//! Surveys the contents of a glTF file from its JSON, without its buffers.
//!
//! Errors of the file are reported when it is loaded, which then ends with its buffers: here they
//! count alone. The counts that the file claims are limited by the length of its buffers.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde_json::Value;

use super::accessor::Storage;
use super::buffer::Buffer;
use super::container::{BINARY_START, GLB_START, json_length};
use super::document::Document;
use super::fields::Fields;
use super::primitive::{COLORS, Mode, Primitive};
use crate::components::{Channels, Filter};
use crate::mesh::{self, TRIPLE, UV};
use crate::options::LoadOptions;
use crate::staging;
use crate::survey::Survey;
use wavecrest_base::error::{Error, Result};

/// Surveys the file at `path`, whose meshes are copied for each of their nodes if it will be `flat`.
///
/// # Errors
/// If it cannot be read.
pub(crate) fn survey(path: &Path, options: &LoadOptions, flat: bool) -> Result<Survey> {
    let (text, is_binary) = json(path).map_err(|e| Error::io("cannot read the scene", path, e))?;
    let mut survey = Survey::new(&staging::view(options, None)?, staging::GLASS_BOUNCES);
    survey.add_json(&text);
    let value: Value = serde_json::from_slice(&text).unwrap_or_default();
    let notes = options.notes(path);
    let binary = is_binary.then(|| Buffer::unread(path.to_owned(), BINARY_START + text.len()));
    let document =
        Fields::top(&value, &notes).and_then(|top| Document::read(&top, binary.as_ref(), false));
    if let Ok(document) = document {
        add(&document, flat, &mut survey);
    }
    Ok(survey)
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
fn add(Document { meshes, nodes, storage, textures, .. }: &Document, flat: bool, to: &mut Survey) {
    to.reading += storage.len() as u64;
    let mut uses = vec![0; meshes.len()];
    nodes.iter().filter_map(|node| node.mesh).for_each(|mesh| uses[mesh] += 1);
    for (mesh, uses) in meshes.iter().zip(uses) {
        for primitive in &mesh.primitives {
            to.add(holds(storage, primitive), uses, flat);
        }
    }
    // Read in turn, and none is kept. Most are looked up at all levels, or for colour and alpha, which takes as much.
    let images = (0..).map_while(|image| textures.source(image, storage));
    to.add_images(images.map(|source| (source, Filter::Trilinear, Channels::Color)));
}

/// The contents of a primitive, whose triangles may be a strip.
fn holds(storage: &Storage, primitive: &Primitive) -> mesh::MeshSurvey {
    let count = |index: usize| storage.accessors[index].count as u64;
    let attribute = |name: &str| primitive.attributes.get(name).map_or(0, |&index| count(index));
    let [positions, normals, uvs] = ["POSITION", "NORMAL", "TEXCOORD_0"].map(attribute);
    let corners = primitive.indices.map_or(positions, count);
    let is_list = primitive.mode == Some(Mode::Triangles);
    let triangles = if is_list { corners / 3 } else { corners };
    let attributes = TRIPLE * (normals + attribute(COLORS)) + UV * uvs;
    mesh::MeshSurvey { positions, triangles, attributes }
}
