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
    /// Reads an element of `meshes`, in a file with this number of accessors and materials.
    pub(super) fn read(fields: &Fields<'_>, lengths: [usize; 2]) -> Result<Self> {
        if fields.get("weights").is_some() {
            let message = "morph targets are ignored";
            fields.warn(message, "the base mesh is shown");
        }
        fields.need("primitives", "a list of objects")?;
        let read = |part: &Fields<'_>| Primitive::read(part, lengths);
        Ok(Self {
            name: fields.text("name")?.filter(|name| !name.is_empty()),
            primitives: fields.list("primitives", "a primitive", read)?,
        })
    }
}

impl Primitive {
    fn read(fields: &Fields<'_>, [accessors, materials]: [usize; 2]) -> Result<Self> {
        let mode = mode(fields)?;
        let path = fields.path();
        if mode.is_none() {
            fields.warn("points and lines are left out", "only triangles are read");
        }
        let own = Fields::new(fields.need("attributes", "an object { ... }")?, "attributes")?;
        let names = own.cursor().value().as_object().map(|map| map.keys().cloned());
        let mut attributes = BTreeMap::new();
        for name in names.into_iter().flatten() {
            let accessor = own.need_index(&name, "accessors", accessors)?;
            if name.starts_with("COLOR_") && name != COLORS {
                fields.warn("further vertex colours are ignored", "only COLOR_0 is used");
            }
            attributes.insert(name, accessor);
        }
        Ok(Self {
            path,
            mode,
            attributes,
            indices: fields.index("indices", "accessors", accessors)?,
            material: fields.index("material", "materials", materials)?,
        })
    }
}

fn mode(fields: &Fields<'_>) -> Result<Option<Mode>> {
    /// Triangles by default.
    const DEFAULT: u64 = 4;
    let Some(cursor) = fields.get("mode") else { return Ok(Some(Mode::Triangles)) };
    match cursor.value().as_u64() {
        Some(0..=3) => Ok(None),
        Some(DEFAULT) => Ok(Some(Mode::Triangles)),
        Some(5) => Ok(Some(Mode::Strip)),
        Some(6) => Ok(Some(Mode::Fan)),
        _ => {
            Err(cursor.error("must be a whole number from 0 to 6: 4 for triangles, 5 strip, 6 fan"))
        }
    }
}
