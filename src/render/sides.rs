//! Several views of a file: a turntable as an animation, or a sheet with names.

use std::path::Path;

use super::args::RenderArgs;
use super::frames::{self, Sequence};
use super::outputs::Outputs;
use super::show::{Reporter, Stage};
use super::watched;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::film::Film;
use wavecrest_image::animation::{Animated, Animation};
use wavecrest_image::farm::Shard;
use wavecrest_report::plot::label::label;
use wavecrest_scene::load::framing::Sheet;

/// Height of the text line under each image of a sheet, as a share of the image's height, and at
/// least in pixels.
const LINE_SHARE: f64 = 0.06;
const LEAST_LINE: u32 = 12;
/// Linear colours of the background and the text of names.
const PAPER: f32 = 1.0;
const INK: f32 = 0.01;

/// Renders several views if requested; returns whether they are.
///
/// # Errors
/// If an option does not fit, or an image cannot be rendered or written.
pub(super) fn run(args: &RenderArgs, shard: Option<Shard>) -> Result<bool> {
    if args.frame.is_some() {
        return Ok(false);
    }
    let input = &args.scene_options.input;
    let output = args.output()?;
    if let Some(sheet) = &input.sheet {
        refuse("--sheet", output, &[of_frame(args), of_image(args, shard)].concat())?;
        let outputs = Outputs::check(args, output, false)?;
        watched(args, |reporter| draw_sheet(args, sheet, &outputs, reporter))?;
        return Ok(true);
    }
    let Some(count) = input.turntable else { return Ok(false) };
    match animated(output) {
        None => {
            refuse("--turntable", output, &of_frame(args))?;
            frames::run(args, 1..=count, shard)?;
        }
        Some(format) => {
            refuse("--turntable", output, &[of_frame(args), of_image(args, shard)].concat())?;
            let outputs = Outputs::of_one(args, output)?;
            watched(args, |reporter| animate(args, count, &outputs, format, reporter))?;
        }
    }
    Ok(true)
}

/// The format of a turntable in one file.
pub(super) fn animated(output: &Path) -> Option<Animated> {
    let is_numbered = output.file_name().is_some_and(|name| name.to_string_lossy().contains('#'));
    Animated::from_path(output).filter(|_| !is_numbered)
}

/// An option, and whether it is given.
type Given = (&'static str, bool);

/// Options that belong to one image, not to frames.
fn of_frame(args: &RenderArgs) -> Vec<Given> {
    vec![
        ("--checkpoint", args.checkpoint.is_some()),
        ("--stats", args.stats.is_some()),
        ("--save-every", args.save_every.is_some()),
        ("--target-error", args.target_error.is_some()),
        ("--time-budget", args.time_budget.is_some()),
    ]
}

/// Options that belong to image files of one view.
fn of_image(args: &RenderArgs, shard: Option<Shard>) -> Vec<Given> {
    vec![
        ("--shard", shard.is_some()),
        ("--also", !args.also.is_empty()),
        ("--aov", args.aov.is_some()),
    ]
}

/// Refuses `others` together with an `option`.
fn refuse(option: &str, output: &Path, others: &[Given]) -> Result<()> {
    let Some((other, _)) = others.iter().find(|(_, is_given)| *is_given) else { return Ok(()) };
    let message = format!("{option} and {other} cannot be used together");
    Err(Error::new(ErrorKind::Usage, message).in_file(output).remedy(format!("leave out {other}")))
}

/// Renders a turntable as one file.
fn animate(
    args: &RenderArgs,
    count: u32,
    outputs: &Outputs<'_>,
    format: Animated,
    reporter: &Reporter,
) -> Result<()> {
    let output = outputs.first();
    let mut sequence = Sequence::prepare(args, &outputs.all(), count as usize, reporter)?;
    outputs.made_of(sequence.ready.encoding);
    let size =
        args.crop.map_or(sequence.ready.scene.camera.size(), |crop| [crop.width, crop.height]);
    let entries = outputs.entries(&sequence.ready.scene)?;
    let transfer = outputs.transfer();
    let animation =
        Animation { path: output, format, size, frames: count, transfer, entries: &entries };
    // Errors of a frame are not about the file.
    let mut failed = None;
    let mut film = |frame| {
        let rendered = sequence.frame(args, frame + 1, outputs);
        rendered.map(|one| one.film).inspect_err(|error| failed = Some(error.clone()))
    };
    animation.write(&mut film).map_err(|error| failed.unwrap_or(error))?;
    reporter.note("write", || output.display().to_string());
    reporter.stage(Stage::Done);
    sequence.finish(&output.display().to_string(), size);
    Ok(())
}

/// Renders every side, and arranges them.
fn draw_sheet(
    args: &RenderArgs,
    Sheet(sides): &Sheet,
    outputs: &Outputs<'_>,
    reporter: &Reporter,
) -> Result<()> {
    let mut sequence = Sequence::prepare(args, &outputs.all(), sides.len(), reporter)?;
    let mut rows = Rows::new(sides.len());
    let mut last = None;
    for (frame, (name, _)) in (1..).zip(sides) {
        let rendered = sequence.frame(args, frame, outputs)?;
        rows.add(name, &rendered.film)?;
        last = Some(rendered);
    }
    let (Some(mut rendered), Some(film)) = (last, rows.film) else { return Ok(()) };
    rendered.film = film;
    reporter.stage(Stage::Write);
    outputs.write(&sequence.ready.scene, &rendered)?;
    reporter.stage(Stage::Done);
    let size = [rendered.film.width(), rendered.film.height()];
    sequence.finish(&outputs.name(), size);
    Ok(())
}

/// Images in rows, with a line of text under each.
pub(super) struct Rows {
    pictures: u32,
    columns: u32,
    added: u32,
    film: Option<Film>,
}

impl Rows {
    /// For this number of images: as many to a row as there are rows, or one more.
    pub(super) fn new(pictures: usize) -> Self {
        let columns = (pictures as f64).sqrt().ceil() as u32;
        Self { pictures: pictures as u32, columns, added: 0, film: None }
    }

    /// The height of a line of text under images of this height.
    fn line(height: u32) -> u32 {
        ((f64::from(height) * LINE_SHARE) as u32).max(LEAST_LINE)
    }

    /// The width and height of the whole, for images of this size.
    pub(super) fn size(&self, [width, height]: [u32; 2]) -> [u32; 2] {
        let rows = self.pictures.div_ceil(self.columns);
        let with_line = height.saturating_add(Self::line(height));
        [width.saturating_mul(self.columns), with_line.saturating_mul(rows)]
    }

    /// Adds an image of the same size as those before it.
    ///
    /// # Errors
    /// If the whole is too large.
    fn add(&mut self, name: &str, picture: &Film) -> Result<()> {
        let (width, height) = (picture.width(), picture.height());
        let (line, whole) = (Self::line(height), self.size([width, height]));
        let film = match &mut self.film {
            Some(film) => film,
            empty => {
                let mut film = Film::new(whole[0], whole[1])?;
                film.pixels_mut().fill([PAPER; 3]);
                empty.insert(film)
            }
        };
        let (left, top) =
            (self.added % self.columns * width, self.added / self.columns * (height + line));
        self.added += 1;
        let across = film.width() as usize;
        let at = |y: u32| (top + y) as usize * across + left as usize;
        for (y, row) in (0..).zip(picture.rows()) {
            film.pixels_mut()[at(y)..][..row.len()].copy_from_slice(row);
        }
        let ink = label(name, width, line).unwrap_or_default();
        for (y, row) in (height..).zip(ink.chunks(width as usize)) {
            for (pixel, part) in film.pixels_mut()[at(y)..].iter_mut().zip(row) {
                *pixel = [PAPER + (INK - PAPER) * part; 3];
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_put_in_rows_with_a_line_under_each() {
        let mut rows = Rows::new(3);
        for level in [0.1, 0.2, 0.3] {
            let film = Film::from_pixels(40, 30, vec![[level; 3]; 1200]).unwrap();
            rows.add("iso", &film).unwrap();
        }
        let film = rows.film.unwrap();
        assert_eq!((film.width(), film.height()), (80, 84));
        let level = |x, y| film.pixel(x, y).unwrap()[0];
        assert_eq!([level(0, 0), level(79, 29), level(39, 71)], [0.1, 0.2, 0.3]);
        assert_eq!([level(0, 30), level(79, 83)], [PAPER, PAPER]);
        let dark = |left: u32| (0..12).any(|y| (0..40).any(|x| level(left + x, 30 + y) < 0.5));
        assert!(dark(0) && dark(40), "names are written");
    }
}
