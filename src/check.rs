//! `check`: is the scene right, and what is in it?

use std::fmt::Write as _;
use std::path::PathBuf;

use glam::Vec3;

use super::common::{SceneOptions, print};
use wavecrest_base::error::Result;
use wavecrest_core::plan::schedule::{PASSES, unplanned};
use wavecrest_core::prepared::Dropped;
use wavecrest_scene::systems::{self, Extracted, Options};

/// Reads a scene with all its meshes and textures, and says what is in it.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct CheckArgs {
    /// The scene: JSON, glTF (.gltf, .glb), or a mesh alone (.ply, .obj)
    pub(crate) scene: PathBuf,
    /// What is read and how
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
}

/// Checks as the arguments say.
///
/// # Errors
/// When the scene cannot be rendered.
pub(crate) fn run(args: &CheckArgs) -> Result<()> {
    args.scene_options.threads.run(|| {
        let mut loaded = args.scene_options.load(&args.scene)?;
        // Every file is read, whether or not it is needed for the picture.
        let passes = unplanned(&PASSES);
        let options = Options { passes: &passes, ..Options::default() };
        let extracted = systems::extract(&mut loaded.world, options)?;
        extracted.scene().appearance.decode()?;
        let dropped = extracted.dropped();
        args.scene_options.warn(&systems::warnings(dropped, extracted.file()));
        let text = summary(&extracted, dropped);
        if args.scene_options.quiet {
            Ok(())
        } else {
            print(&format!("{}: ok\n{text}", args.scene.display()))
        }
    })
}

/// What is in the scene, a line each.
fn summary(extracted: &Extracted, dropped: Dropped) -> String {
    let scene = extracted.scene();
    let geometry = extracted.geometry();
    let [width, height] = scene.camera.size();
    let lights = scene.lights.iter().filter(|light| light.power != Vec3::ZERO);
    let lines = [
        ("image", format!("{width} x {height}, {} rays a pixel", scene.camera.rays_per_pixel())),
        ("shapes", format!("{}", scene.appearance.shapes.len() - geometry.lights.len())),
        ("triangles", format!("{}", geometry.triangles.len())),
        ("without area", format!("{}", dropped.degenerate)),
        ("vertices", format!("{}", geometry.positions.len())),
        ("quads", format!("{}", geometry.quads.len())),
        ("spheres", format!("{}", geometry.spheres.len())),
        ("lights with power", format!("{}", lights.count())),
        ("textures", format!("{}", scene.appearance.images.len())),
        ("bounces", format!("{}", scene.bounces)),
    ];
    lines.iter().fold(String::new(), |mut text, (name, value)| {
        let _ = writeln!(text, "  {name:<18}{value}");
        text
    })
}
