//! The log: a line for each action, choice and result, with the seconds since the start; and what it says, stage by stage.
//!
//! Lines are appended at once, so that those of a killed render are kept, and those of earlier
//! renders stay. A log that can no longer be written, on a full disk, does not end a render. Lines are
//! never added to a file that is no log, such as a mesh.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use crate::image_options::command;
use crate::render::args::RenderArgs;
use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::math::simd::Level;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::Rendered;
use wavecrest_report::bench::Machine;
use wavecrest_report::statistics::{Bvh, Rays, Time};
use wavecrest_scene::systems::Extracted;

/// The destination of lines.
type LogSink = Box<dyn Write + Send>;

/// A log, if requested.
pub(in crate::render) struct Log {
    start: Instant,
    sink: Option<Mutex<LogSink>>,
}

impl Log {
    /// Opens the file, or standard output for `-`.
    ///
    /// # Errors
    /// If it cannot be written to, or holds something other than a log.
    pub(super) fn open(file: Option<&Path>) -> Result<Self> {
        let open = |file: &Path| -> Result<LogSink> {
            if file == Path::new("-") {
                return Ok(Box::new(std::io::stdout()));
            }
            let failed = |e| {
                Error::io("cannot write the log", file, e).remedy("use a file that you can write")
            };
            check_is_log(file, failed)?;
            let opened = OpenOptions::new().append(true).create(true).open(file);
            Ok(Box::new(opened.map_err(failed)?))
        };
        let sink = file.map(open).transpose()?.map(Mutex::new);
        Ok(Self { start: Instant::now(), sink })
    }

    /// Adds a line; its text is computed only if there is a log.
    pub(in crate::render) fn note(&self, topic: &str, text: impl FnOnce() -> String) {
        let Some(sink) = &self.sink else { return };
        let seconds = self.start.elapsed().as_secs_f64();
        let text = text().replace(char::is_control, " ");
        let line = format!("{seconds:10.3}{UNIT}{topic:<8} {text}\n");
        let mut sink = sink.lock().unwrap_or_else(PoisonError::into_inner);
        // In one write, so that the lines of two processes do not mix.
        let _ = sink.write_all(line.as_bytes()).and_then(|()| sink.flush());
    }

    /// The program and the machine.
    pub(in crate::render) fn started(&self, args: &RenderArgs) {
        let version = env!("CARGO_PKG_VERSION");
        self.note("program", || format!("wavecrest {version}: {}", command()));
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
        let is_chosen = args.scene_options.bvh.is_some();
        self.note("choice", || {
            let why =
                if is_chosen { "chosen with --bvh" } else { "from triangles and expected rays" };
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
        let rays = Rays::from(counters);
        self.note("trace", || {
            let speed = rays.all() as f64 / seconds.max(f64::MIN_POSITIVE) / 1e6;
            let Rays { primary, secondary, shadow } = rays;
            format!(
                "{primary} camera rays, {secondary} secondary rays, {shadow} shadow rays, \
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
    pub(in crate::render) fn wrote(&self, files: &[PathBuf], time: &Time) {
        for file in files {
            let bytes = file.metadata().map_or(0, |data| data.len());
            self.note("write", || format!("{}: {bytes} bytes", file.display()));
        }
        self.note("done", || format!("write {:.3} s, all {:.3} s", time.write, time.total));
    }

    /// Warnings that are printed already.
    pub(in crate::render) fn warnings(&self, warnings: &[Warning]) {
        warnings.iter().for_each(|warning| self.note("warning", || warning.to_string()));
    }
}

/// Between the seconds at the start of a line and what follows.
const UNIT: &str = " s  ";

/// Longer than the start of any line.
const START: u64 = 64;

/// Refuses a file with something else in it than a log.
fn check_is_log(file: &Path, failed: impl Fn(std::io::Error) -> Error) -> Result<()> {
    if !file.is_file() {
        return Ok(());
    }
    let mut start = Vec::new();
    File::open(file).and_then(|file| file.take(START).read_to_end(&mut start)).map_err(failed)?;
    let text = String::from_utf8_lossy(&start);
    let seconds = text.split_once(UNIT).map(|(seconds, _)| seconds.trim().parse::<f64>());
    if start.is_empty() || matches!(seconds, Some(Ok(_))) {
        return Ok(());
    }
    let error = Error::new(ErrorKind::Usage, "cannot add to the log: this file is not a log");
    Err(error.in_file(file).remedy("name a new file, or the log of an earlier render"))
}
