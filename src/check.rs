//! `check`: checks a scene and lists its contents.

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};

use super::common::{print, rounded};
use super::input::SceneOptions;
use wavecrest_api::{self as api, session::Session};
use wavecrest_base::error::Result;
use wavecrest_base::read::open;
use wavecrest_base::words::{Size, counted};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::counters::PrimitiveCounts;
use wavecrest_core::kernels::light::Light;
use wavecrest_core::kernels::texture::Image;
use wavecrest_core::plan::schedule::UNPLANNED;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_scene::components::Added;
use wavecrest_scene::load::LoadedScene;
use wavecrest_scene::systems::bounds;
use wavecrest_scene::systems::looks::remove_added;

/// Check a scene with all its meshes and textures, and list its contents.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct CheckArgs {
    /// Scene (.json), glTF file (.gltf, .glb) or mesh (.ply, .obj, .stl)
    pub(crate) scene: PathBuf,
    /// Scene
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
}

/// Runs the check.
///
/// # Errors
/// If the scene cannot be rendered.
pub(crate) fn run(args: &CheckArgs) -> Result<()> {
    args.scene_options.threads.run(|| {
        let mut files = vec![args.scene.clone()];
        let contents = |loaded: &mut LoadedScene| {
            // The contents are those of the file.
            remove_added(&mut loaded.world, |added| added == Added::Ground);
            files.append(&mut loaded.files);
            Ok(())
        };
        // Every file is read, whether or not the image needs it; the tree is for the few test rays of warnings.
        let (usual, bvh) = (args.scene_options.preparing(None), Some(Preset::OnDemand));
        let options = api::SceneOptions { passes: &UNPLANNED, at_once: true, bvh, ..usual };
        let Session { scene, .. } = args.scene_options.session(&args.scene, &options, contents)?;
        let mut lines = summary(&scene);
        let line = |file: &PathBuf| ("file", format!("{}{}", file.display(), bytes_of(file)));
        lines.extend(files.iter().map(line));
        for lazy in &scene.appearance.images {
            let (Image { width, height, .. }, name) = (lazy.get()?, lazy.name());
            let bytes = bytes_of(Path::new(name));
            lines.push(("texture", format!("{name}{bytes}, {width} x {height}")));
        }
        if args.scene_options.quiet {
            return Ok(());
        }
        let line = |(name, value): &(&str, String)| format!("  {name:<18}{value}\n");
        let text: String = lines.iter().map(line).collect();
        print(&format!("{}: ok\n{text}", args.scene.display()))
    })
}

/// The contents of the scene, a name and a value for each line.
fn summary(scene: &PreparedScene) -> Vec<(&'static str, String)> {
    let geometry = scene.accel.geometry();
    let [width, height] = scene.camera.size();
    let rays = counted(scene.camera.rays_per_pixel().into(), "ray");
    let shapes = scene.appearance.shapes.iter().filter(|shape| shape.light.is_none());
    let lights = scene.lights.iter().filter(|light| light.power != Vec3::ZERO);
    let is_ambient = |light: &&Light| light.emitter.ambient_reach().is_some();
    let (around, lights): (Vec<_>, Vec<_>) = lights.partition(is_ambient);
    let around = if around.is_empty() { "" } else { " and ambient light" };
    let [low, high, size] = extent(scene);
    let PrimitiveCounts { triangles, quads, spheres, disks } = geometry.counts();
    vec![
        ("image", format!("{width} x {height}, {rays} per pixel")),
        ("shapes", shapes.count().to_string()),
        ("triangles", triangles.to_string()),
        ("zero-area", scene.degenerate.to_string()),
        ("vertices", geometry.positions.len().to_string()),
        ("quads", quads.to_string()),
        ("spheres", spheres.to_string()),
        ("disks", disks.to_string()),
        ("lights", format!("{}{around}", lights.len())),
        ("textures", scene.appearance.images.len().to_string()),
        ("bounces", scene.bounces.to_string()),
        ("lowest corner", low),
        ("highest corner", high),
        ("size", size),
    ]
}

/// The extent of the scene in its own coordinates, and its size.
fn extent(scene: &PreparedScene) -> [String; 3] {
    let Some([low, high]) = bounds::of(scene.accel.geometry()) else {
        return ["-"; 3].map(str::to_owned);
    };
    let three = |v: DVec3, by: &str| v.to_array().map(|x| rounded(x, 5).to_string()).join(by);
    let origin = scene.origin;
    [three(low + origin, ", "), three(high + origin, ", "), three(high - low, " x ")]
}

/// The length of a file after a comma, if known.
fn bytes_of(path: &Path) -> String {
    open(path).map_or_else(|_| String::new(), |(_, bytes)| format!(", {}", Size(bytes)))
}
