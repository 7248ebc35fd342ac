//! A whole file as typed values, with every index and every range of bytes checked.

use wavecrest_base::error::{Error, ErrorKind, Result};

use super::accessor::Storage;
use super::buffer::Buffer;
use super::camera::Camera;
use super::fields::{Fields, LIGHTS};
use super::light::Light;
use super::material::{GLOSS, MaterialElement};
use super::node::{self, Node, PlacedNode};
use super::pose::Skin;
use super::primitive::MeshParts;
use super::texture::{BASIS, Textures, WEBP};

/// The supported extensions.
const EXTENSIONS: [&str; 12] = [
    "EXT_mesh_gpu_instancing",
    WEBP,
    LIGHTS,
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    GLOSS,
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    BASIS,
    "KHR_texture_transform",
];

/// A file.
pub(super) struct Document {
    pub(super) storage: Storage,
    pub(super) textures: Textures,
    pub(super) materials: Vec<MaterialElement>,
    /// The material of primitives without one.
    pub(super) usual: MaterialElement,
    pub(super) meshes: Vec<MeshParts>,
    pub(super) cameras: Vec<Camera>,
    /// `None` for lights of an unknown type.
    pub(super) lights: Vec<Option<Light>>,
    pub(super) nodes: Vec<Node>,
    pub(super) skins: Vec<Skin>,
    /// The nodes of the scene.
    pub(super) placed: Vec<PlacedNode>,
    /// Whether attributes may be integers: the extension `KHR_mesh_quantization`.
    pub(super) is_quantized: bool,
}

impl Document {
    /// Reads a file from its top; `binary` is its buffer without a URI. Lists refer to each other by
    /// index, so each is read even if another has errors, which are all recorded.
    pub(super) fn read(top: &Fields<'_>, binary: Option<&Buffer>) -> Result<Self> {
        check_asset(top)?;
        let extensions = check_extensions(top)?;
        let notes = top.cursor.notes();
        let storage = Storage::read(top, binary);
        let textures = Textures::read(top, storage.as_ref().ok());
        let materials = top.list("materials", "a material", MaterialElement::read);
        let meshes = top.list("meshes", "a mesh", MeshParts::read);
        let cameras = top.list("cameras", "a camera", Camera::read);
        let lights = notes
            .part(|| top.extension(LIGHTS, |found| found.list("lights", "a light", Light::read)));
        let tree = notes.part(|| {
            // Without accessors no extension is read that uses them.
            let accessors = storage.as_ref().ok().map(|storage| &storage.accessors[..]);
            let nodes = top.list("nodes", "a node", |f| Node::read(f, accessors))?;
            Ok((node::placed(top, &nodes)?, nodes))
        });
        let storage = storage?;
        let (placed, nodes) = tree?;
        let mut worlds = vec![None; nodes.len()];
        placed.iter().for_each(|place| worlds[place.node] = Some(place.world));
        let skins = top.list("skins", "a skin", |f| Skin::read(f, &storage, &worlds));
        Ok(Self {
            is_quantized: extensions.iter().any(|name| name == "KHR_mesh_quantization"),
            storage,
            textures: textures?,
            materials: materials?,
            usual: MaterialElement::read(&top.nothing())?,
            meshes: meshes?,
            cameras: cameras?,
            lights: lights?.unwrap_or_default(),
            nodes,
            skins: skins?,
            placed,
        })
    }
}

fn check_asset(top: &Fields<'_>) -> Result<()> {
    top.need("asset", "an object with the version")?;
    let asset = top.need_object("asset", "an object")?;
    asset.need("version", "\"2.0\"")?;
    // A later 2.x adds nothing mandatory; `minVersion` must be 2.0.
    let is_known = |key, text: &str| {
        text == "2.0" || key == "version" && (text == "2" || text.starts_with("2."))
    };
    for key in ["version", "minVersion"] {
        let Some(cursor) = asset.get(key) else { continue };
        if !cursor.value().as_str().is_some_and(|text| is_known(key, text)) {
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
        let error = Error::new(ErrorKind::Scene, message).in_file(top.cursor.notes().file());
        let error = error.at("extensionsRequired").value(missing.join(", "));
        let holds = |word: &str| missing.iter().any(|name| name.contains(word));
        // This command of the glTF-Transform project writes what it reads unpacked.
        return Err(error.remedy(match holds("compression") {
            true => "unpack it: gltf-transform copy IN OUT",
            false => "export it without them",
        }));
    }
    let ignored = unknown(&used);
    if !ignored.is_empty() {
        let message = format!("unsupported extensions: {}", ignored.join(", "));
        top.cursor.notes().note("extensionsUsed", &message, "ignored");
    }
    Ok([used, required].concat())
}

/// Warns of unsupported parts of the file as a whole.
pub(super) fn remark(top: &Fields<'_>) {
    if top.length("animations") > 0 {
        let remedy = "export it in the pose that you want";
        top.cursor.notes().note("animations", "animations are ignored", remedy);
    }
}
