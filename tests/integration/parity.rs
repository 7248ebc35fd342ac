//! Parity: one image whatever the tracer, the number of threads, the size of the batches, the tree
//! and the part that is rendered, for every scene there is.

use std::path::Path;

use rayon::prelude::*;
use serde_json::{Value, json};
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::film::Film;
use wavecrest_core::math::simd::Level;
use wavecrest_core::plan::Effect;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::RenderOptions;
use wavecrest_core::tile::Tile;

use crate::support::{
    TRACERS, extract_small, image, matte, options, pinhole, point_light, prepare, render_on, scene,
    scene_files, sphere, wall, with,
};

/// The longest side of the images, in pixels: several tiles, and no multiple of one.
const LONGEST: u32 = 45;

/// The most rays that one image may take: scenes of thousands of samples are rendered smaller.
const MOST_RAYS: u64 = 200_000;

fn small(path: &Path) -> PreparedScene {
    extract_small(path, LONGEST, MOST_RAYS).build(Preset::Fast)
}

fn film(scene: &PreparedScene, options: RenderOptions) -> Film {
    render_on(1, scene, &options).film
}

/// Checks every scene; each failure is one line.
fn for_every_scene(check: impl Fn(&Path) -> Result<(), String> + Sync) {
    let scenes = scene_files();
    let failures: Vec<String> = scenes
        .par_iter()
        .filter_map(|(name, path)| check(path).err().map(|why| format!("{name}: {why}")))
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn same(expected: &Film, found: &Film, what: impl std::fmt::Display) -> Result<(), String> {
    if found.same_bits(expected) {
        return Ok(());
    }
    let differing = expected.pixels().iter().zip(found.pixels()).filter(|(a, b)| a != b).count();
    Err(format!("{what}: {differing} pixels differ"))
}

#[test]
fn the_recursive_tracer_gives_the_image_of_the_wavefront() {
    for_every_scene(|path| {
        let scene = small(path);
        let [wavefront, recursive] =
            TRACERS.map(|tracer| film(&scene, RenderOptions { tracer, ..options() }));
        same(&wavefront, &recursive, "recursive")
    });
}

#[test]
fn any_number_of_threads_gives_the_same_image() {
    for_every_scene(|path| {
        let scene = small(path);
        let one = film(&scene, options());
        TRACERS.into_iter().try_for_each(|tracer| {
            [2, 3].into_iter().try_for_each(|threads| {
                let options = RenderOptions { tracer, ..options() };
                let found = render_on(threads, &scene, &options).film;
                same(&one, &found, format!("{tracer:?} on {threads} threads"))
            })
        })
    });
}

#[test]
fn any_size_of_batch_gives_the_same_image() {
    for_every_scene(|path| {
        let scene = small(path);
        let usual = film(&scene, options());
        [1, 3, 7, 8, 9, 64, 65, 1001, 1024, 5000].into_iter().try_for_each(|batch| {
            let found = film(&scene, RenderOptions { batch, ..options() });
            same(&usual, &found, format!("batches of {batch}"))
        })
    });
}

/// Levels differ in the width of their registers, and batches that are no multiple of a vector leave
/// lanes out of use: neither may show.
#[test]
fn any_set_of_vector_instructions_gives_the_same_image() {
    for_every_scene(|path| {
        let mut scene = small(path);
        let best = film(&scene, options());
        Level::available().into_iter().try_for_each(|level| {
            scene.accel.level = level.token().expect("it is available");
            TRACERS.into_iter().try_for_each(|tracer| {
                [13, 1024].into_iter().try_for_each(|batch| {
                    let found = film(&scene, RenderOptions { tracer, batch, ..options() });
                    same(&best, &found, format!("{tracer:?}, {}, {batch}", level.name()))
                })
            })
        })
    });
}

/// Kernels share what they compute and not how: neither their order nor what they leave to each
/// other may show.
#[test]
fn any_kernel_gives_the_same_image() {
    for_every_scene(|path| {
        let mut scene = small(path);
        let usual = film(&scene, options());
        KernelChoice::ALL.into_iter().try_for_each(|kernel| {
            scene.accel.kernel = kernel;
            [13, 1024].into_iter().try_for_each(|batch| {
                let found = film(&scene, RenderOptions { batch, ..options() });
                same(&usual, &found, format!("{}, {batch}", kernel.name()))
            })
        })
    });
}

#[test]
fn any_tree_gives_the_image_of_testing_everything() {
    for_every_scene(|path| {
        // Without a tree every ray tests every primitive, so that fewer rays must do.
        let build = |preset| extract_small(path, LONGEST, MOST_RAYS / 4).build(preset);
        let brute = film(&build(Preset::Brute), options());
        Preset::ALL
            .into_iter()
            .filter(|&preset| preset != Preset::Brute)
            .try_for_each(|preset| same(&brute, &film(&build(preset), options()), preset.name()))
    });
}

#[test]
fn a_crop_is_that_part_of_the_whole_image() {
    for_every_scene(|path| {
        let scene = small(path);
        let whole = film(&scene, options());
        let (width, height) = (whole.width(), whole.height());
        crops(width, height).into_iter().try_for_each(|crop| {
            TRACERS.into_iter().try_for_each(|tracer| {
                let found = film(&scene, RenderOptions { tracer, crop: Some(crop), ..options() });
                same(&part(&whole, crop), &found, format!("{tracer:?}, {crop:?}"))
            })
        })
    });
}

/// A part from the middle, the last pixel, and a column.
fn crops(width: u32, height: u32) -> [Tile; 3] {
    let (x, y) = (width / 3, height / 3);
    [
        Tile { x, y, width: (width - x).div_ceil(2), height: (height - y).div_ceil(2) },
        Tile { x: width - 1, y: height - 1, width: 1, height: 1 },
        Tile { x, y: 0, width: 1, height },
    ]
}

fn part(whole: &Film, crop: Tile) -> Film {
    let pixels = (0..crop.len() as u32).map(|index| {
        let (x, y) = crop.pixel(index);
        whole.pixel(x, y).expect("the crop lies within the image")
    });
    Film::from_pixels(crop.width, crop.height, pixels.collect()).expect("as many as there are")
}

/// Whether any random number decides what this scene shows.
fn draws_numbers(scene: &PreparedScene) -> bool {
    [Effect::DepthOfField, Effect::Antialiasing].into_iter().any(|effect| scene.plan.has(effect))
        || scene.lights.iter().any(|light| light.is_sampled())
}

#[test]
fn the_seed_changes_only_images_of_scenes_that_draw_random_numbers() {
    for_every_scene(|path| {
        let scene = small(path);
        let [first, second, again] =
            [0, 1, 0].map(|seed| film(&scene, RenderOptions { seed, ..options() }));
        same(&first, &again, "the same seed again")?;
        match (draws_numbers(&scene), first.same_bits(&second)) {
            (true, true) => Err("the seed does nothing".to_owned()),
            (false, false) => Err("the seed changes the image".to_owned()),
            _ => Ok(()),
        }
    });
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
    let lens = [
        ("type", json!("thinlens")),
        ("aperture", json!(0.2)),
        ("focal", json!(6)),
        ("nsamplesx", json!(2)),
        ("nsamplesy", json!(1)),
        ("antialias", json!(2)),
    ];
    let camera = pinhole([45, 37], 45.0, 6.0);
    let camera = lens.into_iter().fold(camera, |camera, (key, value)| with(camera, key, value));
    scene(3, &camera, &[point_light(60.0, [3.0, 5.0, 6.0], [1.0; 3])], &shapes)
}

#[test]
fn trilinear_textures_look_the_same_however_they_are_traced() {
    let mut scene = prepare(&filtered());
    let usual = render_on(1, &scene, &options());
    let counted = usual.counters.footprints;
    assert!(counted > usual.counters.secondary_rays && usual.counters.invalid == 0);
    for level in Level::available() {
        scene.accel.level = level.token().expect("it is available");
        for tracer in TRACERS {
            for batch in [1, 3, 7, 8, 9, 64, 65, 1001, 1024, 5000] {
                let found = render_on(1, &scene, &RenderOptions { tracer, batch, ..options() });
                let what = format!("{tracer:?}, {}, {batch}", level.name());
                same(&usual.film, &found.film, &what).unwrap_or_else(|why| panic!("{why}"));
                assert_eq!(found.counters.footprints, counted, "{what}");
                assert_eq!(found.counters.texels, usual.counters.texels, "{what}");
            }
        }
    }
    // The filter does something in this scene: bilinear is another image.
    let bilinear = filtered().to_string().replace("trilinear", "bilinear");
    let bilinear = image(&serde_json::from_str(&bilinear).expect("JSON"));
    assert!(!bilinear.same_bits(&usual.film));
}

/// Four coplanar shapes that overlap in part, each of a colour of its own, in the order given.
fn overlapping(order: [usize; 4], colors: [[f64; 3]; 4]) -> Value {
    let square = |x: f64, y: f64| {
        [[x, y, 0.0], [x, y + 2.0, 0.0], [x + 2.0, y + 2.0, 0.0], [x + 2.0, y, 0.0]]
    };
    let plane = |x, y| json!({"type": "plane", "points": square(x, y)});
    let triangle = json!({"type": "triangle", "points": [[-1, -1, 0], [0, 1, 0], [1, -1, 0]]});
    let strip = json!({"type": "trimesh", "size": 4,
                       "points": [[-1.5, 0, 0], [-1.5, 1.5, 0], [1.5, 0, 0], [1.5, 1.5, 0]]});
    let shapes = [plane(-1.5, -1.5), plane(-0.5, -0.5), triangle, strip];
    let shapes: Vec<Value> = order
        .into_iter()
        .map(|i| with(shapes[i].clone(), "material", matte(0.8, colors[i])))
        .collect();
    let lights = [point_light(50.0, [1.0, 2.0, 5.0], [1.0; 3])];
    scene(0, &pinhole([40, 40], 50.0, 5.0), &lights, &shapes)
}

#[test]
fn coplanar_shapes_of_one_material_look_the_same_in_any_order() {
    let same_color = [[0.9, 0.5, 0.1]; 4];
    let first = image(&overlapping([0, 1, 2, 3], same_color));
    for order in [[3, 2, 1, 0], [1, 3, 0, 2], [2, 0, 3, 1]] {
        let found = image(&overlapping(order, same_color));
        assert!(found.same_bits(&first), "{order:?}");
    }
}

#[test]
fn of_coplanar_shapes_of_one_kind_the_first_is_seen() {
    let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]];
    // At the middle of the image the two planes cover each other; triangles come before planes.
    let planes_alone = |order: [usize; 2]| {
        let mut all = overlapping([order[0], order[1], 2, 3], colors);
        let shapes = all["scene"]["shapes"].as_array_mut().expect("shapes");
        shapes.truncate(2);
        image(&all).pixel(20, 20).expect("a pixel")
    };
    let (red, green) = (planes_alone([0, 1]), planes_alone([1, 0]));
    assert!(red[0] > 0.1 && red[1] == 0.0, "{red:?}");
    assert!(green[1] > 0.1 && green[0] == 0.0, "{green:?}");
}

/// The order of coplanar duplicates within one mesh decides nothing when all their triangles are
/// alike: neither the tree nor the tracer shows through.
#[test]
fn duplicated_triangles_look_the_same_in_any_order_and_tree() {
    let mesh = |indices: Value| {
        let points = [[-2, -2, 0], [-2, 2, 0], [2, 2, 0], [2, -2, 0]];
        let shape = json!({"type": "trimesh", "points": points, "indices": indices,
                           "material": matte(0.7, [0.2, 0.8, 0.4])});
        let lights = [point_light(60.0, [3.0, 1.0, 4.0], [1.0, 0.9, 0.8])];
        scene(0, &pinhole([33, 31], 60.0, 5.0), &lights, &[shape])
    };
    let once = image(&mesh(json!([[0, 1, 2], [0, 2, 3]])));
    let often = json!([[0, 2, 3], [0, 1, 2], [0, 1, 2], [0, 2, 3], [1, 2, 0], [3, 0, 2]]);
    assert!(image(&mesh(often)).same_bits(&once));
}
