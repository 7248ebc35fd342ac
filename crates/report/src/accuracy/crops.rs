//! Crops in equal time and at equal error: the same part of the image by each sampler.

use super::findings::{FamilyFindings, PointFindings, SeriesFindings};
use super::reference::Reference;
use super::setting::Family;
use super::subject::Subject;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_core::render::RenderOptions;
use wavecrest_image::error_map::{MapKind, error_map};

/// A part of the image by one sampler.
#[derive(Clone, Debug)]
pub struct Crop {
    /// The sampler.
    pub name: String,
    /// The setting that fits the time or error.
    pub point: PointFindings,
    /// The part of the image.
    pub film: Film,
    /// Its signed error, in false colours.
    pub map: Film,
    /// The whole image.
    pub whole: Film,
}

/// The quantity that is equal for all samplers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Equal {
    /// Time: each sampler has the most points that fit.
    Time,
    /// Error: each sampler has the fewest points that reach it.
    Error,
}

/// Crops of a family's samplers.
#[derive(Clone, Debug)]
pub struct Crops {
    /// The crop of the reference.
    pub reference: Film,
    /// The crop of each sampler.
    pub crops: Vec<Crop>,
    /// The error at the ends of the false colours.
    pub ends: f64,
}

/// The time or error is that of the first sampler with about this many points.
const POINTS: f64 = 64.0;

/// Largest width and height of the crop in pixels.
const SIZE: [u32; 2] = [64, 48];

/// The family's samplers in equal time or at equal error. `None` for a family without several
/// samplers.
///
/// # Errors
/// If the scene can no longer be rendered.
pub fn crops(
    subject: &mut Subject,
    family: &Family,
    found: &FamilyFindings,
    reference: &Reference,
    equal: Equal,
) -> Result<Option<Crops>> {
    let Some(first) = found.series.first().filter(|_| found.series.len() > 1) else {
        return Ok(None);
    };
    let distance = |p: &&PointFindings| (libm::log(p.x.max(1.0) / POINTS)).abs();
    let Some(budget) = first.points.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    else {
        return Ok(None);
    };
    let mut films = Vec::new();
    for (line, series) in family.series.iter().zip(&found.series) {
        let Some(point) = within(series, budget, equal) else { continue };
        let Some((.., setting)) = line.points.iter().find(|p| p.2.key() == point.key) else {
            continue;
        };
        let film = subject.render(setting, &RenderOptions::default())?.film;
        films.push((series.name.clone(), point.clone(), film));
    }
    let Some((.., whole)) = films.first() else { return Ok(None) };
    let window = worst(whole, &reference.film);
    let part = reference.film.part(window)?;
    let films = films.into_iter().map(|(name, point, whole)| {
        let film = whole.part(window)?;
        Ok((name, point, whole, film))
    });
    let films = films.collect::<Result<Vec<_>>>()?;
    let ends = large(films.iter().map(|(.., film)| film), &part);
    let gain = if ends > 0.0 { (1.0 / ends) as f32 } else { 1.0 };
    let crops = films.into_iter().map(|(name, point, whole, film)| {
        let map = error_map(&film, &part, MapKind::Signed, gain)?;
        Ok(Crop { name, point, film, map, whole })
    });
    let crops = crops.collect::<Result<Vec<_>>>()?;
    Ok(Some(Crops { reference: part, crops, ends }))
}

/// The setting of a sampler with as much time as another, with a small allowance for its spread, or
/// with no larger error.
fn within<'a>(
    series: &'a SeriesFindings,
    budget: &PointFindings,
    equal: Equal,
) -> Option<&'a PointFindings> {
    let points = &series.points;
    match equal {
        Equal::Time => {
            let in_time = |p: &&PointFindings| p.seconds.median <= budget.seconds.high;
            points.iter().rfind(in_time).or(points.first())
        }
        Equal::Error => {
            let near = |p: &&PointFindings| p.rmse.value <= budget.rmse.high;
            points.iter().find(near).or(points.last())
        }
    }
}

/// A mean of a pixel's three errors that one pixel of a hundred exceeds.
pub fn large<'a>(films: impl Iterator<Item = &'a Film>, reference: &Film) -> f64 {
    let error = |(a, b): (&[f32; 3], &[f32; 3])| {
        a.iter().zip(b).map(|(a, b)| f64::from(a - b)).sum::<f64>().abs() / 3.0
    };
    let errors = films.flat_map(|film| film.pixels().iter().zip(reference.pixels()));
    let mut errors: Vec<f64> = errors.map(error).collect();
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() * 99 / 100).copied().unwrap_or(0.0)
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
