//! Parses JSON into a [`SceneFile`], with every check that needs no other file (the existence of
//! textures and meshes is checked, but neither is read).

mod camera;
mod instance;
mod json_schema;
mod light;
mod maps;
mod material;
mod mesh;
mod shape;
mod transform;

use glam::DVec3;

use wavecrest_base::error::{ErrorKind, Result};

pub use camera::LONGEST_SIDE;
pub(crate) use camera::{FOV, check_size, in_proportion};
pub use json_schema::json_schema;
pub(crate) use maps::THRESHOLD;

use super::components::{Ambient, Encoding, Settings};
use super::load::LoadOptions;
use super::reader::{Cursor, Key, Kind, Object, Range, keys};
use super::schema::{Instance, Light, SceneFile, Shape};
use instance::Names;

/// Largest number of mirror bounces. After 10 000 mirrors no light is left.
const MOST_BOUNCES: u32 = 10_000;

/// The report's "low value" by which a surface in shadow is multiplied.
const AMBIENT: f64 = 0.08;

/// The whole file.
pub(crate) const FILE: Kind =
    Kind::new("a scene", "A scene: camera, lights and shapes.", &[FILE_KEYS]);

const FILE_KEYS: &[Key] = keys! {
    /// The address of this schema, for editors.
    "$schema": Text;
    /// Largest number of mirror bounces after the camera ray.
    "nbounces": Integer(0, MOST_BOUNCES), Required;
    /// The camera.
    "camera": Definition("camera"), Required;
    /// The contents of the scene.
    "scene": Definition("scene"), Required;
    /// Transfer curve of 8-bit images, unless one is requested.
    "transfer": word::<Encoding>(), Says("linear");
};

/// Its key `scene`.
pub(crate) const SCENE: Kind =
    Kind::new("the scene", "Lights, shapes and background.", &[SCENE_KEYS]);

const SCENE_KEYS: &[Key] = keys! {
    /// Colour of camera rays that hit nothing.
    "backgroundcolor": Color, Required;
    /// The lights.
    "lightsources": AtLeast(0, &Definition("light"));
    /// The shapes.
    "shapes": AtLeast(0, &Definition("shape"));
    /// Share of the diffuse colour that each light adds everywhere, visible or not; or light from a sky and the ground.
    "ambient": Definition("ambient"), Is(AMBIENT);
    /// Further copies of shapes.
    "instances": AtLeast(0, &Definition("instance"));
};

/// Ambient light by the normal.
pub(crate) const HEMISPHERE: Kind = Kind::new(
    "ambient light (or a number)",
    "Ambient light from a sky and the ground, by the direction of the normal.",
    &[HEMISPHERE_KEYS],
);

const HEMISPHERE_KEYS: &[Key] = keys! {
    /// The light on a surface that faces up.
    "sky": Color, Required;
    /// The light on a surface that faces down.
    "ground": Color, Required;
    /// Direction of the sky.
    "up": Point, Are([0.0, 1.0, 0.0]);
};

/// Reads a whole file from its top.
///
/// # Errors
/// All errors of the file, as one error.
pub(crate) fn scene_file(top: &Cursor<'_>, options: &LoadOptions) -> Result<SceneFile> {
    top.notes().whole(|| {
        let object = top.object(FILE)?;
        // For the editor, which checks the file by the schema at this address.
        object.get("$schema").map(|c| c.text("the address of a JSON schema")).transpose()?;
        let bounces = object.integer("nbounces");
        let an_object = "an object { ... }";
        let camera = object.part("camera", an_object, |cursor| camera::camera(cursor, options));
        let encoding = object.word("transfer");
        let contents = object.part("scene", an_object, |cursor| contents(cursor, bounces))?;
        let Contents { settings, lights, shapes, instances } = contents;
        Ok(SceneFile { settings, camera: camera?, lights, shapes, instances, encoding })
    })
}

/// The content of the key `scene`.
struct Contents {
    settings: Settings,
    lights: Vec<Light>,
    shapes: Vec<Shape>,
    instances: Vec<Instance>,
}

fn contents(cursor: &Cursor<'_>, bounces: u32) -> Result<Contents> {
    let (notes, scene) = (cursor.notes(), &cursor.object(SCENE)?);
    let settings = notes.part(|| settings(scene, bounces));
    let lights = list(scene, "lightsources", "an array of lights", light::light);
    let shapes = list(scene, "shapes", "an array of shapes", shape::shape)?;
    let names = Names::of(&shapes);
    let one = |cursor: &Cursor<'_>| instance::instance(cursor, &names);
    let instances = list(scene, "instances", "an array of instances", one)?;
    let (settings, lights) = (settings?, lights?);
    let is_even = matches!(settings.ambient, Ambient::Even(_));
    if lights.is_empty() && is_even && !shapes.is_empty() {
        let message = "there is no light, so every shape is black".to_owned();
        let error = notes.error(ErrorKind::Scene, "scene.lightsources", message);
        notes.warn(&error.remedy("add a light"));
    }
    Ok(Contents { settings, lights, shapes, instances })
}

fn settings(scene: &Object<'_>, bounces: u32) -> Result<Settings> {
    let message = "is above 1, which images of 8 bits cannot show";
    warn_above_1(scene, "backgroundcolor", message, "use colours from 0 to 1");
    Ok(Settings {
        file: scene.cursor().notes().file().to_owned(),
        bounces,
        background: scene.color("backgroundcolor"),
        ambient: ambient(scene)?,
    })
}

/// The key `ambient`: a number, or a sky and a ground.
fn ambient(scene: &Object<'_>) -> Result<Ambient> {
    let Some(cursor) = scene.get("ambient") else { return Ok(Ambient::Even(AMBIENT)) };
    if !cursor.value().is_object() {
        return Ok(Ambient::Even(cursor.number(Range::NOT_NEGATIVE)?));
    }
    let object = cursor.object(HEMISPHERE)?;
    let (sky, ground) = (object.color("sky"), object.color("ground"));
    let up = object.point_or("up", DVec3::Y);
    if up == DVec3::ZERO {
        let error = object.need("up", "a direction, [x, y, z]")?.error("must not be zero");
        return Err(error.remedy("use a vector such as [0, 1, 0]"));
    }
    Ok(Ambient::Hemisphere { sky, ground, up })
}

/// Warns of a colour with a channel above 1. Invalid colours are reported when they are read.
fn warn_above_1(object: &Object<'_>, key: &'static str, message: &str, remedy: &str) {
    if let Some(cursor) = object.get(key)
        && cursor.color().is_ok_and(|color| color.max_element() > 1.0)
    {
        cursor.warn(message, remedy);
    }
}

/// An optional array, read element by element to its end; empty by default.
fn list<T>(
    scene: &Object<'_>,
    key: &'static str,
    what: &str,
    read: impl Fn(&Cursor<'_>) -> Result<T>,
) -> Result<Vec<T>> {
    let Some(cursor) = scene.get(key) else { return Ok(Vec::new()) };
    cursor.notes().part(|| cursor.every(what, |item| read(&item)))
}
