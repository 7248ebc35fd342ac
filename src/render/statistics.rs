//! The statistics of a render, as JSON.

use std::path::Path;

use super::args::RenderArgs;
use super::goal::Traced;
use crate::common::{to_json, write_text};
use wavecrest_base::error::Result;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::probe::Invalid;
use wavecrest_core::render::{Rendered, TracerKind};
use wavecrest_report::estimate::Estimated;
use wavecrest_report::statistics::{Bvh, Columns, ImageSize, Memory, Statistics, Time};
use wavecrest_scene::memory::{self, Estimate};

/// A finished render.
pub(super) struct Finished<'a> {
    pub(super) scene: &'a PreparedScene,
    pub(super) traced: Traced,
    pub(super) invalid: Option<Invalid>,
    pub(super) time: Time,
    /// The estimated memory before the scene was read.
    pub(super) estimated: Option<Estimate>,
    /// The estimated memory after it was read.
    pub(super) predicted: Estimate,
}

/// Writes the statistics to `file`.
///
/// # Errors
/// If it cannot be written.
pub(super) fn write(file: &Path, args: &RenderArgs, finished: Finished<'_>) -> Result<()> {
    write_text(file, &to_json(&of(args, finished))?)
}

fn of(args: &RenderArgs, finished: Finished<'_>) -> Statistics {
    let Finished { scene, traced, invalid, time, estimated, predicted } = finished;
    let Traced { rendered, preset, goal, resumed } = traced;
    let counters = &rendered.counters;
    Statistics {
        version: env!("CARGO_PKG_VERSION"),
        scene: args.scene.display().to_string(),
        tracer: args.tracer,
        threads: rayon::current_num_threads(),
        seed: args.seed,
        simd: args.search.simd,
        kernel: args.search.kernel,
        precision: args.scene_options.precision,
        image: image(scene, &rendered),
        rays: counters.into(),
        samples: counters.into(),
        textures: (&scene.appearance).into(),
        estimated: Estimated::of(scene, rendered.film.pixels().len() as u64),
        tests: counters.into(),
        kernels: counters.into(),
        dropped: scene.dropped,
        invalid: counters.invalid,
        first_invalid: invalid,
        lights_at_surface: counters.lights_at_surface,
        time,
        memory: Memory {
            predicted: estimated.map_or(0, |estimated| estimated.total()),
            peak: memory::peak(),
        },
        columns: columns(args, &predicted, &rendered),
        bvh: Bvh::of(&scene.accel, preset),
        goal,
        resumed,
        plan: scene.plan.clone(),
    }
}

fn image(scene: &PreparedScene, rendered: &Rendered) -> ImageSize {
    ImageSize {
        width: rendered.film.width(),
        height: rendered.film.height(),
        samples_per_pixel: scene.camera.rays_per_pixel(),
    }
}

fn columns(args: &RenderArgs, predicted: &Estimate, rendered: &Rendered) -> Columns {
    let has_columns = args.tracer == TracerKind::Wavefront;
    let estimated = if has_columns { predicted.batches } else { 0 };
    Columns { estimated, held: rendered.columns }
}
