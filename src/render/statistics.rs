//! The statistics of a render as JSON.

use std::path::Path;

use serde_json::json;

use super::image::Outcome;
use super::renderer::Renderer;
use crate::common::{to_json, write_text};
use wavecrest_base::error::Result;
use wavecrest_base::memory;
use wavecrest_report::statistics::{Bvh, Memory, Textures};

/// Writes the statistics to `file`.
///
/// # Errors
/// If it cannot be written.
pub(super) fn write(file: &Path, renderer: &Renderer<'_>, outcome: &Outcome) -> Result<()> {
    let Renderer { args, scene, preset, time, .. } = renderer;
    let Outcome { rendered, goal, resumed, invalid } = outcome;
    let counters = &rendered.counters;
    let film = &rendered.film;
    // [`wavecrest_report::statistics`] says what each key means.
    let statistics = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": args.scene.display().to_string(),
        "tracer": args.tracer,
        "threads": rayon::current_num_threads(),
        "seed": args.seed,
        "simd": args.search.simd,
        "kernel": args.search.kernel,
        "precision": args.scene_options.precision,
        "image": {
            "width": film.width(),
            "height": film.height(),
            "samples_per_pixel": scene.camera.rays_per_pixel(),
        },
        "rays": counters.rays,
        "samples": counters.samples,
        "textures": Textures::of(&scene.appearance),
        "tests": counters.tests,
        "kernels": counters.kernels,
        "dropped": { "degenerate": scene.degenerate },
        "invalid": counters.invalid,
        "first_invalid": invalid,
        "lights_at_surface": counters.lights_at_surface,
        "cut_short": counters.cut_short,
        "time": time,
        "memory": Memory { peak: memory::peak() },
        "columns": { "held": rendered.columns },
        "bvh": Bvh::of(&scene.accel, *preset),
        "goal": goal,
        "resumed": resumed,
        "plan": scene.plan,
    });
    write_text(file, &to_json(&statistics)?)
}
