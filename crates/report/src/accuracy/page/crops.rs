//! Crops: what each time buys, in the part of the image where it shows most.

use crate::accuracy::report::{FastestSettings, SettingResult};
use crate::accuracy::setting::{Family, SettingSeries};
use crate::accuracy::subject::Subject;
use crate::page::{Block, Picture};
use crate::plot::number::{figure, plural, seconds};
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::film::Film;
use wavecrest_image::compare::compare;
use wavecrest_image::write::{Transfer, png};

/// Largest width and height of the crop in pixels: small enough for its pixels to be seen.
const SIZE: [u32; 2] = [28, 21];

/// The words above each row.
const ABOVE: [&str; 2] = [
    "What each time buys, where random points have their largest error:",
    "Random points in at most the same time:",
];

/// A row with the settings of `answer`, which are of this family, the fastest first; and one with
/// random points in at most the same time, or as few as were measured, beside each answer that is
/// not random. Both end with the reference.
///
/// # Errors
/// If the scene can no longer be rendered.
pub(super) fn rows(
    subject: &mut Subject,
    family: &Family<SettingResult>,
    answer: &FastestSettings,
) -> Result<Vec<Block>> {
    let mut answers: Vec<(&SettingSeries<SettingResult>, &SettingResult)> = Vec::new();
    for at in &answer.errors {
        let reached = family.fastest(at.error);
        answers.extend(reached.filter(|(_, p)| answers.iter().all(|(_, q)| p.key != q.key)));
    }
    answers.sort_by(|a, b| a.1.seconds.median.total_cmp(&b.1.seconds.median));
    let random = answers.iter().filter_map(|(series, point)| {
        let random = family.random().filter(|random| random.name != series.name)?;
        let in_time = |random: &&SettingResult| random.seconds.median <= point.seconds.median;
        Some((random, random.points.iter().rfind(in_time).or(random.points.first())?))
    });
    let random: Vec<_> = random.collect();
    let mut whole = |(series, point): &(&SettingSeries<SettingResult>, &SettingResult)| {
        let (time, points) = (seconds(point.seconds.median), plural(point.x as usize, "point"));
        let error = figure(point.rmse.value * 100.0);
        let caption = format!("{time}: {}, {points}, error {error} %", series.name);
        Ok((caption, subject.render(&point.setting, 0, KernelChoice::default(), &())?.film))
    };
    let answers = answers.iter().map(&mut whole).collect::<Result<Vec<_>>>()?;
    let random = random.iter().map(&mut whole).collect::<Result<Vec<_>>>()?;
    let Some((_, first)) = random.first().or(answers.first()) else { return Ok(Vec::new()) };
    let reference = &subject.references[&family.target];
    let window = worst(first, reference)?;
    let picture = |caption: &str, film: &Film| {
        let alt = format!("Rendered image: {caption}");
        let png = png(&film.part(window)?, Transfer::Linear)?;
        Ok(Picture { png, alt, caption: caption.to_owned() })
    };
    let mut blocks = Vec::new();
    for (words, row) in ABOVE.into_iter().zip([answers, random]).filter(|(_, row)| !row.is_empty())
    {
        let crops = row.iter().map(|(caption, film)| picture(caption, film));
        let crops = crops.chain([picture("reference", reference)]);
        blocks.push(Block::Paragraph(words.to_owned()));
        blocks.push(Block::Pictures(crops.collect::<Result<_>>()?));
    }
    Ok(blocks)
}

/// The window, `[x, y, width, height]`, with the largest squared error.
fn worst(film: &Film, reference: &Film) -> Result<[u32; 4]> {
    let [width, height] = [film.width().min(SIZE[0]), film.height().min(SIZE[1])];
    let step = |n: u32| (n / 4).max(1) as usize;
    let mut worst = ([0, 0, width, height], -1.0);
    for y in (0..=film.height() - height).step_by(step(height)) {
        for x in (0..=film.width() - width).step_by(step(width)) {
            let window = [x, y, width, height];
            let error = compare(&film.part(window)?, &reference.part(window)?)?.mse;
            if error > worst.1 {
                worst = (window, error);
            }
        }
    }
    Ok(worst.0)
}
