//! What comes before the first ray: the scene is read, and its tree built.

use std::path::Path;
use std::time::Instant;

use super::args::RenderArgs;
use super::look;
use crate::common::tell_prepared;
use crate::progress::{Display, Stage};
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_report::statistics::Time;
use wavecrest_scene::components::Encoding;
use wavecrest_scene::memory::Estimate;

/// A scene ready to be rendered.
pub(super) struct Ready {
    pub(super) scene: PreparedScene,
    /// The preset of its tree.
    pub(super) preset: Preset,
    /// Its transfer curve of 8-bit images.
    pub(super) encoding: Encoding,
    /// The seconds of the stages so far.
    pub(super) time: Time,
    /// The estimated memory before it was read, for the statistics.
    pub(super) estimated: Option<Estimate>,
    /// The estimated memory after it was read.
    pub(super) predicted: Estimate,
}

impl Ready {
    /// Loads the scene, none of whose files may be among the `outputs`, and builds its tree. `start`
    /// is the start of the command.
    ///
    /// # Errors
    /// If it cannot be loaded or prepared.
    pub(super) fn prepare(
        args: &RenderArgs,
        outputs: &[&Path],
        progress: &Display,
        start: Instant,
    ) -> Result<Self> {
        let (options, extent) = (&args.scene_options, &args.extent());
        let mut time = Time::default();
        progress.stage(Stage::Load);
        let estimate = || options.estimate(&args.scene, extent);
        let estimated = args.stats.is_some().then(estimate).transpose()?;
        let loaded = options.load(&args.scene, extent, outputs)?;
        let encoding = loaded.transfer();
        let extracted = look::extract(args, loaded)?;
        let preset = options.preset(&extracted);
        let predicted = extent.estimate(&extracted, preset);
        time.load = start.elapsed().as_secs_f64();
        progress.stage(Stage::Build);
        let mut scene = timed(&mut time.build, || options.build(extracted, preset))?;
        tell_prepared(&scene, &args.scene, options.quiet);
        args.search.apply(&mut scene.accel);
        Ok(Self { scene, preset, encoding, time, estimated, predicted })
    }
}

/// Runs `work` and records its seconds.
pub(super) fn timed<R>(seconds: &mut f64, work: impl FnOnce() -> R) -> R {
    let start = Instant::now();
    let result = work();
    *seconds = start.elapsed().as_secs_f64();
    result
}
