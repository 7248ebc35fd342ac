//! Trilinear textures: what they look like, against references that need no filter, and what they
//! cost. The derivatives themselves are tested beside `kernels::differential`.

use glam::Vec3;
use serde_json::{Value, json};
use wavecrest_core::film::Film;
use wavecrest_core::kernels::differential::{Differential, Footprint};
use wavecrest_core::kernels::precision::Exact;
use wavecrest_core::kernels::shade;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::vector::Line;
use wavecrest_core::prepared::{Interaction, PreparedScene, SampleCounts};
use wavecrest_scene::load::{LoadOptions, load_str};
use wavecrest_scene::systems::{SceneOptions, extract};

use crate::support::{
    BACKGROUND, difference, folder, image_of, matte, options, pinhole, plain, prepare, prepare_in,
    put_image, render_on, sphere, thin_lens, wall, with,
};

const FILTERS: [&str; 3] = ["nearest", "bilinear", "trilinear"];

/// A floor that goes to the horizon, with so many images along each side.
fn floor(images: f64, filter: &str) -> Value {
    let half = images / 2.0;
    json!({"type": "trimesh",
           "points": [[-800, 0, 12], [-800, 0, -1588], [800, 0, -1588], [800, 0, 12]],
           "indices": [[0, 1, 2], [0, 2, 3]],
           "uvs": [[-half, 0], [-half, images], [half, images], [half, 0]],
           "texture": "texture.png", "filter": filter, "material": matte(0.8, [0.5; 3])})
}

fn over_the_floor(size: [u32; 2]) -> Value {
    with(with(pinhole(size, 50.0, 7.0), "location", json!([0, 1.7, 7])), "look", json!([0, 1.2, 0]))
}

/// The scene made ready in a folder whose texture has these texels.
fn ready(size: [u32; 2], texel: fn(u32, u32) -> [f32; 3], scene: &Value) -> PreparedScene {
    let folder = folder();
    put_image(folder.path(), "texture.png", size, texel);
    let scene = prepare_in(folder.path(), scene, SceneOptions::default());
    scene.appearance.decode().unwrap_or_else(|error| panic!("{error}"));
    scene
}

fn checkers(x: u32, y: u32) -> [f32; 3] {
    [((x / 8 + y / 8) % 2) as f32; 3]
}

/// `shape` with the texture, seen through a filter.
fn worn(shape: Value, filter: &str) -> Value {
    with(with(shape, "texture", "texture.png"), "filter", filter)
}

fn grey() -> Value {
    matte(0.5, [0.5; 3])
}

/// Root of the mean square of what two images differ by.
fn distance(a: &Film, b: &Film) -> f64 {
    let pairs = a.pixels().iter().flatten().zip(b.pixels().iter().flatten());
    let squares: f64 = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
    (squares / (3 * a.pixels().len()) as f64).sqrt()
}

/// With one ray a pixel, a floor of checkers is nearer to what many rays make of it; and its mirror image is, in which
/// footprints are carried on.
#[test]
fn a_trilinear_floor_is_nearer_to_one_of_many_samples() {
    let ball = sphere([0.0, 1.7, 0.0], 1.5, with(matte(0.0, [0.0; 3]), "kr", 1.0));
    let narrow = with(over_the_floor([64, 64]), "fov", 22);
    for (what, bounces, camera, images, others, many) in [
        ("the floor", 0, over_the_floor([96, 72]), 200.0, &[][..], 16),
        ("the floor in a mirror", 1, narrow, 400.0, &[ball], 12),
    ] {
        let render = |antialias: u32, filter: &str| {
            let camera = with(camera.clone(), "antialias", antialias);
            let shapes = [&[floor(images, filter)], others].concat();
            image_of(&ready([64, 64], checkers, &plain(bounces, &camera, &shapes)), 0)
        };
        let reference = render(many, "nearest");
        let [nearest, bilinear, trilinear] =
            FILTERS.map(|filter| distance(&render(1, filter), &reference));
        let told = format!("{what}: nearest {nearest}, bilinear {bilinear}, trilinear {trilinear}");
        println!("{told}");
        assert!(trilinear < 0.5 * bilinear.min(nearest), "{told}");
        assert!(bounces > 0 || bilinear < nearest, "{told}");
    }
}

/// What renders differ by tells their error: what a trilinear texture blurs is small beside it, with any number of rays.
#[test]
fn the_error_of_trilinear_textures_is_that_which_renders_show() {
    let render = |antialias: u32, seed| {
        let camera = with(over_the_floor([32, 24]), "antialias", antialias);
        let scene = plain(0, &camera, &[floor(200.0, "trilinear")]);
        image_of(&ready([64, 64], checkers, &scene), seed)
    };
    let reference = render(16, 9);
    for (antialias, within) in [(2, 0.4), (4, 0.15)] {
        let [one, other] = [0, 1].map(|seed| render(antialias, seed));
        let told = distance(&one, &other) / std::f64::consts::SQRT_2;
        let error = (distance(&one, &reference) + distance(&other, &reference)) / 2.0;
        assert!((told / error - 1.0).abs() < within, "antialias {antialias}: {told} of {error}");
    }
}

#[test]
fn a_magnified_trilinear_texture_is_bilinear_to_the_last_bit() {
    // 24 pixels see a part of the image alone.
    let render = |filter: &str| {
        let shapes = [wall(4.0, 0.0, grey()), sphere([0.0; 3], 1.0, grey())];
        let scene = plain(0, &pinhole([24, 24], 16.0, 5.0), &shapes.map(|s| worn(s, filter)));
        let scene = ready([5, 3], |x, y| [x as f32 / 5.0, y as f32 / 3.0, 0.4], &scene);
        (image_of(&scene, 0), render_on(1, &scene, &options()).counters.samples)
    };
    let ((bilinear, simple), (trilinear, filtered)) = (render("bilinear"), render("trilinear"));
    assert!(trilinear.same_bits(&bilinear));
    assert_eq!((filtered.texels, filtered.footprints), (4 * 24 * 24, 24 * 24));
    assert_eq!((simple.texels, simple.footprints), (4 * 24 * 24, 0));
}

/// Texels from two levels are eight, from one they are four, and all are counted.
#[test]
fn minified_textures_read_two_levels() {
    // Seen are 3.6 of 20 by 20: less than three texels a pixel, and more than one; and of 2000 by 2000: less than one.
    for (half, texels) in [(10.0, 8), (1000.0, 4)] {
        let wall = worn(wall(half, 0.0, grey()), "trilinear");
        let scene = plain(0, &pinhole([16, 16], 40.0, 5.0), &[wall]);
        let scene = ready([256, 256], |x, _| [x as f32 / 256.0; 3], &scene);
        let found = render_on(1, &scene, &options()).counters.samples;
        assert_eq!((found.footprints, found.texels), (16 * 16, texels * 16 * 16), "{half}");
    }
}

/// The image repeats itself four times around, so that a quarter of a turn changes nothing; but it
/// brings the seam to the front.
#[test]
fn the_seam_of_a_sphere_does_not_show() {
    // At 180 the seam is in the middle, at 90 at the edge.
    let [front, behind] = [180.0, 0.0].map(|degrees| {
        let turn = json!({"rotate": [0.0, degrees, 0.0]});
        let ball = with(sphere([0.0; 3], 1.0, grey()), "transform", turn);
        let scene = plain(0, &pinhole([64, 64], 26.0, 5.0), &[worn(ball, "trilinear")]);
        let texel = |x, y| [((x / 4) % 2) as f32, ((y / 8) % 2) as f32, (x % 64) as f32 / 64.0];
        image_of(&ready([256, 128], texel, &scene), 0)
    });
    let largest = difference(&front, &behind);
    assert!(largest < 2e-3, "{largest}");
}

/// Poles in the middle of the image, and rays that graze: every sample is finite, which `image_of`
/// checks, and all colours are among the texels'.
#[test]
fn hc30_poles_and_silhouettes_of_a_trilinear_sphere_are_finite() {
    for up in [-7.0, 7.0] {
        let camera = with(pinhole([33, 33], 30.0, 5.0), "location", json!([0, up, 0]));
        // The camera is in the plane of the wall: its rays graze it, or miss it.
        let shapes = [sphere([0.0; 3], 1.5, grey()), wall(1e4, 0.0, grey())];
        let scene = plain(0, &camera, &shapes.map(|shape| worn(shape, "trilinear")));
        let texel = |x, y| [((x + y) % 2) as f32 * 0.5 + 0.25, 0.5, 0.25];
        let film = image_of(&ready([64, 32], texel, &scene), 0);
        let background = BACKGROUND.map(|value| value as f32);
        let inside = |&&[r, g, b]: &&[f32; 3]| {
            (0.249..0.751).contains(&r) && (g - 0.5).abs() < 0.01 && (b - 0.25).abs() < 0.01
        };
        let found = film.pixels().iter().filter(|&&p| p != background).collect::<Vec<_>>();
        assert!(found.len() > 500 && found.iter().all(inside), "{:?}", found.first());
    }
}

#[test]
fn pyramids_are_built_where_a_shape_is_trilinear_and_nowhere_else() {
    let folder = folder();
    put_image(folder.path(), "texture.png", [64, 32], |x, _| [x as f32 / 64.0; 3]);
    let bytes = |filters: &[&str]| {
        let worn = |filter: &&str| worn(wall(1.0, 0.0, grey()), filter);
        let shapes: Vec<Value> = filters.iter().map(worn).collect();
        let scene = plain(0, &pinhole([8, 8], 40.0, 5.0), &shapes);
        let file = folder.path().join("scene.json");
        let loaded = load_str(&scene.to_string(), &file, &LoadOptions::default())
            .unwrap_or_else(|error| panic!("{error}"));
        let extracted =
            extract(loaded.world, Default::default()).unwrap_or_else(|error| panic!("{error}"));
        let appearance = &extracted.scene().appearance;
        assert_eq!(appearance.bytes(), 0, "nothing was looked up");
        appearance.decode().unwrap_or_else(|error| panic!("{error}"));
        appearance.bytes()
    };
    let image = 4 * 64 * 32;
    let above = 12 * (32 * 16 + 16 * 8 + 8 * 4 + 4 * 2 + 2 + 1);
    assert_eq!(bytes(&["bilinear", "nearest"]), image);
    assert_eq!(bytes(&["trilinear"]), image + above);
    assert_eq!(bytes(&["nearest", "trilinear", "trilinear"]), image + above);
}

/// The ray after so many mirrors on the way of the camera ray through a pixel, and its differential.
fn mirrored(scene: &PreparedScene, [x, y]: [u32; 2], mirrors: usize) -> (Ray, Differential) {
    let mut ray = scene.camera.ray(x, y, &Stream { seed: 0, pixel: 0, sample: 0, bounce: 0 });
    let share = scene.camera.footprint(0);
    let mut footprint = Footprint::Camera(share);
    for _ in 0..mirrors {
        let hit = scene.accel.closest(&ray, &mut scene.accel.traversal());
        let mut look_ups = SampleCounts::default();
        let met = scene.interaction::<Exact>(&ray, &hit, footprint, &mut look_ups);
        let Interaction::Surface(point, _) = met else { panic!("({x}, {y}) meets no surface") };
        let request = shade::mirror_request(&point, Vec3::ONE.into()).expect("a mirror ray");
        let at = (&ray, &hit);
        footprint = Footprint::Carried(scene.mirrored(footprint, at, &point, &mut look_ups));
        let Line { origin, direction } = request.line;
        ray = Ray::new(origin.into(), direction.into());
    }
    let differential = match footprint {
        Footprint::Camera(share) => scene.camera.differential(ray.direction.into(), share),
        Footprint::Carried(differential) => differential,
    };
    (ray, differential)
}

/// Of every kind of mirror, from either side, and of another around it: derivatives are the differences of the
/// neighbours' rays, as far as these are exact, for every kind of camera.
#[test]
fn rays_change_as_their_neighbours_say() {
    let material = || with(matte(0.0, [0.0; 3]), "kr", 1.0);
    let mesh = |normals: f64| {
        let n = normals;
        json!({"type": "trimesh", "points": [[-4, -4, 0.5], [0, 5, -0.5], [5, -4, 0]],
               "indices": [[0, 1, 2]], "sides": "both", "shading": "smooth", "material": material(),
               "normals": [[-0.3 * n, -0.2 * n, n], [0.1 * n, 0.3 * n, n], [0.2 * n, 0, 0.8 * n]]})
    };
    let shapes = [
        ("quad", wall(9.0, 0.3, material())),
        ("flat", with(mesh(1.0), "shading", "flat")),
        ("sphere", sphere([0.2, 0.1, 0.0], 2.5, material())),
        ("sphere from inside", sphere([0.2, 0.1, 3.0], 4.0, material())),
        ("smooth", mesh(1.0)),
        ("smooth with normals behind", mesh(-1.0)),
    ];
    let plain_camera = pinhole([2000, 2000], 30.0, 5.0);
    let cameras = [
        (1.0, plain_camera.clone()),
        (9.0, with(plain_camera.clone(), "antialias", 3)),
        (1.0, thin_lens(plain_camera, 0.3, 4.0, [1, 1])),
    ];
    let all = shapes.iter().flat_map(|shape| cameras.iter().map(move |camera| (shape, camera)));
    for ((name, shape), (samples, camera)) in all {
        let around = sphere([0.5, -0.3, 1.0], 40.0, material());
        let scene = prepare(&plain(1, camera, &[shape.clone(), around]));
        let pixels = [[1000, 1000], [600, 1300], [1550, 750], [500, 500]];
        for ([x, y], mirrors) in pixels.into_iter().flat_map(|pixel| [0, 1, 2].map(|n| (pixel, n)))
        {
            let (_, Differential { origin, direction }) = mirrored(&scene, [x, y], mirrors);
            let at = |x, y| mirrored(&scene, [x, y], mirrors).0;
            let pairs = [[at(x + 1, y), at(x - 1, y)], [at(x, y + 1), at(x, y - 1)]];
            for (k, [after, before]) in pairs.into_iter().enumerate() {
                let moved = (after.origin - before.origin) / (2.0 * samples);
                let turned = (after.direction - before.direction) / (2.0 * samples);
                for (exact, found) in [(moved, origin[k]), (turned, direction[k])] {
                    let found = Vec3::from(found);
                    let is_near = exact.distance(found) <= 0.01 * exact.length();
                    assert!(
                        is_near,
                        "{name}, {camera}, ({x}, {y}), {k}, {mirrors}: {exact} {found}"
                    );
                }
            }
        }
    }
}
