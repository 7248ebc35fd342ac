//! Frames of a moving camera: a single one, or a range with an image each.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::args::{Frames, RenderArgs};
use super::outputs::Outputs;
use super::ready::Ready;
use super::show::Rendering;
use super::summary::Totals;
use super::{parts, watched};
use crate::interrupt;
use crate::progress::{Display, Stage};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::Rendered;
use wavecrest_image::farm::Shard;

/// Smallest number of digits of a frame's number in the name of its image, by default.
const MIN_DIGITS: usize = 4;

/// Moves the camera to `frame`.
///
/// # Errors
/// If it has no path, or its position coincides with its look-at point.
pub(super) fn place(scene: &mut PreparedScene, frame: u32, file: &Path) -> Result<()> {
    let at = |message: &str| Error::new(ErrorKind::Scene, message).in_file(file).at("camera.path");
    let Some(path) = &scene.path else {
        return Err(at("the camera does not move")
            .remedy("add a path: \"path\": {\"keys\": [{\"frame\": 1, \"location\": ...}, ...]}; a mesh or a glTF file has --turntable"));
    };
    scene.camera = path.at(frame).ok_or_else(|| {
        at("the camera would be at the point it looks at")
            .value(format!("frame {frame}"))
            .remedy("move the keys before or after it")
    })?;
    Ok(())
}

/// The frames of a shard: each of N shards takes every N-th.
fn share(frames: Frames, shard: Option<Shard>) -> impl Iterator<Item = u32> {
    let (number, count) = shard.map_or((1, 1), |shard| (shard.number(), shard.count()));
    frames.skip(number as usize - 1).step_by(count as usize)
}

/// Renders the frames of a range, or of the shard's share of it.
///
/// # Errors
/// If one cannot be rendered or written: those before it are complete then.
pub(super) fn run(args: &RenderArgs, frames: Frames, shard: Option<Shard>) -> Result<()> {
    let paths = args.paths()?;
    let of_frame = |frame| {
        let paths = paths.iter().map(|path| numbered(path, frame)).collect();
        Ok((frame, Outputs::check(args, paths, false)?))
    };
    let all: Vec<(u32, Outputs<'_>)> = share(frames, shard).map(of_frame).collect::<Result<_>>()?;
    watched(args, |progress| {
        let files: Vec<&Path> = all.iter().flat_map(|(_, outputs)| outputs.all()).collect();
        let mut sequence = Sequence::prepare(args, &files, all.len(), progress)?;
        sequence.numbered = true;
        let mut size = [0; 2];
        for (frame, outputs) in &all {
            let rendered = sequence.frame(*frame, outputs)?;
            progress.stage(Stage::Write);
            outputs.write(&sequence.ready.scene, &rendered)?;
            size = [rendered.film.width(), rendered.film.height()];
        }
        progress.stage(Stage::Done);
        sequence.finish(args, &args.output()?.display().to_string(), size);
        Ok(())
    })
}

/// A scene of which several frames are rendered.
pub(super) struct Sequence<'a> {
    args: &'a RenderArgs,
    progress: &'a Display,
    pub(super) ready: Ready,
    summary: Totals,
    /// The number of frames to render, and of those that are finished.
    frames: usize,
    finished: usize,
    /// Whether each has files of its own.
    numbered: bool,
}

impl<'a> Sequence<'a> {
    /// Loads the scene, none of whose files may be among the `outputs`, and builds its tree, for this number of `frames`.
    ///
    /// # Errors
    /// If it cannot be loaded or prepared.
    pub(super) fn prepare(
        args: &'a RenderArgs,
        outputs: &[&Path],
        frames: usize,
        progress: &'a Display,
    ) -> Result<Self> {
        let start = Instant::now();
        let ready = Ready::prepare(args, outputs, progress, start)?;
        interrupt::record();
        let summary = Totals::since(start);
        Ok(Self { args, progress, ready, summary, frames, finished: 0, numbered: false })
    }

    /// Renders a frame.
    ///
    /// # Errors
    /// If the camera has no such frame, or a signal ended the render.
    pub(super) fn frame(&mut self, frame: u32, outputs: &Outputs<'_>) -> Result<Rendered> {
        place(&mut self.ready.scene, frame, &self.args.scene)?;
        self.trace(outputs)
    }

    /// What is rendered of the same work, for [`Sequence::go_on`].
    pub(super) fn so_far(self) -> (Totals, usize) {
        (self.summary, self.finished)
    }

    /// Counts what is rendered already.
    pub(super) fn go_on(&mut self, (summary, finished): (Totals, usize)) {
        (self.summary, self.finished) = (summary, finished);
    }

    /// Renders what the camera sees now.
    ///
    /// # Errors
    /// If a signal ended the render.
    pub(super) fn trace(&mut self, outputs: &Outputs<'_>) -> Result<Rendered> {
        outputs.made_of(self.ready.encoding);
        if interrupt::signal().is_some() {
            return Err(self.interrupted(outputs, 0.0));
        }
        self.progress.frame(self.finished as u64 + 1, self.frames as u64);
        let rendering = Rendering { args: self.args, outputs, progress: self.progress };
        let (rendered, _) = parts::trace(&rendering, &self.ready.scene, None)?;
        if !rendered.finished {
            return Err(self.interrupted(outputs, parts::share(&rendered)));
        }
        self.args.scene_options.check_taken(&self.args.scene)?;
        let first = parts::find_invalid(self.args, &self.ready.scene, &rendered.counters)?;
        parts::report_invalid(&rendered.counters, first.as_ref());
        self.summary.add(&rendered.counters, rendered.seconds);
        self.finished += 1;
        Ok(rendered)
    }

    /// The error that a signal ended the render when this `share` of a frame was finished.
    fn interrupted(&self, outputs: &Outputs<'_>, share: f64) -> Error {
        let all = (self.finished as f64 + share) / self.frames as f64;
        let before = match self.finished {
            1 if self.numbered => "; the frame before it is written".to_owned(),
            2.. if self.numbered => format!("; the {} frames before it are written", self.finished),
            _ => String::new(),
        };
        interrupt::error(all).remedy(outputs.untouched() + &before)
    }

    /// Prints the line after success, with the size of the frames, or of what they are put together to.
    pub(super) fn finish(&self, args: &RenderArgs, name: &str, [width, height]: [u32; 2]) {
        let frames = self.frames;
        self.summary.print(args, name, &format!("{frames} frames, {width}x{height}"));
    }
}

/// `path` with the number of the frame: in place of the last # characters of its name, or before
/// its extension.
fn numbered(path: &Path, frame: u32) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if let Some(end) = name.rfind('#') {
        let start = name[..end].trim_end_matches('#').len();
        let width = end + 1 - start;
        let number = format!("{frame:0width$}");
        return path.with_file_name(format!("{}{number}{}", &name[..start], &name[end + 1..]));
    }
    let number = format!("{frame:0MIN_DIGITS$}");
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map(|e| format!(".{}", e.to_string_lossy()));
    path.with_file_name(format!("{stem}.{number}{}", extension.unwrap_or_default()))
}
