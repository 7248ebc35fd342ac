//! Loads a scene file, a glTF file or a mesh into a world of entities.
//!
//! Each part of the file becomes an entity with the components of [`components`](super::components).
//! Then its mesh files are read ([`meshes`]). Files that are not complete scenes are completed
//! ([`crate::staging`]).

mod copy;
mod materials;
mod meshes;
mod standalone;

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use hecs::World;

use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_base::memory::Stage;
use wavecrest_base::read::open;
use wavecrest_base::replace::check_differs;

use super::camera;
pub use super::camera::LONGEST_SIDE;
use super::components::{Encoding, Environment, JsonPath, Mesh, Name, Settings, View};
use super::folder::Folder;
use super::format::{Cursor, Notes, Place, json};
use super::gltf;
use super::mesh::{self, LoadedMesh, MeshData};
pub use super::options::{LoadOptions, MOST_SAMPLES, antialias, framing, lighting};
use super::query;
use super::scene_file;
pub use super::staging::LightFrame;
use super::staging::Staged;

/// Largest length of a scene file in bytes, 256 MiB. While it is read, JSON takes up to 25 times
/// its length in memory; a larger mesh belongs in a separate file.
const LONGEST_FILE: u64 = 1 << 28;

/// A loaded scene with its warnings and notes.
pub struct LoadedScene {
    /// The file itself.
    pub file: PathBuf,
    /// The entities: see [`components`](super::components).
    pub world: World,
    /// Warnings about the file, in its order; then about its meshes.
    pub warnings: Vec<Warning>,
    /// Choices for values that the file lacks (a camera, lights), and what is left out without harm.
    pub notes: Vec<Warning>,
    /// The files read, without the scene file and textures; and those of shapes that are not shown.
    pub files: Vec<PathBuf>,
    /// The folder of the file; images outside it are copied only if that is allowed.
    pub(crate) folder: Folder,
}

/// Reads the scene at `path` and the files that it names: a scene file in JSON, a glTF file, or a
/// standalone mesh, recognised by its extension and its first bytes.
///
/// # Errors
/// If the file or a mesh cannot be read or violates its format, a texture is missing, a value
/// violates the scene format, or something exceeds a limit.
pub fn load(path: &Path, options: &LoadOptions) -> Result<LoadedScene> {
    Stage::Read.begin();
    match FileFormat::of(path)? {
        FileFormat::Scene | FileFormat::Gltf if options.first.is_some() => {
            Err(mesh::no_part().in_file(path))
        }
        FileFormat::Scene => load_str(&read_text(path)?, path, options),
        FileFormat::Gltf => load_gltf(gltf::read(path)?, path, options),
        FileFormat::Mesh => {
            mesh::announce(path);
            load_standalone(path, options, || mesh::load_first(path, options.first))
        }
    }
}

/// As [`load`], for a glTF file with these `bytes`. Relative names start from the folder of `path`.
///
/// # Errors
/// As [`load`].
pub fn load_gltf(bytes: Vec<u8>, path: &Path, options: &LoadOptions) -> Result<LoadedScene> {
    let notes = options.notes(path);
    let (world, told) = gltf::world(bytes, options, &notes)?;
    loaded(world, notes, told, options)
}

fn load_standalone(
    path: &Path,
    options: &LoadOptions,
    read: impl FnOnce() -> Result<LoadedMesh>,
) -> Result<LoadedScene> {
    let notes = options.notes(path);
    let (world, told) = standalone::world(path, options, &notes, read)?;
    loaded(world, notes, told, options)
}

/// As [`load`], for a mesh with these arrays, treated like a PLY file: with a camera, lights and a
/// material. Errors and warnings use `name`, which has no extension, for the mesh.
///
/// # Errors
/// If an index is out of range, a position is not finite or too large, there is no triangle, or an
/// option requires something that the mesh does not have.
///
/// ```
/// use glam::Vec3;
/// use wavecrest_scene::load::{LoadOptions, load_mesh};
/// use wavecrest_scene::mesh::MeshData;
///
/// let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y].into();
/// let mesh = MeshData { positions, triangles: vec![[0, 1, 2]].into(), ..MeshData::default() };
/// let scene = load_mesh(mesh.clone(), "triangle".as_ref(), &LoadOptions::default())?;
/// assert!(scene.warnings.is_empty() && scene.notes.len() == 1);
///
/// let wrong = MeshData { triangles: vec![[0, 1, 3]].into(), ..mesh };
/// let error = load_mesh(wrong, "triangle".as_ref(), &LoadOptions::default()).err().unwrap();
/// assert!(error.to_string().starts_with("triangle: triangle 0: "), "{error}");
/// # Ok::<(), wavecrest_base::error::Error>(())
/// ```
pub fn load_mesh(mesh: MeshData, name: &Path, options: &LoadOptions) -> Result<LoadedScene> {
    load_standalone(name, options, || mesh::checked(mesh, name))
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
    refuse_camera(file, options)?;
    let notes = options.notes(file);
    let value = json::parse(json, file)?;
    let mut world = scene_file::read(&Cursor::new(&value, Place::Top, &notes), options)?;
    if let Some(background) = options.lighting.background {
        let color = background.color();
        query::change(&mut world, |settings: &mut Settings| settings.background = color);
        let hidden = background == lighting::Background::Transparent;
        query::change(&mut world, |around: &mut Environment| around.hidden = hidden);
    }
    // A mesh written out in JSON is many times larger there than as arrays.
    drop(value);
    warn_of_equal_names(&world, &notes);
    loaded(world, notes, String::new(), options)
}

/// The scene of a `world`, whose mesh files are read now, with the choices in `told`, if any.
fn loaded(
    mut world: World,
    notes: Notes<'_>,
    told: String,
    options: &LoadOptions,
) -> Result<LoadedScene> {
    let told =
        (!told.is_empty()).then(|| Warning::from_error(&notes.error(ErrorKind::Scene, "", told)));
    meshes::complete(&mut world, &notes)?;
    let moves = camera::change(&mut world, options).map_err(|error| error.in_file(notes.file()))?;
    scene_file::warn_of_darkness(&world, &notes);
    let (file, folder) = (notes.file().to_owned(), notes.folder());
    let (warnings, harmless, files) = notes.into_parts();
    let notes = told.into_iter().chain(harmless).collect();
    let mut scene = LoadedScene { file, world, warnings, notes, files, folder };
    if moves && !options.lighting.stays {
        scene.light_for(scene.view()?);
    }
    Ok(scene)
}

/// A copy shares the arrays of meshes. It has no components but those that loading adds.
impl Clone for LoadedScene {
    fn clone(&self) -> Self {
        let Self { file, world, warnings, notes, files, folder } = self;
        Self {
            file: file.clone(),
            world: copy::of(world),
            warnings: warnings.clone(),
            notes: notes.clone(),
            files: files.clone(),
            folder: folder.clone(),
        }
    }
}

impl LoadedScene {
    /// The transfer curve of 8-bit images, unless one is requested.
    pub fn transfer(&self) -> Encoding {
        query::settings(&self.world).map_or_else(|_| Encoding::default(), |all| all.transfer)
    }

    /// The number of triangles of its meshes, each counted once.
    pub fn triangles(&self) -> usize {
        self.world.query::<&Mesh>().iter().map(|mesh| mesh.data.triangles.len()).sum()
    }

    /// The view of the camera.
    ///
    /// # Errors
    /// If the world lacks a camera.
    pub fn view(&self) -> Result<View> {
        query::view(&self.world)
    }

    /// The view that lights were added for; `None` if the file has its own.
    pub fn usual_view(&self) -> Option<View> {
        Staged::of(&self.world).map(|staged| staged.usual())
    }

    /// What decides on added lights for this view: they are to be added again if it is another. `None` without such lights.
    pub fn light_frame(&self, view: View) -> Option<LightFrame> {
        Staged::of(&self.world).map(|staged| staged.frame(view))
    }

    /// Adds lights for this view in place of those that were added before, unless the file has its own.
    pub fn light_for(&mut self, view: View) {
        if let Some(staged) = Staged::of(&self.world) {
            staged.light(&mut self.world, view, &self.file);
        }
    }

    /// Refuses to write `output` over a file of the scene: the file itself, a mesh, a material library, a buffer or an
    /// image.
    ///
    /// # Errors
    /// If it is one.
    pub fn check_apart(&self, output: &Path) -> Result<()> {
        if !output.exists() {
            return Ok(());
        }
        check_differs(output, &self.file, "the scene")?;
        let what = format!("part of the scene {}", self.file.display());
        let images = query::images(&self.world);
        let mut parts = self.files.iter().chain(&images);
        parts.try_for_each(|part| check_differs(output, part, &what))
    }
}

fn refuse_camera(file: &Path, options: &LoadOptions) -> Result<()> {
    if options.framing != framing::Framing::default() {
        let error = Error::new(ErrorKind::Usage, "a scene file has its own camera");
        let remedy = "use --from, --at and --up with three numbers, or change \"camera\" in the scene, instead of --view, --up, --fov, --fit or --turntable";
        return Err(error.in_file(file).remedy(remedy));
    }
    let Some(camera) = &options.camera else { return Ok(()) };
    let error = Error::new(ErrorKind::Usage, "a scene file has only one camera");
    Err(error.in_file(file).value(camera).remedy("leave out --camera"))
}

fn read_text(path: &Path) -> Result<String> {
    let cannot_read = |e| Error::io("cannot read the scene", path, e);
    check_length(path, fs::metadata(path).map_err(cannot_read)?.len())?;
    // The length of a pipe or other special file is known only at its end.
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(cannot_read)?;
    file.take(LONGEST_FILE + 1).read_to_end(&mut bytes).map_err(cannot_read)?;
    check_length(path, bytes.len() as u64)?;
    String::from_utf8(bytes).map_err(|e| {
        let start = e.utf8_error().valid_up_to();
        let message = format!("the scene is not text from byte {start} on");
        let error = Error::new(ErrorKind::Syntax, message).in_file(path);
        error.remedy("save it as UTF-8, or check that it is a scene").because(e)
    })
}

fn check_length(path: &Path, length: u64) -> Result<()> {
    if length <= LONGEST_FILE {
        return Ok(());
    }
    let message = format!("the scene file is too large: {length} bytes or more");
    let error = Error::new(ErrorKind::Limit, message).in_file(path);
    let allowed = LONGEST_FILE >> 20;
    Err(error
        .remedy(format!("keep it below {allowed} MiB, and large meshes in files of their own")))
}

fn warn_of_equal_names(world: &World, notes: &Notes<'_>) {
    let mut owners = HashMap::new();
    for shape in query::shapes(world) {
        let named = (shape.get::<&Name>(), shape.get::<&JsonPath>());
        let (Some(name), Some(place)) = named else { continue };
        if let Some(owner) = owners.insert(name.0.clone(), place.0.clone()) {
            let message = format!("{owner} has the same name, {:?}", name.0);
            notes.note(&place.0, &message, "use a different name for each shape");
        }
    }
}

/// The supported formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// A scene file, in JSON.
    Scene,
    /// glTF, as text or binary.
    Gltf,
    /// A standalone mesh.
    Mesh,
}

impl FileFormat {
    /// The format of a file, by its extension or its first bytes.
    ///
    /// # Errors
    /// If the format is another one.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        match extension.to_ascii_lowercase().as_str() {
            "gltf" | "glb" => return Ok(Self::Gltf),
            "json" => return Ok(Self::Scene),
            _ if mesh::is_mesh_name(path) => return Ok(Self::Mesh),
            _ => {}
        }
        // A missing or special file is an error when it is read; or it is a pipe with a scene.
        let Some(start) = start_of(path) else { return Ok(Self::Scene) };
        if gltf::is_binary(&start) {
            return Ok(Self::Gltf);
        }
        let text = start.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&start);
        match text.trim_ascii_start().first() {
            Some(b'{') => return Ok(Self::Scene),
            None if extension.is_empty() => return Ok(Self::Scene),
            _ => {}
        }
        let error = Error::new(ErrorKind::Usage, "this kind of file is not read").in_file(path);
        Err(error.remedy("use a scene (.json), glTF (.gltf, .glb) or a mesh (.ply, .obj, .stl)"))
    }
}

/// The first bytes of a regular file.
fn start_of(path: &Path) -> Option<Vec<u8>> {
    const ENOUGH: u64 = 256;
    let mut start = Vec::new();
    let (file, _) = open(path).ok()?;
    file.take(ENOUGH).read_to_end(&mut start).ok()?;
    Some(start)
}
