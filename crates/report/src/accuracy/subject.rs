//! A scene rendered in many ways: prepared once for each structure, with new samples for each
//! render.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::time::Instant;

use super::setting::{CountedSetting, Facts, Family, Setting, Target, families};
use super::store::SceneRecord;
use crate::bench::Preparation;
use crate::measure::{Timing, rounds};
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::film::Film;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::prepared::{Original, PreparedScene};
use wavecrest_core::render::{RenderOptions, Rendered, Watch, render};
use wavecrest_scene::load::{LoadOptions, load};
use wavecrest_scene::systems::overrides::{self, Overrides};
use wavecrest_scene::systems::{Options, extract};

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
    pub references: BTreeMap<Target, Film>,
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
        let options = Options { precision: setting.precision, ..Options::default() };
        let extracted = extract(loaded.world, options)?;
        // No render should wait for an image.
        extracted.scene().appearance.decode()?;
        let load = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let scene = extracted.build(Preset::Fast);
        let build = start.elapsed().as_secs_f64();
        let original = scene.original();
        Ok(PreparedSubject { scene, original, time: Preparation { load, build } })
    }

    /// Renders it.
    ///
    /// # Errors
    /// If it can no longer be prepared, or there is no memory for the image.
    pub fn render(&mut self, setting: &Setting, seed: u64) -> Result<Rendered> {
        self.render_with(KernelChoice::default(), setting, seed, &())
    }

    /// As [`Self::render`], with this kernel, watched.
    ///
    /// # Errors
    /// As for [`Self::render`].
    pub fn render_with(
        &mut self,
        kernel: KernelChoice,
        setting: &Setting,
        seed: u64,
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
            let mut quickest = self.render(setting, seed)?;
            for _ in repetitions {
                let again = self.render(setting, seed)?;
                if again.seconds < quickest.seconds {
                    quickest = again;
                }
            }
            Ok(quickest)
        });
        Ok((quickest?, timing))
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
