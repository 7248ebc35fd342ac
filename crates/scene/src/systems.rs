//! From a world of entities to a [`PreparedScene`]: the systems, in the order of execution.
//!
//! | system | reads | output |
//! |---|---|---|
//! | `frame` | the view | the offset of the scene's origin |
//! | `met` | boxes of shapes, cameras, lights | what no ray can meet, of which nothing is stored |
//! | `geometry` | shapes, transforms | positions, triangles, quads, spheres, mesh attributes |
//! | `materials` | materials | one row of numbers for each shape |
//! | `lights` | lights and their shapes | emitters with sampling data |
//! | `view` | shapes, the camera in all frames | which shapes are visible, and from which side |
//! | `census` | all of these | the plan: which effects the scene needs |
//! | `classes` | visible materials and textures | classes, each once; images, each once |
//! | `solids` | classes, boxes of shapes | what shapes enclose, by priority |
//! | `cutouts` | cut-outs | primitives with holes, and their images |
//! | `camera` | the view, pinhole or thin lens | the ray generator |
//! | [`wavecrest_core::accel`] | the geometry | the tree |
//!
//! What the plan skips goes no further than the census: lights that reach nothing in view, textures
//! and normals that nothing shows, shapes that no ray can meet.
//!
//! Only this module and [`crate`] know the world; later stages never query it.

mod backs;
pub mod bounds;
pub(crate) mod camera;
pub(crate) mod census;
pub(crate) mod classes;
pub(crate) mod cutouts;
pub(crate) mod frame;
pub(crate) mod geometry;
pub(crate) mod lights;
pub mod looks;
pub(crate) mod materials;
mod met;
pub mod overrides;
pub(crate) mod reach;
mod solids;
pub(crate) mod textures;
mod unseen;
pub(crate) mod view;

use std::path::{Path, PathBuf};

use hecs::World;

use crate::components::{Sky, SurfaceComponents};
use crate::environment;
use crate::lights::Surroundings;
use crate::query;
use crate::surface::{Columns, OCCLUSION_MAP};
use geometry::{Occurrence, ShapeOutput};
use reach::Faces;
use textures::Images;
use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_base::memory::Stage;
use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::plan::schedule::{PASSES, Pass, Step};
use wavecrest_core::plan::{Effect, Plan};
use wavecrest_core::prepared::{Appearance, Dropped, PreparedScene};

/// The scene without its tree, sufficient to predict a render.
#[derive(Debug)]
pub struct Extracted {
    scene: PreparedScene,
    /// The scene's file, for messages.
    file: PathBuf,
}

/// Options for preparing a scene.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// The precision of hits.
    pub precision: Precision,
    /// The table of the plan: [`PASSES`], or the result of
    /// [`unplanned`](wavecrest_core::plan::schedule::unplanned), which skips nothing: neither
    /// passes and columns nor lights, textures, normals and shapes that nothing shows.
    pub passes: &'a [Pass],
    /// Whether a mesh with several instances is copied for each instead of stored once.
    pub flat: bool,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self { precision: Precision::default(), passes: &PASSES, flat: false }
    }
}

/// Runs every system but the last. It takes the `world`, whose meshes are moved.
///
/// # Errors
/// If the world lacks a camera or settings, a shape is too far out or too large, or an image cannot
/// be read.
pub fn extract(world: World, options: Options<'_>) -> Result<Extracted> {
    Stage::Extract.begin();
    let world = &world;
    let Options { precision, passes, flat } = options;
    let settings = query::settings(world)?;
    let file = settings.file.clone();
    let origin = frame::run(world, precision)?;
    let mut images = Images::default();
    let skips = passes.iter().any(|pass| pass.step == Step::Shadow && !pass.needs.is_empty());
    // Fast precision has no error bounds, so nothing is certain.
    let is_certain = skips && precision != Precision::Fast;
    let cameras = if is_certain { camera::places(world, origin)? } else { Vec::new() };
    let around = met::Scene { world, settings: &settings, origin, cameras: &cameras };
    let meet = |all: &mut [Occurrence<'_>]| met::run(&around, all, &mut images);
    let [mut extracted, mut unseen] =
        geometry::run(world, origin, flat, meet).map_err(|e| e.in_file(&file))?;
    extracted.geometry.set_precision(precision);
    unseen.geometry.set_precision(precision);
    let mut columns = world.query::<Columns<'_>>();
    let columns = columns.view();
    let surface = |shape: &ShapeOutput| SurfaceComponents::of(&columns, shape.entity);
    let surfaces: Vec<SurfaceComponents<'_>> = extracted.shapes.iter().map(surface).collect();
    let materials = materials::run(&surfaces, &extracted.shapes);
    let resolution = || camera::resolution(&cameras, &extracted.geometry);
    let around = Surroundings {
        settings: &settings,
        extracted: &extracted,
        unseen: &unseen,
        origin,
        resolution: &resolution,
    };
    let lights = lights::run(world, &around)?;
    let ambient = settings.ambient as f32 * lights.len() as f32;
    let sky = world.query::<&Sky>().iter().next().copied();
    let only_color = environment::only_color(world, &mut images, &file);
    let hemisphere = sky.map(|sky| sky.hemisphere(world, only_color));
    let possible = materials::possible(&surfaces, &materials);
    let shows_others = |shape: usize, faces: Faces| {
        extracted.shapes[shape].is_transparent
            || faces.any() && settings.bounces > 0 && possible[shape].kr > 0.0
    };
    let in_view = view::run(&cameras, &extracted, shows_others);
    let census = census::Census {
        world,
        surfaces: &surfaces,
        settings: &settings,
        extracted: &extracted,
        materials: &possible,
        lights: &lights,
        has_ambient: ambient > 0.0,
        is_even: only_color.is_some(),
        resolution: &resolution,
        hemisphere: hemisphere.as_ref(),
        in_view: &in_view,
    };
    let mut masks = cutouts::Masks::of_scene(&file);
    let has_holes = |asked: &[bool]| cutouts::look(&surfaces, asked, &extracted, &mut masks);
    let occludes = |shape: usize| {
        let SurfaceComponents { maps, place, .. } = &surfaces[shape];
        let texture = maps.occlusion.as_ref().and_then(|map| map.texture.as_ref());
        let place = (&*file, *place, OCCLUSION_MAP);
        texture.map_or(Ok(true), |texture| Ok(!images.is_one(texture, None, place)?))
    };
    let found = census::run(census, has_holes, occludes)?;
    let plan = Plan::of(found.decisions.clone(), passes);
    let schedule = plan.schedule();
    let lights = lights::keep(world, &settings, schedule, lights, &found)?;
    let shapes = &mut extracted.shapes;
    let classes = classes::run(&surfaces, &materials, schedule, &found, &mut images, shapes);
    let solids = solids::run(&surfaces, &classes, &extracted.geometry, &mut extracted.shapes);
    extracted.pass(&found.transparent);
    let has_environment = plan.has(Effect::Environment);
    let environment = if has_environment { environment::system(world, &mut images) } else { None };
    let background = only_color.filter(|_| !has_environment).unwrap_or(settings.background);
    let images = images.prepare(&file)?;
    let mut hemisphere = hemisphere.filter(|_| plan.has(Effect::HemisphereLight));
    if let (Some(light), Some(environment)) = (&mut hemisphere, &environment)
        && sky.is_some_and(|sky| sky.sky.is_none())
    {
        *light = environment::ambient(environment, &images, light.traced)?;
    }
    let cutouts = cutouts::run(&surfaces, &found.holes, &masks, &mut extracted);
    extracted.drop_unused(schedule, &in_view, &classes);
    let (camera, path) = camera::run(world, origin, schedule)?;
    let geometry::Output { geometry, shapes, meshes } = extracted;
    let appearance = Appearance {
        shapes: shapes.into_iter().map(|output| output.shape).collect(),
        classes,
        places: surfaces.iter().map(|surface| surface.place.to_owned()).collect(),
        names: surfaces.iter().map(|surface| surface.name.map(|name| name.0.clone())).collect(),
        meshes,
        images,
        cutouts,
    };
    let scene = PreparedScene {
        plan,
        origin,
        camera,
        path,
        accel: Accel::unbuilt(geometry),
        appearance,
        lights,
        background: background.as_vec3(),
        ambient,
        hemisphere,
        environment,
        solids,
        bounces: if schedule.goes_on() { settings.bounces } else { 0 },
        dropped: Dropped::default(),
    };
    Ok(Extracted { scene, file })
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

    /// Number of pixels of the whole image.
    pub fn pixels(&self) -> u64 {
        self.scene.camera.size().map(u64::from).iter().product()
    }

    /// Upper bound on the rays of a render, from which the preset is chosen.
    pub fn expected_rays(&self) -> u64 {
        self.scene.expected_rays()
    }

    /// The preset that is likely to finish first.
    pub fn preset(&self) -> Preset {
        Preset::choose(self.geometry().held() as u64, self.expected_rays())
    }

    /// Counts of dropped parts, from a pass over every triangle.
    pub fn dropped(&self) -> Dropped {
        Dropped { degenerate: self.scene.accel.left_out() }
    }

    /// The scene's file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Builds the tree: the last system.
    pub fn build(mut self, preset: Preset) -> PreparedScene {
        Stage::Build.begin();
        self.scene.accel.rebuild(preset);
        self.scene.dropped = self.dropped();
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
    let message = match scene.dropped.degenerate {
        0 => return None,
        1 => "1 triangle has no area and is left out".to_owned(),
        n => format!("{n} triangles have no area and are left out"),
    };
    Some(Warning::from_error(&Error::new(ErrorKind::Mesh, message).in_file(file)))
}
