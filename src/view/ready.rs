//! The scene of pages: prepared once for a camera that goes anywhere, and placed for each render.

use std::sync::Arc;

use glam::DVec3;

use super::ViewArgs;
use super::exchange::Exchange;
use super::request::{Half, Shown};
use super::steering::{Seen, Steering};
use wavecrest_api::SceneOptions;
use wavecrest_api::session::Session;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::camera::{Camera, Placement};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::{Appearance, Original, PreparedScene, Samples};
use wavecrest_core::render::{RenderOptions, TracerKind};
use wavecrest_image::write::Transfer;
use wavecrest_scene::components::{Encoding, View};
use wavecrest_scene::load::{LightFrame, LoadedScene};
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
    /// The transfer curve of the file.
    transfer: Transfer,
    /// The box around everything.
    pub(super) ends: [DVec3; 2],
    /// What decided on added lights as they were prepared.
    lit: Option<LightFrame>,
    /// The view for which it could not be prepared again.
    pub(super) failed: Option<View>,
}

/// Prepares a copy of what was `loaded` for a camera that goes anywhere, from its own view or from this one, with its lights
/// and without what a look does not show. Before the tree is built, others may be dropped by `building`. Returns the view
/// and the frame of added lights, too.
fn session(
    args: &ViewArgs,
    loaded: &LoadedScene,
    (shown, view): (&Shown, Option<View>),
    building: impl FnOnce(),
) -> Result<(Session, View, Option<LightFrame>)> {
    let mut copy = loaded.clone();
    let view = free_camera(&mut copy.world, view)?;
    let lit_for = loaded.usual_view().filter(|_| shown.stays).unwrap_or(view);
    if shown.is_lit() {
        copy.light_for(lit_for);
    }
    let (look, exposure) = (shown.look, shown.develop().factor());
    look.inspect(|look| looks::leave_out(&mut copy.world, *look));
    let usual = args.scene_options.preparing(Some(&args.search));
    let options = SceneOptions { look, exposure, ..usual };
    let session = Session::of(copy, &options, |_| {
        building();
        Ok(())
    })?;
    Ok((session, view, loaded.light_frame(lit_for)))
}

/// Lets go what is prepared before another scene is: two would take twice the memory.
pub(super) fn release(scene: &mut PreparedScene) {
    scene.accel = Accel::unbuilt(Geometry::default());
    scene.appearance = Appearance::default();
}

/// Refuses an image of a size that is too large for a page.
pub(super) fn check_size(args: &ViewArgs, [width, height]: [u32; 2]) -> Result<()> {
    let is_long = width.max(height) > LONGEST_SIDE;
    if is_long || u64::from(width) * u64::from(height) > MOST_PIXELS {
        let message =
            format!("a page shows at most {MOST_PIXELS} pixels, {LONGEST_SIDE} on a side");
        let error = Error::new(ErrorKind::Limit, message).in_file(&args.scene);
        let remedy = "use a smaller --size";
        return Err(error.value(format!("{width} x {height}")).remedy(remedy));
    }
    Ok(())
}

impl Ready {
    /// Reads and prepares the scene as it is `shown`. Returns the view of its camera, too.
    ///
    /// # Errors
    /// If it cannot be loaded or prepared, or its image is too large for a page.
    pub(super) fn open(
        args: &ViewArgs,
        exchange: &Exchange,
        shown: impl FnOnce(&LoadedScene, [u32; 2]) -> Shown,
    ) -> Result<(Self, View, Shown)> {
        let _preparing = exchange.prepare();
        let loaded = Arc::new(args.scene_options.load(&args.scene)?);
        let size = loaded.view()?.placement().size;
        check_size(args, size)?;
        let shown = shown(&loaded, size);
        let (mut session, view, lit) = session(args, &loaded, (&shown, None), || {})?;
        args.scene_options.tell(&mut session.warnings, &mut session.notes);
        Ok((Self::of(session, loaded, lit), view, shown))
    }

    /// Prepares what was read once more: as it is `shown`, and for cameras around `view`.
    ///
    /// # Errors
    /// If it cannot be prepared, or an image can no longer be read. Nothing has changed then.
    pub(super) fn prepare_again(
        &mut self,
        args: &ViewArgs,
        exchange: &Exchange,
        shown: &Shown,
        view: View,
    ) -> Result<()> {
        let _preparing = exchange.prepare();
        let Self { loaded, scene, .. } = self;
        let session = session(args, loaded, (shown, Some(view)), || release(scene));
        let (session, _, lit) = session?;
        *self = Self::of(session, Arc::clone(&self.loaded), lit);
        Ok(())
    }

    /// Whether a render from this view would be prepared in the same way, or failed to be.
    pub(super) fn fits(&self, args: &ViewArgs, shown: &Shown, view: &View) -> bool {
        let is_fast = args.scene_options.precision == Precision::Fast;
        let is_near = is_fast || frame::origin(view) == self.scene.origin;
        let is_lit = shown.stays || !shown.is_lit() || self.loaded.light_frame(*view) == self.lit;
        is_near && is_lit || self.failed == Some(*view)
    }

    fn of(session: Session, loaded: Arc<LoadedScene>, lit: Option<LightFrame>) -> Self {
        let Session { scene, preset, transfer, .. } = session;
        let is_srgb = transfer == Encoding::Srgb;
        let transfer = if is_srgb { Transfer::Srgb } else { Transfer::Linear };
        let (camera, original) = (scene.camera, scene.original());
        let ends = bounds::of_file(&scene).unwrap_or([DVec3::NEG_ONE, DVec3::ONE]);
        let ends = ends.map(|end| end + scene.origin);
        Self { loaded, scene, preset, camera, original, lit, transfer, ends, failed: None }
    }

    /// The transfer curve of what is `shown`.
    pub(super) fn transfer(&self, shown: &Shown) -> Transfer {
        // Other looks are encoded already.
        if shown.is_lit() { shown.transfer.unwrap_or(self.transfer) } else { Transfer::Linear }
    }

    /// Whether lights were added that can follow the camera.
    pub(super) fn has_added_lights(&self) -> bool {
        self.loaded.usual_view().is_some()
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

    /// Makes the scene ready for a render of a half from a view, with an image of this size. A `draft` has a single point on
    /// everything, and added lights that follow only turn: their ground and all that was left out stays.
    pub(super) fn place(
        &mut self,
        view: &View,
        size: [u32; 2],
        half: &Half,
        draft: Option<&Shown>,
    ) {
        let Self { scene, camera, original, .. } = self;
        scene.accel.set_precision(half.precision);
        let one = draft.map(|_| Points { sampling: Sampling::Jittered, side: 1 });
        scene.resample(original, &Samples { lights: one, ..Samples::default() });
        let (location, look) = (view.location - scene.origin, view.look - scene.origin);
        let placed = camera.placed(&Placement { location, look, size, ..view.placement() });
        scene.camera =
            if one.is_some() { placed.resampled(one, one) } else { half.camera(&placed) };
        let follows = draft.is_some_and(|shown| !shown.stays);
        let now = self.loaded.light_frame(*view).filter(|_| follows);
        let place = |frame: Option<LightFrame>| frame.and_then(|frame| frame.place);
        if let (Some(now), Some(lit)) = (place(now), place(self.lit)) {
            scene.move_lights(&(now * lit.inverse()));
        }
    }

    /// The number of rays of the file for each pixel.
    pub(super) fn rays(&self) -> u32 {
        self.camera.rays_per_pixel()
    }
}
