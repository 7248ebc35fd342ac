//! What equal time buys: the same part of the picture by each sampler, at the most points that it has time
//! for.

use super::findings::{FamilyFindings, PointFindings};
use super::reference::Reference;
use super::setting::Family;
use super::subject::Subject;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_core::render::RenderOptions;
use wavecrest_image::error_map::flip_map;
use wavecrest_image::flip::{DEFAULT_PIXELS_PER_DEGREE, flip};

/// A part of the picture, by one sampler.
#[derive(Clone, Debug)]
pub struct Crop {
    /// The sampler.
    pub name: String,
    /// What it had time for.
    pub point: PointFindings,
    /// The part of the picture.
    pub film: Film,
    /// The difference that is seen there, in false colours.
    pub map: Film,
    /// The whole picture.
    pub whole: Film,
}

/// The time that each has is that of the first sampler with about so many points.
const POINTS: f64 = 64.0;

/// Width and height of the part that is shown, in pixels, where the picture is as large.
const SIZE: [u32; 2] = [64, 48];

/// The family's samplers in equal time, and the part of the reference that they are of. `None` for a family
/// without several samplers, or without times to compare.
///
/// # Errors
/// When the scene can no longer be rendered.
pub fn equal_time(
    subject: &mut Subject,
    family: &Family,
    found: &FamilyFindings,
    reference: &Reference,
) -> Result<Option<(Film, Vec<Crop>)>> {
    let Some(budget) = budget(found) else { return Ok(None) };
    let mut films = Vec::new();
    for (line, series) in family.series.iter().zip(&found.series) {
        let in_time = |p: &&PointFindings| p.seconds.median <= budget;
        let Some(point) = series.points.iter().rfind(in_time).or(series.points.first()) else {
            continue;
        };
        let Some((.., setting)) = line.points.iter().find(|p| p.2.key() == point.key) else {
            continue;
        };
        let film = subject.render(setting, &RenderOptions::default())?.film;
        films.push((series.name.clone(), point.clone(), film));
    }
    let Some((.., first)) = films.first() else { return Ok(None) };
    let window = worst(first, &reference.film);
    let crop = |(name, point, whole): (String, PointFindings, Film)| {
        let map = flip_map(&flip(&whole, &reference.film, DEFAULT_PIXELS_PER_DEGREE)?, 1.0)?;
        Ok(Crop { name, point, film: whole.part(window)?, map: map.part(window)?, whole })
    };
    let crops = films.into_iter().map(crop).collect::<Result<Vec<_>>>()?;
    Ok(Some((reference.film.part(window)?, crops)))
}

/// The time that all have, with a little to spare for its own spread.
fn budget(found: &FamilyFindings) -> Option<f64> {
    let first = found.series.first().filter(|_| found.series.len() > 1)?;
    let distance = |p: &&PointFindings| (libm::log(p.x.max(1.0) / POINTS)).abs();
    let point = first.points.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    Some(point.seconds.high)
}

/// The window, `[x, y, width, height]`, in which the squared error is largest.
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
