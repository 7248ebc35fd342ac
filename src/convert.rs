//! `convert`: writes a glTF file, a mesh or a scene as a scene file.

use std::path::{Path, PathBuf};

use super::common::{tell, tell_all};
use super::input::InputOptions;
use super::progress::{Display, Style};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::check_differs;
use wavecrest_scene::load::load;
use wavecrest_scene::write::{check_free, write};

/// Convert a glTF file, a mesh or a scene to a scene in JSON, with meshes and images beside it.
///
/// The scene renders to the same image. It contains the default camera, lights and materials, ready to be edited.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ConvertArgs {
    /// File to convert: .gltf, .glb, .ply, .obj or .stl
    #[arg(value_name = "INPUT")]
    pub(crate) input: PathBuf,
    /// Scene to write; meshes and images are named after it
    #[arg(value_name = "OUTPUT.json")]
    pub(crate) output: PathBuf,
    /// What is shown of the file
    #[command(flatten)]
    pub(crate) input_options: InputOptions,
    /// Replace files that exist
    #[arg(long)]
    pub(crate) force: bool,
    /// Print no notes and no names of written files; warnings and errors stay
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Runs the conversion.
///
/// # Errors
/// If the file cannot be loaded, or an output exists already or cannot be written.
pub(crate) fn run(args: &ConvertArgs) -> Result<()> {
    check_name(&args.output)?;
    check_differs(&args.output, &args.input, "the input")?;
    check_free(&args.output, args.force)?;
    args.input_options.check(&args.input)?;
    let _reading = Display::new(Style::Auto, args.quiet);
    let mut scene = load(&args.input, &args.input_options.load_options())?;
    tell_all(&mut scene.warnings, &mut scene.notes, args.quiet);
    let written = write(&scene, &args.output, args.force).map_err(|e| e.in_file(&args.input))?;
    if !args.quiet {
        written.iter().for_each(|file| tell(&format!("wrote {}", file.display())));
    }
    Ok(())
}

/// With another extension the scene would not be recognised as one.
fn check_name(output: &Path) -> Result<()> {
    if output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        return Ok(());
    }
    let error = Error::new(ErrorKind::Usage, "the name of a scene must end in .json");
    Err(error.in_file(output).remedy("use a name such as scene.json"))
}
