//! A scene on its way to images: it is read, its tree is built, and then it is traced once for each image.

use std::time::Instant;

use super::args::RenderArgs;
use super::image::{Outcome, find_invalid, interrupted, render_image, share};
use super::outputs::Outputs;
use crate::common::{grouped, seconds, tell_all};
use crate::interrupt;
use crate::progress::{Display, Phase, Style};
use wavecrest_api::session::Session;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::memory;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::counters::Counters;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::Rendered;
use wavecrest_image::write::check_size;
use wavecrest_report::statistics::Time;

/// A scene that is ready to be traced, and what the finished images of the command took.
pub(super) struct Renderer<'a> {
    pub(super) args: &'a RenderArgs,
    pub(super) progress: Display,
    start: Instant,
    /// The number of frames, unless there is one image.
    frames: Option<usize>,
    /// Whether each frame has files of its own.
    numbered: bool,
    finished: usize,
    rays: u64,
    traced_seconds: f64,
    pub(super) scene: PreparedScene,
    /// The preset of its tree.
    pub(super) preset: Preset,
    /// The seconds of its stages.
    pub(super) time: Time,
}

impl<'a> Renderer<'a> {
    /// Loads the scene, none of whose files may be among the `outputs`, builds its tree, and does the `job`: one image, or so
    /// many frames. All on the requested threads, with the progress shown.
    ///
    /// # Errors
    /// If it cannot be loaded or prepared, or the job fails.
    pub(super) fn run(
        args: &'a RenderArgs,
        outputs: &[&Outputs<'_>],
        frames: Option<usize>,
        job: impl FnOnce(Self) -> Result<()> + Send,
    ) -> Result<()> {
        let progress = Display::new(args.progress, args.scene_options.quiet);
        args.number.inspect(|&[number, all]| progress.frame(number, all));
        args.scene_options.threads.run(|| job(Self::begin(args, outputs, frames, progress)?))
    }

    fn begin(
        args: &'a RenderArgs,
        outputs: &[&Outputs<'_>],
        frames: Option<usize>,
        progress: Display,
    ) -> Result<Self> {
        let (options, start) = (&args.scene_options, Instant::now());
        let mut time = Time::default();
        progress.begin(Phase::Load);
        let files: Vec<_> = outputs.iter().flat_map(|outputs| outputs.files()).collect();
        let mut loaded = options.read(&args.scene)?;
        files.iter().try_for_each(|output| loaded.check_apart(output))?;
        tell_all(&mut loaded.warnings, &mut loaded.notes, options.quiet);
        let mut session = Session::of(loaded, &args.preparing(), |_| {
            time.load = start.elapsed().as_secs_f64();
            progress.begin(Phase::Build);
            Ok(())
        })?;
        tell_all(&mut session.warnings, &mut session.notes, options.quiet);
        let Session { scene, preset, transfer, seconds: [_, build], .. } = session;
        time.build = build;
        outputs.iter().for_each(|outputs| outputs.made_of(transfer));
        let numbered = frames == Some(outputs.len());
        let mut renderer = Self {
            args,
            progress,
            start,
            frames,
            numbered,
            finished: 0,
            rays: 0,
            traced_seconds: 0.0,
            scene,
            preset,
            time,
        };
        files.iter().try_for_each(|output| check_size(output, renderer.size()))?;
        args.frame.map_or(Ok(()), |frame| renderer.place(frame))?;
        // Until here there was nothing to lose: a signal ended the process.
        interrupt::record();
        Ok(renderer)
    }

    /// Adds a render with its seconds.
    pub(super) fn add(&mut self, counters: &Counters, seconds: f64) {
        self.finished += 1;
        self.rays += counters.rays.all();
        self.traced_seconds += seconds;
    }

    /// Moves the camera to `frame`.
    ///
    /// # Errors
    /// If it has no path, or its position coincides with its look-at point.
    pub(super) fn place(&mut self, frame: u32) -> Result<()> {
        let file = &self.args.scene;
        let at =
            |message: &str| Error::new(ErrorKind::Scene, message).in_file(file).at("camera.path");
        let Some(path) = &self.scene.path else {
            return Err(at("the camera does not move")
                .remedy("add a path: \"path\": {\"keys\": [{\"frame\": 1, \"location\": ...}, ...]}; a mesh or a glTF file has --turntable"));
        };
        self.scene.camera = path.at(frame).ok_or_else(|| {
            at("the camera would be at the point it looks at")
                .value(format!("frame {frame}"))
                .remedy("move the keys before or after it")
        })?;
        Ok(())
    }

    /// Renders what the camera sees now.
    ///
    /// # Errors
    /// If a signal ended the render, or a sample is not finite and that is an error.
    pub(super) fn render(&mut self, outputs: &Outputs<'_>) -> Result<Outcome> {
        if let Some(frames) = self.frames {
            if interrupt::signal().is_some() {
                return Err(self.interrupted(frames, 0.0, outputs));
            }
            self.progress.frame(self.finished as u64 + 1, frames as u64);
        }
        let (progress, scene, start) = (&self.progress, &mut self.scene, self.start);
        let aimed = || render_image(outputs, progress, scene, start);
        let outcome = timed(&mut self.time.trace, aimed)?;
        let Rendered { counters, finished, pass_seconds, .. } = &outcome.rendered;
        if !finished {
            return Err(match self.frames {
                None => interrupted(outputs, &self.scene, &outcome.rendered),
                Some(frames) => self.interrupted(frames, share(&outcome.rendered), outputs),
            });
        }
        let invalid = find_invalid(self.args, &self.scene, counters)?;
        self.add(counters, self.time.trace);
        self.time.passes.clone_from(pass_seconds);
        Ok(Outcome { invalid, ..outcome })
    }

    /// The error that a signal ended the frames when this `share` of one was finished.
    fn interrupted(&self, frames: usize, share: f64, outputs: &Outputs<'_>) -> Error {
        let all = (self.finished as f64 + share) / frames as f64;
        let before = match self.finished {
            1 if self.numbered => "; the frame before it is written".to_owned(),
            2.. if self.numbered => format!("; the {} frames before it are written", self.finished),
            _ => String::new(),
        };
        interrupt::error(all).remedy(outputs.untouched() + &before)
    }

    /// The width and height of an image in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        self.args.crop.map_or(self.scene.camera.size(), |crop| [crop.width, crop.height])
    }

    /// Writes the files of an image.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub(super) fn write(&mut self, outputs: &Outputs<'_>, rendered: &Rendered) -> Result<()> {
        self.progress.begin(Phase::Write);
        timed(&mut self.time.write, || outputs.write(&self.scene, rendered))?;
        self.time.total = self.start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Shows the end, and prints the line after success: `name` is the output, `what` its size.
    pub(super) fn finish(&self, name: &str, what: &str) {
        self.progress.begin(Phase::Done);
        // With lines of JSON standard error is for programs.
        if self.args.progress == Style::Json {
            return;
        }
        let [traced, all] = [self.traced_seconds, self.start.elapsed().as_secs_f64()].map(seconds);
        let frames = self.frames.map_or_else(String::new, |frames| format!("{frames} frames, "));
        // The passes of `--as` count no rays.
        let rays = (self.rays > 0).then(|| format!("  {} rays", grouped(self.rays)));
        let memory =
            memory::peak().map(|bytes| format!("  {} MB", grouped(bytes.div_ceil(1_000_000))));
        let (rays, memory) = (rays.unwrap_or_default(), memory.unwrap_or_default());
        self.args.say(&format!(
            "{name}  {frames}{what}{rays}  {traced} s traced, {all} s in all{memory}"
        ));
    }
}

/// The size of an image in words.
pub(super) fn in_pixels([width, height]: [u32; 2]) -> String {
    format!("{width}x{height}")
}

/// Runs `work` and records its seconds.
fn timed<R>(seconds: &mut f64, work: impl FnOnce() -> R) -> R {
    let start = Instant::now();
    let result = work();
    *seconds = start.elapsed().as_secs_f64();
    result
}
