//! Reads the mesh files that entities name, and completes what depends on them: parts with materials
//! of their own, instances, and shading.

use std::collections::{HashMap, HashSet};

use hecs::{Entity, EntityBuilder, EntityRef, World};

use super::materials::split;
use crate::components::{
    AreaLight, CutOut, Hidden, InstanceOf, JsonPath, Maps, Materials, Mesh, MeshFile, Order,
    Shading, Sides, TextureRef, VertexColors,
};
use crate::format::{Declaration, Notes};
use crate::mesh::{self, MeshData, NamedMaterials, announce};
use crate::query::{Pictured, images_of, json_path, ordered, shapes};
use crate::shapes::{COMMON, INSTANCE};
use crate::surface::SURFACE;
use wavecrest_base::error::{ErrorKind, Result};

/// Completes the `world`.
pub(super) fn complete(world: &mut World, notes: &Notes<'_>) -> Result<()> {
    notes.whole(|| {
        let mut sound = Ok(());
        for light in ids(ordered::<&AreaLight>(world)) {
            sound = notes.part(|| complete_light(world, light, notes)).and(sound);
        }
        leave_out_unseen(world, notes);
        world.query::<&MeshFile>().iter().for_each(|mesh| announce(&mesh.file));
        let mut order = (0..).map(Order);
        let mut parts_of: HashMap<Entity, Vec<Entity>> = HashMap::new();
        for shape in ids(shapes(world)) {
            match notes.part(|| complete_shape(world, shape, notes)) {
                Ok(parts) => {
                    for (&part, order) in parts.iter().zip(&mut order) {
                        let _ = world.insert_one(part, order);
                    }
                    parts_of.insert(shape, parts);
                }
                Err(error) => sound = Err(error),
            }
        }
        sound?;
        for instance in ids(ordered::<&InstanceOf>(world)) {
            complete_instance(world, instance, &parts_of, &mut order);
        }
        Ok(())
    })
}

/// The entities, to change their world.
fn ids(those: Vec<EntityRef<'_>>) -> Vec<Entity> {
    those.into_iter().map(|entity| entity.entity()).collect()
}

/// Leaves out shapes that are hidden and have no instance: their meshes are not read. Warns of them.
fn leave_out_unseen(world: &mut World, notes: &Notes<'_>) {
    let prototypes: HashSet<Entity> = world.query::<&InstanceOf>().iter().map(|of| of.0).collect();
    let mut hidden = ordered::<&Hidden>(world);
    hidden.retain(|shape| !prototypes.contains(&shape.entity()));
    for shape in &hidden {
        let place = json_path(world, shape.entity());
        let message = "the shape is hidden and has no instance";
        notes.note(&place, message, "add an instance, or remove \"hidden\"");
        if let Ok((mesh, pictured)) = shape.query::<(Option<&MeshFile>, Pictured<'_>)>().get() {
            mesh.into_iter().for_each(|mesh| notes.reads(&mesh.file));
            images_of(pictured).for_each(|file| notes.reads(file));
        }
    }
    for shape in ids(hidden) {
        let _ = world.despawn(shape);
    }
}

fn complete_light(world: &mut World, light: Entity, notes: &Notes<'_>) -> Result<()> {
    let place = format!("{}.shape", json_path(world, light));
    if let Ok(file) = world.remove_one::<MeshFile>(light) {
        let file = MeshFile { colors: VertexColors::None, ..file };
        let (mesh, _) = read(&file, &place, notes)?;
        let _ = world.insert_one(light, mesh);
    }
    match world.get::<&Mesh>(light).is_ok_and(|mesh| !mesh.has_area()) {
        true => Err(notes.error(ErrorKind::Scene, &place, "a light must have an area")),
        false => Ok(()),
    }
}

/// Completes a shape; returns its parts, several if its faces have the materials of its file.
fn complete_shape(world: &mut World, shape: Entity, notes: &Notes<'_>) -> Result<Vec<Entity>> {
    let mut parts = vec![shape];
    if let Ok(file) = world.remove_one::<MeshFile>(shape) {
        let (mesh, named) = read(&file, &json_path(world, shape), notes)?;
        if file.materials == Materials::File {
            let Ok(whole) = world.entity(shape) else { return Ok(Vec::new()) };
            let begin = |surface: &[Declaration]| {
                let mut part = EntityBuilder::new();
                whole.get::<&Order>().map(|order| part.add(*order));
                whole.get::<&JsonPath>().map(|path| part.add(JsonPath::clone(&path)));
                let maps = Declaration::of::<Maps>();
                let kept = COMMON.iter().chain([&maps]).chain(surface);
                kept.for_each(|component| (component.copy)(whole, &mut part));
                part
            };
            let split = split(begin, mesh.data, &named, &file.file, notes);
            parts = split.into_iter().map(|mut part| world.spawn(part.build())).collect();
            let _ = world.despawn(shape);
        } else {
            let _ = world.insert_one(shape, mesh);
        }
    }
    parts.iter().try_for_each(|&part| check_attributes(world, part, notes))?;
    Ok(parts)
}

/// Reads a mesh file for the shape at `place`; returns the file's materials too.
fn read(
    MeshFile { file, colors, .. }: &MeshFile,
    place: &str,
    notes: &Notes<'_>,
) -> Result<(Mesh, NamedMaterials)> {
    notes.reads(file);
    let mut loaded = mesh::load(file).map_err(|cause| {
        let message = format!("cannot read the mesh: {cause}");
        notes.error(cause.kind(), &format!("{place}.file"), message).because(cause)
    })?;
    notes.pass_on(loaded.warnings);
    loaded.mesh.decode_colors(*colors);
    let mesh = Mesh { data: loaded.mesh, file: Some(file.clone()), ..Mesh::default() };
    Ok((mesh, loaded.materials))
}

/// Checks that a mesh has the texture coordinates that its textures need. Without normals it is
/// shaded flat.
fn check_attributes(world: &mut World, part: Entity, notes: &Notes<'_>) -> Result<()> {
    type Attributes<'w> =
        (&'w Mesh, &'w mut Shading, Option<&'w TextureRef>, Option<&'w Maps>, Option<&'w CutOut>);
    let place = json_path(world, part);
    let found = world.query_one_mut::<Attributes<'_>>(part);
    let Ok((mesh, shading, texture, maps, cutout)) = found else {
        return Ok(());
    };
    let Mesh { data: MeshData { uvs, normals, .. }, file, .. } = mesh;
    let maps = maps.into_iter().flat_map(Maps::all);
    let maps = maps.filter(|(_, map)| map.texture.is_some()).map(|(key, _)| key);
    let mut keys = texture.map(|_| "texture").into_iter().chain(maps);
    if let Some(key) =
        keys.next().or(cutout.and_then(|cutout| cutout.look_up.as_ref()).map(|_| "alpha"))
        && uvs.is_none()
    {
        let message = "the mesh has no texture coordinates".to_owned();
        let error = notes.error(ErrorKind::Scene, &format!("{place}.{key}"), message);
        let add = file.as_ref().map_or("add \"uvs\"", |_| "export its file with them");
        return Err(error.remedy(format!("{add}, or remove the texture")));
    }
    if *shading == Shading::Smooth && normals.is_none() {
        let message = "the mesh has no normals for smooth shading";
        notes.note(&format!("{place}.shading"), message, "flat shading is used");
        *shading = Shading::Flat;
    }
    Ok(())
}

/// Makes an instance one of each part of its shape, whose surface it has unless it has its own.
fn complete_instance(
    world: &mut World,
    instance: Entity,
    parts_of: &HashMap<Entity, Vec<Entity>>,
    order: &mut impl Iterator<Item = Order>,
) {
    let shape = world.remove_one::<InstanceOf>(instance);
    let parts = shape.ok().and_then(|shape| parts_of.get(&shape.0)).map_or(&[][..], |parts| parts);
    for (&part, order) in parts.iter().zip(order) {
        let mut entity = EntityBuilder::new();
        entity.add_bundle((order, InstanceOf(part)));
        if let (Ok(own), Ok(part)) = (world.entity(instance), world.entity(part)) {
            let sides = [Declaration::of::<Sides>(), Declaration::of::<Shading>()];
            let of_part = SURFACE.iter().chain(&sides);
            of_part.for_each(|component| (component.copy)(part, &mut entity));
            own.get::<&JsonPath>().map(|path| entity.add(JsonPath::clone(&path)));
            INSTANCE.declarations().for_each(|component| (component.copy)(own, &mut entity));
        }
        world.spawn(entity.build());
    }
    let _ = world.despawn(instance);
}
