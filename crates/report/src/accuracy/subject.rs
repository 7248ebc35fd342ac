//! A scene rendered in many ways: prepared once for each structure, with new samples for each
//! render.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::setting::{Facts, Setting, Structure};
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::prepared::{Original, PreparedScene};
use wavecrest_core::render::{RenderOptions, Rendered, render};
use wavecrest_scene::load::{LoadOptions, load};
use wavecrest_scene::systems::{Options, extract, overrides};

/// A scene's file, and its prepared structures.
#[derive(Debug)]
pub struct Subject {
    file: PathBuf,
    size: [u32; 2],
    facts: Facts,
    fingerprint: u128,
    primitives: u64,
    preset: Preset,
    prepared: HashMap<Structure, Prepared>,
}

/// A scene prepared in one structure.
#[derive(Debug)]
pub struct Prepared {
    /// The scene, with the samples of the last render.
    pub scene: PreparedScene,
    /// Its original samples.
    pub original: Original,
    /// The time of its preparation.
    pub time: Stages,
}

/// Seconds before the first ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Stages {
    /// Reading the file and the files that it names, and extracting arrays.
    pub load: f64,
    /// Building the tree.
    pub build: f64,
}

/// Memory limit of prepared scenes: at least one is kept, and more up to this number of bytes, 4
/// GiB.
const MOST_BYTES: u64 = 4 << 30;

impl Subject {
    /// The scene of `file`, with images of at most `longest` pixels on the longer side.
    ///
    /// # Errors
    /// If it cannot be loaded or prepared.
    pub fn open(file: &Path, longest: u32) -> Result<Self> {
        let full = extract(&mut load(file, &LoadOptions::default())?.world, Default::default())?;
        let facts = Facts::of(full.scene());
        let size = within(full.scene().camera.size(), longest);
        Ok(Self {
            file: file.to_owned(),
            size,
            facts,
            fingerprint: full.scene().fingerprint(),
            primitives: full.geometry().held() as u64,
            preset: Preset::Fast,
            prepared: HashMap::new(),
        })
    }

    /// The scene's file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The name of the file without folder and extension.
    pub fn name(&self) -> String {
        self.file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Width and height of its images.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The number of pixels of its images.
    pub fn pixels(&self) -> u64 {
        self.size.map(u64::from).iter().product()
    }

    /// The properties that can be varied.
    pub fn facts(&self) -> Facts {
        self.facts
    }

    /// A hash of the scene: see [`PreparedScene::fingerprint`].
    pub fn fingerprint(&self) -> u128 {
        self.fingerprint
    }

    /// Number of triangles, quads and spheres.
    pub fn primitives(&self) -> u64 {
        self.primitives
    }

    /// Whether a structure is prepared and in memory.
    pub fn is_prepared(&self, structure: &Structure) -> bool {
        self.prepared.contains_key(structure)
    }

    /// The preset of its trees.
    pub fn preset(&self) -> Preset {
        self.preset
    }

    /// The scene in `structure`, prepared if necessary.
    ///
    /// # Errors
    /// If it can no longer be loaded or prepared.
    pub fn prepare(&mut self, structure: &Structure) -> Result<&mut Prepared> {
        let prepared = match self.prepared.remove(structure) {
            Some(prepared) => prepared,
            None => {
                self.make_room();
                self.build(structure, self.preset)?
            }
        };
        Ok(self.prepared.entry(*structure).or_insert(prepared))
    }

    /// Prepares the scene with another preset, without keeping it.
    ///
    /// # Errors
    /// If it can no longer be loaded or prepared.
    pub fn build(&self, structure: &Structure, preset: Preset) -> Result<Prepared> {
        let [width, height] = self.size.map(Some);
        let start = Instant::now();
        let mut loaded =
            load(&self.file, &LoadOptions { width, height, ..LoadOptions::default() })?;
        overrides::apply(&mut loaded.world, &structure.overrides);
        let options = Options { precision: structure.precision, ..Options::default() };
        let extracted = extract(&mut loaded.world, options)?;
        // No render should wait for an image.
        extracted.scene().appearance.decode()?;
        let load = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let scene = extracted.build(preset);
        let build = start.elapsed().as_secs_f64();
        let original = scene.original();
        Ok(Prepared { scene, original, time: Stages { load, build } })
    }

    /// Renders it.
    ///
    /// # Errors
    /// If it can no longer be prepared, or there is no memory for the image.
    pub fn render(&mut self, setting: &Setting, options: &RenderOptions) -> Result<Rendered> {
        self.render_with(KernelChoice::default(), setting, options)
    }

    /// As [`Self::render`], with this kernel.
    ///
    /// # Errors
    /// As for [`Self::render`].
    pub fn render_with(
        &mut self,
        kernel: KernelChoice,
        setting: &Setting,
        options: &RenderOptions,
    ) -> Result<Rendered> {
        let Prepared { scene, original, .. } = self.prepare(&setting.structure)?;
        scene.resample(original, &setting.samples);
        let usual = std::mem::replace(&mut scene.accel.kernel, kernel);
        let rendered = render(scene, options, &());
        scene.accel.kernel = usual;
        rendered
    }

    /// Drops prepared scenes until another one fits.
    fn make_room(&mut self) {
        let bytes = |prepared: &Prepared| prepared.scene.bytes();
        let largest = self.prepared.values().map(bytes).max().unwrap_or(0);
        while self.prepared.values().map(bytes).sum::<u64>() + largest > MOST_BYTES {
            let Some(&first) = self.prepared.keys().next() else { return };
            self.prepared.remove(&first);
        }
    }
}

/// The size with the same proportions and a longer side of at most `longest`.
fn within([width, height]: [u32; 2], longest: u32) -> [u32; 2] {
    let side = width.max(height);
    if side <= longest {
        return [width, height];
    }
    [width, height].map(|n| {
        let scaled = u64::from(n) * u64::from(longest) / u64::from(side);
        scaled.max(1) as u32
    })
}
