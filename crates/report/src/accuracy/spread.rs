//! Bias and variance, separately: a setting of each sampler is rendered many more times, and every
//! value of the image gets a mean, a standard error and an interval.
//!
//! The intervals validate themselves: if samplers are unbiased and errors are estimated correctly,
//! 95 of 100 contain the value of the reference, which comes from other renders.

use super::fit::{CONFIDENCE, student};
use super::reference::{FIRST_SEED, Reference, Sums};
use super::setting::{Family, Line, Setting};
use super::store::{Record, SpreadRecord, Store, all};
use super::subject::Subject;
use super::sweep::Progress;
use std::collections::BTreeMap;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_core::render::RenderOptions;

/// The setting with about this many points is repeated.
const POINTS: f64 = 64.0;

/// Renders of each setting.
const RENDERS: u32 = 16;

/// Renders a setting of each line of the converging families, unless done already.
///
/// # Errors
/// If the scene can no longer be rendered, or a record cannot be written.
pub fn run(
    subject: &mut Subject,
    families: &[Family],
    references: &BTreeMap<&'static str, Reference>,
    store: &mut Store,
    progress: &dyn Progress,
) -> Result<()> {
    let scene = subject.name();
    let lines = families.iter().filter(|family| family.has_slope);
    let lines: Vec<(&Family, &Line)> =
        lines.flat_map(|family| family.series.iter().map(move |line| (family, line))).collect();
    progress.stage(&format!("{scene}: bias and variance"), lines.len() as u64);
    for (family, line) in lines {
        let distance = |x: f64| libm::log(x / POINTS).abs();
        let nearest = line.points.iter().min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
        let (Some((.., setting)), Some(reference)) =
            (nearest, references.get(family.target.name()))
        else {
            continue;
        };
        let key = setting.key();
        let is_it =
            |s: &SpreadRecord| s.scene == scene && s.target == family.target && s.key == key;
        if !all(&store.records).any(is_it) {
            let sums = sums(subject, setting)?;
            let mut record = found(&sums, reference);
            (record.scene, record.target, record.key) = (scene.clone(), family.target, key);
            store.add(Record::Spread(record))?;
        }
        progress.step();
    }
    Ok(())
}

/// Sums over renders with random numbers of their own.
fn sums(subject: &mut Subject, setting: &Setting) -> Result<Sums> {
    let [width, height] = subject.size();
    let mut sums = Sums::new(width as usize * height as usize);
    for number in 0..RENDERS {
        let seed = FIRST_SEED - 1 - u64::from(number);
        let options = RenderOptions { seed, ..RenderOptions::default() };
        sums.add(&subject.render(setting, &options)?.film);
    }
    Ok(sums)
}

/// Variance, bias and coverage over all values that depend on random numbers.
fn found(sums: &Sums, reference: &Reference) -> SpreadRecord {
    let reach = student(1.0 - CONFIDENCE, f64::from(RENDERS) - 1.0);
    let mut record = SpreadRecord { renders: RENDERS, ..SpreadRecord::default() };
    let (mut squares, mut expected, mut count) = (0.0, 0.0, 0_u64);
    let errors = reference.error.pixels().iter().zip(reference.film.pixels());
    for ((mean, variance), (error, truth)) in sums.moments().zip(errors) {
        for channel in 0..3 {
            let square = mean[channel] - f64::from(truth[channel]);
            let error = f64::from(error[channel]);
            let chance = variance[channel] / f64::from(RENDERS) + error * error;
            count += 1;
            record.variance += variance[channel];
            (squares, expected) = (squares + square * square, expected + chance);
            if variance[channel] > 0.0 {
                record.intervals += 1;
                record.covered += u64::from(square * square <= reach * reach * chance);
            }
        }
    }
    let count = count.max(1) as f64;
    record.variance /= count;
    record.bias = ((squares - expected).max(0.0) / count).sqrt();
    record.expected = (expected / count).sqrt();
    record
}

/// The standard error of each value of a setting's image: the root of the variance of its renders.
///
/// # Errors
/// If the scene can no longer be rendered.
pub fn map(subject: &mut Subject, setting: &Setting) -> Result<Film> {
    let [width, height] = subject.size();
    let deviations = |(_, variance): ([f64; 3], [f64; 3])| variance.map(|v| v.sqrt() as f32);
    let pixels = sums(subject, setting)?.moments().map(deviations).collect();
    Film::from_pixels(width, height, pixels)
}
