//! Instances of shapes.

use std::collections::HashMap;

use hecs::{Entity, EntityBuilder, EntityRef, World};
use serde_json::Value;

use super::transform::keeps_round;
use super::{Disk, Name, Sphere, Transform};
use crate::format::{Cursor, Declaration, Kind, Writer, keys};
use crate::surface::{MATERIAL, MATERIAL_OBJECT, Material, Transparency};
use wavecrest_base::error::{Result, did_you_mean};

/// The prototype of an instance: an entity with a sphere, disk, quad, triangle or mesh, which is stored
/// once. Everything else is the instance's own; its [`Transform`] follows the prototype's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstanceOf(pub Entity);

pub(crate) const INSTANCE: Kind = Kind {
    keys: keys! {
        /// The name of the shape.
        "shape": Text, Required;
    },
    components: &[Declaration::of::<Name>(), Declaration::of::<Transform>()],
    more: &[&[OWN_MATERIAL]],
    ..Kind::new("an instance", "A copy of a shape.", &[])
};

const OWN_MATERIAL: Declaration = Declaration {
    keys: keys! {
        /// Replaces the shape's own material.
        "material": Object(&MATERIAL_OBJECT);
    },
    read: |object, entity| match object.get("material") {
        Some(_) => (MATERIAL.read)(object, entity),
        None => Ok(()),
    },
    ..MATERIAL
};

/// The shapes of a file by name. An ambiguous name refers to none.
pub(crate) struct Names(HashMap<String, Option<Entity>>);

impl Names {
    /// The names of these shapes.
    pub(crate) fn of(shapes: Vec<EntityRef<'_>>) -> Self {
        let mut all = HashMap::new();
        for shape in shapes {
            if let Some(name) = shape.get::<&Name>() {
                let entry = all.entry(name.0.clone()).and_modify(|one| *one = None);
                entry.or_insert(Some(shape.entity()));
            }
        }
        Self(all)
    }

    /// The shape that the value of a key `shape` names.
    fn find(&self, cursor: &Cursor<'_>) -> Result<Entity> {
        let name = cursor.text("the name of a shape of scene.shapes")?;
        match self.0.get(name) {
            Some(Some(shape)) => Ok(*shape),
            Some(None) => {
                let error = cursor.error("several shapes have this name");
                Err(error.remedy("use a different name for each shape"))
            }
            None => {
                let error = cursor.error("no shape has this name");
                let near = did_you_mean(name, self.0.keys().map(String::as_str));
                Err(error.remedy(near.map_or_else(
                    || "add a \"name\" to the shape".to_owned(),
                    |near| format!("did you mean {near:?}?"),
                )))
            }
        }
    }
}

/// Reads an element of `scene.instances` as components of an `entity`.
pub(crate) fn instance(
    cursor: &Cursor<'_>,
    (names, world): (&Names, &World),
    entity: &mut EntityBuilder,
) -> Result<()> {
    let object = cursor.object(INSTANCE)?;
    let shape = names.find(&object.need("shape", "the name of a shape of scene.shapes")?)?;
    entity.add(InstanceOf(shape));
    object.components(entity)?;
    let round = match world.entity(shape) {
        Ok(shape) if shape.has::<Sphere>() => Some("a sphere"),
        Ok(shape) if shape.has::<Disk>() => Some("a disk"),
        _ => None,
    };
    round.map_or(Ok(()), |shape| keeps_round(&object, shape))
}

/// Writes an instance; its material only if it is not the shape's.
pub(crate) fn write(world: &World, instance: EntityRef<'_>, mut to: Writer<'_>) -> Value {
    if let Some(of) = instance.get::<&InstanceOf>()
        && let Ok(shape) = world.entity(of.0)
    {
        to.set("shape", to.name(of.0));
        let of = |entity: EntityRef<'_>| {
            let transparency = entity.get::<&Transparency>().map(|of| *of);
            let material = entity.get::<&Material>().map(|of| *of);
            (material, transparency.unwrap_or(Transparency::OPAQUE))
        };
        if of(instance) != of(shape) {
            (OWN_MATERIAL.write)(instance, &mut to);
        }
        // In the order of earlier versions.
        let components = INSTANCE.components.iter().rev();
        components.for_each(|component| (component.write)(instance, &mut to));
    }
    to.end()
}
