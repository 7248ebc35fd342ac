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
    /// What each morph target adds, in the same way.
    pub(super) targets: Vec<BTreeMap<String, usize>>,
    pub(super) indices: Option<usize>,
    /// The index of its material, or `None` for the default one.
    pub(super) material: Option<usize>,
}

/// An element of `meshes`.
#[derive(Clone, Debug)]
pub(super) struct MeshParts {
    pub(super) name: Option<String>,
    pub(super) primitives: Vec<Primitive>,
    /// The weights of its morph targets, for nodes without their own.
    pub(super) weights: Vec<f64>,
}

impl MeshParts {
    /// Reads an element of `meshes`.
    pub(super) fn read(fields: &Fields<'_>) -> Result<Self> {
        fields.need("primitives", "a list of objects")?;
        Ok(Self {
            name: fields.name()?,
            primitives: fields.list("primitives", "a primitive", Primitive::read)?,
            weights: fields.weights()?.unwrap_or_default(),
        })
    }
}

impl Primitive {
    fn read(fields: &Fields<'_>) -> Result<Self> {
        let must_be = "a whole number from 0 to 6: 4 for triangles, 5 strip, 6 fan";
        let mode = fields.code("mode", &MODES, must_be)?.unwrap_or(Some(Mode::Triangles));
        if mode.is_none() {
            fields.warn("points and lines are left out", "only triangles are read");
        }
        let attributes = accessors(&fields.need_object("attributes", "attributes")?)?;
        if attributes.keys().any(|name| name.starts_with("COLOR_") && name != COLORS) {
            fields.warn("further vertex colours are ignored", "only COLOR_0 is used");
        }
        Ok(Self {
            path: fields.path(),
            mode,
            attributes,
            targets: fields.list("targets", "a morph target", accessors)?,
            indices: fields.index("indices", "accessors")?,
            material: fields.index("material", "materials")?,
        })
    }
}

/// The accessors of attributes by their names.
fn accessors(fields: &Fields<'_>) -> Result<BTreeMap<String, usize>> {
    let names = fields.cursor.value().as_object().into_iter().flat_map(|map| map.keys());
    names.map(|name| Ok((name.clone(), fields.need_index(name, "accessors")?))).collect()
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
