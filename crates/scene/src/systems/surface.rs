//! The surface of a shape, looked up by its entity.

use glam::DVec3;
use hecs::{Entity, ViewBorrow};

use crate::components::{
    AreaLight, CutOut, JsonPath, Maps, Material, Name, TextureRef, Transparency,
};

/// The components of a shape's surface, and what messages call it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceComponents<'w> {
    /// The light whose shape it is.
    pub(crate) light: Option<&'w AreaLight>,
    /// The material; shapes of lights have neither one nor textures.
    pub(crate) material: Option<&'w Material>,
    /// The light that goes through it.
    pub(crate) transparency: Option<&'w Transparency>,
    /// The texture of its diffuse colour.
    pub(crate) texture: Option<&'w TextureRef>,
    /// Its other textures.
    pub(crate) maps: &'w Maps,
    /// Its holes.
    pub(crate) cut_out: Option<&'w CutOut>,
    /// Its place in the scene file; empty if unknown.
    pub(crate) place: &'w str,
    /// Its name in the scene file.
    pub(crate) name: Option<&'w Name>,
}

/// [`SurfaceComponents`] as a query, with those of its material and textures together.
pub(crate) type SurfaceColumns<'w> =
    (Option<&'w AreaLight>, MaterialColumns<'w>, Option<&'w JsonPath>, Option<&'w Name>);

type MaterialColumns<'w> = (
    Option<&'w Material>,
    Option<&'w Transparency>,
    Option<&'w TextureRef>,
    Option<&'w Maps>,
    Option<&'w CutOut>,
);

impl<'w> SurfaceComponents<'w> {
    /// Those of an entity: shapes are looked up in the order of their primitives, which the world
    /// does not keep.
    pub(crate) fn of(columns: &'w ViewBorrow<'_, SurfaceColumns<'_>>, entity: Entity) -> Self {
        let (light, surface, place, name) = columns.get(entity).unwrap_or_default();
        let surface = if light.is_none() { surface } else { Default::default() };
        let (material, transparency, texture, maps, cut_out) = surface;
        let (maps, place) = (maps.unwrap_or(&Maps::NONE), place.map_or("", |place| &place.0));
        Self { light, material, transparency, texture, maps, cut_out, place, name }
    }

    /// Whether no light comes from it but what it mirrors or lets through.
    pub(crate) fn is_black(&self) -> bool {
        let is_black = |material: &Material| {
            [material.ks, material.kd] == [0.0; 2] && material.emission == DVec3::ZERO
        };
        self.material.is_some_and(is_black) && !self.is_unlit() && self.maps.metal.is_none()
    }

    /// Whether it shows its base colour as it is.
    pub(crate) fn is_unlit(&self) -> bool {
        self.material.is_some_and(|material| material.unlit)
    }
}
