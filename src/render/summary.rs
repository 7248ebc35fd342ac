//! What a render says of itself on success: the line that it prints, and its statistics as JSON.

use std::path::Path;
use std::time::Instant;

use serde_json::json;

use super::args::RenderArgs;
use super::goal::Traced;
use super::ready::Ready;
use crate::common::{grouped, seconds, tell, to_json, write_text};
use crate::progress::Style;
use wavecrest_base::error::Result;
use wavecrest_core::counters::Counters;
use wavecrest_core::probe::Invalid;
use wavecrest_core::render::TracerKind;
use wavecrest_report::expected::Estimated;
use wavecrest_report::statistics::{Bvh, KernelUse, Memory, Rays, Samples, Tests, Textures};
use wavecrest_scene::memory;

/// The totals so far.
pub(super) struct Totals {
    start: Instant,
    rays: u64,
    traced_seconds: f64,
}

impl Totals {
    /// Empty totals of a command that began at `start`.
    pub(super) fn since(start: Instant) -> Self {
        Self { start, rays: 0, traced_seconds: 0.0 }
    }

    /// Adds a render with its seconds.
    pub(super) fn add(&mut self, counters: &Counters, seconds: f64) {
        self.rays += Rays::from(counters).all();
        self.traced_seconds += seconds;
    }

    /// Prints the line, unless notes are silenced or standard error is for programs: `name` is the
    /// output, `what` its size.
    pub(super) fn print(&self, args: &RenderArgs, name: &str, what: &str) {
        if args.scene_options.quiet || args.progress == Style::Json {
            return;
        }
        tell(&self.line(name, what, self.start.elapsed().as_secs_f64(), memory::peak()));
    }

    fn line(&self, name: &str, what: &str, all_seconds: f64, peak: Option<u64>) -> String {
        let [traced, all] = [self.traced_seconds, all_seconds].map(seconds);
        let memory = peak.map(|bytes| format!("  {} MB", grouped(bytes.div_ceil(1_000_000))));
        // The passes of `--as` count no rays.
        let rays = (self.rays > 0).then(|| format!("  {} rays", grouped(self.rays)));
        let (rays, memory) = (rays.unwrap_or_default(), memory.unwrap_or_default());
        format!("{name}  {what}{rays}  {traced} s traced, {all} s in all{memory}")
    }
}

/// Writes the statistics to `file`.
///
/// # Errors
/// If it cannot be written.
pub(super) fn write_statistics(
    file: &Path,
    args: &RenderArgs,
    ready: &Ready,
    traced: &Traced,
    invalid: Option<Invalid>,
) -> Result<()> {
    let Ready { scene, time, estimated, predicted, .. } = ready;
    let Traced { rendered, preset, goal, resumed } = traced;
    let counters = &rendered.counters;
    let film = &rendered.film;
    let has_columns = args.tracer == TracerKind::Wavefront;
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
        "rays": Rays::from(counters),
        "samples": Samples::from(counters),
        "textures": Textures::from(&scene.appearance),
        "estimated": Estimated::of(scene, film.pixels().len() as u64),
        "tests": Tests::from(counters),
        "kernels": KernelUse::from(counters),
        "dropped": scene.dropped,
        "invalid": counters.invalid,
        "first_invalid": invalid,
        "lights_at_surface": counters.lights_at_surface,
        "cut_short": counters.cut_short,
        "time": time,
        "memory": Memory {
            predicted: estimated.as_ref().map_or(0, |estimated| estimated.total()),
            peak: memory::peak(),
        },
        "columns": {
            "estimated": if has_columns { predicted.batches } else { 0 },
            "held": rendered.columns,
        },
        "bvh": Bvh::of(&scene.accel, *preset),
        "goal": goal,
        "resumed": resumed,
        "plan": scene.plan,
    });
    write_text(file, &to_json(&statistics)?)
}
