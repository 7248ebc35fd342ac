//! The scene of pages: prepared once for a camera that goes anywhere, and placed for each render.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use glam::DVec3;

use super::ViewArgs;
use super::exchange::Exchange;
use super::request::Half;
use super::steering::{Seen, Steering};
use super::take_away::TakeAway;
use crate::common::tell_all;
use wavecrest_api::SceneOptions;
use wavecrest_api::session::Session;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::progress;
use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::camera::{Camera, Placement};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::{Appearance, Original, PreparedScene, Samples};
use wavecrest_core::render::{RenderOptions, TracerKind};
use wavecrest_image::look::Look;
use wavecrest_image::write::Transfer;
use wavecrest_scene::components::{Encoding, View};
use wavecrest_scene::load::LoadedScene;
use wavecrest_scene::systems::{bounds, frame, free_camera, looks};

/// The most pixels of an image, and the longest side: that of a JPEG.
const MOST_PIXELS: u64 = 1 << 24;
const LONGEST_SIDE: u32 = u16::MAX as u32;
/// The least number of paths in a batch, and how many batches each thread has of a small image.
const LEAST_BATCH: usize = 256;
const SHARES: usize = 8;

/// A scene that is ready to be traced, from anywhere.
pub(super) struct Ready {
    /// As it was read.
    loaded: Arc<LoadedScene>,
    pub(super) scene: PreparedScene,
    pub(super) preset: Preset,
    /// The camera and the lights of the file.
    camera: Camera,
    original: Original,
    /// The transfer curve of what is shown.
    pub(super) transfer: Transfer,
    /// The box around everything.
    pub(super) ends: [DVec3; 2],
    /// The origin for which it could not be prepared again.
    failed: Option<DVec3>,
}

/// Prepares a copy of what was `loaded`, without what a look does not show: that is also what may be taken away. Its
/// camera goes anywhere, from its own view or from this one. Before the tree is built, others may be dropped by `building`.
fn session(
    args: &ViewArgs,
    take_away: &TakeAway,
    loaded: &LoadedScene,
    (look, view): (Option<Look>, Option<View>),
    building: impl FnOnce(),
) -> Result<(Session, View)> {
    let mut shown = loaded.clone();
    let view = free_camera(&mut shown.world, view)?;
    check_size(args, &view)?;
    look.inspect(|look| looks::leave_out(&mut shown.world, *look));
    let contents = take_away.contents(&shown)?;
    let options = SceneOptions { look, ..args.scene_options.preparing(Some(&args.search)) };
    let session = Session::of(shown, &options, |_| {
        building();
        Ok(())
    })?;
    take_away.keep(contents);
    Ok((session, view))
}

/// Refuses an image that is too large for a page.
fn check_size(args: &ViewArgs, view: &View) -> Result<()> {
    let is_long = view.width.max(view.height) > LONGEST_SIDE;
    if is_long || u64::from(view.width) * u64::from(view.height) > MOST_PIXELS {
        let message =
            format!("a page shows at most {MOST_PIXELS} pixels, {LONGEST_SIDE} on a side");
        let error = Error::new(ErrorKind::Limit, message).in_file(&args.scene);
        let remedy = "use a smaller --size";
        return Err(error.value(format!("{} x {}", view.width, view.height)).remedy(remedy));
    }
    Ok(())
}

impl Ready {
    /// Reads and prepares the scene, as pages are shown. Returns the view of its camera, too.
    ///
    /// # Errors
    /// If it cannot be loaded or prepared, or its image is too large for a page.
    pub(super) fn open(
        args: &ViewArgs,
        exchange: &Exchange,
        take_away: &TakeAway,
    ) -> Result<(Self, View)> {
        progress::begin();
        exchange.prepares.store(true, Ordering::Relaxed);
        let loaded = Arc::new(args.scene_options.load(&args.scene)?);
        let (mut session, view) = session(args, take_away, &loaded, (args.look, None), || {})?;
        tell_all(&mut session.warnings, &mut session.notes, args.scene_options.quiet);
        exchange.prepares.store(false, Ordering::Relaxed);
        Ok((Self::of(session, loaded, args.look), view))
    }

    /// Prepares what was read once more: for this look, and for cameras around `view`.
    ///
    /// # Errors
    /// If it cannot be prepared, or an image can no longer be read. Nothing has changed then.
    pub(super) fn prepare_again(
        &mut self,
        args: &ViewArgs,
        exchange: &Exchange,
        take_away: &TakeAway,
        look: Option<Look>,
        view: View,
    ) -> Result<()> {
        progress::begin();
        exchange.prepares.store(true, Ordering::Relaxed);
        let PreparedScene { accel, appearance, .. } = &mut self.scene;
        let session = session(args, take_away, &self.loaded, (look, Some(view)), || {
            // Two would take twice the memory.
            *accel = Accel::unbuilt(Geometry::default());
            *appearance = Appearance::default();
        });
        exchange.prepares.store(false, Ordering::Relaxed);
        self.failed = session.is_err().then(|| frame::origin(&view));
        let (session, _) = session?;
        *self = Self::of(session, Arc::clone(&self.loaded), look);
        Ok(())
    }

    /// Whether a render from this view would be prepared in the same way, or failed to be.
    pub(super) fn fits(&self, args: &ViewArgs, view: &View) -> bool {
        let origin = frame::origin(view);
        let is_fast = args.scene_options.precision == Precision::Fast;
        is_fast || origin == self.scene.origin || self.failed == Some(origin)
    }

    fn of(session: Session, loaded: Arc<LoadedScene>, look: Option<Look>) -> Self {
        let Session { scene, preset, transfer, .. } = session;
        let transfer = match transfer {
            // Other looks are encoded already.
            Encoding::Srgb if look.is_none_or(Look::is_shaded) => Transfer::Srgb,
            _ => Transfer::Linear,
        };
        let (camera, original) = (scene.camera, scene.original());
        let ends = bounds::of_file(&scene).unwrap_or([DVec3::NEG_ONE, DVec3::ONE]);
        let ends = ends.map(|end| end + scene.origin);
        Self { loaded, scene, preset, camera, original, transfer, ends, failed: None }
    }

    /// What a ray through a place of the image meets first; a point before it if nothing.
    pub(super) fn see(&self, steering: &Steering, at: [f64; 2]) -> Seen {
        let scene = &self.scene;
        let (from, far) = (steering.view.location, steering.point(at));
        let direction = (far - from).normalize();
        let ray = Ray::new((from - scene.origin).as_vec3(), direction.as_vec3());
        let hit = scene.accel.closest(&ray, &mut scene.accel.traversal());
        if hit.is_miss() {
            return Seen { point: far, is_met: false };
        }
        Seen { point: from + direction * f64::from(hit.t), is_met: true }
    }

    /// The options of a render from where it is placed.
    pub(super) fn options(&self, args: &ViewArgs, tracer: TracerKind) -> RenderOptions {
        // A small image is cut into tiles for all threads, too.
        let share = self.scene.camera_rays() as usize / (SHARES * rayon::current_num_threads());
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
