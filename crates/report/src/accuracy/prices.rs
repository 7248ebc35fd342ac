//! The cost of each effect: the price list of [`crate::effects`], measured for a report.

use std::path::Path;

use crate::effects::scenes::{Variant, variants};
use crate::effects::{Entry, PriceList, Setting, measure};
use crate::measure::Schedule;
use wavecrest_base::error::{Error, Result};
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::render::{RenderOptions, render};
use wavecrest_core::wavefront::DEFAULT_BATCH;
use wavecrest_scene::load::{LoadOptions, load_str};
use wavecrest_scene::systems::extract;

/// Enough rounds for intervals, in little more than a minute.
const SCHEDULE: Schedule = Schedule { warmup: 1, most: 15, seconds: 1.0 };

/// Measures the list with the default settings. Its texture is written to `folder`.
///
/// # Errors
/// If the texture cannot be written, or there is no memory for an image.
pub fn prices(folder: &Path) -> Result<PriceList> {
    let entries: Vec<Entry> = variants(folder)?
        .into_iter()
        .map(|variant| prepare(variant, folder))
        .collect::<Result<_>>()?;
    let setting = Setting {
        simd: Level::best(),
        kernel: KernelChoice::default(),
        precision: Precision::default(),
        batch: DEFAULT_BATCH,
    };
    let trace = |scene: &_, tracer| {
        render(scene, &RenderOptions { tracer, ..RenderOptions::default() }, &())
    };
    measure(&entries, setting, &SCHEDULE, trace, &mut |_, _| {})
}

fn prepare(variant: Variant, folder: &Path) -> Result<Entry> {
    let file = folder.join("effect.json");
    let mut loaded = load_str(&variant.scene.to_string(), &file, &LoadOptions::default())?;
    // The same preset for all, so that no effect has a better tree.
    let scene = extract(&mut loaded.world, Default::default())?.build(Preset::Medium);
    scene.appearance.decode()?;
    Ok(Entry { variant, scene })
}

/// A folder for the texture, deleted when dropped.
///
/// # Errors
/// If it cannot be made.
pub fn folder() -> Result<tempfile::TempDir> {
    tempfile::tempdir()
        .map_err(|e| Error::io("cannot create a folder for the texture", std::env::temp_dir(), e))
}
