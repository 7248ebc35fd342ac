//! Layers beside the colours, against what geometry says.

use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, TracerKind};
use wavecrest_core::tile::Tile;
use wavecrest_image::aov::{Layer, Layers, Request, layers};
use wavecrest_image::metadata::Values;
use wavecrest_scene::systems::SceneOptions;

use crate::support::{
    edited, folder, image_of, matte, options, pinhole, point_light, prepare, prepare_in, put_image,
    render_on, scene, sphere, thin_lens, wall, with,
};

fn made(scene: &PreparedScene, threads: usize, request: &Request<'_>) -> Layers {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    pool.install(|| layers(scene, request, &())).unwrap_or_else(|error| panic!("{error}"))
}

fn all(scene: &PreparedScene) -> Layers {
    made(scene, 2, &Request { layers: &Layer::ALL, crop: None, seed: 0, invalid: 0 })
}

fn values<'a>(found: &'a Layers, name: &str) -> &'a Values {
    let channel = found.channels.iter().find(|channel| channel.name == name);
    &channel.unwrap_or_else(|| panic!("there is no {name}")).values
}

fn floats<'a>(found: &'a Layers, name: &str) -> &'a [f32] {
    match values(found, name) {
        Values::Floats(values) => values,
        Values::Integers(_) => panic!("{name} has whole numbers"),
    }
}

fn integers<'a>(found: &'a Layers, name: &str) -> &'a [u32] {
    match values(found, name) {
        Values::Integers(values) => values,
        Values::Floats(_) => panic!("{name} has floats"),
    }
}

fn vector(found: &Layers, name: &str, pixel: usize) -> DVec3 {
    let axes = if name == "albedo" { ["R", "G", "B"] } else { ["X", "Y", "Z"] };
    let [x, y, z] = axes.map(|axis| f64::from(floats(found, &format!("{name}.{axis}"))[pixel]));
    DVec3::new(x, y, z)
}

/// What the numbers of a layer stand for.
fn table(found: &Layers, name: &str) -> Value {
    let entry = found.entries.iter().find(|entry| entry.name == name).expect("a table");
    serde_json::from_str(&entry.text).expect("JSON")
}

const SIZE: [u32; 2] = [40, 30];
const DISTANCE: f64 = 6.0;

/// The direction through a pixel's centre of a camera that looks along -z, 1 along z.
fn direction(x: u32, y: u32) -> DVec3 {
    let side = 2.0 * 20.0_f64.to_radians().tan() / f64::from(SIZE[1]);
    let right = (f64::from(x) + 0.5 - f64::from(SIZE[0]) / 2.0) * side;
    let up = (f64::from(SIZE[1]) / 2.0 - f64::from(y) - 0.5) * side;
    DVec3::new(right, up, -1.0)
}

fn pixels() -> impl Iterator<Item = (usize, u32, u32)> {
    (0..SIZE[0] * SIZE[1]).map(|i| (i as usize, i % SIZE[0], i / SIZE[0]))
}

fn lamp() -> Value {
    point_light(40.0, [1.0, 2.0, 4.0], [1.0; 3])
}

/// A ball before a wall that covers the left half.
fn ball_and_wall(camera: &Value) -> Value {
    let half = json!({"type": "plane", "material": matte(0.8, [0.25, 0.5, 0.75]),
                      "points": [[-9, -9, -2], [-9, 9, -2], [0, 9, -2], [0, -9, -2]]});
    scene(
        0,
        camera,
        &[lamp()],
        &[sphere([0.5, 0.25, 0.0], 1.0, matte(0.5, [1.0, 0.5, 0.125])), half],
    )
}

#[test]
fn layers_are_what_the_geometry_says() {
    let found = all(&prepare(&ball_and_wall(&pinhole(SIZE, 40.0, DISTANCE))));
    let eye = DVec3::new(0.0, 0.0, DISTANCE);
    let center = DVec3::new(0.5, 0.25, 0.0);
    let (mut balls, mut walls, mut nothing) = (0, 0, 0);
    for (i, x, y) in pixels() {
        let along = direction(x, y);
        let toward = center - eye;
        let nearest = toward.dot(along) / along.length_squared();
        let off = (along * nearest - toward).length();
        // Close to the edge of the ball a rounding decides.
        if (off - 1.0).abs() < 1e-3 {
            continue;
        }
        let id = integers(&found, "object.id")[i];
        let depth = f64::from(floats(&found, "depth.Z")[i]);
        let (z, normal, albedo) = if off < 1.0 {
            balls += 1;
            let z = nearest - (1.0 - off * off).sqrt() / along.length();
            (z, eye + along * z - center, DVec3::new(1.0, 0.5, 0.125))
        } else if along.x < 0.0 {
            walls += 1;
            (DISTANCE + 2.0, DVec3::Z, DVec3::new(0.25, 0.5, 0.75))
        } else {
            nothing += 1;
            assert_eq!((id, depth), (0, 0.0), "{x},{y}");
            assert_eq!(integers(&found, "material.id")[i], 0);
            assert_eq!(vector(&found, "P", i), DVec3::ZERO);
            continue;
        };
        // Depth is along the view axis: that of the wall is the same everywhere.
        assert!((depth - z).abs() < 2e-5, "{x},{y}: {depth} {z}");
        assert!(vector(&found, "P", i).distance(eye + along * z) < 2e-5, "{x},{y}");
        assert!(vector(&found, "N", i).distance(normal) < 2e-5, "{x},{y}");
        assert!(vector(&found, "albedo", i).distance(albedo) < 1e-6, "{x},{y}");
        assert!(id > 0 && integers(&found, "material.id")[i] > 0);
        assert_eq!(integers(&found, "samples.count")[i], 1);
        assert_eq!(floats(&found, "invalid.mask")[i], 0.0);
    }
    assert!(balls > 100 && walls > 100 && nothing > 100, "{balls} {walls} {nothing}");
}

#[test]
fn layers_show_the_first_surface_that_sends_light() {
    let folder = folder();
    put_image(folder.path(), "t.png", [2, 1], |x, _| [x as f32; 3]);
    let bare = ball_and_wall(&pinhole(SIZE, 40.0, DISTANCE));
    let map = json!({"file": "t.png", "filter": "nearest"});
    let pane = with(wall(9.0, 2.0, matte(0.8, [0.5; 3])), "opacitymap", map);
    let before = edited(bare.clone(), &format!("/scene/shapes/- {pane}"));
    let found =
        [bare, before].map(|s| all(&prepare_in(folder.path(), &s, SceneOptions::default())));
    for (i, x, y) in pixels() {
        let [bare, depth] = [0, 1].map(|k| floats(&found[k], "depth.Z")[i]);
        let is_clear = x < SIZE[0] / 2;
        assert!((depth - if is_clear { bare } else { 4.0 }).abs() < 1e-5, "{x},{y}: {depth}");
    }
}

/// Laid over a background as other programs do, colour + (1 - alpha) background, a picture is the render with it.
#[test]
fn a_picture_laid_over_a_background_is_the_render_with_it() {
    let folder = folder();
    put_image(folder.path(), "t.png", [3, 2], |x, y| [0.3 * x as f32 + 0.2 * y as f32; 3]);
    let pane = |z, more: &str| edited(wall(1.0, z, matte(0.8, [0.5, 0.75, 0.25])), more);
    for more in [
        "/material/opacity 0.6",
        "/alpha \"t.png\"",
        "/opacitymap {\"file\": \"t.png\"}",
        "/material/kt 0.8\n/material/thin true\n/material/opacity 0.75\n/material/kr 0.5",
    ] {
        let (faint, other) = (pane(0.0, "/material/opacity 0.3"), pane(0.5, more));
        let scene = scene(3, &pinhole([24, 18], 40.0, 5.0), &[lamp()], &[faint, other]);
        let [black, behind] = ["[0, 0, 0]", "[0.25, 0.5, 1]"].map(|color| {
            let scene = edited(scene.clone(), &format!("/scene/backgroundcolor {color}"));
            prepare_in(folder.path(), &scene, SceneOptions::default())
        });
        let (found, laid, whole) = (all(&black), image_of(&black, 0), image_of(&behind, 0));
        for (i, alpha) in floats(&found, "A").iter().enumerate() {
            let [laid, whole] = [&laid, &whole].map(|film| Vec3::from(film.pixels()[i]));
            let over = laid + (1.0 - alpha) * Vec3::new(0.25, 0.5, 1.0);
            assert!(over.distance(whole) < 1e-6, "{scene}: {laid} {alpha}, {whole}");
        }
    }
}

#[test]
fn numbers_stand_for_the_shapes_that_are_seen() {
    let mut scene = ball_and_wall(&pinhole(SIZE, 40.0, DISTANCE));
    let shapes = scene["scene"]["shapes"].as_array_mut().expect("shapes");
    shapes[1]["name"] = "wall".into();
    // One of the wall's material, and one that is not seen.
    let twin =
        with(sphere([0.5, -1.5, 0.5], 0.3, json!(null)), "material", shapes[1]["material"].clone());
    shapes.push(twin);
    shapes.push(sphere([0.0, 0.0, 90.0], 1.0, matte(0.5, [0.5; 3])));
    let found = all(&prepare(&scene));
    let at = |name: &str, x: u32, y: u32| integers(&found, name)[(y * SIZE[0] + x) as usize];
    let places = [(23, 13), (2, 3), (23, 24)];
    for ((x, y), name) in places.into_iter().zip(["scene.shapes[0]", "wall", "scene.shapes[2]"]) {
        let id = at("object.id", x, y).to_string();
        assert_eq!(table(&found, "objects")[&id], name);
    }
    let materials = places.map(|(x, y)| at("material.id", x, y));
    assert!(materials[0] != materials[1] && materials[1] == materials[2], "{materials:?}");
    let name = &table(&found, "materials")[materials[0].to_string()];
    assert_eq!(name, "scene.shapes[0].material");
    let shown = table(&found, "objects").as_object().map(|all| all.len());
    assert_eq!(shown, Some(3), "of those that are seen");
}

/// A camera with a lens and with several rays in each part of a pixel.
fn blurred() -> Value {
    with(thin_lens(pinhole(SIZE, 40.0, DISTANCE), 0.2, 5.0, [2, 2]), "antialias", 2)
}

#[test]
fn means_are_over_the_samples_that_hit() {
    let mut scene = ball_and_wall(&blurred());
    scene["scene"]["shapes"].as_array_mut().expect("shapes").truncate(1);
    let found = all(&prepare(&scene));
    let depths = floats(&found, "depth.Z");
    let seen: Vec<f32> = depths.iter().copied().filter(|&z| z > 0.0).collect();
    // At the edge some samples hit nothing; they pull no mean towards 0.
    assert!(seen.iter().all(|z| (4.9..6.1).contains(z)) && seen.len() > 120);
    let albedo = floats(&found, "albedo.G");
    assert!(albedo.iter().all(|&g| g == 0.0 || g == 0.5));
    assert!(integers(&found, "samples.count").iter().all(|&n| n == 16));
    // Where the first sample misses, others may hit.
    let ids = integers(&found, "object.id").iter().zip(depths);
    assert!(ids.filter(|&(&id, &z)| id == 0 && z > 0.0).count() > 3);
}

#[test]
fn a_crop_and_any_number_of_threads_give_the_same_layers() {
    // Wider than the tiles of the pass.
    let camera = with(with(blurred(), "width", 150), "height", 75);
    let scene = prepare(&ball_and_wall(&camera));
    let request = |crop| Request { layers: &Layer::ALL, crop, seed: 3, invalid: 0 };
    let whole = made(&scene, 1, &request(None));
    assert_eq!(made(&scene, 3, &request(None)).channels, whole.channels);
    let crop = Tile { x: 57, y: 21, width: 80, height: 50 };
    let part = made(&scene, 2, &request(Some(crop)));
    for (part, whole) in part.channels.iter().zip(&whole.channels) {
        let index = |i: u32| {
            let (x, y) = crop.pixel(i);
            (y * 150 + x) as usize
        };
        let same = (0..crop.len() as u32).all(|i| match (&part.values, &whole.values) {
            (Values::Floats(a), Values::Floats(b)) => {
                a[i as usize].to_bits() == b[index(i)].to_bits()
            }
            (Values::Integers(a), Values::Integers(b)) => a[i as usize] == b[index(i)],
            _ => false,
        });
        assert!(same, "{}", part.name);
    }
    let other = made(&scene, 2, &Request { seed: 4, ..request(None) });
    assert_ne!(other.channels, whole.channels, "the seed moves the samples");
}

#[test]
fn layers_are_in_one_order_and_once_each() {
    let scene = prepare(&ball_and_wall(&pinhole([4, 3], 40.0, DISTANCE)));
    let asked = [Layer::Object, Layer::Depth, Layer::Object];
    let found = made(&scene, 1, &Request { layers: &asked, crop: None, seed: 0, invalid: 0 });
    let names: Vec<_> = found.channels.iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(names, ["depth.Z", "object.id"]);
    let beyond = Tile { x: 2, y: 0, width: 3, height: 1 };
    let request = Request { layers: &asked, crop: Some(beyond), seed: 0, invalid: 0 };
    let told = layers(&scene, &request, &()).expect_err("the crop is too wide").to_string();
    assert!(told.contains("lie within the image"), "{told}");
}

#[test]
fn lights_are_seen_in_their_colour_and_positions_are_those_of_the_scene() {
    let lamp = json!({"type": "arealight", "intensity": 5, "color": [0.5, 0.75, 1.0],
                      "sampling": "random", "samples": 1,
                      "shape": {"type": "sphere", "center": [1e5, 0, 0], "radius": 1}});
    let camera = with(pinhole([9, 9], 30.0, 0.0), "location", json!([1e5, 0, 6]));
    let camera = with(camera, "look", json!([1e5, 0, 0]));
    let prepared = prepare(&scene(0, &camera, &[lamp], &[wall(2.0, -3.0, matte(0.5, [1.0; 3]))]));
    let found = all(&prepared);
    let middle = 4 * 9 + 4;
    assert_eq!(vector(&found, "albedo", middle), DVec3::new(0.5, 0.75, 1.0));
    assert!(vector(&found, "P", middle).distance(DVec3::new(1e5, 0.0, 1.0)) < 0.01);
    assert!(vector(&found, "N", middle).distance(DVec3::Z) < 1e-5);
    assert_eq!(integers(&found, "material.id")[middle], 0);
    let table = table(&found, "objects").to_string();
    assert!(table.contains("scene.lightsources[0]"), "{table}");
}

#[test]
fn the_mask_is_set_where_a_sample_is_not_finite() {
    let strong = |position: [f64; 3]| {
        let light = point_light(1e12, position, [1.0; 3]);
        with(light, "falloff", "inverse-square")
    };
    let size = 1e-15;
    let camera = with(pinhole([24, 18], 50.0, 6.0 * size), "antialias", 2);
    let ball = sphere([0.0; 3], size, matte(0.8, [1.0, 0.5, 0.25]));
    let prepared = prepare(&scene(0, &camera, &[strong([2.0 * size, size, 5.0 * size])], &[ball]));
    let rendered = render_on(1, &prepared, &options());
    let invalid = rendered.counters.invalid;
    assert!(invalid > 0);
    let request = Request { layers: &[Layer::Invalid], crop: None, seed: 0, invalid };
    let found = made(&prepared, 2, &request);
    let mask = floats(&found, "invalid.mask");
    let mut marked = 0;
    for (i, &value) in mask.iter().enumerate() {
        let (x, y) = (i as u32 % 24, i as u32 / 24);
        let crop = Some(Tile { x, y, width: 1, height: 1 });
        let options = RenderOptions { crop, tracer: TracerKind::Wavefront, ..options() };
        let has = render_on(1, &prepared, &options).counters.invalid > 0;
        assert_eq!(value, if has { 1.0 } else { 0.0 }, "{x},{y}");
        marked += u32::from(has);
    }
    assert!(marked > 10 && marked < 24 * 18, "{marked}");
}

#[test]
fn instances_have_numbers_of_their_own() {
    let corners = json!([[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [1, -1, 0]]);
    let mesh = json!({"type": "trimesh", "name": "tile", "hidden": true, "points": corners,
                      "indices": [[0, 1, 2], [0, 2, 3]], "sides": "both",
                      "material": matte(0.5, [0.25, 0.5, 0.75])});
    let shown = |x: f64, z: f64| json!({"shape": "tile", "transform": {"translate": [x, 0, z]}});
    let mut scene = scene(0, &pinhole(SIZE, 40.0, DISTANCE), &[lamp()], &[mesh]);
    let red = with(shown(1.25, -1.0), "material", matte(0.5, [1.0, 0.0, 0.0]));
    scene["scene"]["instances"] = json!([shown(-1.25, 0.5), red]);
    let found = all(&prepare(&scene));
    let table = table(&found, "objects");
    let cases = [(12, "scene.instances[0]", 0.5, 0.25), (27, "scene.instances[1]", -1.0, 1.0)];
    for (x, place, z, red) in cases {
        let pixel = (15 * SIZE[0] + x) as usize;
        let id = integers(&found, "object.id")[pixel].to_string();
        assert_eq!(table[&id], place);
        assert!((f64::from(floats(&found, "depth.Z")[pixel]) - (DISTANCE - z)).abs() < 1e-5);
        assert!((vector(&found, "P", pixel).z - z).abs() < 1e-5);
        assert!(vector(&found, "N", pixel).distance(DVec3::Z) < 1e-6);
        assert_eq!(vector(&found, "albedo", pixel).x, red);
    }
}
