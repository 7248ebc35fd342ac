//! The sweep itself: its renders, their order, and their records.
//!
//! For each seed, all settings of a scene are rendered in a random order, so that neither a slow
//! minute of the machine nor an earlier render favours one of them.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use super::findings::busy_rounds;
use super::fit::Rng;
use super::reference::{self, Reference};
use super::setting::{Family, Setting, Structure, Target, families};
use super::store::{
    Errors, PointRecord, PreparedRecord, Record, ReferenceRecord, SceneRecord, Store, TrialRecord,
    all,
};
use super::subject::Subject;
use super::{layers, steps};
use crate::measure::Timing;
use crate::selftest::examine::trial;
use crate::selftest::{Count, Effort};
use crate::yardstick::yardstick;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::render::{RenderOptions, Rendered};
use wavecrest_image::compare::compare;
use wavecrest_image::flip::{DEFAULT_PIXELS_PER_DEGREE, flip};
use wavecrest_image::read::read;
use wavecrest_image::write::{Transfer, write};

/// Receives the progress of a sweep. Work is counted in points of pixels: a rough measure, by which
/// the time to go is estimated.
pub trait Progress {
    /// The sweep starts, with this much work.
    fn start(&self, work: u64);
    /// The next stage starts.
    fn stage(&self, name: &str);
    /// Some of the work is done.
    fn step(&self, work: u64);
}

/// The extent of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Largest length of the longer side of images in pixels.
    pub longest: u32,
    /// Number of renders of each setting, each with its own seed.
    pub seeds: u32,
    /// Largest number of points of a kind.
    pub most: u32,
    /// Smallest number of points of a render of the reference.
    pub least: u32,
}

/// A scene with its references, for the report.
#[derive(Debug)]
pub struct Swept {
    /// The scene.
    pub subject: Subject,
    /// The variations.
    pub families: Vec<Family>,
    /// The references of the errors.
    pub references: BTreeMap<&'static str, Reference>,
}

/// Sweeps the scenes of `files` in turn; results in `store` are not repeated.
///
/// # Errors
/// If a scene cannot be rendered, or a record or a reference cannot be written.
pub fn run(
    files: &[PathBuf],
    options: &Options,
    store: &mut Store,
    progress: &dyn Progress,
) -> Result<Vec<Swept>> {
    let open = |file: &PathBuf| Subject::open(file, options.longest);
    let subjects = files.iter().map(open).collect::<Result<Vec<Subject>>>()?;
    progress.start(subjects.iter().map(|subject| work(subject, options)).sum());
    subjects.into_iter().map(|subject| scene(subject, options, store, progress)).collect()
}

/// The work of a scene's sweep.
fn work(subject: &Subject, options: &Options) -> u64 {
    let families = families(&subject.facts(), options.most);
    let targets = Target::ALL.into_iter().filter(|t| families.iter().any(|f| f.target == *t));
    let references = targets.map(|_| reference::least_work(options.least)).sum::<u64>();
    let settings = settings(&families);
    let points: u64 = settings.iter().map(|(.., setting)| setting.work()).sum();
    subject.pixels() * (references + u64::from(options.seeds) * points)
}

fn scene(
    mut subject: Subject,
    options: &Options,
    store: &mut Store,
    progress: &dyn Progress,
) -> Result<Swept> {
    store.admit(SceneRecord {
        scene: subject.name(),
        file: subject.file().to_owned(),
        fingerprint: format!("{:032x}", subject.fingerprint()),
        size: subject.size(),
        primitives: subject.primitives(),
    })?;
    let families = families(&subject.facts(), options.most);
    let mut references = BTreeMap::new();
    for target in Target::ALL {
        let approached: Vec<&Family> = families.iter().filter(|f| f.target == target).collect();
        if !approached.is_empty() {
            let found = reference(&mut subject, target, &approached, options, store, progress)?;
            references.insert(target.name(), found);
            progress.step(subject.pixels() * reference::least_work(options.least));
        }
    }
    points(&mut subject, &families, &references, options, store, progress)?;
    layers::run(&mut subject, store, progress)?;
    trials(&mut subject, store, progress)?;
    steps::run(&mut subject, store, progress)?;
    Ok(Swept { subject, families, references })
}

/// The reference of `target`, from the folder if it exists.
fn reference(
    subject: &mut Subject,
    target: Target,
    families: &[&Family],
    options: &Options,
    store: &mut Store,
    progress: &dyn Progress,
) -> Result<Reference> {
    let name = subject.name();
    if let Some(known) = known_reference(store, &name, target)? {
        return Ok(known);
    }
    progress.stage(&format!("{name}: reference ({})", target.name()));
    let nearest = nearest(families);
    let smallest = |subject: &mut Subject, film: &Film| {
        let mut smallest = f64::INFINITY;
        for setting in &nearest {
            let rendered = subject.render(setting, &RenderOptions::default())?;
            smallest = smallest.min(compare(&rendered.film, film)?.rmse);
        }
        Ok(smallest)
    };
    let made = reference::make(subject, target, options.least, smallest)?;
    let file = format!("{name}-{}.exr", target.name());
    write(&made.film, &store.folder().join(&file), Transfer::Linear)?;
    store.add(Record::Reference(ReferenceRecord {
        scene: name,
        target,
        file,
        samples: made.samples,
        replicates: made.replicates,
        standard_error: made.standard_error,
        seconds: made.seconds,
    }))?;
    Ok(made)
}

/// The reference in `store`.
fn known_reference(store: &Store, scene: &str, target: Target) -> Result<Option<Reference>> {
    let is_it = |known: &&ReferenceRecord| known.scene == scene && known.target == target;
    let Some(known) = all(&store.records).find(is_it) else { return Ok(None) };
    let film = read(&store.folder().join(&known.file))?;
    let &ReferenceRecord { samples, replicates, standard_error, seconds, .. } = known;
    Ok(Some(Reference { film, samples, replicates, standard_error, seconds }))
}

/// The settings nearest to a reference: the last of each converging line.
fn nearest(families: &[&Family]) -> Vec<Setting> {
    families
        .iter()
        .filter(|family| family.has_slope)
        .flat_map(|family| family.series.iter().filter_map(|line| line.points.last()))
        .map(|(.., setting)| *setting)
        .collect()
}

/// Each setting of the families once, with its target and its key.
fn settings(families: &[Family]) -> Vec<(Target, String, Setting)> {
    let lines = families.iter().flat_map(|f| f.series.iter().map(move |line| (f.target, line)));
    let mut all: Vec<(Target, String, Setting)> = lines
        .flat_map(|(target, line)| line.points.iter().map(move |(.., s)| (target, s.key(), *s)))
        .collect();
    all.sort_by(|a, b| (a.0.name(), &a.1).cmp(&(b.0.name(), &b.1)));
    all.dedup_by(|a, b| (a.0, &a.1) == (b.0, &b.1));
    all
}

/// Largest number of rounds, busy or not, as a multiple of those that are to be kept.
const MOST_ROUNDS: usize = 2;

/// Renders every setting with every seed.
fn points(
    subject: &mut Subject,
    families: &[Family],
    references: &BTreeMap<&'static str, Reference>,
    options: &Options,
    store: &mut Store,
    progress: &dyn Progress,
) -> Result<()> {
    let name = subject.name();
    let mut all = settings(families);
    note_preparation(subject, all.iter().map(|(.., setting)| setting), store)?;
    progress.stage(&name);
    let seeds = options.seeds as usize;
    for seed in 0.. {
        // Busy rounds are measured again, with other seeds.
        let (rounds, busy) = busy_rounds(&name, &store.records);
        let done = seed as usize;
        if done >= MOST_ROUNDS * seeds || done >= seeds && rounds - busy.len() >= seeds {
            break;
        }
        Rng::new(seed).shuffle(&mut all);
        for (target, key, setting) in &all {
            if !store.has(&name, *target, key, seed)
                && let Some(reference) = references.get(target.name())
            {
                warm_up(subject, &setting.structure)?;
                let yardstick = yardstick();
                let options = RenderOptions { seed, ..RenderOptions::default() };
                let (rendered, timing) = timed(subject, setting, &options)?;
                let error = errors(&rendered.film, &reference.film)?;
                let record = point(&name, *target, key, seed, &rendered, error);
                let timing = Some(timing);
                store.add(Record::Point(PointRecord { yardstick, timing, ..record }))?;
            }
            progress.step(subject.pixels() * setting.work());
        }
    }
    Ok(())
}

/// Renders that take less than this in seconds together are repeated, up to a limit.
const LEAST_TIMED: f64 = 0.01;
const REPETITIONS: usize = 10;

/// A render with the time of its fastest repetition: other programs can only add to a time, and
/// they add much to a millisecond. The timing is that of all repetitions.
///
/// # Errors
/// As [`Subject::render`].
pub(super) fn timed(
    subject: &mut Subject,
    setting: &Setting,
    options: &RenderOptions,
) -> Result<(Rendered, Timing)> {
    let (quickest, timing) = Timing::of(|| {
        let mut quickest = subject.render(setting, options)?;
        let mut spent = quickest.seconds;
        for _ in 1..REPETITIONS {
            if spent >= LEAST_TIMED {
                break;
            }
            let again = subject.render(setting, options)?;
            spent += again.seconds;
            if again.seconds < quickest.seconds {
                quickest = again;
            }
        }
        Ok(quickest)
    });
    Ok((quickest?, timing))
}

fn point(
    scene: &str,
    target: Target,
    key: &str,
    seed: u64,
    rendered: &Rendered,
    error: Errors,
) -> PointRecord {
    let c = &rendered.counters;
    let passes = rendered.pass_seconds.iter().map(|(name, s)| ((*name).to_owned(), *s)).collect();
    PointRecord {
        scene: scene.to_owned(),
        target,
        key: key.to_owned(),
        seed,
        seconds: rendered.seconds,
        yardstick: 0.0,
        timing: None,
        passes,
        rays: c.primary_rays + c.secondary_rays + c.shadow_rays,
        error,
    }
}

/// Prepares a structure if necessary, and traces some rays, so that the first timed render finds
/// the memory like the others.
fn warm_up(subject: &mut Subject, structure: &Structure) -> Result<()> {
    if !subject.is_prepared(structure) {
        let setting = Setting { structure: *structure, ..Setting::default() };
        subject.render(&setting.least(), &RenderOptions::default())?;
    }
    Ok(())
}

/// Number of preparations of a structure for the median of its time, and the seconds after which no
/// further one starts.
const PREPARED: usize = 7;
const SHORT: f64 = 3.0;

/// Records the preparation time of each structure of `settings`, unless done already.
fn note_preparation<'a>(
    subject: &mut Subject,
    settings: impl Iterator<Item = &'a Setting>,
    store: &mut Store,
) -> Result<()> {
    let scene = subject.name();
    for setting in settings {
        let key = Setting { samples: Default::default(), ..*setting }.key();
        if all(&store.records).any(|p: &PreparedRecord| p.scene == scene && p.key == key) {
            continue;
        }
        let mut note = |time| {
            let (scene, key) = (scene.clone(), key.clone());
            store.add(Record::Prepared(PreparedRecord { scene, key, time }))
        };
        note(subject.prepare(&setting.structure)?.time)?;
        let start = Instant::now();
        for _ in 1..PREPARED {
            if start.elapsed().as_secs_f64() > SHORT {
                break;
            }
            note(subject.build(&setting.structure, subject.preset())?.time)?;
        }
    }
    Ok(())
}

/// The errors of `film` against `reference`.
///
/// # Errors
/// If their sizes differ.
pub fn errors(film: &Film, reference: &Film) -> Result<Errors> {
    let found = compare(film, reference)?;
    let mut seen = flip(film, reference, DEFAULT_PIXELS_PER_DEGREE)?;
    let flip_95 = {
        let most = seen.map.len().saturating_sub(1) * 95 / 100;
        seen.map.select_nth_unstable_by(most, f32::total_cmp);
        f64::from(seen.map[most])
    };
    let (mse, relative_mse, bias) = (found.mse, found.relative_mse, found.bias);
    Ok(Errors { mse, relative_mse, bias, flip: seen.mean, flip_95 })
}

/// Tests every precision at the edges and on the faces of the scene's triangles.
fn trials(subject: &mut Subject, store: &mut Store, progress: &dyn Progress) -> Result<()> {
    let name = subject.name();
    let done = all(&store.records).filter(|t: &&TrialRecord| t.scene == name).count();
    progress.stage(&format!("{name}: leaks and self-hits"));
    for precision in Precision::ALL.into_iter().skip(done) {
        let structure = Structure { precision, ..Structure::default() };
        let accel = &subject.prepare(&structure)?.scene.accel;
        if accel.geometry().triangles.is_empty() {
            return Ok(());
        }
        let found = trial(accel, &Effort { precision, seed: 1, count: Count::Quick });
        store.add(Record::Trial(TrialRecord {
            scene: name.clone(),
            precision: precision.name().to_owned(),
            leaks: [found.leaks.tried, found.leaks.failed],
            self_hits: [found.self_hits.tried, found.self_hits.failed],
            errors: Some(Box::new(found.errors)),
        }))?;
    }
    Ok(())
}
