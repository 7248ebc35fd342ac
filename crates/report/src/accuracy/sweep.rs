//! The sweep itself: its renders, their order, and their records.
//!
//! For each seed, all settings of a scene are rendered in a random order, so that neither a slow
//! minute of the machine nor an earlier render favours one of them.

use std::collections::BTreeMap;
use std::path::PathBuf;

use rand::seq::SliceRandom;

use super::setting::{CountedSetting, Family, Setting, Truth};
use super::store::{
    ImageErrors, PointRecord, PreparedRecord, Record, Store, SweepHeader, TrialRecord, busy_rounds,
    records_of,
};
use super::subject::{LEAST_WORK, Subject};
use super::{OnProgress, SweepProgress};
use crate::measure::rounds;
use crate::selftest::examine::trial;
use crate::selftest::{Count, Effort};
use crate::summary::generator;
use wavecrest_base::error::Result;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_image::compare::{Comparison, compare};
use wavecrest_image::flip::{DEFAULT_PIXELS_PER_DEGREE, flip};

/// Sweeps the scenes of `files` in turn, with this many renders of each setting, each with its own
/// seed; results in `store` are not repeated.
///
/// # Errors
/// If a scene cannot be rendered, two have one name, or a record or a reference cannot be written.
pub fn run(
    files: &[PathBuf],
    seeds: u32,
    store: &mut Store,
    progress: &OnProgress<'_>,
) -> Result<Vec<Subject>> {
    let SweepHeader { longest, most, least, .. } = store.header;
    let open = |file: &PathBuf| Subject::open(file, longest, most);
    let mut subjects = files.iter().map(open).collect::<Result<Vec<Subject>>>()?;
    let references = Truth::ALL.len() as u64 * LEAST_WORK * u64::from(least);
    let work = |subject: &Subject| {
        let settings = settings(&subject.families);
        let points: u64 = settings.iter().map(|(_, setting)| setting.work()).sum();
        subject.pixels() * (references + u64::from(seeds) * points)
    };
    subjects.iter().try_for_each(|subject| store.admit(subject.record.clone()))?;
    progress(SweepProgress::More(subjects.iter().map(work).sum()));
    for subject in &mut subjects {
        for target in Truth::ALL {
            let stage = format!("{}: reference ({target})", subject.record.scene);
            progress(SweepProgress::Stage(&stage));
            let film = subject.reference(target, store, progress)?;
            subject.references.insert(target, film);
        }
        points(subject, seeds as usize, store, progress)?;
        trials(subject, store, progress)?;
    }
    Ok(subjects)
}

/// Each setting of the families once, with its target and its key.
fn settings(families: &[Family<CountedSetting>]) -> Vec<((Truth, String), Setting)> {
    let all = families.iter().flat_map(|f| f.points().map(|(.., s)| ((f.target, s.key()), *s)));
    all.collect::<BTreeMap<_, _>>().into_iter().collect()
}

/// Largest number of rounds, busy or not, as a multiple of those that are to be kept.
const MOST_ROUNDS: usize = 2;

/// Renders every setting with every seed.
fn points(
    subject: &mut Subject,
    seeds: usize,
    store: &mut Store,
    progress: &OnProgress<'_>,
) -> Result<()> {
    let scene = subject.record.scene.clone();
    let mut all = settings(&subject.families);
    note_preparation(subject, store)?;
    progress(SweepProgress::Stage(&scene));
    for seed in 0.. {
        // Busy rounds are measured again, with other seeds.
        let (rounds, busy) = busy_rounds(&scene, &store.records);
        let done = seed as usize;
        if done >= MOST_ROUNDS * seeds || done >= seeds && rounds - busy.len() >= seeds {
            break;
        }
        all.shuffle(&mut generator(seed));
        for ((target, key), setting) in &all {
            let render = (&scene, target, key, seed);
            let is_it = |p: &PointRecord| (&p.scene, &p.target, &p.key, p.seed) == render;
            if !records_of(&store.records).any(is_it) {
                // No timed render should wait for its tree.
                subject.prepare(setting)?;
                let (rendered, timing) = subject.timed(setting, seed)?;
                let (film, reference) = (&rendered.film, &subject.references[target]);
                let Comparison { mse, relative_mse, bias, .. } = compare(film, reference)?;
                let flip = flip(film, reference, DEFAULT_PIXELS_PER_DEGREE)?.mean;
                store.add(Record::Point(PointRecord {
                    scene: scene.clone(),
                    target: *target,
                    key: key.clone(),
                    seed,
                    seconds: rendered.seconds,
                    timing,
                    rays: rendered.counters.rays.all(),
                    error: ImageErrors { mse, relative_mse, bias, flip },
                }))?;
            }
            progress(SweepProgress::Step(subject.pixels() * setting.work()));
        }
    }
    Ok(())
}

/// Number of preparations for the median of their time, and the seconds after which no further one
/// starts.
const PREPARED: usize = 7;
const SHORT: f64 = 4.0;

/// Records the preparation time of the scene as it is, unless done already.
fn note_preparation(subject: &Subject, store: &mut Store) -> Result<()> {
    let scene = &subject.record.scene;
    if records_of(&store.records).any(|p: &PreparedRecord| p.scene == *scene) {
        return Ok(());
    }
    for _ in rounds(PREPARED, SHORT) {
        let time = subject.build(&Setting::default())?.time;
        store.add(Record::Prepared(PreparedRecord { scene: scene.clone(), time }))?;
    }
    Ok(())
}

/// Tests every precision at the edges and on the faces of the scene's triangles.
fn trials(subject: &mut Subject, store: &mut Store, progress: &OnProgress<'_>) -> Result<()> {
    let scene = subject.record.scene.clone();
    let done = records_of(&store.records).filter(|t: &&TrialRecord| t.scene == scene).count();
    progress(SweepProgress::Stage(&format!("{scene}: leaks and self-hits")));
    for precision in Precision::ALL.into_iter().skip(done) {
        let setting = Setting { precision, ..Setting::default() };
        let accel = &subject.prepare(&setting)?.scene.accel;
        if accel.geometry().triangles.is_empty() {
            return Ok(());
        }
        let found = trial(accel, &Effort { precision, seed: 1, count: Count::Quick });
        store.add(Record::Trial(TrialRecord {
            scene: scene.clone(),
            precision: precision.name().to_owned(),
            leaks: [found.leaks.tried, found.leaks.failed],
            self_hits: [found.self_hits.tried, found.self_hits.failed],
            errors: Box::new(found.errors),
        }))?;
    }
    Ok(())
}
