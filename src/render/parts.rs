//! Renders that lose no work: with a checkpoint, ended by a signal, or one shard of many.

use std::path::Path;
use std::time::Instant;

use super::args::RenderArgs;
use super::look;
use super::show::{Rendering, Show};
use crate::common::tell;
use crate::interrupt;
use crate::progress::Stage;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{check_differs, check_replaceable};
use wavecrest_core::counters::Counters;
use wavecrest_core::prepared::{MOST_RAYS, PreparedScene};
use wavecrest_core::probe::{self, Invalid};
use wavecrest_core::render::Rendered;
use wavecrest_image::farm::{Author, Session, Shard};
use wavecrest_report::accuracy::pilot::budget::Pace;

/// The extension of a part's name.
const EXTENSION: &str = "part";

/// Runs the checks that are possible before the scene is read.
///
/// # Errors
/// If a shard would be written as an image, or the checkpoint would overwrite another file.
pub(super) fn check(args: &RenderArgs, output: &Path) -> Result<()> {
    if args.shard.is_some() && output.extension().is_none_or(|name| name != EXTENSION) {
        return Err(Error::new(ErrorKind::Usage, "a shard must be written to a .part file")
            .in_file(output)
            .remedy("use a name such as out-1.part, and join all parts with wavecrest merge"));
    }
    let Some(file) = &args.checkpoint else { return Ok(()) };
    check_replaceable(file)?;
    check_differs(file, output, "the output")?;
    check_differs(file, &args.scene, "the scene")?;
    if let Some(stats) = &args.stats {
        check_differs(file, stats, "the statistics")?;
    }
    args.checkpoint().map_or(Ok(()), |checkpoint| checkpoint.check().map(drop))
}

/// Renders the image as requested, as long as its `pace` is good enough; returns it with the share
/// that a checkpoint held (0 to 1).
pub(super) fn trace(
    rendering: &Rendering<'_>,
    scene: &PreparedScene,
    pace: Option<&Pace<'_>>,
) -> Result<(Rendered, f64)> {
    let show = Show::begin(rendering, scene, pace);
    if rendering.args.checkpoint.is_none() {
        return look::trace(rendering.args, scene, &show).map(|rendered| (rendered, 0.0));
    }
    let session = session(rendering, scene, None)?;
    let rendered = session.render(&show, &warn)?;
    Ok((rendered, session.resumed()))
}

/// Renders a shard and writes its part; returns what was counted, and the seconds of tracing.
pub(super) fn write_shard(
    rendering: &Rendering<'_>,
    shard: Shard,
    scene: &PreparedScene,
) -> Result<(Counters, f64)> {
    let Rendering { args, outputs, progress } = *rendering;
    let session = session(rendering, scene, Some(shard))?;
    let show = Show::begin(rendering, scene, None);
    let start = Instant::now();
    let done = session.render_units(&show, &warn)?;
    let seconds = start.elapsed().as_secs_f64();
    drop(show);
    if session.share() < 1.0 {
        let what = outputs.untouched();
        return Err(interrupt::error(session.share()).remedy(what + &go_on(args)));
    }
    let first = find_invalid(args, scene, &done.counters)?;
    report_invalid(&done.counters, first.as_ref());
    session.write(outputs.first())?;
    progress.stage(Stage::Done);
    Ok((done.counters, seconds))
}

/// The work on the image, or on a shard of it; says what a checkpoint held.
fn session<'a>(
    rendering: &Rendering<'_>,
    scene: &'a PreparedScene,
    shard: Option<Shard>,
) -> Result<Session<'a>> {
    let Rendering { args, outputs, .. } = *rendering;
    let command = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    let (file, transfer) = (args.scene.display().to_string(), outputs.transfer());
    let author = Author { scene: file, command, transfer };
    let session = Session::begin(scene, args.options(), author, shard, args.checkpoint())?;
    if let Some(file) = &args.checkpoint
        && args.resume
        && !args.scene_options.quiet
    {
        let (file, percent) = (file.display(), (session.resumed() * 1000.0).floor() / 10.0);
        tell(&match session.has_checkpoint() {
            true => format!("resuming from {file}: {percent} % is done"),
            false => format!("no checkpoint {file} yet: starting from the beginning"),
        });
    }
    Ok(session)
}

/// Writes the finished part of an image that a signal ended, unless it would replace an older image; returns the error
/// with the progress.
pub(super) fn interrupted(
    rendering: &Rendering<'_>,
    scene: &PreparedScene,
    rendered: &Rendered,
) -> Error {
    let (outputs, share) = (rendering.outputs, share(rendered));
    let error = interrupt::error(share);
    let written = if share == 0.0 {
        Ok(outputs.untouched())
    } else {
        let entries = outputs.entries(scene);
        entries.and_then(|entries| outputs.write_unfinished(&rendered.film, &entries, share))
    };
    match written {
        Ok(words) => error.remedy(words + &go_on(rendering.args)),
        Err(error) => error,
    }
}

/// The finished share of an image, from 0 to 1.
pub(super) fn share(rendered: &Rendered) -> f64 {
    let pixels: usize = rendered.tiles.iter().map(|tile| tile.len()).sum();
    pixels as f64 / rendered.film.pixels().len() as f64
}

/// How to resume, if possible.
fn go_on(args: &RenderArgs) -> String {
    let RenderArgs { checkpoint, target_error, time_budget, look, .. } = args;
    match checkpoint {
        Some(file) => format!("; resume with --checkpoint {} --resume", file.display()),
        // These have none.
        None if target_error.is_some() || time_budget.is_some() || look.is_some() => String::new(),
        None => "; use --checkpoint FILE to be able to resume".to_owned(),
    }
}

/// A failure that does not end a render, such as of a checkpoint that cannot be written: the warning is printed even with
/// `--quiet`.
pub(super) fn warn(error: &Error) {
    tell(&format!("warning: {error}"));
}

/// The first sample that was not finite; warns of an image with such texels, once.
///
/// # Errors
/// If there is one, and `--trap-invalid` is given.
pub(super) fn find_invalid(
    args: &RenderArgs,
    scene: &PreparedScene,
    counters: &Counters,
) -> Result<Option<Invalid>> {
    static WARNED: std::sync::Once = std::sync::Once::new();
    let mut images = scene.appearance.all_images();
    if let Some(image) = images.find(|image| image.held().is_some_and(|held| held.invalid > 0)) {
        let message = format!("texels of {} are not finite and count as 0", image.name());
        let error = Error::new(ErrorKind::Texture, message).in_file(&args.scene);
        if args.trap_invalid {
            return Err(error);
        }
        WARNED.call_once(|| warn(&error));
    }
    let first = counters.first_invalid;
    let first = first.map(|sample| probe::name_invalid(scene, sample, args.seed));
    let Some(invalid) = first.as_ref().filter(|_| args.trap_invalid) else { return Ok(first) };
    let Invalid { x, y, shape, .. } = invalid;
    let error = Error::new(ErrorKind::Scene, "a sample is not finite").in_file(&args.scene);
    let scene = args.scene.display();
    Err(error
        .at(shape)
        .value(invalid)
        .remedy(format!("see it with: wavecrest probe {scene} --pixel {x},{y}")))
}

/// Prints the number of samples that were not finite, and the first, and of those that were cut short.
pub(super) fn report_invalid(counters: &Counters, first: Option<&Invalid>) {
    if counters.cut_short > 0 {
        tell(&format!(
            "warning: paths ended at {MOST_RAYS} rays, in number {}: transparent surfaces send on more light than \
             they receive, or hardly less; use a smaller kr, kt or nbounces (in glTF, transmissionFactor)",
            counters.cut_short
        ));
    }
    if let Some(first) = first {
        let count = counters.invalid;
        tell(&format!(
            "warning: {count} samples were not finite and count as black; the first is {first}"
        ));
    }
}
