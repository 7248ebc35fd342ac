//! The JSON of a scene file, from the entities of a world.

use std::collections::{HashMap, HashSet};

use glam::{DAffine3, DVec3};
use hecs::{Entity, EntityRef, World};
use serde_json::{Map, Value, json};

use crate::components::{
    Ambient, AreaLight, CameraKey, CameraPath, CutOut, DirectionalLight, Encoding, Hidden,
    InstanceOf, Maps, Material, Mesh, MetalMap, Name, Order, Placing, PointLight, Quad, Shading,
    Sides, Sphere, Spot, StrengthMap, TextureRef, ThinLens, Transform, Triangle, VertexColors,
    View,
};
use crate::query;
use wavecrest_base::error::{Error, ErrorKind, Result};

use super::beside::Beside;

/// The whole file. Meshes are moved out of the world.
pub(super) fn scene(
    world: &mut World,
    encoding: Encoding,
    beside: &mut Beside<'_>,
) -> Result<Value> {
    check_kinds(world)?;
    let (settings, view) = (query::settings(world)?, query::view(world)?);
    let path = world.query::<&CameraPath>().iter().next().cloned();
    let lights = lights(world, beside)?;
    let names = names(world);
    let shapes = ordered::<hecs::Without<&Mesh, hecs::Or<&AreaLight, &InstanceOf>>>(world);
    let shapes: Vec<Value> = shapes
        .into_iter()
        .map(|entity| shape(world, entity, names.get(&entity), beside))
        .collect::<Result<_>>()?;
    let instances: Vec<Value> = ordered::<&InstanceOf>(world)
        .into_iter()
        .filter_map(|entity| instance(world, entity, &names))
        .collect();
    let mut inner = Map::new();
    inner.insert("backgroundcolor".into(), vector(settings.background));
    inner.insert("ambient".into(), ambient(settings.ambient));
    inner.insert("lightsources".into(), lights.into());
    inner.insert("shapes".into(), shapes.into());
    if !instances.is_empty() {
        inner.insert("instances".into(), instances.into());
    }
    Ok(json!({
        "nbounces": settings.bounces,
        "transfer": encoding.name(),
        "camera": camera(&view, path.as_ref()),
        "scene": inner,
    }))
}

/// Refuses components that only scene files have.
fn check_kinds(world: &mut World) -> Result<()> {
    let others =
        world.query_mut::<hecs::Or<hecs::Or<&Sphere, &Quad>, hecs::Or<&Triangle, &ThinLens>>>();
    if others.into_iter().next().is_none() {
        return Ok(());
    }
    let error = Error::new(ErrorKind::Usage, "this is already a scene file");
    Err(error.remedy("convert glTF files and meshes"))
}

/// The matching entities, in the order of the file.
fn ordered<Q: hecs::Query>(world: &World) -> Vec<Entity> {
    let mut found: Vec<(Order, Entity)> = world
        .query::<(Entity, &Order)>()
        .with::<Q>()
        .iter()
        .map(|(entity, order)| (*order, entity))
        .collect();
    found.sort_unstable_by_key(|(order, _)| *order);
    found.into_iter().map(|(_, entity)| entity).collect()
}

/// A unique name for each named shape, and for each that instances refer to.
fn names(world: &World) -> HashMap<Entity, String> {
    let mut used = HashSet::new();
    let mut names = HashMap::new();
    for entity in ordered::<&Mesh>(world) {
        let own = world.get::<&Name>(entity).map(|name| name.0.clone());
        let is_hidden = world.get::<&Hidden>(entity).is_ok();
        let Some(wanted) = own.ok().or_else(|| is_hidden.then(|| "shape".to_owned())) else {
            continue;
        };
        let numbered = (2_u32..).map(|n| format!("{wanted}-{n}"));
        let free =
            std::iter::once(wanted.clone()).chain(numbered).find(|name| used.insert(name.clone()));
        names.extend(free.map(|name| (entity, name)));
    }
    names
}

fn lights(world: &mut World, beside: &mut Beside<'_>) -> Result<Vec<Value>> {
    let mut found = Vec::new();
    type AnyLight<'w> = hecs::Or<hecs::Or<&'w PointLight, &'w DirectionalLight>, &'w AreaLight>;
    for entity in ordered::<AnyLight<'_>>(world) {
        let own = world.entity(entity).map_err(|_| query::missing("light"))?;
        let point = own.get::<&PointLight>().map(|light| *light);
        let spot = own.get::<&Spot>().map(|spot| *spot);
        let directional = own.get::<&DirectionalLight>().map(|light| *light);
        found.push(match (point, spot, directional) {
            (Some(light), None, _) => point_light(&light),
            (Some(light), Some(spot), _) => spot_light(&light, &spot),
            (None, _, Some(light)) => directional_light(&light),
            _ => area_light(world, entity, beside)?,
        });
    }
    Ok(found)
}

fn spot_light(light: &PointLight, spot: &Spot) -> Value {
    let mut value = point_light(light);
    value["type"] = "spotlight".into();
    value["direction"] = vector(spot.direction);
    value["inner"] = spot.inner_degrees.into();
    value["outer"] = spot.outer_degrees.into();
    value
}

fn directional_light(light: &DirectionalLight) -> Value {
    json!({
        "type": "directionallight",
        "intensity": light.intensity,
        "color": vector(light.color),
        "direction": vector(light.direction),
        "angle": light.angle_degrees,
        "sampling": light.sampling.name(),
        "samples": light.samples,
    })
}

fn point_light(light: &PointLight) -> Value {
    json!({
        "type": "pointlight",
        "intensity": light.intensity,
        "position": vector(light.position),
        "color": vector(light.color),
        "falloff": light.falloff.name(),
    })
}

fn area_light(world: &mut World, entity: Entity, beside: &mut Beside<'_>) -> Result<Value> {
    let light = world.get::<&AreaLight>(entity).map(|light| *light);
    let light = light.map_err(|_| query::missing("AreaLight"))?;
    let mut shape = Map::new();
    mesh_and_place(world, entity, beside, &mut shape);
    Ok(json!({
        "type": "arealight",
        "intensity": light.intensity,
        "color": vector(light.color),
        "falloff": light.falloff.name(),
        "sampling": light.sampling.name(),
        "samples": light.samples,
        "shape": shape,
    }))
}

/// The mesh of a shape, and its transform.
fn mesh_and_place(
    world: &mut World,
    entity: Entity,
    beside: &mut Beside<'_>,
    to: &mut Map<String, Value>,
) {
    to.insert("type".into(), "trimesh".into());
    if let Ok(mut mesh) = world.get::<&mut Mesh>(entity) {
        let is_colored = mesh.data.colors.is_some();
        let name = beside.mesh(std::mem::take(&mut mesh.data));
        to.insert("file".into(), name.into());
        if is_colored {
            to.insert("vertexcolors".into(), VertexColors::Linear.name().into());
        }
    }
    if let Ok(Transform(transform)) = world.get::<&Transform>(entity).map(|t| *t)
        && transform != DAffine3::IDENTITY
    {
        to.insert("transform".into(), matrix(&transform));
    }
}

fn shape(
    world: &mut World,
    entity: Entity,
    name: Option<&String>,
    beside: &mut Beside<'_>,
) -> Result<Value> {
    let mut to = Map::new();
    mesh_and_place(world, entity, beside, &mut to);
    if let Some(name) = name {
        to.insert("name".into(), name.clone().into());
    }
    let Ok(entity) = world.entity(entity) else { return Ok(to.into()) };
    let is_smooth = entity.get::<&Shading>().is_some_and(|s| *s == Shading::Smooth);
    to.insert("shading".into(), if is_smooth { "smooth" } else { "flat" }.into());
    let is_front = entity.get::<&Sides>().is_some_and(|s| *s == Sides::Front);
    to.insert("sides".into(), if is_front { "front" } else { "both" }.into());
    if entity.has::<Hidden>() {
        to.insert("hidden".into(), true.into());
    }
    texture(entity, beside, &mut to)?;
    cutout(entity, beside, &mut to)?;
    maps(entity, beside, &mut to)?;
    to.insert("material".into(), material(entity));
    Ok(to.into())
}

fn texture(
    entity: EntityRef<'_>,
    beside: &mut Beside<'_>,
    to: &mut Map<String, Value>,
) -> Result<()> {
    let Some(texture) = entity.get::<&TextureRef>() else { return Ok(()) };
    to.insert("texture".into(), beside.image(&texture.source)?.into());
    if texture.tint != DVec3::ONE {
        to.insert("tint".into(), vector(texture.tint));
    }
    look_up(&texture, to);
    Ok(())
}

/// The look-up keys of a texture.
fn look_up(texture: &TextureRef, to: &mut Map<String, Value>) {
    to.insert("encoding".into(), texture.encoding.name().into());
    to.insert("filter".into(), texture.filter.name().into());
    to.insert("wrap".into(), texture.wrap.name().into());
    if let Some(Placing(rows)) = texture.placing {
        to.insert("uvtransform".into(), json!(rows));
    }
}

fn maps(entity: EntityRef<'_>, beside: &mut Beside<'_>, to: &mut Map<String, Value>) -> Result<()> {
    let Some(maps) = entity.get::<&Maps>() else { return Ok(()) };
    let mut map = |key: &str, texture: &TextureRef, more: &[(&str, f64)]| -> Result<()> {
        let mut map = Map::new();
        map.insert("file".into(), beside.image(&texture.source)?.into());
        look_up(texture, &mut map);
        map.extend(more.iter().map(|(key, value)| ((*key).to_owned(), (*value).into())));
        to.insert(key.into(), map.into());
        Ok(())
    };
    if let Some(texture) = &maps.emission {
        map("emissionmap", texture, &[])?;
    }
    if let Some(MetalMap { texture, metallic, roughness }) = &maps.metal {
        map("metalmap", texture, &[("metallic", *metallic), ("roughness", *roughness)])?;
    }
    if let Some(StrengthMap { texture, strength }) = &maps.occlusion {
        map("occlusionmap", texture, &[("strength", *strength)])?;
    }
    if let Some(StrengthMap { texture, strength }) = &maps.normal {
        map("normalmap", texture, &[("strength", *strength)])?;
    }
    Ok(())
}

fn cutout(
    entity: EntityRef<'_>,
    beside: &mut Beside<'_>,
    to: &mut Map<String, Value>,
) -> Result<()> {
    let Some(cutout) = entity.get::<&CutOut>() else { return Ok(()) };
    to.insert("alphacutoff".into(), cutout.threshold.into());
    let texture = entity.get::<&TextureRef>();
    let is_same = |texture: &TextureRef| {
        (&texture.source, texture.wrap) == (&cutout.source, cutout.wrap) && !cutout.is_mask
    };
    if !texture.is_some_and(|texture| is_same(&texture)) {
        to.insert("alpha".into(), beside.image(&cutout.source)?.into());
    }
    to.entry("filter").or_insert_with(|| cutout.filter.name().into());
    to.entry("wrap").or_insert_with(|| cutout.wrap.name().into());
    if let Some(Placing(rows)) = cutout.placing {
        to.entry("uvtransform").or_insert_with(|| json!(rows));
    }
    Ok(())
}

fn material(entity: EntityRef<'_>) -> Value {
    entity.get::<&Material>().map_or(Value::Null, |material| {
        let mut to = json!({
            "ks": material.ks,
            "kd": material.kd,
            "specularexponent": material.specular_exponent,
            "diffusecolor": vector(material.diffuse_color),
            "kr": material.kr,
        });
        if material.emission != DVec3::ZERO {
            to["emission"] = vector(material.emission);
        }
        if material.specular_color != DVec3::ONE {
            to["specularcolor"] = vector(material.specular_color);
        }
        to
    })
}

/// An instance of a named shape, with its transform. Everything else is the shape's.
fn instance(world: &World, entity: Entity, names: &HashMap<Entity, String>) -> Option<Value> {
    let of = world.get::<&InstanceOf>(entity).ok()?.0;
    let name = names.get(&of)?;
    let transform = world.get::<&Transform>(entity).map_or(DAffine3::IDENTITY, |t| t.0);
    Some(json!({ "shape": name, "transform": matrix(&transform) }))
}

fn camera(view: &View, path: Option<&CameraPath>) -> Value {
    let mut camera = json!({
        "type": "pinhole",
        "width": view.width,
        "height": view.height,
        "fov": view.fov_degrees,
        "fovaxis": view.fov_axis.name(),
        "location": vector(view.location),
        "look": vector(view.look),
        "up": vector(view.up),
        "antialias": view.antialias,
        "sampling": view.sampling.name(),
    });
    if let Some(CameraPath { keys, interpolation }) = path {
        let key = |key: &CameraKey| {
            json!({
                "frame": key.frame,
                "location": vector(key.location),
                "look": vector(key.look),
                "up": vector(key.up),
                "fov": key.fov_degrees,
            })
        };
        let keys: Vec<Value> = keys.iter().map(key).collect();
        camera["path"] = json!({ "interpolation": interpolation.name(), "keys": keys });
    }
    camera
}

fn ambient(ambient: Ambient) -> Value {
    match ambient {
        Ambient::Even(factor) => factor.into(),
        Ambient::Hemisphere { sky, ground, up } => {
            json!({ "sky": vector(sky), "ground": vector(ground), "up": vector(up) })
        }
    }
}

fn vector(v: DVec3) -> Value {
    v.to_array().to_vec().into()
}

/// Rows, from columns.
fn matrix(transform: &DAffine3) -> Value {
    let [x, y, z] = [transform.matrix3.x_axis, transform.matrix3.y_axis, transform.matrix3.z_axis];
    let t = transform.translation;
    json!([[x.x, y.x, z.x, t.x], [x.y, y.y, z.y, t.y], [x.z, y.z, z.z, t.z], [0.0, 0.0, 0.0, 1.0],])
}
