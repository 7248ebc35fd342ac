//! From a scene file to a world of entities.
//!
//! The file is parsed into plain typed values, which have been checked; then the meshes that it
//! names are read, and each of its parts becomes an entity with the components that
//! [`components`](super::components) lists.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use glam::{DAffine3, DVec3};
use hecs::{Entity, EntityBuilder, World};
use serde_json::Value;

use crate::error::{Error, ErrorKind, Result, Warning};

use super::alone;
use super::components::{
    AreaLight, Encoding, Hidden, InstanceOf, JsonPath, Material, Mesh, Order, Pinhole, Quad,
    Shading, Sides, Sphere, TextureRef, Transform, Triangle,
};
use super::form::FileForm;
use super::gltf;
use super::mesh::{self, LoadedMesh, MeshData};
use super::parse;
use super::reader::{Cursor, Notes, Place, json};
use super::schema::{Camera, Geometry, Instance, Light, SceneFile, Shape};
use super::staging;
use super::survey::{self, Survey};

/// Greatest length of a scene file in bytes, 256 MiB. JSON takes up to 25 times its length in
/// memory while it is read; a larger mesh belongs in a file of its own.
const LONGEST_FILE: u64 = 1 << 28;

/// How a scene file is to be read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// Whether a key that the format does not have is an error rather than a warning.
    pub strict: bool,
    /// The width of the image in pixels, in place of the file's.
    pub width: Option<u32>,
    /// The height of the image in pixels, in place of the file's.
    pub height: Option<u32>,
    /// The camera to take of a file that may have several, by its name or its number.
    pub camera: Option<String>,
}

/// A scene, and what its author should know about it.
pub struct LoadedScene {
    /// The entities: see [`components`](super::components).
    pub world: World,
    /// What is odd about the file, in its order; then what is odd about its meshes.
    pub warnings: Vec<Warning>,
    /// What was chosen, where the file does not say: a camera, a light.
    pub notes: Vec<Warning>,
    /// How images of 8 bits are to be written, where nobody says.
    pub encoding: Encoding,
}

/// Reads the scene at `path`, and the files that it names: a scene file in JSON, a glTF file, or a mesh
/// alone, by the ending of its name, and by what it begins with.
///
/// # Errors
/// The file, or a mesh, cannot be read or breaks its format; a texture is not there; a value is not
/// one that the scene format allows; something is larger than allowed.
pub fn load(path: &Path, options: &LoadOptions) -> Result<LoadedScene> {
    match FileForm::of(path) {
        FileForm::Scene => load_str(&read_text(path)?, path, options),
        FileForm::Gltf => gltf::load(path, options),
        FileForm::Mesh => alone::load(path, options),
    }
}

/// As [`load`], from text. Relative paths start from the folder of `file`, which need not exist.
///
/// # Errors
/// As [`load`].
///
/// ```
/// use std::path::Path;
/// use wavecrest::scene::load::{LoadOptions, load_str};
///
/// let json = r#"{
///     "nbounces": 1,
///     "camera": {
///         "type": "pinhole", "width": 64, "height": 48, "fov": 60,
///         "location": [0, 0, 5], "look": [0, 0, 0]
///     },
///     "scene": { "backgroundcolor": [0, 0, 0], "lightsources": [], "shapes": [] }
/// }"#;
/// let scene = load_str(json, Path::new("empty.json"), &LoadOptions::default())?;
/// assert!(scene.warnings.is_empty());
/// # Ok::<(), wavecrest::error::Error>(())
/// ```
pub fn load_str(json: &str, file: &Path, options: &LoadOptions) -> Result<LoadedScene> {
    load_with(json, file, options, mesh::load)
}

/// As [`load_str`], with the function that reads mesh files.
pub(super) fn load_with(
    json: &str,
    file: &Path,
    options: &LoadOptions,
    read_mesh: impl Fn(&Path) -> Result<LoadedMesh>,
) -> Result<LoadedScene> {
    refuse_camera(file, options)?;
    let notes = Notes::new(file, options.strict);
    let value = parse_json(json, file)?;
    let scene = parse::scene_file(&Cursor::new(&value, Place::Top, &notes), options)?;
    // A mesh written out in JSON is many times larger there than as arrays.
    drop(value);
    warn_of_equal_names(&scene.shapes, &notes);
    let encoding = scene.encoding;
    let world = Spawner { world: World::new(), notes: &notes, read_mesh }.spawn(scene)?;
    Ok(LoadedScene { world, warnings: notes.into_warnings(), notes: Vec::new(), encoding })
}

fn refuse_camera(file: &Path, options: &LoadOptions) -> Result<()> {
    let Some(camera) = &options.camera else { return Ok(()) };
    let error = Error::new(ErrorKind::Usage, "a scene file has one camera, and no other to choose");
    Err(error.in_file(file).value(camera).remedy("leave --camera out"))
}

/// What the scene file at `path` calls for, told without reading a mesh or a texture into memory.
///
/// # Errors
/// As [`load`], as far as the scene file itself and the headers of meshes go.
pub fn survey(path: &Path, options: &LoadOptions) -> Result<Survey> {
    match FileForm::of(path) {
        FileForm::Scene => {}
        FileForm::Gltf => return gltf::survey(path, options),
        FileForm::Mesh => {
            let (width, height) = staging::size(options, None)?;
            return survey::alone(path, [width, height]);
        }
    }
    let notes = Notes::new(path, options.strict);
    let text = read_text(path)?;
    let value = parse_json(&text, path)?;
    let scene = parse::scene_file(&Cursor::new(&value, Place::Top, &notes), options)?;
    drop(value);
    survey::of(scene, text.len() as u64, &notes)
}

fn read_text(path: &Path) -> Result<String> {
    let cannot_read = |e| Error::io("cannot read the scene", path, e);
    check_length(path, fs::metadata(path).map_err(cannot_read)?.len())?;
    // The length of what is not a plain file, such as a pipe, is known only at its end.
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(cannot_read)?;
    file.take(LONGEST_FILE + 1).read_to_end(&mut bytes).map_err(cannot_read)?;
    check_length(path, bytes.len() as u64)?;
    String::from_utf8(bytes).map_err(|e| {
        let start = e.utf8_error().valid_up_to();
        let message = format!("the scene is not UTF-8 text from byte {start} on");
        let error = Error::new(ErrorKind::Syntax, message).in_file(path);
        error.remedy("save it as UTF-8").because(e)
    })
}

fn check_length(path: &Path, length: u64) -> Result<()> {
    if length <= LONGEST_FILE {
        return Ok(());
    }
    let message = format!("the scene file has {length} bytes or more");
    let error = Error::new(ErrorKind::Limit, message).in_file(path);
    let allowed = format!("at most {LONGEST_FILE} (256 MiB) are allowed");
    Err(error.remedy(format!("{allowed}: keep large meshes in files of their own")))
}

pub(super) fn parse_json(text: &str, file: &Path) -> Result<Value> {
    // Some editors begin a file with a byte order mark, which JSON does not have.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    json::parse(text).map_err(|e| {
        let text = e.to_string();
        let place = format!("line {} column {}", e.line(), e.column());
        let reason = text.strip_suffix(&format!(" at {place}")).unwrap_or(&text);
        Error::new(ErrorKind::Syntax, format!("not valid JSON: {reason}")).in_file(file).at(place)
    })
}

fn warn_of_equal_names(shapes: &[Shape], notes: &Notes<'_>) {
    let mut owners = HashMap::new();
    for shape in shapes {
        let Some(name) = &shape.name else { continue };
        if let Some(owner) = owners.insert(&name.0, &shape.path) {
            let message = format!("the name {:?} is also that of {owner}", name.0);
            let error = notes.error(ErrorKind::Scene, &shape.path, message);
            notes.warn(&error.remedy("give each shape a name of its own"));
        }
    }
}

/// Makes entities of a scene file's parts.
struct Spawner<'a, R> {
    world: World,
    notes: &'a Notes<'a>,
    read_mesh: R,
}

impl<R: Fn(&Path) -> Result<LoadedMesh>> Spawner<'_, R> {
    fn spawn(mut self, scene: SceneFile) -> Result<World> {
        self.world.spawn((scene.settings,));
        self.camera(scene.camera);
        for (order, light) in (0..).zip(scene.lights) {
            self.light(Order(order), light)?;
        }
        let mut order = 0..;
        let mut shapes = Vec::with_capacity(scene.shapes.len());
        self.warn_of_unseen(&scene.shapes, &scene.instances);
        for (order, shape) in (&mut order).zip(scene.shapes) {
            shapes.push(self.shape(Order(order), shape)?);
        }
        for (order, instance) in order.zip(scene.instances) {
            self.instance(Order(order), shapes[instance.shape], instance);
        }
        Ok(self.world)
    }

    /// A shape that only instances show, without any.
    fn warn_of_unseen(&self, shapes: &[Shape], instances: &[Instance]) {
        let mut shown = vec![false; shapes.len()];
        instances.iter().for_each(|instance| shown[instance.shape] = true);
        for (shape, _) in shapes.iter().zip(shown).filter(|(shape, shown)| shape.hidden && !shown) {
            let error = self.error(&shape.path, "the shape is hidden and no instance shows it");
            self.notes.warn(&error.remedy("add one to scene.instances, or remove \"hidden\""));
        }
    }

    /// Shows the shape of the entity `of` once more.
    fn instance(&mut self, order: Order, of: Entity, instance: Instance) {
        let Instance { path, name, transform, material, .. } = instance;
        let mut entity = EntityBuilder::new();
        let own = |world: &World| world.get::<&Transform>(of).map_or(DAffine3::IDENTITY, |t| t.0);
        let transform = Transform(transform * own(&self.world));
        entity.add_bundle((order, JsonPath(path), InstanceOf(of), transform));
        add_some(&mut entity, name);
        let shape = &self.world;
        add_some(&mut entity, material.or(shape.get::<&Material>(of).ok().map(|m| *m)));
        add_some(&mut entity, shape.get::<&Sides>(of).ok().map(|sides| *sides));
        add_some(&mut entity, shape.get::<&Shading>(of).ok().map(|shading| *shading));
        add_some(&mut entity, shape.get::<&TextureRef>(of).ok().map(|texture| (*texture).clone()));
        self.world.spawn(entity.build());
    }

    fn camera(&mut self, Camera { view, lens }: Camera) {
        match lens {
            Some(lens) => self.world.spawn((view, lens)),
            None => self.world.spawn((view, Pinhole)),
        };
    }

    fn light(&mut self, order: Order, light: Light) -> Result<()> {
        match light {
            Light::Point { path, light } => {
                self.world.spawn((order, JsonPath(path), light));
            }
            Light::Area { path, light, shape } => self.area_light(order, path, light, *shape)?,
        }
        Ok(())
    }

    fn area_light(
        &mut self,
        order: Order,
        path: String,
        light: AreaLight,
        shape: Shape,
    ) -> Result<()> {
        let mut entity = EntityBuilder::new();
        entity.add_bundle((order, JsonPath(path), light));
        let form = self.read_mesh_file(&shape.path, shape.geometry)?;
        if let Form::Mesh(mesh) = &form
            && !has_area(&mesh.data)
        {
            return Err(self.error(&shape.path, "a light must have an area"));
        }
        add_form(&mut entity, form);
        add_some(&mut entity, shape.name);
        add_some(&mut entity, shape.facing);
        add_some(&mut entity, shape.transform);
        self.world.spawn(entity.build());
        Ok(())
    }

    fn shape(&mut self, order: Order, shape: Shape) -> Result<Entity> {
        let form = self.read_mesh_file(&shape.path, shape.geometry)?;
        let mut shading = shape.shading;
        if let Form::Mesh(mesh) = &form {
            self.check_uvs(&shape.path, shape.texture.as_ref(), &mesh.data)?;
            shading = self.possible_shading(&shape.path, shading, &mesh.data);
        }
        let mut entity = EntityBuilder::new();
        entity.add_bundle((order, JsonPath(shape.path), shape.sides, shading));
        add_form(&mut entity, form);
        add_some(&mut entity, shape.name);
        add_some(&mut entity, shape.facing);
        add_some(&mut entity, shape.transform);
        add_some(&mut entity, shape.material);
        add_some(&mut entity, shape.texture);
        if shape.hidden {
            entity.add(Hidden);
        }
        Ok(self.world.spawn(entity.build()))
    }

    /// The shape's form, with its mesh file read, if it has one.
    fn read_mesh_file(&self, path: &str, geometry: Geometry) -> Result<Form> {
        Ok(match geometry {
            Geometry::Sphere(sphere) => Form::Sphere(sphere),
            Geometry::Quad(quad) => Form::Quad(quad),
            Geometry::Triangle(triangle) => Form::Triangle(triangle),
            Geometry::Mesh(data) => Form::Mesh(Mesh { data, file: None }),
            Geometry::MeshFile(file) => {
                let loaded = (self.read_mesh)(&file).map_err(|e| self.mesh_error(path, e))?;
                loaded.warnings.into_iter().for_each(|warning| self.notes.pass_on(warning));
                Form::Mesh(Mesh { data: loaded.mesh, file: Some(file) })
            }
        })
    }

    /// The error of a mesh reader, after the place in the scene that asked for the mesh.
    fn mesh_error(&self, path: &str, cause: Error) -> Error {
        let message = format!("cannot read the mesh: {cause}");
        self.notes.error(cause.kind(), &format!("{path}.file"), message).because(cause)
    }

    fn error(&self, place: &str, message: &str) -> Error {
        self.notes.error(ErrorKind::Scene, place, message.to_owned())
    }

    fn check_uvs(&self, path: &str, texture: Option<&TextureRef>, mesh: &MeshData) -> Result<()> {
        if texture.is_none() || mesh.uvs.is_some() {
            return Ok(());
        }
        let message = "the mesh has no texture coordinates, which a texture needs";
        let error = self.error(&format!("{path}.texture"), message);
        Err(error.remedy("give it \"uvs\", or remove the texture"))
    }

    /// The shading asked for, as far as the mesh has what it needs.
    fn possible_shading(&self, path: &str, asked: Shading, mesh: &MeshData) -> Shading {
        if asked == Shading::Smooth && mesh.normals.is_none() {
            let message = "the mesh has no normals, which smooth shading needs";
            let error = self.error(&format!("{path}.shading"), message);
            self.notes.warn(&error.remedy("shading stays flat"));
            return Shading::Flat;
        }
        asked
    }
}

/// The component that says where a shape is, whichever it has.
enum Form {
    Sphere(Sphere),
    Quad(Quad),
    Triangle(Triangle),
    Mesh(Mesh),
}

fn add_form(entity: &mut EntityBuilder, form: Form) {
    match form {
        Form::Sphere(sphere) => entity.add(sphere),
        Form::Quad(quad) => entity.add(quad),
        Form::Triangle(triangle) => entity.add(triangle),
        Form::Mesh(mesh) => entity.add(mesh),
    };
}

fn add_some<C: hecs::Component>(entity: &mut EntityBuilder, component: Option<C>) {
    if let Some(component) = component {
        entity.add(component);
    }
}

/// Whether any triangle of a mesh has an area.
fn has_area(mesh: &MeshData) -> bool {
    mesh.triangles.iter().any(|triangle| {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
        (b - a).cross(c - a) != DVec3::ZERO
    })
}
