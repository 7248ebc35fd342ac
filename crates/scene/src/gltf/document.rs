//! A whole file as typed values, with every index and every range of bytes checked.

use wavecrest_base::error::{Error, ErrorKind, Result};

use super::accessor::{Accessor, Storage};
use super::buffer::{Buffer, View};
use super::camera::Camera;
use super::fields::Fields;
use super::light::Light;
use super::material::Surface;
use super::node::{self, Lengths, Node, Placed};
use super::primitive::MeshParts;
use super::texture::Textures;

/// The supported extensions.
const EXTENSIONS: [&str; 6] = [
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// A file.
pub(super) struct Document {
    pub(super) buffers: Vec<Buffer>,
    views: Vec<View>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) textures: Textures,
    pub(super) materials: Vec<Surface>,
    pub(super) meshes: Vec<MeshParts>,
    pub(super) cameras: Vec<Camera>,
    /// `None` for lights of an unknown type.
    pub(super) lights: Vec<Option<Light>>,
    pub(super) nodes: Vec<Node>,
    /// The nodes of the scene.
    pub(super) placed: Vec<Placed>,
    /// Whether attributes may be integers: the extension `KHR_mesh_quantization`.
    pub(super) is_quantized: bool,
}

impl Document {
    /// Reads a file from its top; `binary` is its buffer without a URI. Lists refer to each other by
    /// index, so each is read even if another has errors, which are all recorded.
    pub(super) fn read(top: &Fields<'_>, binary: Option<&Buffer>) -> Result<Self> {
        check_asset(top)?;
        let extensions = check_extensions(top)?;
        let notes = top.cursor().notes();
        let data = Data::read(top, binary);
        let textures = Textures::read(top, data.as_ref().ok().map(Data::storage));
        let surface = |f: &Fields<'_>| Surface::read(f, top.length("textures"));
        let materials = top.list("materials", "a material", surface);
        let lengths = [top.length("accessors"), top.length("materials")];
        let meshes = top.list("meshes", "a mesh", |f| MeshParts::read(f, lengths));
        let cameras = top.list("cameras", "a camera", Camera::read);
        let lights = notes.part(|| lights(top));
        let tree = notes.part(|| tree(top, data.as_ref().ok().map(|data| &data.accessors[..])));
        let Data { buffers, views, accessors } = data?;
        let (nodes, placed) = tree?;
        Ok(Self {
            is_quantized: extensions.iter().any(|name| name == "KHR_mesh_quantization"),
            buffers,
            views,
            accessors,
            textures: textures?,
            materials: materials?,
            meshes: meshes?,
            cameras: cameras?,
            lights: lights?,
            nodes,
            placed,
        })
    }

    /// The data of accessors.
    pub(super) fn storage(&self) -> Storage<'_> {
        Storage { buffers: &self.buffers, views: &self.views }
    }
}

/// The bytes of a file, and the accessors to them.
struct Data {
    buffers: Vec<Buffer>,
    views: Vec<View>,
    accessors: Vec<Accessor>,
}

impl Data {
    /// Reads each list only if the one before it is right.
    fn read(top: &Fields<'_>, binary: Option<&Buffer>) -> Result<Self> {
        let buffers = buffers(top, binary)?;
        let views = top.list("bufferViews", "a buffer view", |f| View::read(f, &buffers))?;
        let storage = Storage { buffers: &buffers, views: &views };
        let accessors = top.list("accessors", "an accessor", |f| Accessor::read(f, storage))?;
        Ok(Self { buffers, views, accessors })
    }

    fn storage(&self) -> Storage<'_> {
        Storage { buffers: &self.buffers, views: &self.views }
    }
}

/// All nodes, and those of the scene. Without `accessors` no extension is read that uses them.
fn tree(top: &Fields<'_>, accessors: Option<&[Accessor]>) -> Result<(Vec<Node>, Vec<Placed>)> {
    let lights = top.extension("KHR_lights_punctual", |found| Ok(found.length("lights")));
    let lengths = Lengths {
        nodes: top.length("nodes"),
        meshes: top.length("meshes"),
        cameras: top.length("cameras"),
        lights: lights.ok().flatten().unwrap_or(0),
    };
    let nodes = top.list("nodes", "a node", |f| Node::read(f, lengths, accessors))?;
    let placed = node::placed(top, &nodes)?;
    Ok((nodes, placed))
}

fn buffers(top: &Fields<'_>, binary: Option<&Buffer>) -> Result<Vec<Buffer>> {
    let mut number = 0;
    top.list("buffers", "a buffer", |fields| {
        number += 1;
        Buffer::read(fields, binary.filter(|_| number == 1))
    })
}

fn lights(top: &Fields<'_>) -> Result<Vec<Option<Light>>> {
    let lights =
        top.extension("KHR_lights_punctual", |found| found.list("lights", "a light", Light::read));
    Ok(lights?.unwrap_or_default())
}

fn check_asset(top: &Fields<'_>) -> Result<()> {
    let asset = Fields::new(top.need("asset", "an object with the version")?, "an object")?;
    for key in ["version", "minVersion"] {
        let found = match key {
            "version" => Some(asset.need(key, "\"2.0\"")?),
            _ => asset.get(key),
        };
        let Some(cursor) = found else { continue };
        // A later 2.x adds nothing mandatory; `minVersion` must be 2.0.
        let is_known = match (key, cursor.value().as_str()) {
            ("version", Some(text)) => text == "2" || text.starts_with("2."),
            (_, text) => text == Some("2.0"),
        };
        if !is_known {
            let error = cursor.error("only glTF 2.0 is read");
            return Err(error.remedy("export the file as glTF 2.0"));
        }
    }
    Ok(())
}

/// The extensions that the file uses; unsupported required ones are refused.
fn check_extensions(top: &Fields<'_>) -> Result<Vec<String>> {
    let used = top.texts("extensionsUsed")?;
    let required = top.texts("extensionsRequired")?;
    let unknown = |names: &[String]| -> Vec<String> {
        names.iter().filter(|name| !EXTENSIONS.contains(&name.as_str())).cloned().collect()
    };
    let missing = unknown(&required);
    if !missing.is_empty() {
        let message = "the file requires unsupported extensions";
        let error = Error::new(ErrorKind::Scene, message).in_file(top.cursor().notes().file());
        let error = error.at("extensionsRequired").value(missing.join(", "));
        let is_packed =
            missing.iter().any(|name| name.contains("compression") || name.contains("basisu"));
        return Err(error.remedy(match is_packed {
            true => "export it without compression",
            false => "export it without them",
        }));
    }
    let ignored = unknown(&used);
    if !ignored.is_empty() {
        let message = format!("unsupported extensions: {}", ignored.join(", "));
        top.cursor().notes().note("extensionsUsed", &message, "ignored");
    }
    Ok([used, required].concat())
}

/// Warns of unsupported parts of the file as a whole.
pub(super) fn remark(top: &Fields<'_>) {
    if let Some(key) = ["animations", "skins"].into_iter().find(|key| top.length(key) > 0) {
        let remedy = "export it in the pose that you want";
        top.cursor().notes().note(key, "animations and skins are ignored", remedy);
    }
}
