//! The log entries of a render, stage by stage.

use std::path::Path;

use super::Reporter;
use crate::render::args::RenderArgs;
use wavecrest_base::error::Error;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::math::simd::Level;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::Rendered;
use wavecrest_report::bench::Machine;
use wavecrest_report::statistics::{Bvh, Time};
use wavecrest_scene::systems::Extracted;

/// A million.
const MILLION: f64 = 1e6;

impl Reporter {
    /// The program and the machine.
    pub(in crate::render) fn started(&self, args: &RenderArgs, command: &str) {
        self.note("program", || format!("wavecrest {}: {command}", env!("CARGO_PKG_VERSION")));
        self.note("machine", || {
            let Machine { processor, cores, threads, os, .. } = Machine::this();
            let processor = processor.unwrap_or_else(|| "unknown processor".to_owned());
            format!("{processor}, {cores} cores, {os}; {threads} threads")
        });
        self.note("choice", || {
            let best = if args.search.simd == Level::best() { " (the best available)" } else { "" };
            format!(
                "{} tracer, {} precision, instructions {}{best}, kernel {}, seed {}",
                args.tracer,
                args.scene_options.precision,
                args.search.simd.name(),
                args.search.kernel.name(),
                args.seed
            )
        });
    }

    /// The scene, and its simulated effects.
    pub(in crate::render) fn loaded(&self, extracted: &Extracted, seconds: f64) {
        let (scene, geometry) = (extracted.scene(), extracted.geometry());
        self.note("load", || {
            let [width, height] = scene.camera.size();
            let [spheres, disks] = geometry.spheres_and_disks();
            format!(
                "{}: {width} x {height} pixels, rays per pixel: {}; triangles: {}, quads: {}, spheres: {spheres}, \
                 disks: {disks}, lights: {}; {seconds:.3} s",
                extracted.file().display(),
                scene.camera.rays_per_pixel(),
                geometry.triangles.len(),
                geometry.quads.len(),
                scene.lights.len()
            )
        });
        for decision in scene.plan.decisions() {
            let sign = if decision.present { '+' } else { '-' };
            self.note("effect", || {
                format!("{sign} {}: {}", decision.effect.name(), decision.reason)
            });
        }
    }

    /// The tree, and the reason for its preset.
    pub(in crate::render) fn built(
        &self,
        args: &RenderArgs,
        scene: &PreparedScene,
        preset: Preset,
        seconds: f64,
    ) {
        let asked = args.scene_options.bvh.is_some();
        self.note("choice", || {
            let why = if asked { "chosen with --bvh" } else { "from triangles and expected rays" };
            format!("tree {}: {why}", preset.name())
        });
        self.note("build", || {
            let Bvh { nodes, depth, bytes, .. } = Bvh::of(&scene.accel, preset);
            format!("{nodes} nodes, depth {depth}, {bytes} bytes, in {seconds:.3} s")
        });
    }

    /// The rays, and the chunks of trees that they built.
    pub(in crate::render) fn traced(
        &self,
        rendered: &Rendered,
        scene: &PreparedScene,
        seconds: f64,
    ) {
        let counters = &rendered.counters;
        let kinds = [counters.primary_rays, counters.secondary_rays, counters.shadow_rays];
        self.note("trace", || {
            let [primary, secondary, shadow] = kinds;
            let speed = kinds.iter().sum::<u64>() as f64 / seconds.max(f64::MIN_POSITIVE) / MILLION;
            format!(
                "{primary} camera rays, {secondary} mirror rays, {shadow} shadow rays, \
                 in {seconds:.3} s: {speed:.2} million a second"
            )
        });
        if let Some([built, all]) = scene.accel.chunks() {
            self.note("trace", || format!("{built} of {all} chunks of the tree built"));
        }
        if counters.invalid > 0 {
            self.note("warning", || format!("{} samples were not finite", counters.invalid));
        }
    }

    /// The files, and totals.
    pub(in crate::render) fn wrote(&self, files: &[&Path], time: &Time) {
        for file in files {
            let bytes = file.metadata().map_or(0, |data| data.len());
            self.note("write", || format!("{}: {bytes} bytes", file.display()));
        }
        self.note("done", || format!("write {:.3} s, all {:.3} s", time.write, time.total));
    }

    /// The error that ended the command.
    pub(in crate::render) fn failed(&self, error: &Error) {
        self.note("error", || error.to_string());
    }
}
