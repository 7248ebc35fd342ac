//! Files without lights of their own: what lights them, what they stand on and what is behind them.

use std::f64::consts::PI;
use std::path::Path;

use exr::prelude::read_first_rgba_layer_from_file;

use wavecrest_core::film::Film;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::srgb::srgb_encode;
use wavecrest_core::plan::schedule::UNPLANNED;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_image::aov::{Layer, Request, layers};
use wavecrest_image::look::Look;
use wavecrest_image::metadata::Values;
use wavecrest_image::write::{Transfer, write};
use wavecrest_scene::load::lighting::{Background, Lighting, Rig, screen_color};
use wavecrest_scene::load::{LoadOptions, load, load_str};
use wavecrest_scene::systems::SceneOptions;

use crate::support::{
    edited, folder, image_of, matte, pinhole, put, ready, ready_by, run_well, scene, sphere, with,
};

/// A ball of so many faces along its equator, without normals.
fn ball(path: &Path, faces: u32) {
    let at = |i: u32, j: u32| {
        let (u, v) = (
            2.0 * PI * f64::from(i) / f64::from(faces),
            2.0 * PI * f64::from(j) / f64::from(faces),
        );
        format!("v {} {} {}\n", u.cos() * v.sin(), v.cos(), -u.sin() * v.sin())
    };
    let rows = faces / 2;
    let points = (0..=rows).flat_map(|j| (0..faces).map(move |i| (i, j)));
    let mut text: String = points.map(|(i, j)| at(i, j)).collect();
    for (i, j) in (0..rows).flat_map(|j| (0..faces).map(move |i| (i, j))) {
        let number = |i: u32, j: u32| 1 + j * faces + i % faces;
        let corners = [number(i, j), number(i, j + 1), number(i + 1, j + 1), number(i + 1, j)];
        text += &format!("f {} {} {} {}\n", corners[0], corners[1], corners[2], corners[3]);
    }
    std::fs::write(path, text).expect("a file");
}

/// The ball under these lights.
fn lit(lighting: Lighting) -> PreparedScene {
    lit_by(lighting, SceneOptions::default())
}

/// The same, prepared by these options.
fn lit_by(lighting: Lighting, by: SceneOptions) -> PreparedScene {
    shown(LoadOptions { lighting, ..LoadOptions::default() }, by)
}

/// The ball with these options.
fn shown(options: LoadOptions, by: SceneOptions) -> PreparedScene {
    let folder = folder();
    let path = folder.path().join("ball.obj");
    ball(&path, 24);
    let (width, height) = (Some(96), Some(72));
    let options = LoadOptions { width, height, ..options };
    ready_by(load(&path, &options), by)
}

/// What screens show of the pixels where the whole pixel is of shape `number`, from dark to light.
fn levels(scene: &PreparedScene, film: &Film, number: u32) -> Vec<f32> {
    let all = [Layer::Object, Layer::Alpha, Layer::Albedo];
    let request = Request { layers: &all, crop: None, seed: 0, invalid: 0 };
    let found = layers(scene, &request, &()).expect("layers").channels;
    let numbers =
        match &found.iter().find(|channel| channel.name == "object.id").expect("it").values {
            Values::Integers(numbers) => numbers.clone(),
            Values::Floats(_) => Vec::new(),
        };
    let width = film.width() as usize;
    let around = |i: usize| [i, i - 1, i + 1, i - width, i + width];
    let inner = (width + 1..numbers.len() - width - 1)
        .filter(|&i| around(i).iter().all(|&other| numbers[other] == number));
    let mut levels: Vec<f32> = inner.map(|i| srgb_encode(film.pixels()[i][1])).collect();
    levels.sort_by(f32::total_cmp);
    levels
}

/// The mesh, and the ground that comes after it.
const MESH: u32 = 1;
const GROUND: u32 = 2;

#[test]
fn shadow_background_and_dark_sides_are_of_different_tones() {
    let scene = lit(Lighting::default());
    let film = image_of(&scene, 0);
    let background = srgb_encode(scene.background.y);
    let share = |levels: &[f32], share: f64| levels[(share * (levels.len() - 1) as f64) as usize];
    let (mesh, ground) = (levels(&scene, &film, MESH), levels(&scene, &film, GROUND));
    let (dark, light) = (share(&mesh, 0.02), share(&mesh, 0.9));
    // Below the ball it is darker still.
    let (touched, shadow, bare) = (ground[0], share(&ground, 0.06), share(&ground, 0.95));
    assert!(touched + 0.1 < dark, "where they touch {touched}, dark sides {dark}");
    assert!((bare - background).abs() < 0.01, "the ground ends nowhere: {bare}, {background}");
    assert!(dark + 0.08 < shadow, "dark sides {dark}, shadow {shadow}");
    assert!(shadow + 0.1 < background, "shadow {shadow}, background {background}");
    assert!(light + 0.04 < background, "lit sides {light}, background {background}");
    assert!(dark > 0.25, "no side is black: {dark}");
    assert!(share(&mesh, 1.0) < 1.0, "and nothing is burnt");
}

#[test]
fn the_ground_is_as_the_background_whatever_that_is() {
    for color in [[1.0, 1.0, 1.0], [0.02, 0.1, 0.4]] {
        let background = Some(Background::Color(color.into()));
        let film = image_of(&lit(Lighting { background, ..Lighting::default() }), 0);
        for corner in [(0, 0), (95, 0), (0, 71), (95, 71)] {
            let found = film.pixel(corner.0, corner.1).expect("a corner");
            for (found, right) in found.into_iter().zip(color) {
                assert!((f64::from(found) - right).abs() <= 0.02 * right, "{found}, not {right}");
            }
        }
    }
}

#[test]
fn clay_leaves_the_ground_as_the_background() {
    let clay = SceneOptions { look: Some(Look::Clay), ..SceneOptions::default() };
    let scene = lit_by(Lighting::default(), clay);
    let film = image_of(&scene, 0);
    let (mesh, ground) = (levels(&scene, &film, MESH), levels(&scene, &film, GROUND));
    let bare = ground[ground.len() * 19 / 20];
    let background = srgb_encode(scene.background.y);
    assert!((bare - background).abs() < 0.01, "{bare}, {background}");
    let plain = lit(Lighting::default());
    let (dull, plain) = (mesh[mesh.len() / 2], levels(&plain, &image_of(&plain, 0), MESH));
    assert!(dull + 0.05 < plain[plain.len() / 2], "the mesh is of clay: {dull}");
}

#[test]
fn looks_show_the_file_without_what_is_added_to_it() {
    let corners = |least: f64, most: f64| {
        (0..8).map(move |i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { least } else { most }))
    };
    let points = corners(-5.0, 5.0).chain(corners(-1.0, 1.0));
    let mut room: String = points.map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    for first in [1, 9] {
        for [a, b, c, d] in
            [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
        {
            room += &format!("f {} {} {} {}\n", first + a, first + b, first + c, first + d);
        }
    }
    let folder = folder();
    put(folder.path(), "room.obj", &room);
    let shapes = |look| {
        let options = SceneOptions { look, passes: &UNPLANNED, ..SceneOptions::default() };
        let loaded = load(&folder.path().join("room.obj"), &LoadOptions::default());
        ready_by(loaded, options).appearance.shapes.len()
    };
    // A closed room gets a lamp, which lights its edges, too.
    for (look, expected) in [
        (None, 2),
        (Some(Look::Clay), 2),
        (Some(Look::Wireframe), 2),
        (Some(Look::Ids), 1),
        (Some(Look::Depth), 1),
        (Some(Look::Uv), 1),
    ] {
        assert_eq!(shapes(look), expected, "{look:?}");
    }
}

#[test]
fn other_lights_leave_the_ground_out_and_none_shows_colours_as_they_are() {
    let [headlight, none] =
        [Rig::Headlight, Rig::None].map(|rig| lit(Lighting { rig, ..Lighting::default() }));
    for scene in [&headlight, &none] {
        assert_eq!(scene.appearance.shapes.len(), 1);
    }
    assert_eq!((headlight.lights.len(), none.lights.len()), (1, 0));
    let middle = image_of(&none, 0).pixel(48, 36).expect("a pixel");
    assert_eq!(middle, [0.7; 3]);
}

#[test]
fn a_mesh_alone_has_the_colour_that_is_asked_for() {
    let lighting = Lighting { rig: Rig::None, ..Lighting::default() };
    for (text, right) in [("1,0,0.5", [1.0, 0.0, 0.214_041_14]), ("#ff0000", [1.0, 0.0, 0.0])] {
        let color = Some(screen_color(text).expect("a colour"));
        let options = LoadOptions { color, lighting, ..LoadOptions::default() };
        let found =
            image_of(&shown(options, SceneOptions::default()), 0).pixel(48, 36).expect("a pixel");
        assert!(found.iter().zip(right).all(|(a, b)| (a - b).abs() < 1e-6), "{text}: {found:?}");
    }
    for wrong in ["1,0", "1,0,0,0", "2,0,0", "-0.1,0,0", "nan,0,0", "#ff000", "#+f+f+f", "red", ""]
    {
        assert!(screen_color(wrong).is_err(), "{wrong}");
    }
}

/// An even one: it is seen behind the ball, and lights it from all sides alike. Bytes are encoded.
#[test]
fn an_image_around_a_mesh_alone_is_all_its_light() {
    let folder = folder();
    let around = |name: &str, color: [f32; 3], background| {
        let film = Film::from_pixels(2, 1, vec![color; 2]).expect("a film");
        let path = folder.path().join(name);
        write(&film, &path, Transfer::Srgb).expect("a file");
        let lighting = Lighting { background, ..Lighting::default() };
        let environment = Some(path);
        let scene = shown(
            LoadOptions { environment, lighting, ..LoadOptions::default() },
            SceneOptions::default(),
        );
        assert_eq!(scene.appearance.shapes.len(), 1, "there is no ground");
        let film = image_of(&scene, 0);
        [(0, 0), (48, 36)].map(|(x, y)| film.pixel(x, y).expect("a pixel"))
    };
    let near = |found: [f32; 3], right: [f32; 3]| {
        found.iter().zip(right).all(|(found, right)| (found - right).abs() <= 0.01 * right)
    };
    for (name, color) in [("a.exr", [3.0, 1.0, 0.5]), ("a.png", [1.0, 0.5, 0.25])] {
        let [behind, ball] = around(name, color, None);
        assert!(near(behind, color), "{name}: {behind:?}");
        assert!(near(ball, color.map(|value| 0.7 * value)), "{name}: {ball:?}");
    }
    let [behind, ball] = around("a.exr", [3.0, 1.0, 0.5], Some(Background::Transparent));
    assert_eq!(behind, [0.0; 3]);
    assert!(near(ball, [2.1, 0.7, 0.35]), "{ball:?}");
}

#[test]
fn a_mesh_without_normals_is_smooth_up_to_the_angle_of_a_crease() {
    let smooth = |crease_degrees| {
        let scene = lit(Lighting { crease_degrees, ..Lighting::default() });
        scene.appearance.shapes[0].smooth
    };
    assert!(smooth(30.0) && !smooth(0.0));
}

#[test]
fn what_no_ray_hits_is_transparent() {
    let folder = folder();
    ball(&folder.path().join("ball.obj"), 24);
    let arguments = ["ball.obj", "a.png", "--also", "a.exr", "--background", "transparent"];
    run_well(folder.path(), &[&arguments[..], &["--width", "40", "--height", "30"]].concat());
    let png = image::open(folder.path().join("a.png")).expect("a PNG").into_rgba8();
    let exr = read_first_rgba_layer_from_file(
        folder.path().join("a.exr"),
        |size, _| image::Rgba32FImage::new(size.width() as u32, size.height() as u32),
        |image, at, (r, g, b, a): (f32, f32, f32, f32)| {
            image.put_pixel(at.x() as u32, at.y() as u32, image::Rgba([r, g, b, a]));
        },
    );
    let exr = exr.expect("an EXR").layer_data.channel_data.pixels;
    assert_eq!((png.get_pixel(0, 0).0, exr.get_pixel(0, 0).0), ([0; 4], [0.0; 4]));
    assert_eq!((png.get_pixel(20, 15).0[3], exr.get_pixel(20, 15).0[3]), (255, 1.0));
    let edge = exr.enumerate_pixels().find(|(.., pixel)| pixel.0[3] == 0.5).expect("half a pixel");
    let straight = srgb_encode(edge.2.0[1] / 0.5) * 255.0;
    let found = png.get_pixel(edge.0, edge.1).0;
    assert!(
        (f32::from(found[1]) - straight).abs() <= 1.0 && found[3] == 128,
        "{found:?}, {straight}"
    );
}

/// They do in what mirrors or bends.
#[test]
fn surroundings_do_not_show_straight_before_a_transparent_background() {
    let lighting = Lighting { background: Some(Background::Transparent), ..Lighting::default() };
    let options = LoadOptions { lighting, ..LoadOptions::default() };
    let even = r#"{"zenith": [1, 1, 1], "horizon": [1, 1, 1], "nadir": [1, 1, 1]}"#;
    for (around, more) in ["{}", even].into_iter().flat_map(|a| ["kr", "kt", "kd"].map(|m| (a, m)))
    {
        let ball = sphere([0.0; 3], 0.7, with(matte(0.0, [0.0; 3]), more, 1));
        let scene = scene(3, &pinhole([24, 18], 40.0, 5.0), &[], &[ball]);
        let scene = edited(scene, &format!("/scene/environment {around}"));
        let film = image_of(&ready(load_str(&scene.to_string(), Path::new("s.json"), &options)), 0);
        let [nothing, ball] = [0, 12].map(|x| film.pixel(x, 9).expect("a pixel"));
        assert!(nothing == [0.0; 3] && (ball[0] > 0.1) == (more != "kd"), "{around}, {more}");
    }
}

#[test]
fn a_room_alone_is_lit_by_a_lamp_under_its_ceiling() {
    let folder = folder();
    let path = folder.path().join("room.obj");
    let block = |x: [f64; 2], y: [f64; 2], z: [f64; 2]| -> String {
        let corner = |i: usize| format!("v {} {} {}\n", x[i & 1], y[i >> 1 & 1], z[i >> 2]);
        (0..8).map(corner).collect()
    };
    let sides = "f -8 -6 -5 -7\nf -4 -3 -1 -2\nf -8 -4 -2 -6\nf -7 -5 -1 -3\n\
                 f -8 -7 -3 -4\nf -6 -2 -1 -5\n";
    // Walls face inward: from the right to the left.
    let walls = block([3.0, -3.0], [0.0, 2.7], [-2.5, 2.5]);
    let table = block([-0.7, 1.0], [0.0, 0.76], [-0.4, 0.6]);
    put(folder.path(), "room.obj", [&walls, sides, &table, sides].concat());
    let options = LoadOptions { width: Some(64), height: Some(48), ..LoadOptions::default() };
    let scene = ready(load(&path, &options));
    let [light, sky] = &scene.lights[..] else { panic!("{:?}", scene.lights) };
    assert!(sky.emitter.ambient_reach().is_some(), "what is near darkens it");
    assert!(light.is_sampled() && light.samples() > 1, "its shadows are soft");
    // The ceiling of the room is at 2.7 metres.
    let stream = Stream { seed: 0, pixel: 0, sample: 0, bounce: 0 };
    let height = f64::from(light.point(0, &stream).position.y) + scene.origin.y;
    assert!(height > 2.4 && height < 2.7, "{height}");
    let film = image_of(&scene, 0);
    let dark = film.pixels().iter().filter(|p| srgb_encode(p[1]) < 0.2).count();
    assert!(dark < film.pixels().len() / 50, "{dark} pixels are dark");
}
