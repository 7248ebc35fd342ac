//! From a scene file to a world of entities.
//!
//! The file is parsed into plain typed values, which have been checked; then the meshes that it
//! names are read, and each of its parts becomes an entity with the components that
//! [`components`](super::components) lists.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use wavecrest_base::error::{Error, ErrorKind, Result};

use super::format::FileFormat;
use super::gltf;
use super::mesh::{self, LoadedMesh};
use super::parse;
use super::reader::{Cursor, Notes, Place, json};
use super::schema::Shape;
use super::spawn;
use super::staging;
use super::standalone;
use super::survey::{self, Survey};

pub use super::loaded::LoadedScene;
pub use super::options::LoadOptions;

/// Greatest length of a scene file in bytes, 256 MiB. JSON takes up to 25 times its length in
/// memory while it is read; a larger mesh belongs in a file of its own.
const LONGEST_FILE: u64 = 1 << 28;

/// Reads the scene at `path`, and the files that it names: a scene file in JSON, a glTF file, or a
/// standalone mesh, by the ending of its name, and by what it begins with.
///
/// # Errors
/// The file, or a mesh, cannot be read or breaks its format; a texture is not there; a value is not
/// one that the scene format allows; something is larger than allowed.
pub fn load(path: &Path, options: &LoadOptions) -> Result<LoadedScene> {
    match FileFormat::of(path) {
        FileFormat::Scene => load_str(&read_text(path)?, path, options),
        FileFormat::Gltf => gltf::load(path, options),
        FileFormat::Mesh => standalone::load(path, options),
    }
}

/// As [`load`], from text. Relative paths start from the folder of `file`, which need not exist.
///
/// # Errors
/// As [`load`].
///
/// ```
/// use std::path::Path;
/// use wavecrest_scene::load::{LoadOptions, load_str};
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
/// # Ok::<(), wavecrest_base::error::Error>(())
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
    let value = json::parse(json, file)?;
    let scene = parse::scene_file(&Cursor::new(&value, Place::Top, &notes), options)?;
    // A mesh written out in JSON is many times larger there than as arrays.
    drop(value);
    warn_of_equal_names(&scene.shapes, &notes);
    let encoding = scene.encoding;
    let world = spawn::world(scene, &notes, read_mesh)?;
    Ok(LoadedScene { world, warnings: notes.into_warnings(), notes: Vec::new(), encoding })
}

fn refuse_camera(file: &Path, options: &LoadOptions) -> Result<()> {
    let Some(camera) = &options.camera else { return Ok(()) };
    let error = Error::new(ErrorKind::Usage, "a scene file has one camera, and no other to choose");
    Err(error.in_file(file).value(camera).remedy("leave --camera out"))
}

/// What the scene file at `path` calls for, without reading a mesh or a texture into memory.
///
/// # Errors
/// As [`load`], as far as the scene file itself and the headers of meshes go.
pub fn survey(path: &Path, options: &LoadOptions) -> Result<Survey> {
    match FileFormat::of(path) {
        FileFormat::Scene => {}
        FileFormat::Gltf => return gltf::survey(path, options),
        FileFormat::Mesh => {
            let (width, height) = staging::size(options, None)?;
            return survey::standalone(path, [width, height]);
        }
    }
    let notes = Notes::new(path, options.strict);
    let text = read_text(path)?;
    let value = json::parse(&text, path)?;
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
