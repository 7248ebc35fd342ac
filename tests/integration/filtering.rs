//! Trilinear textures: what they look like, against references that need no filter, and what they
//! cost. The derivatives themselves are tested beside `kernels::differential`.

use std::path::Path;

use glam::Vec3;
use serde_json::{Value, json};
use wavecrest_core::film::Film;
use wavecrest_core::kernels::precision::Exact;
use wavecrest_core::kernels::shade;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::vector::Line;
use wavecrest_core::prepared::{Interaction, LookUps, MirrorPoint, PreparedScene};
use wavecrest_image::write::{Transfer, write};
use wavecrest_scene::load::{LoadOptions, load_str};
use wavecrest_scene::memory::estimate_extracted;
use wavecrest_scene::systems::extract;

use crate::support::{
    BACKGROUND, folder, image_of, matte, options, pinhole, point_light, prepare, render_on, scene,
    sphere, try_prepare, wall, with,
};

const FILTERS: [&str; 3] = ["nearest", "bilinear", "trilinear"];

/// A scene of shapes that show their own colour or texture, whatever lights them.
fn plain(bounces: u32, camera: &Value, shapes: &[Value]) -> Value {
    let mut scene = scene(bounces, camera, &[point_light(0.0, [0.0, 9.0, 9.0], [1.0; 3])], shapes);
    scene["scene"]["ambient"] = 1.0.into();
    scene
}

/// Writes an image as a PNG of 8 bits.
fn write_image(file: &Path, [width, height]: [u32; 2], texel: impl Fn(u32, u32) -> [f32; 3]) {
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let texels = texels.map(|(x, y)| texel(x, y)).collect();
    let film = Film::from_pixels(width, height, texels).expect("a film");
    write(&film, file, Transfer::Linear).expect("a file");
}

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

fn ready(folder: &Path, scene: &Value) -> PreparedScene {
    try_prepare(scene, &folder.join("scene.json")).unwrap_or_else(|error| panic!("{error}"))
}

/// Root of the mean square of what two images differ by.
fn difference(a: &Film, b: &Film) -> f64 {
    let pairs = a.pixels().iter().flatten().zip(b.pixels().iter().flatten());
    let squares: f64 = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
    (squares / (3 * a.pixels().len()) as f64).sqrt()
}

/// With one ray a pixel, a floor of checkers is nearer to what many rays make of it.
#[test]
fn a_trilinear_floor_is_nearer_to_one_of_many_samples() {
    let folder = folder();
    let checkers = |x: u32, y: u32| [((x / 8 + y / 8) % 2) as f32; 3];
    write_image(&folder.path().join("texture.png"), [64, 64], checkers);
    let render = |antialias: u32, filter: &str| {
        let camera = with(over_the_floor([96, 72]), "antialias", antialias);
        image_of(&ready(folder.path(), &plain(0, &camera, &[floor(200.0, filter)])), 0)
    };
    let reference = render(16, "nearest");
    let [nearest, bilinear, trilinear] =
        FILTERS.map(|filter| difference(&render(1, filter), &reference));
    println!("nearest {nearest}, bilinear {bilinear}, trilinear {trilinear}");
    assert!(trilinear < 0.5 * bilinear, "bilinear {bilinear}, trilinear {trilinear}");
    assert!(bilinear < nearest, "nearest {nearest}, bilinear {bilinear}");
    // Where there are more samples, each stands for less.
    let finer = difference(&render(4, "trilinear"), &reference);
    assert!(finer < 0.7 * trilinear, "{finer}, {trilinear}");
}

/// In a mirror, footprints are carried on.
#[test]
fn a_trilinear_floor_in_a_mirror_is_nearer_to_one_of_many_samples() {
    let folder = folder();
    let checkers = |x: u32, y: u32| [((x / 8 + y / 8) % 2) as f32; 3];
    write_image(&folder.path().join("texture.png"), [64, 64], checkers);
    let ball = sphere([0.0, 1.7, 0.0], 1.5, with(matte(0.0, [0.0; 3]), "kr", 1.0));
    let render = |antialias: u32, filter: &str| {
        let camera = with(pinhole([64, 64], 22.0, 7.0), "antialias", antialias);
        let camera = with(with(camera, "location", json!([0, 1.7, 7])), "look", json!([0, 1.2, 0]));
        let shapes = [floor(400.0, filter), ball.clone()];
        image_of(&ready(folder.path(), &plain(1, &camera, &shapes)), 0)
    };
    let reference = render(12, "nearest");
    let [nearest, bilinear, trilinear] =
        FILTERS.map(|filter| difference(&render(1, filter), &reference));
    println!("nearest {nearest}, bilinear {bilinear}, trilinear {trilinear}");
    assert!(trilinear < 0.5 * bilinear.min(nearest), "{bilinear}, {nearest}, {trilinear}");
}

#[test]
fn a_magnified_trilinear_texture_is_bilinear_to_the_last_bit() {
    let folder = folder();
    let texel = |x: u32, y: u32| [x as f32 / 5.0, y as f32 / 3.0, 0.4];
    write_image(&folder.path().join("texture.png"), [5, 3], texel);
    // 24 pixels see a part of the image alone.
    let render = |filter: &str| {
        let wall = with(wall(4.0, 0.0, matte(0.5, [0.5; 3])), "texture", "texture.png");
        let ball = with(sphere([0.0; 3], 1.0, matte(0.5, [0.5; 3])), "texture", "texture.png");
        let shapes = [with(wall, "filter", filter), with(ball, "filter", filter)];
        let scene = ready(folder.path(), &plain(0, &pinhole([24, 24], 16.0, 5.0), &shapes));
        (image_of(&scene, 0), render_on(1, &scene, &options()).counters)
    };
    let ((bilinear, simple), (trilinear, filtered)) = (render("bilinear"), render("trilinear"));
    assert!(trilinear.same_bits(&bilinear));
    assert_eq!((filtered.texels, filtered.footprints), (4 * 24 * 24, 24 * 24));
    assert_eq!((simple.texels, simple.footprints), (4 * 24 * 24, 0));
}

#[test]
fn a_texture_of_one_colour_is_that_colour_at_any_level() {
    let folder = folder();
    let color = [200, 31, 77].map(|byte: u8| f32::from(byte) / 255.0);
    write_image(&folder.path().join("texture.png"), [37, 21], |_, _| color);
    let camera = over_the_floor([48, 36]);
    for filter in FILTERS {
        let scene = ready(folder.path(), &plain(0, &camera, &[floor(300.0, filter)]));
        let film = image_of(&scene, 0);
        let background = BACKGROUND.map(|value| value as f32);
        let others = film.pixels().iter().filter(|&&p| p != background && p != color).count();
        assert_eq!(others, 0, "{filter}");
        assert!(film.pixels().iter().filter(|&&p| p == color).count() > 48 * 10, "{filter}");
    }
}

/// Texels from two levels are eight, from one they are four, and all are counted.
#[test]
fn minified_textures_read_two_levels() {
    let folder = folder();
    write_image(&folder.path().join("texture.png"), [256, 256], |x, _| [x as f32 / 256.0; 3]);
    let texels = |half: f64| {
        let wall = with(wall(half, 0.0, matte(0.5, [0.5; 3])), "texture", "texture.png");
        let wall = with(wall, "filter", "trilinear");
        let scene = ready(folder.path(), &plain(0, &pinhole([16, 16], 40.0, 5.0), &[wall]));
        let counters = render_on(1, &scene, &options()).counters;
        assert_eq!(counters.footprints, 16 * 16);
        counters.texels
    };
    // Seen are 3.6 of 20 by 20: less than three texels a pixel, and more than one.
    assert_eq!(texels(10.0), 8 * 16 * 16);
    // And of 2000 by 2000: less than one.
    assert_eq!(texels(1000.0), 4 * 16 * 16);
}

/// The image repeats itself four times around, so that a quarter of a turn changes nothing; but it
/// brings the seam to the front.
#[test]
fn the_seam_of_a_sphere_does_not_show() {
    let folder = folder();
    let texel =
        |x: u32, y: u32| [((x / 4) % 2) as f32, ((y / 8) % 2) as f32, (x % 64) as f32 / 64.0];
    write_image(&folder.path().join("texture.png"), [256, 128], texel);
    let render = |degrees: f64| {
        let ball = with(sphere([0.0; 3], 1.0, matte(0.5, [0.5; 3])), "texture", "texture.png");
        let turned = with(ball, "transform", json!({"rotate": [0.0, degrees, 0.0]}));
        let shape = with(turned, "filter", "trilinear");
        image_of(&ready(folder.path(), &plain(0, &pinhole([64, 64], 26.0, 5.0), &[shape])), 0)
    };
    // At 180 the seam is in the middle, at 90 at the edge.
    let [front, behind] = [180.0, 0.0].map(render);
    let largest = front.pixels().iter().flatten().zip(behind.pixels().iter().flatten());
    let largest = largest.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(largest < 2e-3, "{largest}");
}

/// Poles in the middle of the image, and rays that graze: every sample is finite, which `image_of`
/// checks, and all colours are among the texels'.
#[test]
fn hc30_poles_and_silhouettes_of_a_trilinear_sphere_are_finite() {
    let folder = folder();
    let texel = |x: u32, y: u32| [((x + y) % 2) as f32 * 0.5 + 0.25, 0.5, 0.25];
    write_image(&folder.path().join("texture.png"), [64, 32], texel);
    for up in [-7.0, 7.0] {
        let camera = with(pinhole([33, 33], 30.0, 5.0), "location", json!([0, up, 0]));
        let ball = with(sphere([0.0; 3], 1.5, matte(0.5, [0.5; 3])), "texture", "texture.png");
        let ball = with(with(ball, "filter", "trilinear"), "name", "ball");
        let floor = with(wall(1e4, 0.0, matte(0.5, [0.5; 3])), "texture", "texture.png");
        // The camera is in the plane of the wall: its rays graze it, or miss it.
        let shapes = [ball, with(floor, "filter", "trilinear")];
        let film = image_of(&ready(folder.path(), &plain(0, &camera, &shapes)), 0);
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
    write_image(&folder.path().join("texture.png"), [64, 32], |x, _| [x as f32 / 64.0; 3]);
    let bytes = |filters: &[&str]| {
        let shapes: Vec<Value> = filters
            .iter()
            .map(|&filter| {
                let wall = with(wall(1.0, 0.0, matte(0.5, [0.5; 3])), "texture", "texture.png");
                with(wall, "filter", filter)
            })
            .collect();
        let scene = plain(0, &pinhole([8, 8], 40.0, 5.0), &shapes);
        let file = folder.path().join("scene.json");
        let loaded = load_str(&scene.to_string(), &file, &LoadOptions::default())
            .unwrap_or_else(|error| panic!("{error}"));
        let extracted =
            extract(loaded.world, Default::default()).unwrap_or_else(|error| panic!("{error}"));
        let estimated = estimate_extracted(&extracted, 64, extracted.preset(), 64).appearance;
        let appearance = &extracted.scene().appearance;
        assert_eq!(appearance.bytes(), 0, "nothing was looked up");
        appearance.decode().unwrap_or_else(|error| panic!("{error}"));
        let bytes = appearance.bytes();
        assert_eq!(estimated, bytes);
        bytes
    };
    let image = 4 * 64 * 32;
    let above = 12 * (32 * 16 + 16 * 8 + 8 * 4 + 4 * 2 + 2 + 1);
    assert_eq!(bytes(&["bilinear", "nearest"]), image);
    assert_eq!(bytes(&["trilinear"]), image + above);
    assert_eq!(bytes(&["nearest", "trilinear", "trilinear"]), image + above);
}

/// The mirror ray of the camera ray through a pixel, and what its differential was found to be.
fn mirror_ray(scene: &PreparedScene, x: u32, y: u32) -> (Ray, [Vec3; 2], [Vec3; 2]) {
    let ray = scene.camera.ray(x, y, &Stream { seed: 0, pixel: 0, sample: 0, bounce: 0 });
    let hit = scene.accel.closest(&ray, &mut scene.accel.traversal());
    let differential = scene.camera.differential(ray.direction);
    let mut look_ups = LookUps::default();
    let met = scene.interaction::<Exact>(&ray, &hit, &|| differential, &mut look_ups);
    let Interaction::Surface(point) = met else { panic!("({x}, {y}) meets no surface") };
    let request = shade::mirror_request(&point, Vec3::ONE.into()).expect("a mirror ray");
    let Line { origin, direction } = request.line;
    let next = Ray::new(origin.into(), direction.into());
    let mirror = MirrorPoint::of(&point);
    let found = scene.mirrored(&differential, &ray, &hit, &mirror, &mut look_ups);
    (next, found.origin, found.direction)
}

/// Of every kind of mirror, from either side: derivatives are the differences of the neighbours' rays,
/// as far as these are exact.
#[test]
fn mirror_rays_of_shapes_change_as_their_neighbours_say() {
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
    for (name, shape) in shapes {
        let scene = prepare(&plain(1, &pinhole([400, 400], 30.0, 5.0), &[shape]));
        for (x, y) in [(200, 200), (120, 260), (310, 150), (100, 100)] {
            let (_, origin, direction) = mirror_ray(&scene, x, y);
            let at = |x, y| mirror_ray(&scene, x, y).0;
            let pairs = [[at(x + 1, y), at(x - 1, y)], [at(x, y + 1), at(x, y - 1)]];
            for (k, [after, before]) in pairs.into_iter().enumerate() {
                let moved = (after.origin - before.origin) / 2.0;
                let turned = (after.direction - before.direction) / 2.0;
                let off = [(moved, origin[k]), (turned, direction[k])]
                    .map(|(exact, found)| exact.distance(found) / exact.length());
                assert!(off.iter().all(|&off| off < 0.01), "{name}, ({x}, {y}), {k}: {off:?}");
            }
        }
    }
}
