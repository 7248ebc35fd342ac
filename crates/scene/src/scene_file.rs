//! The scene file: its top, its settings, and its lists of lights, shapes and instances, read into a
//! world and written from one.

use std::collections::{HashMap, HashSet};

use glam::DVec3;
use hecs::{Entity, EntityBuilder, EntityRef, World};
use serde_json::{Value, json};

use crate::camera::{self, CAMERAS};
use crate::components::{Encoding, JsonPath, Order, Settings, View};
use crate::environment::{self, Environment};
use crate::format::{
    self, Beside, Cursor, Declared, Field, Kind, Notes, Object, Range, Takes, Writer, keys,
};
use crate::lights::{LIGHTS, SKY, Sky};
use crate::options::LoadOptions;
use crate::query;
use crate::shapes::{self, Hidden, INSTANCE, InstanceOf, Name, Names, SHAPES};
use crate::surface::{Maps, Material, Transparency};
use wavecrest_base::error::Result;

/// Largest number of bounces. After 10 000 mirrors no light is left.
const MOST_BOUNCES: u32 = 10_000;

/// The report's "low value" by which a surface in shadow is multiplied.
pub(crate) const AMBIENT: f64 = 0.08;

/// The whole file.
pub(crate) const FILE: Kind = Kind::new(
    "a scene",
    "A scene: camera, lights and shapes.",
    keys! {
        /// The address of the JSON Schema that `wavecrest schema` prints, for editors.
        "$schema": Text;
        /// How often a ray may be mirrored or refracted after the camera ray.
        "nbounces": Integer(0, MOST_BOUNCES), Required;
        /// The camera.
        "camera": Variants(&CAMERAS), Required;
        /// The contents of the scene.
        "scene": Object(&SCENE), Required;
        /// Transfer curve of 8-bit images; `--transfer` overrides it.
        "transfer": word::<Encoding>(), Says("linear");
    },
);

/// Its key `scene`.
const SCENE: Kind = Kind::new(
    "the scene",
    "Lights, shapes and background.",
    keys! {
        /// Colour of rays that hit nothing. After a mirror they add nothing.
        "backgroundcolor": Color, Required;
        /// What rays see that hit nothing, in place of the background.
        "environment": Object(&environment::OBJECT);
        /// The lights.
        "lightsources": AtLeast(0, &Variants(&LIGHTS));
        /// The shapes.
        "shapes": AtLeast(0, &Variants(&SHAPES));
        /// Share of the diffuse colour that each light adds everywhere, visible or not; or light
        /// from a sky and the ground.
        "ambient": Either(&Object(&SKY), &Number(Range::NOT_NEGATIVE)), Is(AMBIENT);
        /// Further copies of shapes.
        "instances": AtLeast(0, &Object(&INSTANCE));
    },
);

/// The JSON Schema of a scene file.
///
/// Every scene that loads with `strict` is valid by it.
///
/// ```
/// let schema = wavecrest_scene::json_schema();
/// assert_eq!(schema["properties"]["nbounces"]["maximum"], 10_000);
/// ```
pub fn json_schema() -> Value {
    format::json_schema(&FILE)
}

/// What a scene file is: an object, with the keys of all that is in it.
pub fn file() -> &'static Takes {
    &Takes::Object(&FILE)
}

/// Reads a whole file from its top into a world.
///
/// # Errors
/// All errors of the file, as one error.
pub(crate) fn read(top: &Cursor<'_>, options: &LoadOptions) -> Result<World> {
    let mut world = World::new();
    top.notes().whole(|| {
        let object = top.object(FILE)?;
        // For the editor, which checks the file by the schema at this address.
        object.get("$schema").map(|c| c.text("the address of a JSON schema")).transpose()?;
        let (bounces, transfer) = (object.read("nbounces"), object.read("transfer"));
        let an_object = "an object { ... }";
        let mut entity = EntityBuilder::new();
        let camera =
            object.part("camera", an_object, |cursor| camera::camera(cursor, options, &mut entity));
        world.spawn(entity.build());
        object.part("scene", an_object, |cursor| {
            let scene = &cursor.object(SCENE)?;
            let settings = cursor.notes().part(|| settings(scene, bounces, transfer, &mut world));
            contents(scene, &mut world)?;
            if let Some(cursor) = scene.get("environment") {
                let around = Environment::read(&cursor.object(environment::OBJECT)?)?;
                around.map(|around| world.spawn((around,)));
            }
            world.spawn((settings?,));
            Ok(())
        })?;
        camera
    })?;
    Ok(world)
}

/// Reads the lists of a scene.
fn contents(scene: &Object<'_>, world: &mut World) -> Result<()> {
    let lights = list(scene, "lightsources", "an array of lights", world, |cursor, entity, _| {
        cursor.variant(&LIGHTS)?.components(entity)
    });
    list(scene, "shapes", "an array of shapes", world, |cursor, entity, _| {
        cursor.variant(&SHAPES)?.components(entity)
    })?;
    let names = Names::of(query::shapes(world));
    let instance = |cursor: &Cursor<'_>, entity: &mut EntityBuilder, world: &World| {
        shapes::instance(cursor, (&names, world), entity)
    };
    list(scene, "instances", "an array of instances", world, instance)?;
    lights
}

/// An optional array, empty by default. Each of its elements becomes an entity.
fn list(
    scene: &Object<'_>,
    key: &'static str,
    what: &str,
    world: &mut World,
    read: impl Fn(&Cursor<'_>, &mut EntityBuilder, &World) -> Result<()>,
) -> Result<()> {
    let Some(cursor) = scene.get(key) else { return Ok(()) };
    let mut order = (0..).map(Order);
    let one = |item: Cursor<'_>| {
        let mut entity = EntityBuilder::new();
        entity.add(JsonPath(item.path()));
        order.next().map(|order| entity.add(order));
        read(&item, &mut entity, world)?;
        world.spawn(entity.build());
        Ok(())
    };
    cursor.notes().part(|| cursor.every(what, one)).map(drop)
}

fn settings(
    scene: &Object<'_>,
    bounces: u32,
    transfer: Encoding,
    world: &mut World,
) -> Result<Settings> {
    let message = "is above 1, which images of 8 bits cannot show";
    scene.warn_above_1("backgroundcolor", message, "use colours from 0 to 1");
    Ok(Settings {
        file: scene.cursor().notes().file().to_owned(),
        bounces,
        background: scene.read("backgroundcolor"),
        ambient: ambient(scene, world)?,
        transfer,
    })
}

/// The key `ambient`: a number, or a sky and a ground.
fn ambient(scene: &Object<'_>, world: &mut World) -> Result<f64> {
    let Some(cursor) = scene.get("ambient") else { return Ok(AMBIENT) };
    if !cursor.value().is_object() {
        return cursor.number(Range::NOT_NEGATIVE);
    }
    let mut entity = EntityBuilder::new();
    entity.add(JsonPath(cursor.path()));
    let object = cursor.object(SKY)?;
    if !object.has("sky") && (object.has("ground") || !scene.has("environment")) {
        cursor.warn(
            "has no \"sky\"",
            "add one: without it, ambient light is that of an environment alone",
        );
    }
    object.components(&mut entity)?;
    world.spawn(entity.build());
    Ok(0.0)
}

/// Warns of shapes without any light, if none, nor any instance, shines, mirrors or shows what is behind.
pub(crate) fn warn_of_darkness(world: &World, notes: &Notes<'_>) {
    let has_sky = world.query::<&Sky>().iter().next().is_some();
    let is_lit = has_sky || !query::lights(world).is_empty();
    let shows = |shape: &EntityRef<'_>| {
        let shines = |m: &Material| m.unlit || m.kr > 0.0 || m.emission != DVec3::ZERO;
        shape.get::<&Material>().is_some_and(|material| shines(&material))
            || shape.get::<&Transparency>().is_some_and(|through| through.has_effect())
            || shape.get::<&Maps>().is_some_and(|maps| maps.opacity.is_some())
    };
    let surfaces = query::ordered::<&Material>(world);
    if !is_lit && !surfaces.is_empty() && !surfaces.iter().any(shows) {
        let message = "there is no light, so every shape is black";
        notes.note("scene.lightsources", message, "add a light");
    }
}

/// The JSON of a whole file, from a world. Meshes and images are queued `beside` it.
///
/// # Errors
/// If the world has no camera or no settings.
pub(crate) fn write(world: &World, beside: &mut Beside) -> Result<Value> {
    let settings = query::settings(world)?;
    let names = names(world);
    let mut all = |those: Vec<EntityRef<'_>>, one: &dyn Fn(EntityRef<'_>, Writer<'_>) -> Value| {
        let each =
            |entity: EntityRef<'_>| one(entity, Writer::new(entity.entity(), beside, &names));
        those.into_iter().map(each).collect::<Vec<Value>>()
    };
    let views = world.iter().filter(EntityRef::has::<View>).collect();
    let camera = all(views, &|one, to| to.variant(&CAMERAS, one));
    let lights = all(query::lights(world), &|one, to| to.variant(&LIGHTS, one));
    let shapes = all(query::shapes(world), &|one, to| {
        let mut shape = to.variant(&SHAPES, one);
        names.get(&one.entity()).into_iter().for_each(|name| shape["name"] = name.clone().into());
        shape
    });
    let instances = query::ordered::<&InstanceOf>(world);
    let instances = all(instances, &|one, to| shapes::write(world, one, to));
    let skies = world.iter().filter(EntityRef::has::<Sky>).collect();
    let sky = all(skies, &|one, to| to.of(&SKY, one));
    let around = world.iter().filter(EntityRef::has::<Environment>).collect();
    let mut around = all(around, &|one, to| to.of(&environment::OBJECT, one));
    let ambient = sky.into_iter().next().unwrap_or_else(|| settings.ambient.into());
    let mut scene = json!({
        "backgroundcolor": settings.background.to_json(),
        "ambient": ambient,
        "lightsources": lights,
        "shapes": shapes,
    });
    if let Some(around) = around.pop() {
        scene["environment"] = around;
    }
    if !instances.is_empty() {
        scene["instances"] = instances.into();
    }
    Ok(json!({
        "nbounces": settings.bounces,
        "transfer": settings.transfer.name(),
        "camera": camera.first().ok_or_else(|| query::missing("View"))?,
        "scene": scene,
    }))
}

/// A unique name for each named shape, and for each that instances refer to.
fn names(world: &World) -> HashMap<Entity, String> {
    let prototypes: HashSet<Entity> =
        world.query::<&InstanceOf>().iter().map(|InstanceOf(shape)| *shape).collect();
    let (mut used, mut last) = (HashSet::new(), HashMap::new());
    let mut names = HashMap::new();
    for shape in query::shapes(world) {
        let own = shape.get::<&Name>().map(|name| name.0.clone());
        let needs_one = prototypes.contains(&shape.entity()) || shape.has::<Hidden>();
        let Some(wanted) = own.or_else(|| needs_one.then(|| "shape".to_owned())) else {
            continue;
        };
        let mut name = wanted.clone();
        // Each number is tried once, however many shapes have the name.
        let number = last.entry(wanted.clone()).or_insert(1_u32);
        while !used.insert(name.clone()) {
            *number += 1;
            name = format!("{wanted}-{number}");
        }
        names.insert(shape.entity(), name);
    }
    names
}
