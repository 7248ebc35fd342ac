//! From a world of entities to a [`PreparedScene`]: the systems, in the order of execution.
//!
//! | system | reads | leaves |
//! |---|---|---|
//! | `looks` | surfaces, what is added to files | for a look: the surfaces that it shows |
//! | `strip` | unlit materials, metal maps | of their surfaces what counts |
//! | `frame` | the view, settings, all that shines | the offset of the scene's origin, the camera in all frames, which rays can show anything |
//! | `placement` | shapes, instances, transforms | shapes where they are shown |
//! | `culling` | boxes of shapes, cameras, lights | what no ray can meet, of which nothing is stored; what mirrors and transparent surfaces show |
//! | `geometry` | shapes, whose meshes it takes out of the world | positions, triangles, quads, spheres, mesh attributes, what shadow rays pass; an entity for each shape |
//! | `materials` | materials | one row of numbers for each shape, and bounds on it |
//! | `lights` | lights and their shapes | an entity for each light, with sampling data |
//! | `sky` | ambient light, the environment | light by the normal, the colour of an even environment |
//! | `view` | shapes, the camera in all frames | which shapes are in view, and from which side |
//! | `reach` | lights, shapes | which lights reach surfaces, and which surfaces they reach |
//! | `shows` | materials, lights that reach them | which properties of materials are visible |
//! | `cutouts` | cut-outs that rays may meet | primitives with holes, and their images |
//! | `census` | all of these | the plan: which effects the scene needs |
//! | `lights` | lights that reach something in view | the lights to simulate |
//! | `classes` | visible materials and textures | classes, each once; images, each once |
//! | `environment` | the environment | what rays see that hit nothing |
//! | `camera` | the view, pinhole or thin lens | the ray generator |
//! | `textures` | headers of images | images, to be decoded at their first look-up |
//! | `solids` | classes, boxes of shapes | what shapes enclose, by priority |
//! | `sky` | light by the normal, an environment | light by the normal |
//! | `appearance` | shapes | the arrays of shapes and of what nothing hides of their meshes |
//! | [`wavecrest_core::accel`] | the geometry | the tree |
//!
//! What systems find out about a shape or a light are components of its entity. What the plan skips goes no
//! further than the census: lights that reach nothing in view, textures and normals that nothing shows, shapes
//! that no ray can meet.
//!
//! Only this module and [`crate`] know the world; later stages never query it.

mod appearance;
mod backs;
pub mod bounds;
mod brightness;
mod camera;
mod census;
mod classes;
mod culling;
pub(crate) mod cutouts;
mod environment;
pub mod frame;
mod geometry;
mod lights;
pub mod looks;
mod materials;
pub mod overrides;
mod placement;
mod reach;
mod shows;
mod sky;
mod solids;
mod surface;
mod textures;
mod unseen;
mod view;
mod visibility;

use std::path::Path;

use hecs::{Entity, World};

use crate::components::{FreeCamera, View};
use crate::query::{self, missing};
use textures::Images;
use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_base::memory::Stage;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, KernelChoice};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::plan::Plan;
use wavecrest_core::plan::schedule::{PASSES, Pass, UNPLANNED};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_image::look::Look;

/// How a scene is prepared, once it is read. By default as for its light.
#[derive(Clone, Copy, Debug)]
pub struct SceneOptions {
    /// The precision of hits.
    pub precision: Precision,
    /// The quality of the tree; the one that is likely to finish first if `None`.
    pub bvh: Option<Preset>,
    /// Whether a mesh with several instances is copied for each instead of stored once.
    pub flat: bool,
    /// What images show instead of light.
    pub look: Option<Look>,
    /// The table of the plan: [`PASSES`], or [`UNPLANNED`], which skips nothing: neither passes and columns nor lights,
    /// textures, normals and shapes that nothing shows. Looks without light use that.
    pub passes: &'static [Pass],
    /// Whether nothing is left for the first rays: no image is decoded then, and unless `bvh` says so no part of the tree
    /// is built.
    pub at_once: bool,
    /// The factor by which images are brighter than the light.
    pub exposure: f32,
    /// The kernel that searches the tree; it changes no answer.
    pub kernel: KernelChoice,
    /// The instruction set; it changes no answer.
    pub level: Level,
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self {
            precision: Precision::default(),
            bvh: None,
            flat: false,
            look: None,
            passes: &PASSES,
            at_once: false,
            exposure: 1.0,
            kernel: KernelChoice::default(),
            level: Level::best(),
        }
    }
}

/// So many primitives tell what share of all is out of view.
const SAMPLED: usize = 4096;

/// The scene without its tree, sufficient to predict a render.
#[derive(Debug)]
pub struct Extracted {
    scene: PreparedScene,
    options: SceneOptions,
}

/// Lets the camera of `world` go anywhere once the scene is prepared. Returns its view at the start: its own, or `view`.
///
/// # Errors
/// If the world lacks a camera.
pub fn free_camera(world: &mut World, view: Option<View>) -> Result<View> {
    let cameras = world.query_mut::<(Entity, &View)>().into_iter();
    let camera = cameras.map(|(entity, own)| (entity, *own)).next();
    let (entity, own) = camera.ok_or_else(|| missing("View"))?;
    let view = view.unwrap_or(own);
    // It exists.
    let _ = world.insert(entity, (view, FreeCamera));
    Ok(view)
}

/// Runs every system but the last. It takes the `world`, whose meshes are moved.
///
/// # Errors
/// If the world lacks a camera or settings, a shape is too far out or too large, or an image cannot
/// be read, or decoded if nothing is left for the first rays.
pub fn extract(mut world: World, mut options: SceneOptions) -> Result<Extracted> {
    Stage::Extract.begin();
    if let Some(look) = options.look {
        looks::show(&mut world, look);
        if !look.is_shaded() {
            options.passes = &UNPLANNED;
        }
    }
    materials::strip(&mut world);
    let mut images = Images::of_scene(&query::settings(&world)?.file);
    let frame = frame::run(&world, &options, &mut images)?;
    let mut instances = placement::run(&world, frame.origin);
    culling::run(&world, &frame, &mut instances, &mut images)?;
    let mut arrays = geometry::run(&mut world, &frame, instances, options.flat)?;
    materials::run(&world, &frame);
    lights::run(&mut world, &frame, &arrays.geometry)?;
    sky::run(&mut world, &mut images);
    view::run(&world, &frame, &arrays.geometry);
    reach::run(&world, &arrays.geometry);
    shows::run(&world, &frame, &mut images)?;
    let cutouts = cutouts::run(&world, &frame.settings.file, &mut arrays)?;
    let plan = Plan::of(census::run(&world, &frame, &arrays.geometry), options.passes);
    let (lights, ambient) = lights::kept(&mut world, &frame, plan.schedule())?;
    let classes = classes::run(&world, plan.schedule(), &mut images);
    let (environment, background) = environment::run(&world, &frame, &plan, &mut images);
    let (camera, path) = camera::run(&world, frame.origin, Some(plan.schedule()))?;
    let images = images.prepare()?;
    let scene = PreparedScene {
        origin: frame.origin,
        camera,
        path,
        lights,
        ambient,
        background,
        visible: frame.visible,
        bounces: if plan.schedule().goes_on() { frame.settings.bounces } else { 0 },
        solids: solids::run(&world, &classes, &arrays.geometry),
        hemisphere: sky::light(&world, &plan, environment.as_ref(), &images)?,
        environment,
        appearance: appearance::run(&world, &plan, classes, images, cutouts, arrays.meshes),
        accel: Accel::unbuilt(arrays.geometry),
        plan,
        degenerate: 0,
    };
    if options.at_once {
        scene.appearance.decode()?;
    }
    Ok(Extracted { scene, options })
}

impl Extracted {
    /// The geometry for the tree.
    pub fn geometry(&self) -> &Geometry {
        self.scene.accel.geometry()
    }

    /// The scene, without a tree.
    pub fn scene(&self) -> &PreparedScene {
        &self.scene
    }

    /// The preset of the tree: that of the options, or the one that is likely to finish first.
    pub fn preset(&self) -> Preset {
        let chosen = || {
            let has_light = self.options.look.is_none_or(Look::is_shaded);
            let rays =
                if has_light { self.scene.expected_rays() } else { self.scene.camera_rays() };
            let held = self.geometry().held() as u64;
            if self.options.at_once {
                return Preset::choose(held, rays);
            }
            Preset::choose_for_part(held, self.out_of_view(), rays)
        };
        self.options.bvh.unwrap_or_else(chosen)
    }

    /// About the number of primitives outside instances that the first camera cannot see, from a sample of all.
    fn out_of_view(&self) -> u64 {
        let (geometry, camera) = (self.geometry(), &self.scene.camera);
        let step = geometry.own().div_ceil(SAMPLED).max(1);
        let sampled = (0..geometry.own() as u32).step_by(step);
        let unseen = sampled.filter(|&number| !camera.may_see(&geometry.bounds(number), 0.0));
        unseen.count() as u64 * step as u64
    }

    /// Builds the tree by this preset, whatever the options say, for their kernel and instruction set: the last system.
    pub fn build(mut self, preset: Preset) -> PreparedScene {
        Stage::Build.begin();
        self.scene.accel.rebuild(preset);
        // From a pass over every triangle.
        self.scene.degenerate = self.scene.accel.left_out();
        self.scene.accel.search_by(self.options.kernel, self.options.level);
        self.scene
    }
}

/// Warnings about the scene of `file`: shapes that the camera sees from behind only, and a camera that sees nothing.
pub fn warnings(scene: &PreparedScene, file: &Path) -> Vec<Warning> {
    let all = backs::warning(scene).into_iter().chain(unseen::warning(scene));
    all.map(|error| Warning::from_error(&error.in_file(file))).collect()
}

/// The note that parts of the scene of `file`, which nothing could show, are dropped.
pub fn note(scene: &PreparedScene, file: &Path) -> Option<Warning> {
    let message = match scene.degenerate {
        0 => return None,
        1 => "1 triangle has no area and is left out".to_owned(),
        n => format!("{n} triangles have no area and are left out"),
    };
    Some(Warning::from_error(&Error::new(ErrorKind::Mesh, message).in_file(file)))
}
