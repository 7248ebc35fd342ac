//! What all shapes have besides their geometry and their surface.

use super::Transform;
use crate::format::{Declaration, Declared, Key, Object, Writer, keys, words};
use wavecrest_base::error::Result;

/// What a shape of the scene has besides geometry and surface.
pub(crate) const COMMON: [Declaration; 5] = [
    Declaration::of::<Name>(),
    Declaration::of::<Hidden>(),
    Declaration::of::<Transform>(),
    Declaration::of::<Sides>(),
    Declaration::of::<Shading>(),
];

/// The same of the shape of a light, which is seen from both sides.
pub(super) const OF_LIGHT: [Declaration; 4] = [
    Declaration::of::<Name>(),
    Declaration::of::<Transform>(),
    Declaration::checked::<Sides>(),
    Declaration::checked::<Shading>(),
];

/// The name of the entity in the scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name(pub String);

impl Declared for Name {
    const KEYS: &'static [Key] = keys! {
        /// A name, for messages and for instances.
        "name" | "id": Text;
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let Some(cursor) = object.get("name") else { return Ok(None) };
        Ok(Some(Self(cursor.text("a string that is not empty")?.to_owned())))
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.set("name", self.0.clone());
    }
}

/// Marks a shape that is not rendered itself; only its instances are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hidden;

impl Declared for Hidden {
    const KEYS: &'static [Key] = keys! {
        /// Whether only its instances are rendered; without any, its files are not read.
        "hidden": Truth, Off;
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let hidden = object.get("hidden").map_or(Ok(false), |cursor| cursor.truth())?;
        Ok(hidden.then_some(Self))
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.set("hidden", true);
    }
}

words!(Sides, Shading);

wavecrest_base::choices! {
    /// The sides of a surface that lights reach.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Sides {
        /// The front; the back shows ambient light only.
        Front = "front",
        /// Both.
        Both = "both",
    }
}

impl Declared for Sides {
    const KEYS: &'static [Key] = keys! {
        /// The sides that lights illuminate; by default both for spheres and for meshes without
        /// `normal`, and the front for others. The back of a shape with `front` shows ambient light
        /// only and mirrors nothing.
        "sides": word::<Sides>();
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        // A mesh without a statement about its fronts has two.
        let has_fronts = !matches!(object.word(), "sphere" | "trimesh") || object.has("normal");
        let usual = if has_fronts { Self::Front } else { Self::Both };
        Ok(Some(object.read_or("sides", Some(usual))))
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.put("sides", *self);
    }
}

wavecrest_base::choices! {
    /// The shading normals of a mesh.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Shading {
        /// The triangle's own.
        Flat = "flat",
        /// Interpolated from the vertices, if the mesh has normals.
        Smooth = "smooth",
    }
}

impl Declared for Shading {
    const KEYS: &'static [Key] = keys! {
        /// Whether a mesh is shaded with the normals of its triangles or with its own.
        "shading": word::<Shading>(), Says("flat");
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        Ok(Some(object.read("shading")))
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.put("shading", *self);
    }
}
