//! Converts a document to the values of a scene file.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use glam::DAffine3;
use hecs::{EntityBuilder, World};

use crate::components::{CutOut, Maps, Order, TextureRef};
use crate::format::Notes;
use crate::options::LoadOptions;
use crate::options::framing::{Framing, Up};
use crate::options::lighting::Rig;
use crate::staging::{self, Framed, Scenery, Upward, VisibleMesh};
use crate::systems::cutouts::Masks;
use wavecrest_base::error::{ErrorKind, Result};

use super::camera::{self, PlacedCamera};
use super::document::Document;
use super::light::{self, LightSource};
use super::material::MaterialElement;
use super::mesh::PrimitiveReader;
use super::node::{Node, PlacedNode, flattens};
use super::pose::Pose;
use super::spawn::{NodeUse, Spawned, extent};

/// Makes a scene from a document, and reports the choices made for the user.
pub(super) fn world(
    document: &Document,
    options: &LoadOptions,
    notes: &Notes<'_>,
) -> Result<(World, String)> {
    let mut primitives = notes.whole(|| Ok(primitives(document, notes)))?;
    let up = if options.like_meshes { Upward::Guessed(Up::Y) } else { Upward::Stated(Up::Y) };
    if options.like_meshes {
        let degrees = options.lighting.crease_degrees;
        primitives.iter_mut().for_each(|primitive| primitive.mesh.complete(degrees, true));
    }
    let mut images = Masks::of_scene(notes.file());
    let shown: Vec<VisibleMesh<'_>> =
        primitives.iter().map(|one| one.visible(&mut images)).collect();
    let uses = primitives.iter().map(|primitive| primitive.uses.iter().map(|one| &one.world));
    let instances = shown.iter().zip(uses).flat_map(|(shown, uses)| shown.instances(uses));
    let contents = Scenery::new(instances.collect());
    let own = match options.framing == Framing::default() {
        true => camera::chosen(&shots(document), &contents.sphere, options, notes)?,
        false => None,
    };
    let has_camera = own.is_some();
    let framed = match own {
        Some(view) => Framed::own(view),
        None => {
            staging::framed(&contents, up, options).map_err(|error| error.in_file(notes.file()))?
        }
    };
    let mut lights = lights(document, notes);
    let glowing = glowing(&primitives);
    let count = lights.len() + glowing.len();
    check_lights(&primitives, notes)?;
    let own = light::FileLights { lights: lights.iter().map(LightSource::of).collect(), glowing };
    let added = own.why_more(&contents.sphere, options.lighting.replaces);
    let exposure = own.exposure(&contents, &framed.view, added.is_some());
    let mut world = World::new();
    let (settings, told_light) = match added {
        Some(why) => {
            let (settings, told) =
                staging::light(&mut world, &contents, &framed, notes.file(), &options.lighting);
            (settings, Some(format!("{why}: {told}")))
        }
        None => {
            for (light, order) in lights.iter_mut().zip(0..) {
                light::expose(light, exposure);
                world.spawn(light.add(Order(order)).build());
            }
            (staging::settings(notes.file(), count, &options.lighting), None)
        }
    };
    drop(contents);
    drop(shown);
    // Nothing is seen of the choices without primitives.
    let told = told(has_camera, &framed.told, told_light, exposure);
    let told = if primitives.is_empty() { String::new() } else { told };
    world.spawn((settings,));
    framed.spawn(&mut world);
    // Without lights, a lamp is a surface that shows its emission.
    let shows_colors = added.is_some() && options.lighting.rig == Rig::None;
    // Behind all lights that are not meshes.
    let mut order = (lights.len() as u32 + staging::MOST_LAMPS..).map(Order);
    for primitive in primitives {
        let order = &mut order;
        if primitive.surface.is_light() && !shows_colors {
            primitive.add_lights(exposure, notes.file(), order, &mut world);
        } else {
            primitive.add_shapes(notes.file(), order, &mut world);
        }
    }
    staging::allow_for_surfaces(&mut world);
    Ok((world, told))
}

/// Largest number of triangles of lights: each node that shows one holds a copy.
const MOST_LIGHT_TRIANGLES: usize = 1 << 22;

fn check_lights(primitives: &[Spawned], notes: &Notes<'_>) -> Result<()> {
    let lights = primitives.iter().filter(|primitive| primitive.surface.is_light());
    let triangles =
        |primitive: &Spawned| primitive.mesh.triangles.len().saturating_mul(primitive.uses.len());
    let all = lights.map(triangles).fold(0, usize::saturating_add);
    if all <= MOST_LIGHT_TRIANGLES {
        return Ok(());
    }
    let message = "emissive meshes have too many triangles";
    let error = notes.error(ErrorKind::Limit, "materials", message).value(all);
    Err(error.remedy(format!("use at most {MOST_LIGHT_TRIANGLES}, or set emissiveFactor to 0")))
}

/// The choices made for the user.
fn told(has_camera: bool, chosen: &str, light: Option<String>, exposure: f64) -> String {
    let scaled = || {
        let rounded: f64 = format!("{exposure:.3e}").parse().unwrap_or(exposure);
        format!("lights scaled by {rounded:?} (exposure)")
    };
    let light = light.unwrap_or_else(scaled);
    let camera = if has_camera { "" } else { "no camera: a default camera is added; " };
    format!("{camera}{chosen}{light}")
}

/// The primitives that the nodes of the scene show, in the order of the nodes. Errors are recorded.
fn primitives(document: &Document, notes: &Notes<'_>) -> Vec<Spawned> {
    let mut reader = PrimitiveReader::new(document, notes);
    // The primitives of each mesh that is read already in a pose.
    let mut known: BTreeMap<(usize, _), Range<usize>> = BTreeMap::new();
    let mut primitives: Vec<Spawned> = Vec::new();
    for PlacedNode { node, world } in &document.placed {
        let Some(mesh) = document.nodes[*node].mesh else { continue };
        let place = format!("nodes[{node}]");
        let places = notes.part(|| places(document, *node, world, &place, notes));
        let Some(places) = places.ok().filter(|places| !places.is_empty()) else { continue };
        let pose = Pose::of(document, *node, mesh);
        let numbers = known.entry((mesh, pose.key())).or_insert_with(|| {
            let first = primitives.len();
            read(document, (mesh, &pose), &mut reader, notes, &mut primitives);
            first..primitives.len()
        });
        for (path, world) in places {
            for primitive in &mut primitives[numbers.clone()] {
                let path = match numbers.len() {
                    1 => path.clone(),
                    _ => format!("{path}, {}", primitive.path),
                };
                let name = document.nodes[*node].name.clone();
                let world = world * DAffine3::from_translation(primitive.origin);
                primitive.uses.push(NodeUse { path, name, world });
            }
        }
    }
    // Errors are also reported in meshes that no node of the scene shows.
    let used: BTreeSet<usize> = known.into_keys().map(|(mesh, _)| mesh).collect();
    for mesh in (0..document.meshes.len()).filter(|mesh| !used.contains(mesh)) {
        let message = "the mesh is not used";
        notes.leave_out(&format!("meshes[{mesh}]"), message, "no node of the scene refers to it");
        read(document, (mesh, &Pose::default()), &mut reader, notes, &mut Vec::new());
    }
    if primitives.is_empty() {
        let (message, remedy) = match is_left_out(document) {
            true => (
                "nothing is left of the scene: all its surfaces are left out as invisible",
                "export them with alphaMode OPAQUE, or with an alpha above the cutoff",
            ),
            false => ("the scene is empty", "no node of the scene has a mesh of triangles"),
        };
        notes.note("nodes", message, remedy);
    }
    primitives
}

/// The transforms at which a node shows its mesh, each with its path.
fn places(
    document: &Document,
    node: usize,
    world: &DAffine3,
    path: &str,
    notes: &Notes<'_>,
) -> Result<Vec<(String, DAffine3)>> {
    let Node { instancing, skin, .. } = &document.nodes[node];
    if skin.is_some() {
        if instancing.is_some() {
            let message = "instances of a mesh with a skin are ignored";
            notes.note(path, message, "its joints alone place it");
        }
        return Ok(vec![(path.to_owned(), DAffine3::IDENTITY)]);
    }
    let all = match instancing {
        None => vec![(path.to_owned(), *world)],
        Some(found) => {
            let place = |i| {
                let transform = found.transform(&document.storage, world, i).ok_or_else(|| {
                    let message = format!("instance {i} has an invalid transform");
                    let error = notes.error(ErrorKind::Scene, path, message);
                    error.remedy("use a unit quaternion and finite numbers")
                })?;
                Ok((format!("{path}, instance {i}"), transform))
            };
            (0..found.count).map(place).collect::<Result<Vec<_>>>()?
        }
    };
    let (kept, flat): (Vec<_>, Vec<_>) = all.into_iter().partition(|(_, world)| !flattens(world));
    if let Some((path, _)) = flat.first() {
        let message = "nodes with a scale of 0 are left out";
        notes.note(path, message, "use a scale other than 0 on every axis");
    }
    Ok(kept)
}

/// Whether some primitive of the scene is left out as invisible.
fn is_left_out(document: &Document) -> bool {
    let meshes = document.placed.iter().filter_map(|placed| document.nodes[placed.node].mesh);
    let mut materials = meshes
        .flat_map(|mesh| &document.meshes[mesh].primitives)
        .filter_map(|primitive| primitive.material);
    materials.any(|material| document.materials[material].threshold().is_none())
}

/// Reads the primitives of a mesh in a pose, and records their errors.
fn read(
    document: &Document,
    (mesh, pose): (usize, &Pose),
    reader: &mut PrimitiveReader<'_>,
    notes: &Notes<'_>,
    primitives: &mut Vec<Spawned>,
) {
    let parts = &document.meshes[mesh];
    for primitive in &parts.primitives {
        let surface = primitive.material.map_or(&document.usual, |i| &document.materials[i]);
        let (texture, maps, set) = textures(document, surface, notes);
        let Some(threshold) = surface.threshold() else {
            let message = "an invisible surface is left out";
            let remedy = "its alpha is 0 or below the cutoff everywhere";
            notes.leave_out(&primitive.path, message, remedy);
            continue;
        };
        let uses_alpha = threshold > 0.0 || surface.blends;
        let mesh = notes.part(|| reader.mesh(primitive, pose, set, uses_alpha));
        let Some(mut mesh) = mesh.ok().flatten() else { continue };
        let has_uvs = mesh.uvs.is_some();
        let texture = texture.filter(|_| has_uvs);
        let is_cut = threshold > 0.0 && (texture.is_some() || mesh.alphas.is_some());
        let cutout = is_cut.then(|| CutOut {
            look_up: texture.as_ref().map(|texture| texture.look_up.clone()),
            is_mask: false,
            threshold,
        });
        let mut maps = if has_uvs { maps } else { Maps::default() };
        if maps.normal.is_some() && primitive.attributes.contains_key("TANGENT") {
            let message = "the tangents of the file are not used";
            notes.note(&primitive.path, message, "bake normal maps by the method of MikkTSpace");
        }
        if maps.metal.is_none() && (texture.is_some() || mesh.colors.is_some()) {
            maps.metal = surface.metal_by_color();
        }
        primitives.push(Spawned {
            path: primitive.path.clone(),
            name: parts.name.clone(),
            cutout,
            texture,
            maps,
            origin: std::mem::take(&mut mesh.origin),
            mesh,
            surface: surface.clone(),
            uses: Vec::new(),
        });
    }
}

/// The textures of a surface whose images exist, and the one set of coordinates that they use.
fn textures(
    document: &Document,
    surface: &MaterialElement,
    notes: &Notes<'_>,
) -> (Option<TextureRef>, Maps, Option<u32>) {
    let mut set = None;
    let (color, maps) = surface.textures(|info, encoding, tint| {
        let texture = document.textures.reference(info, encoding, tint, notes)?;
        if *set.get_or_insert(info.set) == info.set {
            return Some(texture);
        }
        let message = "a texture with another set of coordinates is left out";
        let remedy = "use one set of coordinates for all textures of a material";
        notes.note("materials", message, remedy);
        None
    });
    (color, maps, set)
}

/// The cameras of the scene's nodes.
fn shots(document: &Document) -> Vec<PlacedCamera<'_>> {
    let shot = |&PlacedNode { node, world }: &PlacedNode| {
        let number = document.nodes[node].camera?;
        let (camera, node) = (&document.cameras[number], document.nodes[node].name.as_deref());
        Some(PlacedCamera { number, camera, node, world })
    };
    document.placed.iter().filter_map(shot).collect()
}

/// The lights of the scene's nodes.
fn lights(document: &Document, notes: &Notes<'_>) -> Vec<EntityBuilder> {
    let placed = |place: &PlacedNode| {
        let light = document.lights[document.nodes[place.node].light?]?;
        let path = format!("nodes[{}]", place.node);
        let found = light.placed(path.clone(), &place.world);
        if found.is_none() {
            let message = "the node of the light has a scale of 0";
            notes.note(&path, message, "the light is left out");
        }
        found
    };
    document.placed.iter().filter_map(placed).collect()
}

/// The emissive meshes as lights.
fn glowing(primitives: &[Spawned]) -> Vec<LightSource> {
    let lights = primitives.iter().filter(|primitive| primitive.surface.is_light());
    let source = |primitive: &Spawned, world: &DAffine3| {
        let (area, middle) = extent(&primitive.mesh, world);
        LightSource::glowing(primitive.surface.emission, area, middle)
    };
    lights
        .flat_map(|light| light.uses.iter().map(move |found| source(light, &found.world)))
        .collect()
}
