//! A session: a scene that is read and prepared once, and rendered as often as one likes.
//!
//! Every door opens it here: the command, its page, Python, and programs.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::goal::{Goal, Job, Reached};
use wavecrest_base::error::{Result, Warning};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Watch};
use wavecrest_scene::components::Encoding;
use wavecrest_scene::load::{LoadOptions, LoadedScene, load};
use wavecrest_scene::systems::{self, Extracted, SceneOptions};

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
        let extracted = systems::extract(loaded.world, *options)?;
        let preparing = start.elapsed().as_secs_f64();
        building(&extracted)?;
        let preset = extracted.preset();
        let start = Instant::now();
        let scene = extracted.build(preset);
        let seconds = [preparing, start.elapsed().as_secs_f64()];
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
