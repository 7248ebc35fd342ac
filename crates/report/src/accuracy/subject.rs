//! A scene rendered in many ways: prepared once for each precision and override of its file, with new samples for each
//! render; and its reference images, with their own standard error.
//!
//! A reference is the mean of several renders with the reference kernel and different random numbers.
//! Each is unbiased, so their spread estimates the distance of the mean from the truth: the
//! standard error, as a root mean square over all values of the image. An error below [`FLOOR`]
//! standard errors is noise of the reference; renders are added until the reference is accurate
//! enough for the comparisons, or until there are [`MOST_REPLICATES`].

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use super::setting::{Axis, CountedSetting, Facts, Family, Setting, Truth, converges, families};
use super::store::{Record, ReferenceRecord, SceneRecord, Store, records_of};
use super::{OnProgress, SweepProgress};
use crate::bench::Preparation;
use crate::measure::{Timing, rounds};
use wavecrest_api::SceneOptions;
use wavecrest_api::session::Session;
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::film::Film;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::{Original, PreparedScene};
use wavecrest_core::render::{Progress, RenderOptions, Rendered, Watch, render};
use wavecrest_image::compare::compare;
use wavecrest_image::read::read;
use wavecrest_image::write::{Transfer, write};
use wavecrest_scene::load::{LoadOptions, load};
use wavecrest_scene::systems::extract;
use wavecrest_scene::systems::overrides::{self, Overrides};

/// A scene, and its prepared structures.
#[derive(Debug)]
pub struct Subject {
    /// Its file and its size, under its name.
    pub record: SceneRecord,
    /// The properties that can be varied.
    pub facts: Facts,
    /// The variations.
    pub families: Vec<Family<CountedSetting>>,
    /// The references of errors, once they are rendered.
    pub references: BTreeMap<Truth, Film>,
    prepared: HashMap<(Precision, Overrides), PreparedSubject>,
}

/// A scene prepared in one structure.
#[derive(Debug)]
pub struct PreparedSubject {
    /// The scene, with the samples of the last render.
    pub scene: PreparedScene,
    /// Its original samples.
    pub original: Original,
    /// The time of its preparation.
    pub time: Preparation,
}

/// Renders that take less than this in seconds together are repeated, up to a limit.
const LEAST_TIMED: f64 = 0.01;
const REPETITIONS: usize = 10;

/// Memory limit of prepared scenes: at least one is kept, and more up to this number of bytes, 4
/// GiB.
const MOST_BYTES: u64 = 4 << 30;

/// Errors of at least this many standard errors are above the noise of the reference.
pub const FLOOR: f64 = 3.0;

/// Smallest number of renders of a reference: fewer would not show their spread.
const LEAST_REPLICATES: usize = 4;

/// Largest number of renders.
const MOST_REPLICATES: usize = 32;

/// Their first seed, which no other render uses.
const FIRST_SEED: u64 = 1 << 63;

impl Subject {
    /// The scene of `file`, with images of at most `longest` pixels on the longer side, and variations with up to
    /// `most` points of a kind.
    ///
    /// # Errors
    /// If it cannot be loaded or prepared.
    pub fn open(file: &Path, longest: u32, most: u32) -> Result<Self> {
        let full = extract(load(file, &LoadOptions::default())?.world, Default::default())?;
        let record = SceneRecord {
            scene: file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            file: file.to_owned(),
            fingerprint: format!("{:032x}", full.scene().fingerprint()),
            size: within(full.scene().camera.size(), longest),
            primitives: full.geometry().held() as u64,
        };
        let facts = Facts::of(full.scene());
        let families = families(&facts, most);
        let (references, prepared) = (BTreeMap::new(), HashMap::new());
        Ok(Self { record, facts, families, references, prepared })
    }

    /// The number of pixels of its images.
    pub fn pixels(&self) -> u64 {
        self.record.size.map(u64::from).iter().product()
    }

    /// The scene for `setting`, prepared if necessary.
    ///
    /// # Errors
    /// If it can no longer be loaded or prepared.
    pub fn prepare(&mut self, setting: &Setting) -> Result<&mut PreparedSubject> {
        let key = (setting.precision, setting.overrides);
        let prepared = match self.prepared.remove(&key) {
            Some(prepared) => prepared,
            None => {
                self.make_room();
                self.build(setting)?
            }
        };
        Ok(self.prepared.entry(key).or_insert(prepared))
    }

    /// Prepares the scene without keeping it.
    ///
    /// # Errors
    /// If it can no longer be loaded or prepared.
    pub fn build(&self, setting: &Setting) -> Result<PreparedSubject> {
        let [width, height] = self.record.size.map(Some);
        let start = Instant::now();
        let mut loaded =
            load(&self.record.file, &LoadOptions { width, height, ..LoadOptions::default() })?;
        overrides::apply(&mut loaded.world, &setting.overrides);
        // No render should wait for an image.
        let (precision, bvh) = (setting.precision, Some(Preset::Fast));
        let options = SceneOptions { precision, bvh, at_once: true, ..SceneOptions::default() };
        let Session { scene, seconds: [_, build], .. } = Session::of(loaded, &options, |_| Ok(()))?;
        let load = start.elapsed().as_secs_f64() - build;
        let original = scene.original();
        Ok(PreparedSubject { scene, original, time: Preparation { load, build } })
    }

    /// Renders it with this kernel, watched.
    ///
    /// # Errors
    /// If it can no longer be prepared, or there is no memory for the image.
    pub fn render(
        &mut self,
        setting: &Setting,
        seed: u64,
        kernel: KernelChoice,
        watch: &dyn Watch,
    ) -> Result<Rendered> {
        let PreparedSubject { scene, original, .. } = self.prepare(setting)?;
        scene.resample(original, &setting.samples);
        let usual = std::mem::replace(&mut scene.accel.kernel, kernel);
        let options = RenderOptions { seed, ..RenderOptions::default() };
        let rendered = render(scene, &options, watch);
        scene.accel.kernel = usual;
        rendered
    }

    /// As [`Self::render`], with the time of its fastest repetition: other programs can only add to a
    /// time, and they add much to a millisecond. The timing is that of all repetitions.
    ///
    /// # Errors
    /// As for [`Self::render`].
    pub fn timed(&mut self, setting: &Setting, seed: u64) -> Result<(Rendered, Timing)> {
        let (quickest, timing) = Timing::of(|| {
            let repetitions = rounds(REPETITIONS, LEAST_TIMED).skip(1);
            let mut quickest = self.render(setting, seed, KernelChoice::default(), &())?;
            for _ in repetitions {
                let again = self.render(setting, seed, KernelChoice::default(), &())?;
                if again.seconds < quickest.seconds {
                    quickest = again;
                }
            }
            Ok(quickest)
        });
        Ok((quickest?, timing))
    }

    /// The reference of `target` in `store`, or a new one, with the least points of each kind there:
    /// rendered until the errors of the settings nearest to it are above its noise.
    ///
    /// # Errors
    /// If the scene can no longer be rendered, or the reference can be neither read nor written.
    pub(super) fn reference(
        &mut self,
        target: Truth,
        store: &mut Store,
        progress: &OnProgress<'_>,
    ) -> Result<Film> {
        let (scene, least) = (self.record.scene.clone(), store.header.least);
        let is_it = |known: &&ReferenceRecord| known.scene == scene && known.target == target;
        let work = REFERENCE_COST * u64::from(least);
        let of_one = self.pixels() * work;
        if let Some(known) = records_of(&store.records).find(is_it) {
            progress(SweepProgress::Step(LEAST_REPLICATES as u64 * of_one));
            return read(&store.folder.join(&known.file));
        }
        let approached = self.families.iter().filter(|family| family.target == target);
        let last = approached.flat_map(|family| &family.series).filter_map(|s| s.points.last());
        let nearest = last.filter(|(.., setting)| converges(&setting.key()));
        let nearest: Vec<Setting> = nearest.map(|(.., setting)| *setting).collect();
        let (setting, count) = setting(&self.facts, target, least);
        let is_sampled = self.facts.is_sampled(target);
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
            let rendered = self.render(&setting, seed, KernelChoice::Reference, &watch)?;
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
                let rendered = self.render(setting, 0, KernelChoice::default(), &())?;
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

    /// Drops prepared scenes until another one fits.
    fn make_room(&mut self) {
        let bytes = |prepared: &PreparedSubject| prepared.scene.bytes();
        let largest = self.prepared.values().map(bytes).max().unwrap_or(0);
        while self.prepared.values().map(bytes).sum::<u64>() + largest > MOST_BYTES {
            let Some(&first) = self.prepared.keys().next() else { return };
            self.prepared.remove(&first);
        }
    }
}

/// The size with the same proportions and a longer side of at most `longest`.
fn within(size: [u32; 2], longest: u32) -> [u32; 2] {
    let side = size.into_iter().fold(longest, u32::max);
    size.map(|n| (u64::from(n) * u64::from(longest) / u64::from(side)).max(1) as u32)
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

/// The variance of a value between images of one size: the mean over all their values.
fn variance(films: &[Film]) -> f64 {
    let n = films.len() as f64;
    let values = films.first().map_or(0, |film| film.pixels().len() * 3);
    let of = |index: usize| {
        let each = || films.iter().map(move |film| f64::from(film.pixels().as_flattened()[index]));
        let mean = each().sum::<f64>() / n;
        each().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0)
    };
    (0..values).map(of).sum::<f64>() / values.max(1) as f64
}

/// The setting of the reference of `target`, and the number of points of each kind in the scene: at
/// least `least` for each sampled kind.
fn setting(facts: &Facts, target: Truth, least: u32) -> (Setting, u32) {
    if !facts.is_sampled(target) {
        return (Setting::default(), 1);
    }
    let side = (1..).find(|side| side * side >= least).unwrap_or(1);
    let points = Points { sampling: Sampling::Sobol, side };
    let axis = if target == Truth::Pixel { Axis::Pixel(facts.lights) } else { Axis::of(facts) };
    (Setting { samples: axis.samples(points), ..Setting::default() }, points.count())
}

/// The least work of a reference for each of its points: see [`Setting::work`].
pub(super) const LEAST_WORK: u64 = REFERENCE_COST * LEAST_REPLICATES as u64;

/// How many times as long as the usual kernel the reference kernel takes, roughly.
const REFERENCE_COST: u64 = 3;
