//! Instanced meshes of nodes: the extension `EXT_mesh_gpu_instancing`.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

use crate::format::Notes;
use wavecrest_base::error::{Error, ErrorKind, Result};

use super::accessor::{Accessor, Component, Storage};
use super::document::Document;
use super::fields::Fields;
use super::node::{flattens, is_place};

/// The accessors of the instances' attributes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instancing {
    count: usize,
    translation: Option<usize>,
    rotation: Option<usize>,
    scale: Option<usize>,
}

impl Instancing {
    /// Reads the extension of a node, if it has it and the file's `accessors` are right.
    pub(super) fn read(
        fields: &Fields<'_>,
        accessors: Option<&[Accessor]>,
    ) -> Result<Option<Self>> {
        let Some(accessors) = accessors else { return Ok(None) };
        let found = fields.extension("EXT_mesh_gpu_instancing", |found| {
            let attributes = found.need("attributes", "an object { ... }")?;
            let attributes = Fields::new(attributes, "attributes")?;
            let of = |key: &str, width: usize| accessor(&attributes, key, width, accessors);
            let (translation, rotation) = (of("TRANSLATION", 3)?, of("ROTATION", 4)?);
            let scale = of("SCALE", 3)?;
            let counts = || {
                let all = [translation, rotation, scale].into_iter().flatten();
                all.map(|index| accessors[index].count)
            };
            let count = counts().next().unwrap_or(0);
            if counts().any(|other| other != count) {
                let error = attributes.error("all accessors must have as many elements");
                return Err(error.remedy("export the file again"));
            }
            Ok(Self { count, translation, rotation, scale })
        })?;
        Ok(found.filter(|found| found.count > 0))
    }

    /// The transforms of the instances of a node at `world`.
    ///
    /// # Errors
    /// If one is not a valid transform.
    pub(super) fn places(
        &self,
        document: &Document,
        node: &str,
        world: &DAffine3,
    ) -> Result<Vec<DAffine3>> {
        let storage = document.storage();
        let place = |i: usize| {
            let transform = *world * self.transform(&document.accessors, storage, i)?;
            is_place(&transform).then_some(transform)
        };
        let places = (0..self.count).map(|i| {
            place(i).ok_or_else(|| {
                let message = format!("instance {i} has an invalid transform");
                let error = Error::new(ErrorKind::Scene, message).at(node);
                error.remedy("use a unit quaternion and finite numbers")
            })
        });
        places.collect()
    }

    fn transform(&self, all: &[Accessor], storage: Storage<'_>, i: usize) -> Option<DAffine3> {
        let vector = |index: Option<usize>, absent: DVec3| {
            index.map_or(absent, |at| DVec3::from_array(all[at].elements(storage).get(i)))
        };
        let turned = match self.rotation {
            Some(at) => {
                let parts = DVec4::from_array(all[at].elements(storage).get(i));
                let length = parts.length();
                let is_sound = length > 0.0 && length.is_finite();
                DMat3::from_quat(is_sound.then(|| DQuat::from_vec4(parts / length))?)
            }
            None => DMat3::IDENTITY,
        };
        let scale = DMat3::from_diagonal(vector(self.scale, DVec3::ONE));
        let translation = vector(self.translation, DVec3::ZERO);
        Some(DAffine3 { matrix3: turned * scale, translation })
    }
}

/// The accessor of an attribute with this number of components.
fn accessor(
    attributes: &Fields<'_>,
    key: &str,
    width: usize,
    accessors: &[Accessor],
) -> Result<Option<usize>> {
    let Some(index) = attributes.index(key, "accessors", accessors.len())? else { return Ok(None) };
    let found = &accessors[index];
    let is_right = found.width == width
        && (found.component == Component::F32 || found.normalized && width == 4);
    if is_right {
        return Ok(Some(index));
    }
    let cursor = attributes.need(key, "an index into accessors")?;
    Err(cursor.error(format!("must be VEC{width} of floats")).remedy("export the file again"))
}

/// The transforms at which a node shows its mesh, each with its path.
pub(super) fn places(
    document: &Document,
    node: usize,
    world: &DAffine3,
    path: &str,
    notes: &Notes<'_>,
) -> Result<Vec<(String, DAffine3)>> {
    let all = match &document.nodes[node].instancing {
        None => vec![(path.to_owned(), *world)],
        Some(found) => {
            let places =
                found.places(document, path, world).map_err(|e| e.in_file(notes.file()))?;
            let path = |(i, world)| (format!("{path}, instance {i}"), world);
            places.into_iter().enumerate().map(path).collect()
        }
    };
    let (kept, flat): (Vec<_>, Vec<_>) = all.into_iter().partition(|(_, world)| !flattens(world));
    if let Some((path, _)) = flat.first() {
        let message = "nodes with a scale of 0 are left out";
        notes.note(path, message, "use a scale other than 0 on every axis");
    }
    Ok(kept)
}
