//! glTF files, made here in code, and meshes alone.

// What each part of a file becomes, as its image shows it.
mod images;

// What is refused, and in which words; what is warned of.
mod refused;
mod surfaces;

// Conversion to scene files: the same image to the last bit.
mod converted;

// Files that a file names, and where they may be.
mod outside;

// Far from the origin.
mod far;

// Meshes at rest: skins and morph targets.
mod pose;

// Which lights count, and what replaces them.
mod studio;

use std::path::Path;

use base64::Engine as _;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder as _};
use serde_json::{Value, json};
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_scene::load::load_gltf as load_bytes;
use wavecrest_scene::load::{LoadOptions, LoadedScene};

use crate::support::{image_of, ready};

/// The options of a small image.
fn small() -> LoadOptions {
    LoadOptions { width: Some(24), height: Some(18), ..LoadOptions::default() }
}

/// A file being made: its JSON, and the bytes of its buffer.
#[derive(Clone)]
struct File {
    json: Value,
    bytes: Vec<u8>,
}

impl File {
    fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [],
            "meshes": [], "materials": [], "accessors": [], "bufferViews": [], "cameras": []
        });
        Self { json, bytes: Vec::new() }
    }

    /// Appends to a list; returns the number of what is new.
    fn push(&mut self, list: &str, value: Value) -> usize {
        let items = self.json[list].as_array_mut().expect("a list");
        items.push(value);
        items.len() - 1
    }

    /// A view of new bytes.
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        let view = json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()});
        self.push("bufferViews", view)
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, count: usize, of: &str) -> usize {
        let view = self.view(bytes);
        let accessor =
            json!({"bufferView": view, "componentType": component, "count": count, "type": of});
        self.push("accessors", accessor)
    }

    /// An accessor of floats.
    fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(&bytes, 5126, values.len(), ["", "SCALAR", "VEC2", "VEC3", "VEC4"][N])
    }

    /// An accessor of indices of 16 bits.
    fn indices(&mut self, indices: &[u16]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        self.accessor(&bytes, 5123, indices.len(), "SCALAR")
    }

    /// A node of the scene.
    fn node(&mut self, node: Value) -> usize {
        let number = self.push("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().expect("a list").push(number.into());
        number
    }

    /// A camera on +z that looks at the origin.
    fn camera(&mut self) {
        let camera = json!({"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1}});
        let camera = self.push("cameras", camera);
        self.node(json!({"camera": camera, "translation": [0, 0, 5]}));
    }

    /// A light of the extension at a node with these members.
    fn light(&mut self, light: Value, mut node: Value) {
        self.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        let lights = &mut self.json["extensions"]["KHR_lights_punctual"]["lights"];
        if lights.is_null() {
            *lights = json!([]);
        }
        let lights = lights.as_array_mut().expect("a list");
        lights.push(light);
        node["extensions"] = json!({"KHR_lights_punctual": {"light": lights.len() - 1}});
        self.node(node);
    }

    /// As one binary file.
    fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        let mut text = json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut data = self.bytes.clone();
        data.resize(data.len().next_multiple_of(4), 0);
        let word = |length: usize| u32::try_from(length).expect("it is small").to_le_bytes();
        let chunk = |kind: &[u8; 4], data: &[u8]| [&word(data.len()), &kind[..], data].concat();
        let chunks = [chunk(b"JSON", &text), chunk(b"BIN\0", &data)].concat();
        [b"glTF", &word(2)[..], &word(12 + chunks.len()), &chunks].concat()
    }

    /// As text, whose buffer is `uri`.
    fn text(&self, uri: &str) -> String {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bytes.len(), "uri": uri}]);
        json.to_string()
    }

    /// As text that holds its buffer.
    fn embedded(&self) -> String {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
        self.text(&format!("data:application/octet-stream;base64,{data}"))
    }

    /// With another value at a place such as `/nodes/0/mesh`, which must be there.
    fn with(&self, place: &str, value: impl Into<Value>) -> Self {
        let mut file = self.clone();
        *file.json.pointer_mut(place).unwrap_or_else(|| panic!("{place}")) = value.into();
        file
    }
}

fn loaded(file: &File) -> Result<LoadedScene> {
    load_bytes(file.glb(), Path::new("a.glb"), &small())
}

/// The image, which both tracers agree on and of which every sample is a number.
fn rendered(loaded: Result<LoadedScene>) -> Film {
    image_of(&ready(loaded), 0)
}

fn image(file: &File) -> Film {
    rendered(loaded(file))
}

/// A square of side 2 about the origin, seen from +z, with coordinates for a texture: v runs down.
const SQUARE: [[f32; 3]; 4] =
    [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
const SQUARE_UVS: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];

/// The square in a red material, a camera before it, and a light beside that.
fn square() -> File {
    let mut file = File::new();
    let positions = file.floats(&SQUARE);
    let uvs = file.floats(&SQUARE_UVS);
    let indices = file.indices(&[0, 1, 2, 0, 2, 3]);
    let color = json!({"baseColorFactor": [0.8, 0.2, 0.1, 1], "metallicFactor": 0});
    file.push("materials", json!({"pbrMetallicRoughness": color}));
    let attributes = json!({"POSITION": positions, "TEXCOORD_0": uvs});
    let primitive = json!({"attributes": attributes, "indices": indices, "material": 0});
    file.push("meshes", json!({"primitives": [primitive]}));
    file.node(json!({"mesh": 0}));
    file.camera();
    file.light(json!({"type": "point", "intensity": 20}), json!({"translation": [1, 2, 4]}));
    file
}

/// The square in this material, with a texture of these texels, the top row first, that ends at its edge.
fn mapped(texels: [[u8; 3]; 4], material: Value) -> File {
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(texels.as_flattened(), 2, 2, ExtendedColorType::Rgb8)
        .expect("a PNG");
    let mut file = square();
    let view = file.view(&png);
    for (list, value) in [
        ("images", json!({"bufferView": view, "mimeType": "image/png"})),
        ("samplers", json!({"magFilter": 9728, "wrapS": 33071, "wrapT": 33071})),
        ("textures", json!({"source": 0, "sampler": 0})),
        ("materials", material),
    ] {
        file.json[list] = json!([value]);
    }
    file
}

/// The square that shows these texels.
fn textured_with(texels: [[u8; 3]; 4]) -> File {
    let shown = json!({"metallicFactor": 0, "baseColorTexture": {"index": 0}});
    mapped(texels, json!({"pbrMetallicRoughness": shown}))
}

/// The square with a picture in which every texel is told apart.
fn textured() -> File {
    textured_with([[255, 0, 0], [0, 255, 0], [0, 0, 255], [188; 3]])
}
