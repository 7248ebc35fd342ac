//! A session: a scene that is read and prepared once, and rendered as often as one likes.
//!
//! Every door opens it here: the command, its page, Python, and programs.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::goal::{Goal, Job, Reached};
use wavecrest_base::error::{Result, Warning};
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::plan::schedule::{PASSES, unplanned};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Watch};
use wavecrest_image::look::Look;
use wavecrest_scene::components::Encoding;
use wavecrest_scene::load::{LoadOptions, LoadedScene, load};
use wavecrest_scene::systems::{self, Extracted, looks};

/// How a scene is prepared, once it is read. By default as for its light.
#[derive(Clone, Copy, Debug)]
pub struct SceneOptions {
    /// The precision of hits.
    pub precision: Precision,
    /// The quality of the tree; the one that is likely to finish first if `None`.
    pub bvh: Option<Preset>,
    /// Whether a mesh with several instances is copied for each.
    pub flat: bool,
    /// What images show instead of light.
    pub look: Option<Look>,
    /// Whether what light would not show is prepared, too.
    pub all: bool,
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
            all: false,
            at_once: false,
            exposure: 1.0,
            kernel: KernelChoice::default(),
            level: Level::best(),
        }
    }
}

/// A scene that is ready to be rendered.
#[derive(Debug)]
pub struct Session {
    /// The file, or what names the scene in messages.
    pub file: PathBuf,
    /// The scene. Its camera may be moved and resampled.
    pub scene: PreparedScene,
    /// The preset of its tree.
    pub preset: Preset,
    /// The transfer curve of 8-bit images, unless one is requested.
    pub transfer: Encoding,
    /// Warnings about what was read and prepared.
    pub warnings: Vec<Warning>,
    /// What is worth knowing, and no cause for concern.
    pub notes: Vec<Warning>,
    /// Seconds of preparing, and of building the tree.
    pub seconds: [f64; 2],
}

impl SceneOptions {
    /// The scene that was `loaded`, without its tree.
    ///
    /// # Errors
    /// As [`systems::extract`], or if an image is to be decoded and cannot be.
    fn extract(&self, mut loaded: LoadedScene) -> Result<Extracted> {
        match self.look {
            Some(Look::Clay) => looks::clay(&mut loaded.world),
            Some(Look::Uv) => looks::show_uvs(&mut loaded.world),
            _ => {}
        }
        let all = self.all || self.look.is_some_and(|look| !look.is_shaded());
        let passes = if all { &unplanned(&PASSES)[..] } else { &PASSES };
        let Self { precision, flat, exposure, .. } = *self;
        let options = systems::Options { precision, passes, flat, exposure };
        let extracted = systems::extract(loaded.world, options)?;
        if self.at_once {
            extracted.scene().appearance.decode()?;
        }
        Ok(extracted)
    }
}

impl Session {
    /// Reads and prepares a scene file, a glTF file or a mesh.
    ///
    /// # Errors
    /// If it cannot be read or prepared: see [`load`] and [`systems::extract`].
    pub fn open(file: &Path, loading: &LoadOptions, options: &SceneOptions) -> Result<Self> {
        Self::of(load(file, loading)?, options, |_| Ok(()))
    }

    /// Prepares a scene that is loaded. `building` is called before its tree is built, and may refuse that.
    ///
    /// # Errors
    /// As [`systems::extract`], or of `building`.
    pub fn of(
        mut loaded: LoadedScene,
        options: &SceneOptions,
        building: impl FnOnce(&Extracted) -> Result<()>,
    ) -> Result<Self> {
        let [warnings, notes] = [&mut loaded.warnings, &mut loaded.notes].map(std::mem::take);
        let (file, transfer) = (loaded.file.clone(), loaded.transfer());
        let start = Instant::now();
        let extracted = options.extract(loaded)?;
        let preparing = start.elapsed().as_secs_f64();
        building(&extracted)?;
        let usual = || match options.at_once {
            true => extracted.preset().at_once(),
            false => extracted.preset(),
        };
        let preset = options.bvh.unwrap_or_else(usual);
        let start = Instant::now();
        let mut scene = extracted.build(preset);
        let seconds = [preparing, start.elapsed().as_secs_f64()];
        scene.accel.search_by(options.kernel, options.level);
        let mut session = Self { file, scene, preset, transfer, warnings, notes, seconds };
        session.warnings.extend(systems::warnings(&session.scene, &session.file));
        session.notes.extend(systems::note(&session.scene, &session.file));
        Ok(session)
    }

    /// Renders towards a goal. `watch` may end it; `&()` does not.
    ///
    /// # Errors
    /// As [`Goal::render`].
    pub fn render(
        &mut self,
        goal: &Goal,
        options: &RenderOptions,
        watch: &dyn Watch,
    ) -> Result<Reached> {
        let passes = Goal::passes(&mut self.scene, *options, Default::default())?;
        goal.render(&mut self.scene, &passes, &Job::new(watch))
    }
}
