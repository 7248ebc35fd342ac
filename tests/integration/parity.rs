//! Parity: one image whatever the tracer, the number of threads, the size of the batches, the instructions, the kernel,
//! the tree, the plan and the part that is rendered.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde_json::{Value, json};
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::counters::Counters;
use wavecrest_core::film::Film;
use wavecrest_core::math::simd::Level;
use wavecrest_core::plan::Effect;
use wavecrest_core::plan::schedule::{PASSES, unplanned};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, TracerKind};
use wavecrest_core::tile::Tile;
use wavecrest_scene::systems::Options;

use crate::planning::check_work;
use crate::support::{
    TRACERS, both, extract_small, extract_small_by, image, matte, options, pinhole, point_light,
    prepare, render_on, scene, scene_files, sphere, thin_lens, wall, with,
};

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

/// One thing after the other; every size of batch with every level where `all` are asked for. The recursive tracer has no
/// batches.
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
    let some = if all { &BATCHES[..] } else { &[13, 1024] };
    let mut settings: Vec<Setting> = BATCHES.map(|batch| Setting { batch, ..usual }).into();
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

/// All that is counted but how hits are searched for and sorted, which is each tracer's own affair.
pub(crate) fn work(counters: &Counters) -> Counters {
    let Counters { tests, kernels, spans, .. } = Counters::default();
    Counters { tests, kernels, spans, ..*counters }
}

/// Renders with every setting: one image, and the same work.
fn check_settings(name: &str, scene: &mut PreparedScene, all: bool) -> Result<(), String> {
    let usual = render_on(1, scene, &options());
    check_work(name, scene, &usual, &options());
    for setting in settings(all) {
        let Setting { tracer, threads, batch, level, kernel } = setting;
        scene.accel.level = level.token().expect("it is available");
        scene.accel.kernel = kernel;
        let found = render_on(threads, scene, &RenderOptions { tracer, batch, ..options() });
        same(&usual.film, &found.film, setting)?;
        let (c, rays) = (&found.counters, &found.counters.kernels);
        // Camera rays that meet nothing are left out by the batch: how many depends on its size.
        let expected = if batch == options().batch {
            work(&usual.counters)
        } else {
            let Counters { primary_rays, lens_samples, .. } = *c;
            Counters { primary_rays, lens_samples, ..work(&usual.counters) }
        };
        if work(c) != expected
            || rays.closest.rays() != c.primary_rays + c.secondary_rays
            || rays.shadow.rays() != c.shadow_rays
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

/// Whether any random number decides what this scene shows.
fn draws_numbers(scene: &PreparedScene) -> bool {
    [Effect::DepthOfField, Effect::Antialiasing].into_iter().any(|effect| scene.plan.has(effect))
        || scene.lights.iter().any(|light| light.is_sampled())
}

/// The seed changes images of scenes that draw random numbers, and no others.
fn check_seeds(scene: &PreparedScene) -> Result<(), String> {
    let [first, second, again] =
        [0, 1, 0].map(|seed| film(scene, RenderOptions { seed, ..options() }));
    same(&first, &again, "the same seed again")?;
    match (draws_numbers(scene), first.same_bits(&second)) {
        (true, true) => Err("the seed does nothing".to_owned()),
        (false, false) => Err("the seed changes the image".to_owned()),
        _ => Ok(()),
    }
}

/// Any tree, and any plan, gives the image of testing and running everything.
fn check_trees_and_plans(path: &Path) -> Result<(), String> {
    // Without a tree every ray tests every primitive, so that fewer rays must do.
    let mut scene = extract_small(path, LONGEST, MOST_RAYS / 4).build(Preset::Brute);
    let brute = film(&scene, options());
    for preset in Preset::ALL.into_iter().filter(|&preset| preset != Preset::Brute) {
        scene.accel.rebuild(preset);
        for tracer in TRACERS {
            same(&brute, &film(&scene, RenderOptions { tracer, ..options() }), (preset, tracer))?;
        }
    }
    let passes = &unplanned(&PASSES)[..];
    let everything = Options { passes, ..Options::default() };
    let everything = extract_small_by(path, LONGEST, MOST_RAYS / 4, everything);
    for rendered in both(&everything.build(Preset::Fast)) {
        same(&brute, &rendered.film, "unplanned")?;
    }
    Ok(())
}

#[test]
fn every_scene_has_one_image_however_it_is_rendered() {
    let check = |(name, path): &(String, PathBuf)| {
        let mut scene = extract_small(path, LONGEST, MOST_RAYS).build(Preset::Fast);
        let checked = check_settings(name, &mut scene, false)
            .and_then(|()| check_seeds(&scene))
            .and_then(|()| check_trees_and_plans(path));
        checked.err().map(|why| format!("{name}: {why}"))
    };
    let failures: Vec<String> = scene_files().par_iter().filter_map(check).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Trilinear textures on every kind of shape, in mirrors of every kind, through a lens, with several
/// rays a pixel: all that differentials go through.
fn filtered() -> Value {
    let trilinear = |shape: Value, image: &str| {
        with(with(shape, "texture", format!("textures/{image}.png")), "filter", "trilinear")
    };
    let kr = |kr: f64| with(matte(0.7, [0.9, 0.8, 0.7]), "kr", kr);
    let floor = json!({"type": "trimesh", "material": kr(0.2),
                       "points": [[-60, -1, 6], [-60, -1, -90], [60, -1, -90], [60, -1, 6]],
                       "indices": [[0, 1, 2], [0, 2, 3]],
                       "uvs": [[-15, 0], [-15, 24], [15, 24], [15, 0]]});
    let smooth = json!({"type": "trimesh", "material": kr(0.6), "shading": "smooth", "sides": "both",
                        "points": [[1, -1, 0], [1.4, 1.5, -1], [2.5, 1.4, -0.5], [2.4, -1, 0.5]],
                        "indices": [[0, 1, 2], [0, 2, 3]],
                        "normals": [[-0.6, 0, 0.8], [-0.4, 0.4, 0.8], [0.3, 0.4, 0.8], [0.5, 0, 0.9]]});
    let triangle = json!({"type": "triangle", "material": kr(0.0),
                          "points": [[-3, -1, -2], [-2.5, 2, -2], [-1.2, -1, -1]]});
    let shapes = [
        trilinear(floor, "checker"),
        trilinear(sphere([-0.4, 0.0, 0.0], 1.0, kr(0.4)), "globe"),
        with(trilinear(sphere([0.9, -0.6, 1.5], 0.4, kr(0.0)), "uvgrid"), "wrap", "clamp"),
        smooth,
        trilinear(triangle, "bricks"),
        trilinear(wall(4.0, -6.0, kr(0.5)), "picture"),
    ];
    let camera = thin_lens(pinhole([45, 37], 45.0, 6.0), 0.2, 6.0, [2, 1]);
    let camera = with(camera, "antialias", 2);
    scene(3, &camera, &[point_light(60.0, [3.0, 5.0, 6.0], [1.0; 3])], &shapes)
}

#[test]
fn scenes_of_all_differentials_and_of_blocks_of_samples_have_one_image_too() {
    let blocks = crate::parts::ball([11, 9], 29);
    for (name, json) in [("trilinear", filtered()), ("three blocks of samples", blocks)] {
        let found = check_settings(name, &mut prepare(&json), true);
        assert_eq!(found, Ok(()), "{name}");
    }
    let scene = prepare(&filtered());
    let usual = render_on(1, &scene, &options());
    assert!(usual.counters.look_ups.footprints > usual.counters.secondary_rays);
    // The filter does something in this scene: bilinear is another image.
    let bilinear = filtered().to_string().replace("trilinear", "bilinear");
    let bilinear = image(&serde_json::from_str(&bilinear).expect("JSON"));
    assert!(!bilinear.same_bits(&usual.film));
}
