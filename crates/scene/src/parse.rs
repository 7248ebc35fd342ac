//! From JSON to [`SceneFile`], with every check that needs no other file than this one (that a
//! texture or a mesh exists is looked up, but neither is read).

mod camera;
mod instance;
mod json_schema;
mod light;
mod material;
mod mesh;
mod shape;
mod transform;

pub use json_schema::json_schema;

use wavecrest_base::error::Result;

pub(super) use camera::{FOV, LONGEST_SIDE, check_size};

use super::components::{Encoding, Settings};
use super::load::LoadOptions;
use super::reader::{Cursor, Object, Range};
use super::schema::SceneFile;
use instance::Names;

/// Greatest number of mirror bounces. Light that meets 10 000 mirrors is spent.
const MOST_BOUNCES: u32 = 10_000;

/// The report's "low value" by which a surface in shadow is multiplied.
const AMBIENT: f64 = 0.08;

const KEYS: [&str; 5] = ["$schema", "nbounces", "camera", "scene", "transfer"];
const SCENE_KEYS: [&str; 5] = ["backgroundcolor", "lightsources", "shapes", "ambient", "instances"];

/// Reads a whole file from its top.
pub(crate) fn scene_file(top: &Cursor<'_>, options: &LoadOptions) -> Result<SceneFile> {
    let object = top.object("a scene", KEYS.into())?;
    // For the editor, which checks the file by the schema at this address.
    object.get("$schema").map(|c| c.text("the address of a JSON schema")).transpose()?;
    let bounces = object.integer("nbounces", 0, MOST_BOUNCES)?;
    let camera = camera::camera(&object.need("camera", "an object { ... }")?, options)?;
    let scene = object.need("scene", "an object { ... }")?;
    let scene = scene.object("the scene", SCENE_KEYS.into())?;
    let settings = settings(&scene, bounces)?;
    let lights = list(&scene, "lightsources", "an array of lights", light::light)?;
    let shapes = list(&scene, "shapes", "an array of shapes", shape::shape)?;
    let encoding = object.choice_or("transfer", &material::ENCODINGS, Encoding::default())?;
    let names = Names::of(&shapes);
    let one = |cursor: &Cursor<'_>| instance::instance(cursor, &names);
    let instances = list(&scene, "instances", "an array of instances", one)?;
    Ok(SceneFile { settings, camera, lights, shapes, instances, encoding })
}

fn settings(scene: &Object<'_>, bounces: u32) -> Result<Settings> {
    Ok(Settings {
        file: scene.cursor().notes().file().to_owned(),
        bounces,
        background: scene.color("backgroundcolor")?,
        ambient: scene.number_or("ambient", Range::NOT_NEGATIVE, AMBIENT)?,
    })
}

/// An optional array, read element by element; absent, it is empty.
fn list<T>(
    scene: &Object<'_>,
    key: &'static str,
    what: &str,
    read: impl Fn(&Cursor<'_>) -> Result<T>,
) -> Result<Vec<T>> {
    scene.get(key).map_or(Ok(Vec::new()), |cursor| cursor.each(what, |item| read(&item)))
}
