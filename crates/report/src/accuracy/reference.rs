//! Reference images for errors, with their own standard error.
//!
//! A reference is the mean of several renders with the reference kernel and different random numbers.
//! Each is unbiased, so their spread estimates the distance of the mean from the truth: the
//! standard error, as a root mean square over all values of the image. An error below [`FLOOR`]
//! standard errors is noise of the reference; renders are added until the reference is accurate
//! enough for the comparisons, or until there are [`MOST_REPLICATES`].

use std::sync::atomic::{AtomicU64, Ordering};

use super::pilot::variance;
use super::setting::{Axis, Facts, Setting, Target, converges};
use super::store::{Record, ReferenceRecord, Store, records_of};
use super::subject::Subject;
use super::{OnProgress, SweepProgress};
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::film::Film;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::render::Progress;
use wavecrest_image::compare::compare;
use wavecrest_image::read::read;
use wavecrest_image::write::{Transfer, write};

/// Errors of at least this many standard errors are above the noise of the reference.
pub const FLOOR: f64 = 3.0;

/// Smallest number of renders of a reference: fewer would not show their spread.
const LEAST_REPLICATES: usize = 4;

/// Largest number of renders.
const MOST_REPLICATES: usize = 32;

/// Their first seed, which no other render uses.
const FIRST_SEED: u64 = 1 << 63;

/// The reference of `target` in `store`, or a new one, with the least points of each kind there:
/// rendered until the errors of the settings nearest to it are above its noise.
///
/// # Errors
/// If the scene can no longer be rendered, or the reference can be neither read nor written.
pub(super) fn reference(
    subject: &mut Subject,
    target: Target,
    store: &mut Store,
    progress: &OnProgress<'_>,
) -> Result<Film> {
    let (scene, least) = (subject.record.scene.clone(), store.header.least);
    let is_it = |known: &&ReferenceRecord| known.scene == scene && known.target == target;
    let work = REFERENCE_COST * u64::from(least);
    let of_one = subject.pixels() * work;
    if let Some(known) = records_of(&store.records).find(is_it) {
        progress(SweepProgress::Step(LEAST_REPLICATES as u64 * of_one));
        return read(&store.folder.join(&known.file));
    }
    let approached = subject.families.iter().filter(|family| family.target == target);
    let last = approached.flat_map(|family| &family.series).filter_map(|s| s.points.last());
    let nearest = last.filter(|(.., setting)| converges(&setting.key()));
    let nearest: Vec<Setting> = nearest.map(|(.., setting)| *setting).collect();
    let (setting, count) = setting(&subject.facts, target, least);
    let is_sampled = subject.facts.is_sampled(target);
    let mut films: Vec<Film> = Vec::new();
    let mut seconds = 0.0;
    let (film, standard_error) = loop {
        let seed = FIRST_SEED + films.len() as u64;
        progress(SweepProgress::More(u64::from(films.len() >= LEAST_REPLICATES) * of_one));
        let told = AtomicU64::new(0);
        let watch = Progress(|done: u64, _| {
            let before = told.fetch_max(done, Ordering::Relaxed);
            progress(SweepProgress::Step(done.saturating_sub(before) * work));
        });
        let rendered = subject.render_with(KernelChoice::Reference, &setting, seed, &watch)?;
        seconds += rendered.seconds;
        films.push(rendered.film);
        if !is_sampled {
            progress(SweepProgress::Step((LEAST_REPLICATES as u64 - 1) * of_one));
            break (mean(&films)?, 0.0);
        }
        if films.len() < LEAST_REPLICATES {
            continue;
        }
        let standard_error = (variance(&films) / films.len() as f64).sqrt();
        let film = mean(&films)?;
        let mut smallest = f64::INFINITY;
        for setting in &nearest {
            let rendered = subject.render(setting, 0)?;
            smallest = smallest.min(compare(&rendered.film, &film)?.rmse);
        }
        if smallest >= FLOOR * standard_error || films.len() >= MOST_REPLICATES {
            break (film, standard_error);
        }
    };
    let file = format!("{scene}-{}.exr", target.name());
    write(&film, &store.folder.join(&file), Transfer::Linear)?;
    let replicates = films.len() as u32;
    let samples = u64::from(replicates) * u64::from(count);
    store.add(Record::Reference(ReferenceRecord {
        scene,
        target,
        file,
        samples,
        replicates,
        standard_error,
        seconds,
    }))?;
    Ok(film)
}

/// The mean of images of one size, at least one.
fn mean(films: &[Film]) -> Result<Film> {
    let mut mean = Film::new(films[0].width(), films[0].height())?;
    for (index, value) in mean.pixels_mut().as_flattened_mut().iter_mut().enumerate() {
        let each = films.iter().map(|film| f64::from(film.pixels().as_flattened()[index]));
        *value = (each.sum::<f64>() / films.len() as f64) as f32;
    }
    Ok(mean)
}

/// The setting of the reference of `target`, and the number of points of each kind in the scene: at
/// least `least` for each sampled kind.
fn setting(facts: &Facts, target: Target, least: u32) -> (Setting, u32) {
    if !facts.is_sampled(target) {
        return (Setting::default(), 1);
    }
    let side = (1..).find(|side| side * side >= least).unwrap_or(1);
    let points = Points { sampling: Sampling::Sobol, side };
    let axis = if target == Target::Pixel { Axis::Pixel(facts.lights) } else { Axis::of(facts) };
    (Setting { samples: axis.samples(points), ..Setting::default() }, points.count())
}

/// The least work of a reference for each of its points: see [`Setting::work`].
pub(super) const LEAST_WORK: u64 = REFERENCE_COST * LEAST_REPLICATES as u64;

/// How many times as long as the usual kernel the reference kernel takes, roughly.
const REFERENCE_COST: u64 = 3;
