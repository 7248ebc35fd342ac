//! Replaces surfaces for inspection.

use std::sync::Arc;

use glam::DVec3;
use hecs::{Entity, Without, World};

use crate::components::{
    Added, Channels, Encoding, Filter, InstanceOf, LookUp, Maps, Material, Mesh, TextureRef,
    TextureSource, Wrap,
};
use crate::query::{change, remove};
use wavecrest_image::look::Look;

/// The reflectance of clay.
const CLAY: DVec3 = DVec3::splat(0.5);

/// Replaces the surfaces of the world by those of a look.
pub(super) fn show(world: &mut World, look: Look) {
    leave_out(world, look);
    match look {
        Look::Clay => clay(world),
        Look::Uv => show_uvs(world),
        _ => {}
    }
}

/// Removes what a look does not show: what is added to a file has edges and a depth of its own. Clay has all of it, as it
/// is lit, and so edges have the light of the lamp.
pub fn leave_out(world: &mut World, look: Look) {
    remove_added(world, |added| match look {
        Look::Clay => false,
        Look::Wireframe => added == Added::Ground,
        _ => true,
    });
}

/// Removes those of the shapes that are no part of the file.
pub fn remove_added(world: &mut World, which: impl Fn(Added) -> bool) {
    let added = world.query_mut::<(Entity, &Added)>().into_iter();
    let added: Vec<_> =
        added.filter(|(_, added)| which(**added)).map(|(entity, _)| entity).collect();
    for entity in added {
        let _ = world.despawn(entity);
    }
}

/// Gives every surface one matte grey, and no texture or other colour; except an added ground, whose
/// edge would show.
fn clay(world: &mut World) {
    for material in world.query_mut::<Without<&mut Material, &Added>>() {
        *material = Material { diffuse_color: CLAY, ..Material::MATTE };
    }
    change(world, |mesh: &mut Mesh| mesh.data.colors = None);
    remove::<TextureRef>(world);
    remove::<Maps>(world);
}

/// Shows the texture coordinates of every surface as colours; surfaces without are grey.
fn show_uvs(world: &mut World) {
    clay(world);
    let texture = TextureRef {
        look_up: LookUp {
            source: TextureSource::Embedded { place: "uv".into(), bytes: uv_image() },
            filter: Filter::Nearest,
            wrap: Wrap::Repeat,
            placing: None,
        },
        encoding: Encoding::Linear,
        tint: DVec3::ONE,
        channels: Channels::Color,
    };
    let shapes: Vec<(Entity, Entity)> = world
        .query_mut::<(Entity, &Material, Option<&InstanceOf>)>()
        .into_iter()
        .map(|(entity, _, of)| (entity, of.map_or(entity, |of| of.0)))
        .collect();
    for (entity, geometry) in shapes {
        let has_uvs = world.get::<&Mesh>(geometry).map_or(true, |mesh| mesh.data.uvs.is_some());
        if has_uvs {
            let _ = world.insert_one(entity, texture.clone());
        }
    }
}

/// Texels along each side of the image of texture coordinates, and fields of its checker.
const UV_SIDE: u8 = 255;
const UV_FIELDS: u32 = 16;

/// A PPM: u as red, v as green, and a checker as blue.
fn uv_image() -> Arc<[u8]> {
    let mut bytes = format!("P6 {UV_SIDE} {UV_SIDE} 255\n").into_bytes();
    let field = |x: u8| u32::from(x) * UV_FIELDS / u32::from(UV_SIDE);
    for y in 0..UV_SIDE {
        for x in 0..UV_SIDE {
            let is_light = (field(x) + field(y)) % 2 == 0;
            // v runs from bottom to top.
            bytes.extend([x, UV_SIDE - 1 - y, if is_light { 200 } else { 80 }]);
        }
    }
    bytes.into()
}
