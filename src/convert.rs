//! `convert`: from a glTF file or a mesh to a scene file.

use std::path::{Path, PathBuf};

use super::common::{FramingOptions, tell};
use super::lighting::LightingOptions;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::check_differs;
use wavecrest_scene::load::{LoadOptions, load};
use wavecrest_scene::write::write;

/// Writes a glTF file or a mesh as a scene in JSON, with meshes and images beside it.
///
/// It renders to the same image, and has in it what was chosen: camera, light, materials.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ConvertArgs {
    /// The file to convert: .gltf, .glb, .ply, .obj or .stl
    #[arg(value_name = "INPUT")]
    pub(crate) input: PathBuf,
    /// The scene to write; meshes and images are named after it
    #[arg(value_name = "OUTPUT.json")]
    pub(crate) output: PathBuf,
    /// The camera to take of a glTF file, by its name or its number [default: the first of the scene]
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: Option<String>,
    /// Width of the image in pixels
    #[arg(long, value_name = "PIXELS")]
    pub(crate) width: Option<u32>,
    /// Height of the image in pixels
    #[arg(long, value_name = "PIXELS")]
    pub(crate) height: Option<u32>,
    /// Read material files and images that an OBJ file names outside its folder, too
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// From where the file is seen
    #[command(flatten)]
    pub(crate) framing: FramingOptions,
    /// How a file without lights is lit
    #[command(flatten)]
    pub(crate) lighting: LightingOptions,
    /// Replace files that are there already
    #[arg(long)]
    pub(crate) force: bool,
    /// Say nothing but errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Converts as the arguments say.
///
/// # Errors
/// When the file cannot be loaded, or one that is to be written is there already or cannot be written.
pub(crate) fn run(args: &ConvertArgs) -> Result<()> {
    check_name(&args.output)?;
    check_differs(&args.output, &args.input, "the input")?;
    let options = LoadOptions {
        strict: false,
        width: args.width,
        height: args.height,
        camera: args.camera.clone(),
        allow_outside: args.allow_outside,
        framing: (&args.framing).into(),
        lighting: args.lighting.options(),
    };
    let scene = load(&args.input, &options)?;
    if !args.quiet {
        scene.warnings.iter().for_each(|warning| tell(&format!("warning: {warning}")));
        scene.notes.iter().for_each(|note| tell(&format!("note: {note}")));
    }
    let written = write(scene, &args.output, args.force).map_err(|e| e.in_file(&args.input))?;
    if !args.quiet {
        written.iter().for_each(|file| tell(&format!("wrote {}", file.display())));
    }
    Ok(())
}

/// By another ending the scene would not be known as one.
fn check_name(output: &Path) -> Result<()> {
    if output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        return Ok(());
    }
    let error = Error::new(ErrorKind::Usage, "the name of a scene must end in .json");
    Err(error.in_file(output).remedy("name it so, such as scene.json"))
}
