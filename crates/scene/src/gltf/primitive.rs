//! Meshes and their primitives, as in the file.

use std::collections::BTreeMap;

use wavecrest_base::error::Result;

use super::fields::Fields;

/// The attribute of visible colours.
pub(super) const COLORS: &str = "COLOR_0";

/// How the vertices of a primitive form triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Triangles,
    Strip,
    Fan,
}

/// A part of a mesh with one material.
#[derive(Clone, Debug)]
pub(super) struct Primitive {
    /// Its place in the file.
    pub(super) path: String,
    /// `None` for points and lines.
    pub(super) mode: Option<Mode>,
    /// Accessors by the name of the attribute.
    pub(super) attributes: BTreeMap<String, usize>,
    pub(super) indices: Option<usize>,
    /// The index of its material, or `None` for the default one.
    pub(super) material: Option<usize>,
}

/// An element of `meshes`.
#[derive(Clone, Debug)]
pub(super) struct MeshParts {
    pub(super) name: Option<String>,
    pub(super) primitives: Vec<Primitive>,
}

impl MeshParts {
    /// Reads an element of `meshes`.
    pub(super) fn read(fields: &Fields<'_>) -> Result<Self> {
        if fields.get("weights").is_some() {
            fields.warn("morph targets are ignored", "the base mesh is shown");
        }
        fields.need("primitives", "a list of objects")?;
        let name = fields.name()?;
        Ok(Self { name, primitives: fields.list("primitives", "a primitive", Primitive::read)? })
    }
}

impl Primitive {
    fn read(fields: &Fields<'_>) -> Result<Self> {
        let must_be = "a whole number from 0 to 6: 4 for triangles, 5 strip, 6 fan";
        let mode = fields.code("mode", &MODES, must_be)?.unwrap_or(Some(Mode::Triangles));
        if mode.is_none() {
            fields.warn("points and lines are left out", "only triangles are read");
        }
        let own = fields.need_object("attributes", "attributes")?;
        let mut attributes = BTreeMap::new();
        for name in own.cursor.value().as_object().into_iter().flat_map(|map| map.keys()) {
            let accessor = own.need_index(name, "accessors")?;
            if name.starts_with("COLOR_") && name != COLORS {
                fields.warn("further vertex colours are ignored", "only COLOR_0 is used");
            }
            attributes.insert(name.clone(), accessor);
        }
        Ok(Self {
            path: fields.path(),
            mode,
            attributes,
            indices: fields.index("indices", "accessors")?,
            material: fields.index("material", "materials")?,
        })
    }
}

/// The format's codes of points, of three kinds of lines, and of triangles.
const MODES: [(u64, Option<Mode>); 7] = [
    (0, None),
    (1, None),
    (2, None),
    (3, None),
    (4, Some(Mode::Triangles)),
    (5, Some(Mode::Strip)),
    (6, Some(Mode::Fan)),
];
