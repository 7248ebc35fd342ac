//! Crops: what each time buys, in the part of the image where it shows most.

use super::answer::Answer;
use super::findings::Point;
use super::setting::{Family, Series};
use super::subject::Subject;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;

/// A part of the image by one setting.
#[derive(Clone, Debug)]
pub struct Crop {
    /// The sampler.
    pub name: String,
    /// The setting.
    pub point: Point,
    /// The part of the image.
    pub film: Film,
}

/// The same part of the image in several times.
#[derive(Clone, Debug)]
pub struct Crops {
    /// The settings of an answer, the fastest first.
    pub answers: Vec<Crop>,
    /// Random points in at most the same time, or as few as were measured; none beside an answer
    /// that is random.
    pub random: Vec<Crop>,
    /// The reference.
    pub reference: Film,
}

/// Largest width and height of the crop in pixels: small enough for its pixels to be seen.
const SIZE: [u32; 2] = [28, 21];

/// Crops of the settings of `answer`, which are of this family. `None` if it has none.
///
/// # Errors
/// If the scene can no longer be rendered.
pub fn crops(
    subject: &mut Subject,
    family: &Family<Point>,
    answer: &Answer,
    reference: &Film,
) -> Result<Option<Crops>> {
    let mut settings: Vec<(&Series<Point>, &Point)> = Vec::new();
    for at in &answer.errors {
        let reached = family.fastest(at.error);
        settings.extend(reached.filter(|(_, p)| settings.iter().all(|(_, q)| p.key != q.key)));
    }
    settings.sort_by(|a, b| a.1.seconds.median.total_cmp(&b.1.seconds.median));
    let rivals = settings.iter().filter_map(|(series, point)| {
        let random = family.random().filter(|random| random.name != series.name)?;
        Some((random, random.within(point.seconds.median)?))
    });
    let rivals: Vec<_> = rivals.collect();
    let mut whole = |(series, point): &(&Series<Point>, &Point)| {
        let film = subject.render(&point.setting, 0)?.film;
        Ok(Crop { name: series.name.clone(), point: (*point).clone(), film })
    };
    let answers = settings.iter().map(&mut whole).collect::<Result<Vec<Crop>>>()?;
    let random = rivals.iter().map(&mut whole).collect::<Result<Vec<Crop>>>()?;
    let Some(first) = random.first().or(answers.first()) else { return Ok(None) };
    let window = worst(&first.film, reference);
    let part = |crop: Crop| Ok(Crop { film: crop.film.part(window)?, ..crop });
    Ok(Some(Crops {
        answers: answers.into_iter().map(part).collect::<Result<_>>()?,
        random: random.into_iter().map(part).collect::<Result<_>>()?,
        reference: reference.part(window)?,
    }))
}

/// The window, `[x, y, width, height]`, with the largest squared error.
fn worst(film: &Film, reference: &Film) -> [u32; 4] {
    let size = [film.width().min(SIZE[0]), film.height().min(SIZE[1])];
    let step = |n: u32| (n / 4).max(1) as usize;
    let mut best = ([0, 0, size[0], size[1]], -1.0);
    for y in (0..=film.height() - size[1]).step_by(step(size[1])) {
        for x in (0..=film.width() - size[0]).step_by(step(size[0])) {
            let window = [x, y, size[0], size[1]];
            let error = squared(film, reference, window);
            if error > best.1 {
                best = (window, error);
            }
        }
    }
    best.0
}

fn squared(film: &Film, reference: &Film, [x, y, width, height]: [u32; 4]) -> f64 {
    let mut sum = 0.0;
    for (row, other) in film.rows().zip(reference.rows()).skip(y as usize).take(height as usize) {
        let columns = x as usize..(x + width) as usize;
        for (a, b) in row[columns.clone()].iter().zip(&other[columns]) {
            for (a, b) in a.iter().zip(b) {
                let difference = f64::from(a - b);
                sum += difference * difference;
            }
        }
    }
    sum
}
