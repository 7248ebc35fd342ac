//! One render of an image: as light or as a look, resumed from a checkpoint, or ended by a signal; and its samples that are
//! not finite.

use super::args::RenderArgs;
use super::outputs::Outputs;
use super::show::{Show, warn};
use crate::common::{command_words, tell};
use crate::interrupt;
use crate::progress::Display;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::counters::Counters;
use wavecrest_core::prepared::{MOST_RAYS, PreparedScene};
use wavecrest_core::probe::{self, InvalidSample};
use wavecrest_core::render::Rendered;
use wavecrest_core::render::units::Order;
use wavecrest_image::farm::{Author, Session, Shard};
use wavecrest_image::look;
use wavecrest_report::accuracy::pilot::budget::Pace;

/// Renders the image once, as long as its `pace` is good enough; returns it with the share that a checkpoint held (0 to 1).
pub(super) fn render_once(
    outputs: &Outputs<'_>,
    progress: &Display,
    scene: &PreparedScene,
    pace: Option<&Pace<'_>>,
) -> Result<(Rendered, f64)> {
    let (show, args) = (Show::begin(outputs, progress, scene, pace), outputs.args);
    if args.checkpoint.is_some() {
        let part = begin(outputs, scene, None)?;
        return Ok((part.render(&show, &warn)?, part.resumed().unwrap_or_default()));
    }
    // The pace of a part is that of the whole only if it is a fair sample.
    let order = if pace.is_some() { Order::Spread } else { Order::Rows };
    Ok((look::render(scene, args.look, &args.options(), &show, order)?, 0.0))
}

/// The work on the image, or on a shard of it; says what a checkpoint held.
pub(super) fn begin<'a>(
    outputs: &Outputs<'_>,
    scene: &'a PreparedScene,
    shard: Option<Shard>,
) -> Result<Session<'a>> {
    let args = outputs.args;
    let (file, transfer) = (args.scene.display().to_string(), outputs.transfer());
    let author = Author { scene: file, command: command_words(), transfer };
    let part = Session::begin(scene, args.options(), author, shard, args.checkpoint())?;
    if let Some(file) = &args.checkpoint
        && args.resume
    {
        let (file, percent) = (file.display(), |share: f64| (share * 1000.0).floor() / 10.0);
        args.say(&match part.resumed().map(percent) {
            Some(percent) => format!("resuming from {file}: {percent} % is done"),
            None => format!("no checkpoint {file} yet: starting from the beginning"),
        });
    }
    Ok(part)
}

/// Writes the finished part of an image that a signal ended, unless it would replace an older image; returns the error
/// with the progress.
pub(super) fn interrupted(
    outputs: &Outputs<'_>,
    scene: &PreparedScene,
    rendered: &Rendered,
) -> Error {
    let share = share(rendered);
    let error = interrupt::error(share);
    let written = if share == 0.0 {
        Ok(outputs.untouched())
    } else {
        let entries = outputs.entries(scene);
        entries.and_then(|entries| outputs.write_unfinished(&rendered.film, &entries, share))
    };
    match written {
        Ok(words) => error.remedy(words + &go_on(outputs.args)),
        Err(error) => error,
    }
}

/// The finished share of an image, from 0 to 1.
pub(super) fn share(rendered: &Rendered) -> f64 {
    let pixels: usize = rendered.tiles.iter().map(|tile| tile.len()).sum();
    pixels as f64 / rendered.film.pixels().len() as f64
}

/// How to resume, if possible.
pub(super) fn go_on(args: &RenderArgs) -> String {
    let RenderArgs { checkpoint, target_error, time_budget, look, .. } = args;
    match checkpoint {
        Some(file) => format!("; resume with --checkpoint {} --resume", file.display()),
        // These have none.
        None if target_error.is_some() || time_budget.is_some() || look.is_some() => String::new(),
        None => "; use --checkpoint FILE to be able to resume".to_owned(),
    }
}

/// The first sample that was not finite; warns of it, of paths that were cut short, and once of an image with such texels.
///
/// # Errors
/// If there is such a sample or texel, and `--trap-invalid` is given.
pub(super) fn find_invalid(
    args: &RenderArgs,
    scene: &PreparedScene,
    counters: &Counters,
) -> Result<Option<InvalidSample>> {
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
    if let Some(invalid) = first.as_ref().filter(|_| args.trap_invalid) {
        let InvalidSample { x, y, shape, .. } = invalid;
        let error = Error::new(ErrorKind::Scene, "a sample is not finite").in_file(&args.scene);
        let scene = args.scene.display();
        let remedy = format!("see it with: wavecrest probe {scene} --pixel {x},{y}");
        return Err(error.at(shape).value(invalid).remedy(remedy));
    }
    if counters.cut_short > 0 {
        tell(&format!(
            "warning: paths ended at {MOST_RAYS} rays, in number {}: transparent surfaces send on more light than \
             they receive, or hardly less; use a smaller kr, kt or nbounces (in glTF, transmissionFactor)",
            counters.cut_short
        ));
    }
    if let Some(first) = &first {
        let count = counters.invalid;
        tell(&format!(
            "warning: {count} samples were not finite and count as black; the first is {first}"
        ));
    }
    Ok(first)
}
