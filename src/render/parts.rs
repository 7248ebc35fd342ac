//! Renders that lose no work: with a checkpoint, ended by a signal, or one shard of many.

use std::path::Path;
use std::time::Instant;

use super::args::RenderArgs;
use super::show::stage::Stage;
use super::show::{Seen, Show};
use super::summary::Summary;
use super::{invalid, look};
use crate::common::tell;
use crate::interrupt::Interrupt;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{check_differs, check_replaceable};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{Rendered, Watch};
use wavecrest_core::tile::Tile;
use wavecrest_image::farm::checkpoint::Checkpoint;
use wavecrest_image::farm::{Author, Session, Shard};
use wavecrest_report::accuracy::pilot::budget::Pace;

/// The extension of a part's name.
const EXTENSION: &str = "part";

/// Runs the checks that are possible before the scene is read.
///
/// # Errors
/// If a shard would be written as an image, or the checkpoint would overwrite another file.
pub(super) fn check(args: &RenderArgs, output: &Path) -> Result<()> {
    let parts = &args.parts;
    if parts.shard.is_some() && output.extension().is_none_or(|name| name != EXTENSION) {
        return Err(Error::new(ErrorKind::Usage, "a shard must be written to a .part file")
            .in_file(output)
            .remedy("use a name such as out-1.part, and join all parts with wavecrest merge"));
    }
    let Some(file) = &parts.checkpoint else { return Ok(()) };
    check_replaceable(file)?;
    check_differs(file, output, "the output")?;
    check_differs(file, &args.scene, "the scene")?;
    if let Some(stats) = &args.stats {
        check_differs(file, stats, "the statistics")?;
    }
    parts.checkpoint().map_or(Ok(()), |checkpoint| checkpoint.check().map(drop))
}

/// Shows the render, and ends it on a signal or if it is too slow.
struct Screen<'a> {
    show: Show<'a>,
    interrupt: &'a Interrupt,
    pace: Option<&'a Pace<'a>>,
}

impl<'a> Screen<'a> {
    fn new(args: &RenderArgs, scene: &PreparedScene, seen: &Seen<'a>) -> Self {
        seen.reporter.stage(Stage::Trace);
        let show = Show::new(args, seen.outputs, scene, seen.reporter);
        Self { show, interrupt: seen.interrupt, pace: None }
    }
}

impl Watch for Screen<'_> {
    fn progress(&self, done: u64, all: u64) {
        self.show.progress(done, all);
        if let Some(pace) = self.pace {
            pace.progress(done, all);
        }
    }

    fn tile(&self, tile: &Tile, pixels: &[[f32; 3]]) {
        self.show.tile(tile, pixels);
    }

    fn cancelled(&self) -> bool {
        self.interrupt.signal().is_some() || self.pace.is_some_and(Pace::is_late)
    }
}

/// Renders the image as requested, as long as its `pace` is good enough; returns it with the share
/// that a checkpoint held (0 to 1).
pub(super) fn trace(
    args: &RenderArgs,
    scene: &PreparedScene,
    seen: &Seen<'_>,
    pace: Option<&Pace<'_>>,
) -> Result<(Rendered, f64)> {
    let screen = Screen { pace, ..Screen::new(args, scene, seen) };
    let Some(checkpoint) = args.parts.checkpoint() else {
        return look::trace(args, scene, &screen).map(|rendered| (rendered, 0.0));
    };
    let options = args.options();
    let session = Session::begin(scene, &options, author(args, seen), None, Some(&checkpoint))?;
    tell_of_checkpoint(args, &checkpoint, &session);
    let rendered = session.render(&screen, &warn)?;
    Ok((rendered, session.resumed()))
}

/// Renders a shard and writes its part.
pub(super) fn write_shard(
    args: &RenderArgs,
    shard: Shard,
    scene: &PreparedScene,
    seen: &Seen<'_>,
    mut summary: Summary,
) -> Result<()> {
    let output = seen.outputs.first();
    let (options, checkpoint) = (args.options(), args.parts.checkpoint());
    let session =
        Session::begin(scene, &options, author(args, seen), Some(shard), checkpoint.as_ref())?;
    if let Some(checkpoint) = &checkpoint {
        tell_of_checkpoint(args, checkpoint, &session);
    }
    let screen = Screen::new(args, scene, seen);
    let start = Instant::now();
    let done = session.render_units(&screen, &warn)?;
    summary.add(&done.counters, start.elapsed().as_secs_f64());
    drop(screen);
    if session.share() < 1.0 {
        let what = seen.outputs.untouched();
        return Err(seen.interrupt.error(session.share()).remedy(what + &go_on(args)));
    }
    let first = invalid::find(args, scene, &done.counters)?;
    invalid::report(&done.counters, first.as_ref());
    session.write(output)?;
    summary.print(args, &seen.outputs.name(), &format!("shard {shard}"));
    seen.reporter.note("write", || output.display().to_string());
    seen.reporter.stage(Stage::Done);
    Ok(())
}

/// Writes the finished part of an image that a signal ended, unless it would replace an older image; returns the error
/// with the progress.
pub(super) fn interrupted(
    args: &RenderArgs,
    scene: &PreparedScene,
    rendered: &Rendered,
    seen: &Seen<'_>,
) -> Error {
    let share = share(rendered);
    let error = seen.interrupt.error(share);
    let written = if share == 0.0 {
        seen.outputs.untouched()
    } else {
        let entries = seen.outputs.entries(scene);
        match entries.and_then(|e| seen.outputs.write_unfinished(&rendered.film, &e, share)) {
            Ok(words) => words,
            Err(error) => return error,
        }
    };
    error.remedy(written + &go_on(args))
}

/// The finished share of an image, from 0 to 1.
pub(super) fn share(rendered: &Rendered) -> f64 {
    let pixels: usize = rendered.tiles.iter().map(|tile| tile.len()).sum();
    pixels as f64 / rendered.film.pixels().len() as f64
}

/// How to resume, if possible.
fn go_on(args: &RenderArgs) -> String {
    match &args.parts.checkpoint {
        Some(file) => format!("; resume with --checkpoint {} --resume", file.display()),
        None => "; use --checkpoint FILE to be able to resume".to_owned(),
    }
}

fn author(args: &RenderArgs, seen: &Seen<'_>) -> Author {
    let command = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
    let transfer = seen.outputs.transfer();
    Author { scene: args.scene.display().to_string(), command: command.collect(), transfer }
}

fn tell_of_checkpoint(args: &RenderArgs, checkpoint: &Checkpoint, session: &Session<'_>) {
    if !checkpoint.resume || args.scene_options.quiet {
        return;
    }
    let file = checkpoint.file.display();
    if session.has_checkpoint() {
        let percent = (session.resumed() * 1000.0).floor() / 10.0;
        tell(&format!("resuming from {file}: {percent} % is done"));
    } else {
        tell(&format!("no checkpoint {file} yet: starting from the beginning"));
    }
}

/// A checkpoint that cannot be written does not end a render; the warning is printed even with
/// `--quiet`.
fn warn(error: &Error) {
    tell(&format!("warning: {error}"));
}
