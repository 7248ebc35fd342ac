//! From a scene file to a world of entities.
//!
//! The file is parsed into plain typed values, which have been checked; then the meshes that it
//! names are read, and each of its parts becomes an entity with the components that
//! [`components`](super::components) lists.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use glam::DVec3;
use hecs::{EntityBuilder, World};
use serde_json::Value;

use crate::error::{Error, ErrorKind, Result, Warning};

use super::alone;
use super::components::{
    AreaLight, Encoding, JsonPath, Mesh, Order, Pinhole, Quad, Shading, Sphere, TextureRef,
    Triangle,
};
use super::gltf;
use super::mesh::{self, LoadedMesh, MeshData};
use super::parse;
use super::reader::{Cursor, Notes, Place, json};
use super::schema::{Camera, Geometry, Light, SceneFile, Shape};

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

/// The forms that a scene may have.
enum FileForm {
    Scene,
    Gltf,
    Mesh,
}

impl FileForm {
    fn of(path: &Path) -> Self {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        match extension.to_ascii_lowercase().as_str() {
            "gltf" | "glb" => Self::Gltf,
            "ply" | "obj" => Self::Mesh,
            _ if begins_as_glb(path) => Self::Gltf,
            _ => Self::Scene,
        }
    }
}

/// Whether a regular file is a GLB file under another name.
fn begins_as_glb(path: &Path) -> bool {
    let mut start = [0; 4];
    path.is_file()
        && File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok()
        && gltf::is_binary(&start)
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
        for (order, shape) in (0..).zip(scene.shapes) {
            self.shape(Order(order), shape)?;
        }
        Ok(self.world)
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

    fn shape(&mut self, order: Order, shape: Shape) -> Result<()> {
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
        self.world.spawn(entity.build());
        Ok(())
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
