//! Every scene, read once: one image, whose hash `tests/golden.txt` has, whatever the tracer, the number of threads, the
//! size of the batches, the instructions, the kernel, the tree, the plan and the part that is rendered, and once the scene
//! has been written and read again; and hits without leaks.
//!
//! `WAVECREST_BLESS=1 cargo test --test integration parity` writes the hashes again. An image with another hash is left in
//! `target/tmp/golden/`. All arithmetic of the renderer is IEEE 754 without functions of the machine's own, so that every
//! machine gives the same bits.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde_json::Value;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::counters::Counters;
use wavecrest_core::film::Film;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::plan::Effect;
use wavecrest_core::plan::schedule::UNPLANNED;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, TracerKind};
use wavecrest_core::tile::Tile;
use wavecrest_image::look::Look;
use wavecrest_image::write::Transfer;
use wavecrest_report::selftest::examine::{SceneTrial, trial};
use wavecrest_report::selftest::{Count, Effort};
use wavecrest_scene::load::{LoadOptions, LoadedScene, load};
use wavecrest_scene::systems::SceneOptions;
use wavecrest_scene::write::write;
use xxhash_rust::xxh3::xxh3_64;

use crate::planning::check_work;
use crate::support::{
    TRACERS, blessing, both, files_in, folder, image, load_small, options, prepare, ready,
    ready_by, render_on, repository, scene_files, stem,
};

/// Where the hashes of images are recorded, a name and its hash a line.
const GOLDEN: &str = "tests/golden.txt";

/// The longest side of the images, in pixels: several tiles, and no multiple of one.
const LONGEST: u32 = 45;

/// The most rays that one image may take: scenes of thousands of samples are rendered smaller.
const MOST_RAYS: u64 = 200_000;

/// What may not show. Levels differ in the width of their registers, and batches that are no multiple of a vector leave
/// lanes out of use; kernels share what they compute and not how, nor what they leave to each other.
#[derive(Clone, Copy, Debug)]
struct Setting {
    tracer: TracerKind,
    threads: usize,
    batch: usize,
    level: Level,
    kernel: KernelChoice,
}

/// Sizes of batches about those of vectors, tiles and the usual batch.
const BATCHES: [usize; 10] = [1, 3, 7, 8, 9, 64, 65, 1001, 1024, 5000];

/// Those of most scenes.
const SOME_BATCHES: [usize; 3] = [1, 13, 5000];

/// One thing after the other; every size of batch, each with every level, where `all` are asked for. The recursive tracer
/// has no batches.
fn settings(all: bool) -> Vec<Setting> {
    let (batch, level) = (options().batch, Level::best());
    let usual = Setting {
        tracer: TracerKind::Wavefront,
        threads: 1,
        batch,
        level,
        kernel: KernelChoice::Auto,
    };
    let recursive = Setting { tracer: TracerKind::Recursive, ..usual };
    let some = if all { &BATCHES[..] } else { &[13] };
    let batches = if all { &BATCHES[..] } else { &SOME_BATCHES };
    let mut settings: Vec<Setting> =
        batches.iter().map(|&batch| Setting { batch, ..usual }).collect();
    settings.extend([usual, recursive].map(|usual| Setting { threads: 3, ..usual }));
    for level in Level::available() {
        settings.push(Setting { level, ..recursive });
        settings.extend(some.iter().map(|&batch| Setting { level, batch, ..usual }));
    }
    for kernel in KernelChoice::ALL.into_iter().filter(|&kernel| kernel != usual.kernel) {
        settings.extend([13, 1024].map(|batch| Setting { kernel, batch, ..usual }));
    }
    settings
}

fn film(scene: &PreparedScene, options: RenderOptions) -> Film {
    render_on(1, scene, &options).film
}

fn same(expected: &Film, found: &Film, what: impl std::fmt::Debug) -> Result<(), String> {
    if found.same_bits(expected) {
        return Ok(());
    }
    let differing = expected.pixels().iter().zip(found.pixels()).filter(|(a, b)| a != b).count();
    Err(format!("{what:?}: {differing} pixels differ"))
}

/// All that is counted but how hits are searched for, which is each tracer's own affair.
pub(crate) fn work(counters: &Counters) -> Counters {
    let Counters { tests, kernels, .. } = Counters::default();
    Counters { tests, kernels, ..*counters }
}

/// Renders with every setting: one image, and the same work.
fn check_settings(
    name: &str,
    scene: &mut PreparedScene,
    usual: &Rendered,
    all: bool,
) -> Result<(), String> {
    check_work(name, scene, usual, &options());
    for setting in settings(all) {
        let Setting { tracer, threads, batch, level, kernel } = setting;
        scene.accel.level = level.token().expect("it is available");
        scene.accel.kernel = kernel;
        let found = render_on(threads, scene, &RenderOptions { tracer, batch, ..options() });
        same(&usual.film, &found.film, setting)?;
        let (c, rays) = (&found.counters, &found.counters.kernels);
        // Camera rays that meet nothing are left out by the batch: how many depends on its size.
        let mut expected = work(&usual.counters);
        if batch != options().batch {
            (expected.rays.primary, expected.samples.lens) = (c.rays.primary, c.samples.lens);
        }
        if work(c) != expected
            || rays.closest.rays() != c.rays.primary + c.rays.secondary
            || rays.shadow.rays() != c.rays.shadow
        {
            return Err(format!("{setting:?}: {c:?}, not {expected:?}"));
        }
    }
    scene.accel.kernel = KernelChoice::Auto;
    check_crops(scene, &usual.film)
}

/// A part from the middle, the last pixel, and a column are those of the whole image.
fn check_crops(scene: &PreparedScene, whole: &Film) -> Result<(), String> {
    let (width, height) = (whole.width(), whole.height());
    let (x, y) = (width / 3, height / 3);
    let crops = [
        Tile { x, y, width: (width - x).div_ceil(2), height: (height - y).div_ceil(2) },
        Tile { x: width - 1, y: height - 1, width: 1, height: 1 },
        Tile { x, y: 0, width: 1, height },
    ];
    crops.into_iter().try_for_each(|crop| {
        let Tile { x, y, width, height } = crop;
        let part = whole.part([x, y, width, height]).expect("it lies within the image");
        TRACERS.into_iter().try_for_each(|tracer| {
            let found = film(scene, RenderOptions { tracer, crop: Some(crop), ..options() });
            same(&part, &found, (tracer, crop))
        })
    })
}

/// No ray passes between surfaces, or meets the one that it leaves.
fn check_hits(scene: &PreparedScene) -> Result<(), String> {
    let effort = Effort { precision: Precision::Exact, seed: 1, count: Count::Brief };
    let SceneTrial { leaks, self_hits, .. } = trial(&scene.accel, &effort);
    let is_tried = self_hits.tried > 0 || scene.accel.geometry().is_empty();
    let is_right = is_tried && leaks.failed == 0 && self_hits.failed == 0;
    is_right.then_some(()).ok_or_else(|| format!("{leaks:?}, {self_hits:?}"))
}

/// Whether any random number decides what this scene shows.
fn draws_numbers(scene: &PreparedScene) -> bool {
    [Effect::DepthOfField, Effect::Antialiasing].into_iter().any(|effect| scene.plan.has(effect))
        || scene.lights.iter().any(|light| light.is_sampled())
}

/// The seed changes images of scenes that draw random numbers, and no others.
fn check_seeds(scene: &PreparedScene, usual: &Film) -> Result<(), String> {
    let other = film(scene, RenderOptions { seed: 1, ..options() });
    match (draws_numbers(scene), usual.same_bits(&other)) {
        (true, true) => Err("the seed does nothing".to_owned()),
        (false, false) => Err("the seed changes the image".to_owned()),
        _ => Ok(()),
    }
}

/// Any tree gives the image of testing everything, in a part: without a tree every ray tests every primitive.
fn check_trees(scene: &mut PreparedScene, whole: &Film) -> Result<(), String> {
    let (width, height) = (whole.width().div_ceil(4), whole.height().div_ceil(4));
    let (x, y) = ((whole.width() - width) / 2, (whole.height() - height) / 2);
    let crop = Tile { x, y, width, height };
    let part = whole.part([x, y, width, height]).expect("it lies within the image");
    Preset::ALL.into_iter().try_for_each(|preset| {
        scene.accel.rebuild(preset);
        TRACERS.into_iter().try_for_each(|tracer| {
            let found = film(scene, RenderOptions { tracer, crop: Some(crop), ..options() });
            same(&part, &found, (preset, tracer))
        })
    })
}

/// Running everything, planned or not, gives the same image.
fn check_plan(path: &Path, whole: &Film) -> Result<(), String> {
    let everything = SceneOptions { passes: &UNPLANNED, ..SceneOptions::default() };
    let everything = ready_by(Ok(load_small(path, LONGEST, MOST_RAYS)), everything);
    both(&everything).iter().try_for_each(|found| same(whole, &found.film, "unplanned"))
}

/// The image of the scene once it has been written and read again, which is then written the same.
fn written(scene: &LoadedScene) -> Result<Film, String> {
    let text = |error: wavecrest_base::error::Error| error.to_string();
    let folders = [folder(), folder()];
    let [once, twice] = folders.each_ref().map(|folder| folder.path().join("out.json"));
    write(scene, &once, false).map_err(text)?;
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    let again = load(&once, &strict).map_err(text)?;
    for file in write(&again, &twice, false).map_err(text)? {
        let first = once.with_file_name(file.file_name().expect("a name"));
        if std::fs::read(first).ok() != std::fs::read(&file).ok() {
            return Err(format!("{} is written otherwise", file.display()));
        }
    }
    Ok(film(&ready(Ok(again)), options()))
}

/// Compares the hash of an image with the recorded one; otherwise the image is left to be seen.
fn check_hash(name: &str, film: &Film, hash: &str, golden: Option<&str>) -> Result<(), String> {
    if blessing() || golden == Some(hash) {
        return Ok(());
    }
    let seen = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden").join(format!("{name}.exr"));
    std::fs::create_dir_all(seen.parent().expect("a folder")).expect("a folder");
    wavecrest_image::write::write(film, &seen, Transfer::Linear).expect("an image");
    let again = "WAVECREST_BLESS=1 cargo test --test integration parity";
    let golden = golden.unwrap_or("none");
    Err(format!("hash {hash}, not {golden}: see {}; if it is right: {again}", seen.display()))
}

/// Copies of what was loaded are prepared as they are, and leave it as it was.
fn check_copies(loaded: LoadedScene, fingerprint: u128) -> Result<(), String> {
    let clay = SceneOptions { look: Some(Look::Clay), ..SceneOptions::default() };
    let _ = ready_by(Ok(loaded.clone()), clay);
    let same = ready(Ok(loaded)).fingerprint() == fingerprint;
    same.then_some(()).ok_or_else(|| "a copy is another scene".to_owned())
}

fn hash(film: &Film) -> String {
    let bits = film.pixels().as_flattened().iter().flat_map(|value| value.to_bits().to_le_bytes());
    format!("{:016x}", xxh3_64(&bits.collect::<Vec<u8>>()))
}

#[test]
fn every_scene_has_one_image_however_it_is_rendered() {
    let golden = std::fs::read_to_string(repository(GOLDEN)).expect("a file");
    let golden: BTreeMap<&str, &str> =
        golden.lines().map(|line| line.split_once(": ").expect("a name and a hash")).collect();
    let check = |(name, path): &(String, PathBuf)| {
        let loaded = load_small(path, LONGEST, MOST_RAYS);
        let again = written(&loaded);
        let mut scene = ready(Ok(loaded.clone()));
        let prepared = scene.fingerprint();
        let usual = render_on(1, &scene, &options());
        let hash = hash(&usual.film);
        let checked = check_hash(name, &usual.film, &hash, golden.get(&**name).copied())
            .and_then(|()| check_settings(name, &mut scene, &usual, false))
            .and_then(|()| check_seeds(&scene, &usual.film))
            .and_then(|()| check_hits(&scene))
            .and_then(|()| check_trees(&mut scene, &usual.film))
            .and_then(|()| check_plan(path, &usual.film))
            .and_then(|()| same(&usual.film, &again?, "written"))
            .and_then(|()| check_copies(loaded, prepared));
        (format!("{name}: {hash}\n"), checked.err().map(|why| format!("{name}: {why}")))
    };
    let models = files_in("scenes/gltf", "gltf").into_iter();
    let models = models.map(|path| (format!("gltf-{}", stem(&path)), path));
    let scenes: Vec<_> = scene_files().into_iter().chain(models).collect();
    let (lines, failures): (Vec<String>, Vec<_>) = scenes.par_iter().map(check).unzip();
    let failures: Vec<String> = failures.into_iter().flatten().collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    if blessing() {
        std::fs::write(repository(GOLDEN), lines.concat()).expect("a file");
    }
    assert!(blessing() || lines.len() == golden.len(), "a hash belongs to no scene");
}

/// Trilinear textures on every kind of shape, in mirrors of every kind, through a lens, with several
/// rays a pixel: all that differentials go through.
const FILTERED: &str = include_str!("parity/filtered.json");

#[test]
fn scenes_of_all_differentials_and_of_blocks_of_samples_have_one_image_too() {
    let parsed = |text: &str| serde_json::from_str::<Value>(text).expect("JSON");
    let filtered = parsed(FILTERED);
    let blocks = crate::parts::ball([11, 9], 29);
    for (name, json) in [("trilinear", &filtered), ("three blocks of samples", &blocks)] {
        let mut scene = prepare(json);
        let usual = render_on(1, &scene, &options());
        let found = check_settings(name, &mut scene, &usual, true);
        assert_eq!(found, Ok(()), "{name}");
    }
    let scene = prepare(&filtered);
    let usual = render_on(1, &scene, &options());
    assert!(usual.counters.samples.footprints > usual.counters.rays.secondary);
    // The filter does something in this scene: bilinear is another image.
    let bilinear = image(&parsed(&FILTERED.replace("trilinear", "bilinear")));
    assert!(!bilinear.same_bits(&usual.film));
}
