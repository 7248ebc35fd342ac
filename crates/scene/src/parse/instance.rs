//! Instances of shapes.

use std::collections::HashMap;

use glam::DAffine3;

use crate::reader::{Cursor, Key, Kind, Object, keys};
use crate::schema::{Geometry, Instance, Shape};
use wavecrest_base::error::{Result, did_you_mean};

use super::{material, shape, transform};

pub(crate) const INSTANCE: Kind = Kind::new("an instance", "A copy of a shape.", &[KEYS]);

const KEYS: &[Key] = keys! {
    /// The name of the shape.
    "shape": Text, Required;
    /// Transform after the shape's own.
    "transform": Definition("transform");
    /// Replaces the shape's own material.
    "material": Definition("material");
    /// A name, for messages.
    "name": Text;
    /// Synonym of name.
    "id": Text;
};

/// The shapes of a file by name. An ambiguous name refers to none.
pub(super) struct Names<'a> {
    shapes: &'a [Shape],
    places: HashMap<&'a str, Option<usize>>,
}

impl<'a> Names<'a> {
    /// The names of `shapes`.
    pub(super) fn of(shapes: &'a [Shape]) -> Self {
        let mut places: HashMap<&str, Option<usize>> = HashMap::new();
        for (i, shape) in shapes.iter().enumerate() {
            if let Some(name) = &shape.name {
                places.entry(&name.0).and_modify(|place| *place = None).or_insert(Some(i));
            }
        }
        Self { shapes, places }
    }

    /// The index of the shape that the value of a key `shape` names.
    fn find(&self, cursor: &Cursor<'_>) -> Result<usize> {
        let name = cursor.text("the name of a shape of scene.shapes")?;
        match self.places.get(name) {
            Some(Some(place)) => Ok(*place),
            Some(None) => {
                let error = cursor.error("several shapes have this name");
                Err(error.remedy("use a different name for each shape"))
            }
            None => {
                let error = cursor.error("no shape has this name");
                let near = did_you_mean(name, self.places.keys().copied());
                Err(error.remedy(near.map_or_else(
                    || "add a \"name\" to the shape".to_owned(),
                    |near| format!("did you mean {near:?}?"),
                )))
            }
        }
    }
}

/// Reads an element of `scene.instances`.
pub(super) fn instance(cursor: &Cursor<'_>, names: &Names<'_>) -> Result<Instance> {
    let object = cursor.object(INSTANCE)?;
    let place = names.find(&object.need("shape", "the name of a shape of scene.shapes")?)?;
    let material = object.get("material").map(|cursor| material::material(&cursor)).transpose()?;
    Ok(Instance {
        path: cursor.path(),
        name: shape::name(&object)?,
        shape: place,
        transform: moved(&object, &names.shapes[place])?,
        material,
    })
}

/// The instance's transform, applied after the shape's own.
fn moved(object: &Object<'_>, shape: &Shape) -> Result<DAffine3> {
    let mut moved = DAffine3::IDENTITY;
    if let Some(cursor) = object.get("transform") {
        moved = transform::transform(&cursor)?;
        if matches!(shape.geometry, Geometry::Sphere(_)) && !transform::is_uniform(&moved) {
            return Err(shape::uneven(&cursor));
        }
    }
    Ok(moved * shape.transform.map_or(DAffine3::IDENTITY, |own| own.0))
}
