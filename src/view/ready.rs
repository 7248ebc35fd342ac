//! The scene of pages: prepared once for a camera that goes anywhere, and placed for each render.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::SystemTime;

use glam::DVec3;
use serde_json::json;

use super::ViewArgs;
use super::exchange::{Exchange, Kind};
use super::request::Half;
use super::steering::Steering;
use super::take_away::TakeAway;
use crate::input::SceneOptions;
use wavecrest_api::session::{self as api, Session};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::progress;
use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::camera::{Camera, Placement};
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::{Appearance, Original, PreparedScene, Samples};
use wavecrest_core::render::{RenderOptions, TracerKind};
use wavecrest_image::look::Look;
use wavecrest_image::write::Transfer;
use wavecrest_scene::components::{Encoding, View};
use wavecrest_scene::systems::{bounds, free_camera};

/// The most pixels of an image.
const MOST_PIXELS: u64 = 1 << 24;
/// The least number of paths in a batch, and how many batches each thread has of a small image.
const LEAST_BATCH: usize = 256;
const SHARES: usize = 8;

/// A scene that is ready to be traced, from anywhere.
pub(super) struct Ready {
    pub(super) scene: PreparedScene,
    pub(super) preset: Preset,
    /// The camera and the lights of the file.
    camera: Camera,
    original: Original,
    /// The transfer curve of what is shown.
    pub(super) transfer: Transfer,
    /// The box around everything.
    pub(super) ends: [DVec3; 2],
    /// The files that were read, as they were then.
    files: Vec<(PathBuf, Option<Stamp>)>,
}

/// The length of a file, and when it was changed last.
type Stamp = (u64, Option<SystemTime>);

fn stamp(file: &Path) -> Option<Stamp> {
    let found = fs::metadata(file).ok()?;
    Some((found.len(), found.modified().ok()))
}

/// Reads and prepares the scene, as pages are shown; once more if there is a `view` already.
///
/// # Errors
/// If it cannot be loaded or prepared, or is too large to be shown.
pub(super) fn prepare(
    args: &ViewArgs,
    exchange: &Exchange,
    take_away: &TakeAway,
    look: Option<Look>,
    view: Option<View>,
) -> Result<(Ready, View)> {
    progress::begin();
    exchange.prepares.store(true, Ordering::Relaxed);
    // Notes are printed once.
    let quiet = args.scene_options.quiet || view.is_some();
    let options = &SceneOptions { quiet, ..args.scene_options.clone() };
    let preparing = api::SceneOptions { look, ..options.preparing(Some(&args.search)) };
    let (mut start, mut files) = (None, Vec::new());
    let session = options.session(&args.scene, &preparing, |loaded| {
        take_away.keep(loaded)?;
        let all = std::iter::once(&args.scene).chain(&loaded.files);
        files = all.map(|file| (file.clone(), stamp(file))).collect();
        check_size(args, start.insert(free_camera(&mut loaded.world, view)?))
    })?;
    let Session { scene, preset, transfer, .. } = session;
    let transfer = match transfer {
        // Other looks are encoded already.
        Encoding::Srgb if look.is_none_or(Look::is_shaded) => Transfer::Srgb,
        _ => Transfer::Linear,
    };
    let (camera, original) = (scene.camera, scene.original());
    let ends = bounds::of_file(&scene).unwrap_or([DVec3::NEG_ONE, DVec3::ONE]);
    let ends = ends.map(|end| end + scene.origin);
    exchange.prepares.store(false, Ordering::Relaxed);
    let view = start.ok_or_else(|| Error::new(ErrorKind::Scene, "there is no camera"))?;
    Ok((Ready { scene, preset, camera, original, transfer, ends, files }, view))
}

/// Refuses an image that is too large for a page.
fn check_size(args: &ViewArgs, view: &View) -> Result<()> {
    if u64::from(view.width) * u64::from(view.height) > MOST_PIXELS {
        let message = format!("a page shows at most {MOST_PIXELS} pixels");
        let error = Error::new(ErrorKind::Limit, message).in_file(&args.scene);
        let remedy = "use a smaller --size";
        return Err(error.value(format!("{} x {}", view.width, view.height)).remedy(remedy));
    }
    Ok(())
}

impl Ready {
    /// Whether no file has changed since it was read. If one has, pages are told, and keep what they show.
    pub(super) fn is_as_read(&self, exchange: &Exchange) -> bool {
        let mut changed = self.files.iter().filter(|(file, read)| stamp(file) != *read);
        let Some((file, _)) = changed.next() else { return true };
        let words =
            format!("{} has changed since it was read: it is shown as it was", file.display());
        let message = json!({"kind": "error", "message": words});
        exchange.send(Kind::Error, message.to_string());
        false
    }

    /// Frees what is large: two scenes would take twice the memory.
    pub(super) fn free(&mut self) {
        self.scene.accel = Accel::unbuilt(Geometry::default());
        self.scene.appearance = Appearance::default();
    }

    /// What a ray through a place of the image meets first; a point before it if nothing.
    pub(super) fn point(&self, steering: &Steering, at: [f64; 2]) -> DVec3 {
        let scene = &self.scene;
        let (from, far) = (steering.view.location, steering.point(at));
        let direction = (far - from).normalize();
        let ray = Ray::new((from - scene.origin).as_vec3(), direction.as_vec3());
        let hit = scene.accel.closest(&ray, &mut scene.accel.traversal());
        if hit.is_miss() { far } else { from + direction * f64::from(hit.t) }
    }

    /// The options of a render from where it is placed.
    pub(super) fn options(&self, args: &ViewArgs, tracer: TracerKind) -> RenderOptions {
        let pixels = self.scene.camera.size().map(|side| side as usize).iter().product::<usize>();
        // A small image is cut into tiles for all threads, too.
        let paths = pixels * self.scene.camera.rays_per_pixel() as usize;
        let share = paths / (SHARES * rayon::current_num_threads());
        let batch = share.clamp(LEAST_BATCH, args.batch.max(LEAST_BATCH as u32) as usize);
        RenderOptions { tracer, seed: args.seed, batch, ..RenderOptions::default() }
    }

    /// Makes the scene ready for a render of a half from a placement; with a single point on everything if it is a `draft`.
    pub(super) fn place(&mut self, placement: Placement, half: &Half, draft: bool) {
        let Self { scene, camera, original, .. } = self;
        scene.accel.set_precision(half.precision);
        let one = draft.then_some(Points { sampling: Sampling::Jittered, side: 1 });
        scene.resample(original, &Samples { lights: one, ..Samples::default() });
        let (location, look) = (placement.location - scene.origin, placement.look - scene.origin);
        let placed = camera.placed(&Placement { location, look, ..placement });
        scene.camera = if draft { placed.resampled(one, one) } else { half.camera(&placed) };
    }

    /// The number of rays of the file for each pixel.
    pub(super) fn rays(&self) -> u32 {
        self.camera.rays_per_pixel()
    }
}
