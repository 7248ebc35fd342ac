//! `check`: checks a scene and lists its contents.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};

use super::common::{Extent, SceneOptions, print, rounded, size, warn};
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::texture::Image;
use wavecrest_core::plan::schedule::{PASSES, unplanned};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_scene::systems::{self, Options, bounds, looks};

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
        let mut loaded = args.scene_options.load(&args.scene, &Extent::default(), &[])?;
        // The contents are those of the file.
        if let Some(ground) = looks::ground(&loaded.world) {
            let _ = loaded.world.despawn(ground);
        }
        // Read every file, whether or not the image needs it.
        let passes = unplanned(&PASSES);
        let options = Options { passes: &passes, ..Options::default() };
        let extracted = systems::extract(&mut loaded.world, options)?;
        let extracted = args.scene_options.checked(extracted, &Extent::default())?;
        extracted.scene().appearance.decode()?;
        let file = extracted.file().to_owned();
        // For the few test rays of warnings.
        let scene = args.scene_options.build(extracted, Preset::OnDemand)?;
        warn(&systems::warnings(&scene, &file));
        let mut text = summary(&scene);
        files(&mut text, &args.scene, &loaded.files);
        textures(&mut text, &scene)?;
        if args.scene_options.quiet {
            Ok(())
        } else {
            print(&format!("{}: ok\n{text}", args.scene.display()))
        }
    })
}

/// The contents of the scene, a line each.
fn summary(scene: &PreparedScene) -> String {
    let geometry = scene.accel.geometry();
    let [width, height] = scene.camera.size();
    let lights = scene.lights.iter().filter(|light| light.power != Vec3::ZERO);
    let [low, high, size] = extent(scene);
    let lines = [
        ("image", format!("{width} x {height}, {}", rays_per_pixel(scene))),
        ("shapes", format!("{}", scene.appearance.shapes.len() - geometry.lights.len())),
        ("triangles", format!("{}", geometry.triangles.len())),
        ("zero-area", format!("{}", scene.dropped.degenerate)),
        ("vertices", format!("{}", geometry.positions.len())),
        ("quads", format!("{}", geometry.quads.len())),
        ("spheres", format!("{}", geometry.spheres.len())),
        ("lights", format!("{}", lights.count())),
        ("textures", format!("{}", scene.appearance.images.len())),
        ("bounces", format!("{}", scene.bounces)),
        ("lowest corner", low),
        ("highest corner", high),
        ("size", size),
    ];
    let mut text = String::new();
    lines.iter().for_each(|(name, value)| line(&mut text, name, value));
    text
}

fn line(text: &mut String, name: &str, value: &str) {
    let _ = writeln!(text, "  {name:<18}{value}");
}

fn rays_per_pixel(scene: &PreparedScene) -> String {
    match scene.camera.rays_per_pixel() {
        1 => "1 ray per pixel".to_owned(),
        n => format!("{n} rays per pixel"),
    }
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

/// The scene's file and those of its meshes, with their sizes.
fn files(text: &mut String, scene: &Path, others: &[PathBuf]) {
    for path in std::iter::once(scene).chain(others.iter().map(PathBuf::as_path)) {
        line(text, "file", &format!("{}{}", path.display(), bytes_of(path)));
    }
}

/// The decoded images, with their sizes.
fn textures(text: &mut String, scene: &PreparedScene) -> Result<()> {
    for lazy in &scene.appearance.images {
        let Image { width, height, .. } = lazy.get()?;
        let bytes = bytes_of(Path::new(lazy.name()));
        line(text, "texture", &format!("{}{bytes}, {width} x {height}", lazy.name()));
    }
    Ok(())
}

/// The length of a file after a comma, if known.
fn bytes_of(path: &Path) -> String {
    let length = path.metadata().ok().filter(|found| found.is_file()).map(|found| found.len());
    length.map_or_else(String::new, |bytes| format!(", {}", size(bytes)))
}
