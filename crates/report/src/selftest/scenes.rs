//! Built-in scenes, rendered in every way.

use std::path::Path;

use super::prelude::*;
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::film::Film;
use wavecrest_core::math::simd::Level;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, TracerKind, render};
use wavecrest_image::compare::compare;
use wavecrest_scene::load::{LoadOptions, load};
use wavecrest_scene::systems::{self, Extracted};

/// The longer side of an image in pixels, and the most rays of one; scenes with many samples are
/// smaller.
const LONGEST: f64 = 32.0;
const MOST_RAYS: f64 = 20_000.0;

/// A batch that is no multiple of a vector.
const ODD_BATCH: usize = 13;

/// Renders a scene by every kernel and tracer at every instruction level: all images must be equal.
/// Returns the hash of their bits.
pub(super) fn exact(effort: &Effort, file: &Path) -> (Outcome, u64) {
    match prepared(effort, file).and_then(|scene| every_image(effort, scene)) {
        Ok((outcome, film)) => (outcome, hash(film.pixels().iter().flatten().map(|x| x.to_bits()))),
        Err(error) => (Outcome::of(false, || error.to_string()), 0),
    }
}

/// The scene at a small size.
fn prepared(effort: &Effort, file: &Path) -> Result<PreparedScene> {
    let extracted = |size: [Option<u32>; 2]| -> Result<Extracted> {
        let [width, height] = size;
        let loaded = load(file, &LoadOptions { width, height, ..LoadOptions::default() })?;
        let options = systems::SceneOptions { precision: effort.precision, ..Default::default() };
        systems::extract(loaded.world, options)
    };
    let whole = extracted([None; 2])?;
    let size = whole.scene().camera.size().map(f64::from);
    let rays_a_pixel = whole.scene().expected_rays() as f64 / (size[0] * size[1]);
    let longest = LONGEST.min((MOST_RAYS / rays_a_pixel).sqrt());
    let scale = (longest / size[0].max(size[1])).min(1.0);
    let small = extracted(size.map(|side| Some((side * scale).round().max(1.0) as u32)))?;
    let preset = small.preset();
    Ok(small.build(preset))
}

fn every_image(effort: &Effort, mut scene: PreparedScene) -> Result<(Outcome, Film)> {
    let batch = RenderOptions::default().batch;
    let wavefront = |kernel| (TracerKind::Wavefront, kernel, batch);
    let ways = KernelChoice::ALL.map(wavefront).into_iter().chain([
        (TracerKind::Wavefront, KernelChoice::Auto, ODD_BATCH),
        (TracerKind::Recursive, KernelChoice::Auto, batch),
    ]);
    let render = |scene: &PreparedScene, tracer, batch| {
        let options = RenderOptions { tracer, seed: effort.seed, batch, ..Default::default() };
        render(scene, &options, &()).map(|rendered| rendered.film)
    };
    let (mut outcome, first) = (Outcome::default(), render(&scene, TracerKind::Wavefront, batch)?);
    for level in Level::available() {
        let Some(token) = level.token() else { continue };
        scene.accel.level = token;
        for (tracer, kernel, batch) in ways.clone() {
            scene.accel.kernel = kernel;
            let found = render(&scene, tracer, batch)?;
            outcome.check(found.same_bits(&first), || {
                let pixels = compare(&first, &found).map_or(0, |found| found.different_pixels);
                let way = [level.name(), tracer.name(), kernel.name()].join(" ");
                format!("{way}: {pixels} pixels differ from those of the first way")
            });
        }
    }
    Ok((outcome, first))
}
