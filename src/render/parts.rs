//! Renders that lose no work: kept in a checkpoint, ended by a signal, or one shard of many.

mod array;

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::show::{Show, Stage};
use super::{RenderArgs, Seen};
use crate::common::{above_zero, tell};
use crate::interrupt::Interrupt;
use array::Choice;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{check_differs, check_replaceable};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{Rendered, Watch, render};
use wavecrest_core::tile::Tile;
use wavecrest_image::farm::checkpoint::Checkpoint;
use wavecrest_image::farm::{Author, Session, Shard};

/// Seconds between two checkpoints unless asked otherwise.
const EVERY: f64 = 60.0;

/// The extension of a part's name.
const EXTENSION: &str = "part";

/// Options on what is kept, and which share is rendered.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct PartOptions {
    /// Keep what is finished in this file, now and then and when SIGINT or SIGTERM ends the render
    #[arg(long, value_name = "FILE", conflicts_with_all = ["target_error", "time_budget"])]
    pub(crate) checkpoint: Option<PathBuf>,
    /// Seconds between two writings of the checkpoint, at least [default: 60]
    #[arg(long, value_name = "SECONDS", requires = "checkpoint", value_parser = above_zero)]
    pub(crate) every: Option<f64>,
    /// Go on with what the checkpoint holds; without one, begin
    #[arg(long, requires = "checkpoint")]
    pub(crate) resume: bool,
    /// Render the I-th of N equal shares and write it as a part (.part) for `wavecrest merge`; auto or
    /// auto/N takes I from the array job of a scheduler
    #[arg(long, value_name = "I/N", conflicts_with_all = ["target_error", "time_budget", "stats", "also", "aov", "save_every"])]
    pub(crate) shard: Option<Choice>,
}

impl PartOptions {
    /// The shard to render, if one is asked for.
    pub(super) fn shard(&self) -> Result<Option<Shard>> {
        self.shard.map(|choice| choice.resolve(|name| std::env::var(name).ok())).transpose()
    }

    /// Checks what can be checked before the scene is read.
    pub(super) fn check(&self, args: &RenderArgs, output: &Path) -> Result<()> {
        if self.shard.is_some() && output.extension().is_none_or(|name| name != EXTENSION) {
            return Err(Error::new(ErrorKind::Usage, "a shard is a part of an image, and not one")
                .in_file(output)
                .remedy(
                    "name it such as out-1.part, and put all parts together: wavecrest merge",
                ));
        }
        let Some(file) = &self.checkpoint else { return Ok(()) };
        check_replaceable(file)?;
        check_differs(file, output, "the output")?;
        check_differs(file, &args.scene, "the scene")?;
        if let Some(stats) = &args.stats {
            check_differs(file, stats, "the statistics")?;
        }
        self.checkpoint().map_or(Ok(()), |checkpoint| checkpoint.check().map(drop))
    }

    /// Bytes held for a checkpoint of so many pixels: their sums, beside the image.
    pub(super) fn kept_bytes(&self, pixels: u64) -> u64 {
        let each = if self.checkpoint.is_some() { size_of::<[f64; 3]>() as u64 } else { 0 };
        pixels * each
    }

    fn checkpoint(&self) -> Option<Checkpoint> {
        let every = self.every.unwrap_or(EVERY);
        Some(Checkpoint {
            file: self.checkpoint.clone()?,
            // Longer than can be said is never.
            every: Duration::try_from_secs_f64(every).unwrap_or(Duration::MAX),
            resume: self.resume,
        })
    }
}

/// Shows the render, and ends it when a signal has come.
struct Screen<'a> {
    show: Show<'a>,
    interrupt: &'a Interrupt,
}

impl<'a> Screen<'a> {
    fn new(args: &RenderArgs, scene: &PreparedScene, seen: &Seen<'a>) -> Self {
        seen.reporter.stage(Stage::Trace);
        let show = Show::new(args, seen.outputs, scene, seen.reporter);
        Self { show, interrupt: seen.interrupt }
    }
}

impl Watch for Screen<'_> {
    fn progress(&self, done: u64, all: u64) {
        self.show.progress(done, all);
    }

    fn tile(&self, tile: &Tile, pixels: &[[f32; 3]]) {
        self.show.tile(tile, pixels);
    }

    fn cancelled(&self) -> bool {
        self.interrupt.signal().is_some()
    }
}

/// Renders the image as the arguments ask: it, and the part of it that a checkpoint held (0 to 1).
pub(super) fn trace(
    args: &RenderArgs,
    scene: &PreparedScene,
    seen: &Seen<'_>,
) -> Result<(Rendered, f64)> {
    let screen = Screen::new(args, scene, seen);
    let Some(checkpoint) = args.parts.checkpoint() else {
        return render(scene, &args.options(), &screen).map(|rendered| (rendered, 0.0));
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
) -> Result<()> {
    let output = seen.outputs.first();
    let (options, checkpoint) = (args.options(), args.parts.checkpoint());
    let session =
        Session::begin(scene, &options, author(args, seen), Some(shard), checkpoint.as_ref())?;
    if let Some(checkpoint) = &checkpoint {
        tell_of_checkpoint(args, checkpoint, &session);
    }
    let screen = Screen::new(args, scene, seen);
    let done = session.render_units(&screen, &warn)?;
    drop(screen);
    if session.share() < 1.0 {
        let what = format!("{} is not written", output.display());
        return Err(seen.interrupt.error(session.share()).remedy(what + &go_on(args)));
    }
    let invalid = super::find_invalid(args, scene, &done.counters)?;
    super::tell_invalid(args, &done.counters, invalid.as_ref());
    session.write(output)?;
    seen.reporter.note("write", || output.display().to_string());
    seen.reporter.stage(Stage::Done);
    Ok(())
}

/// Writes what there is of an image that a signal ended; the error says what was done.
pub(super) fn interrupted(
    args: &RenderArgs,
    scene: &PreparedScene,
    rendered: &Rendered,
    seen: &Seen<'_>,
) -> Error {
    let pixels: usize = rendered.tiles.iter().map(|tile| tile.len()).sum();
    let share = pixels as f64 / rendered.film.pixels().len() as f64;
    let error = seen.interrupt.error(share);
    let name = seen.outputs.name();
    let written = if pixels == 0 {
        format!("{name} is left as it was")
    } else {
        let entries = seen.outputs.entries(scene);
        match entries.and_then(|e| seen.outputs.write_part(&rendered.film, &e, share)) {
            Ok(()) => format!("{name} holds it, black elsewhere"),
            Err(error) => return error,
        }
    };
    error.remedy(written + &go_on(args))
}

/// How to go on, where that can be.
fn go_on(args: &RenderArgs) -> String {
    match &args.parts.checkpoint {
        Some(file) => format!("; go on with --checkpoint {} --resume", file.display()),
        None => "; with --checkpoint FILE it could go on".to_owned(),
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
        tell(&format!("going on with {file}, which holds {percent} %"));
    } else {
        tell(&format!("there is no checkpoint {file} yet: rendering from the start"));
    }
}

/// A checkpoint that cannot be written ends no render, but is told even to who wants quiet.
fn warn(error: &Error) {
    tell(&format!("warning: {error}"));
}
