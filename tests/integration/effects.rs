//! Effects: a scene pays for what it shows. The counters are exact, so that "nothing" is 0.

use serde_json::{Value, json};
use wavecrest_core::counters::Counters;
use wavecrest_core::plan::Effect;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::wavefront::batch::Batch;
use wavecrest_scene::systems::Options;

use crate::parity::work;
use crate::support::{
    both_alone, folder, matte, options, pinhole, point_light, prepare, prepare_in, put,
    put_texture, reason, refusal, render_on, scene, sphere, thin_lens, try_prepare, wall, with,
};

const SIZE: [u32; 2] = [16, 12];
const PIXELS: u64 = 16 * 12;

/// What both tracers count, once they are seen to count the same; how they search for hits is each
/// one's own affair, and their tests and kernels are added up.
fn counters(scene: &PreparedScene) -> Counters {
    let [mut wavefront, recursive] = both_alone(scene).map(|rendered| rendered.counters);
    assert_eq!(work(&wavefront), work(&recursive), "the tracers do not do the same work");
    wavefront.tests += recursive.tests;
    wavefront.kernels += recursive.kernels;
    wavefront
}

fn camera() -> Value {
    pinhole(SIZE, 40.0, 5.0)
}

fn lens(aperture: f64) -> Value {
    thin_lens(camera(), aperture, 5.0, [3, 2])
}

fn light() -> Value {
    point_light(30.0, [1.0, 2.0, 4.0], [1.0; 3])
}

fn area_light(intensity: f64) -> Value {
    let corners = json!([[-1, 4, -1], [-1, 4, 1], [1, 4, 1], [1, 4, -1]]);
    json!({"type": "arealight", "intensity": intensity, "color": [1, 1, 1], "sampling": "jittered",
           "samples": 3, "shape": {"type": "plane", "points": corners}})
}

/// A mirroring wall that fills the picture.
fn mirror() -> Value {
    wall(50.0, 0.0, with(matte(0.8, [0.5; 3]), "kr", 0.5))
}

/// A wall behind the eye that faces it, which only the mirror shows.
fn behind() -> Value {
    with(wall(50.0, 9.0, matte(0.8, [0.5; 3])), "normal", json!([0, 0, -1]))
}

#[test]
fn a_scene_without_lights_casts_no_shadow_ray() {
    let lit = counters(&prepare(&scene(0, &camera(), &[light()], &[mirror()])));
    assert_eq!((lit.primary_rays, lit.shadow_rays), (PIXELS, PIXELS), "with a light: one each");
    let dark = prepare(&scene(0, &camera(), &[], &[mirror()]));
    assert_eq!(counters(&dark).shadow_rays, 0);
    assert!(!dark.plan.schedule().has_shadows());
}

#[test]
fn a_light_without_power_casts_no_shadow_ray_but_keeps_its_ambient_part() {
    let black = with(light(), "color", json!([0, 0, 0]));
    for dark in [with(light(), "intensity", 0), black, area_light(0.0)] {
        let prepared = prepare(&scene(0, &camera(), &[dark], &[mirror()]));
        let found = counters(&prepared);
        assert_eq!((found.shadow_rays, found.light_samples), (0, 0));
        let film = render_on(1, &prepared, &options()).film;
        assert_eq!(film.pixel(3, 3), Some([0.5 * 0.08; 3]));
    }
}

#[test]
fn a_light_without_power_beside_one_with_power_draws_no_sample() {
    let scene = scene(0, &camera(), &[light(), area_light(0.0)], &[mirror()]);
    let prepared = prepare(&scene);
    assert!(!prepared.plan.has(Effect::AreaLights));
    let found = counters(&prepared);
    assert_eq!((found.shadow_rays, found.light_samples), (PIXELS, 0));
}

#[test]
fn without_mirrors_or_without_bounces_there_is_no_secondary_ray() {
    let of = |bounces, kr: f64| {
        let wall = wall(50.0, 0.0, with(matte(0.8, [0.5; 3]), "kr", kr));
        counters(&prepare(&scene(bounces, &camera(), &[light()], &[wall, behind()]))).secondary_rays
    };
    assert_eq!(of(1, 0.5), PIXELS, "with both: one for each pixel");
    assert_eq!(of(7, 0.5), PIXELS, "the other wall is no mirror");
    assert_eq!(of(7, 0.0), 0);
    assert_eq!(of(0, 0.5), 0);
}

#[test]
fn bounces_are_not_counted_beyond_the_last() {
    // So wide that a ray goes to and fro as often as it may.
    let wide = |z| wall(1e4, z, with(matte(0.8, [0.5; 3]), "kr", 0.5));
    let away = with(wide(9.0), "normal", -1);
    for bounces in [1, 2, 5, 40] {
        let dark = with(light(), "intensity", 0);
        let scene = scene(bounces, &camera(), &[dark], &[wide(0.0), away.clone()]);
        let found = counters(&prepare(&scene)).secondary_rays;
        assert_eq!(found, PIXELS * u64::from(bounces), "{bounces} bounces");
    }
}

#[test]
fn a_pinhole_draws_no_lens_number() {
    let of = |camera: &Value| counters(&prepare(&scene(0, camera, &[light()], &[mirror()])));
    let open = of(&lens(0.5));
    assert_eq!((open.primary_rays, open.lens_samples), (6 * PIXELS, 6 * PIXELS));
    for camera in [camera(), lens(0.0)] {
        let found = of(&camera);
        assert_eq!((found.primary_rays, found.lens_samples), (PIXELS, 0));
    }
    let smooth = of(&with(camera(), "antialias", 3));
    assert_eq!((smooth.primary_rays, smooth.lens_samples), (9 * PIXELS, 0));
}

#[test]
fn point_lights_draw_no_light_sample() {
    let of = |light| counters(&prepare(&scene(0, &camera(), &[light], &[mirror()])));
    assert_eq!(of(light()).light_samples, 0);
    assert_eq!(of(area_light(30.0)).light_samples, 9 * PIXELS, "jittered 3: nine points each");
    let random = with(area_light(30.0), "sampling", "random");
    assert_eq!(of(random).light_samples, 3 * PIXELS, "random 3: three");
}

#[test]
fn a_back_asks_no_light_for_anything() {
    let back = with(mirror(), "normal", -1);
    let found = counters(&prepare(&scene(3, &camera(), &[light(), area_light(9.0)], &[back])));
    let asked = (found.shadow_rays, found.light_samples, found.secondary_rays);
    assert_eq!(asked, (0, 0, 0));
}

#[test]
fn texels_are_read_only_for_what_is_textured() {
    let folder = folder();
    put_texture(folder.path());
    let of = |wall: Value| {
        let scene = scene(0, &camera(), &[light()], &[wall]);
        let prepared = prepare_in(folder.path(), &scene, Options::default());
        (counters(&prepared).texels, prepared.appearance.images.len())
    };
    assert_eq!(of(mirror()), (0, 0));
    let textured = with(mirror(), "texture", "t.png");
    assert_eq!(of(textured.clone()), (4 * PIXELS, 1), "bilinear: four each");
    assert_eq!(of(with(textured, "filter", "nearest")), (PIXELS, 1), "nearest: one");
}

/// Textures are opened by the system that decodes them and nowhere else: a file that is there but
/// is no image fails where it is worn, and is not so much as opened on the shape of a light, which
/// shows its own colour.
#[test]
fn the_texture_of_a_light_is_not_opened() {
    let folder = folder();
    put(folder.path(), "broken.png", "no image");
    let file = folder.path().join("scene.json");
    let worn = with(mirror(), "texture", "broken.png");
    let error = refusal(&scene(0, &camera(), &[light()], &[worn]), &file).to_string();
    assert!(error.contains("scene.shapes[0].texture: cannot read the texture"), "{error}");
    for texture in ["broken.png", "missing.png"] {
        let mut light = area_light(30.0);
        light["shape"]["texture"] = texture.into();
        let scene = scene(0, &camera(), &[light], &[mirror()]);
        let prepared = try_prepare(&scene, &file).expect("the light needs no image");
        assert!(prepared.appearance.images.is_empty() && !prepared.plan.has(Effect::Textures));
    }
}

#[test]
fn a_texture_that_nothing_shows_is_not_opened() {
    let folder = folder();
    put(folder.path(), "broken.png", "no image");
    let file = folder.path().join("scene.json");
    let worn = |wall: Value| with(wall, "texture", "broken.png");
    let by = |ambient: f64, lights: &[Value], shapes: &[Value]| {
        let mut scene = scene(3, &camera(), lights, shapes);
        scene["scene"]["ambient"] = ambient.into();
        scene
    };
    let shiny = with(mirror(), "material", with(with(matte(0.0, [0.5; 3]), "ks", 0.8), "kr", 0.5));
    let line = json!({"type": "triangle", "points": [[0, 0, 0], [1, 1, 1], [2, 2, 2]],
                      "material": matte(0.8, [0.5; 3])});
    let dark = with(light(), "intensity", 0);
    let behind_it = with(light(), "position", json!([0, 0, -4]));
    for (scene, why) in [
        (by(0.08, &[], &[worn(mirror())]), "no light reaches a texture"),
        (by(0.0, std::slice::from_ref(&dark), &[worn(mirror())]), "no light reaches a texture"),
        (by(0.0, &[behind_it], &[worn(mirror())]), "no light reaches a texture"),
        (by(0.0, &[light()], &[worn(shiny.clone())]), "no surface uses the colour of its texture"),
        (
            by(0.08, &[light()], &[mirror(), worn(line)]),
            "no surface uses the colour of its texture",
        ),
    ] {
        let prepared = try_prepare(&scene, &file).unwrap_or_else(|error| panic!("{why}: {error}"));
        assert_eq!(reason(&prepared, Effect::Textures), (false, why));
        assert_eq!(counters(&prepared).texels, 0);
    }
    for scene in [by(0.08, &[dark], &[worn(shiny)]), by(0.0, &[light()], &[worn(mirror())])] {
        assert!(try_prepare(&scene, &file).is_err(), "its colour shows");
    }
}

#[test]
fn an_image_that_two_shapes_wear_is_decoded_once() {
    let folder = folder();
    put_texture(folder.path());
    let worn = with(mirror(), "texture", "t.png");
    let scene = scene(0, &camera(), &[light()], &[worn.clone(), with(worn, "filter", "nearest")]);
    let prepared = prepare_in(folder.path(), &scene, Options::default());
    assert_eq!(prepared.appearance.images.len(), 1);
}

#[test]
fn shapes_that_are_not_there_are_never_tested() {
    let triangle = json!({"type": "triangle", "points": [[-9, -9, 0], [0, 9, 0], [9, -9, 0]],
                          "material": matte(0.8, [0.5; 3])});
    let tests = |shape: Value| {
        let tests = counters(&prepare(&scene(0, &camera(), &[light()], &[shape]))).tests;
        [tests.triangles, tests.quads, tests.spheres, tests.disks]
    };
    // The one shape is tested by every primary ray, and by every shadow ray that starts on it.
    let disk = json!({"type": "disk", "center": [0, 0, 0], "normal": [0, 0, 1], "radius": 9,
                      "material": matte(0.8, [0.5; 3])});
    let kinds = [triangle, mirror(), sphere([0.0; 3], 1.0, matte(0.8, [0.5; 3])), disk];
    for (kind, shape) in kinds.into_iter().enumerate() {
        let found = tests(shape);
        assert!(found[kind] >= PIXELS / 4, "{found:?}");
        let others = (0..4).filter(|&other| other != kind).map(|other| found[other]).sum::<u64>();
        assert_eq!(others, 0, "{found:?}");
    }
    let nothing = prepare(&scene(4, &camera(), &[light()], &[]));
    assert_eq!(counters(&nothing), Counters::default(), "not even rays");
}

#[test]
fn columns_that_a_scene_does_not_need_have_no_storage() {
    let groups = |bounces, lights: &[Value]| {
        let prepared = prepare(&scene(bounces, &camera(), lights, &[mirror()]));
        Batch::bytes_per_path(&prepared).into_iter().map(|(name, _)| name).collect::<Vec<_>>()
    };
    let dark = with(light(), "intensity", 0);
    assert_eq!(groups(0, &[]), ["paths", "rays", "hits"]);
    assert_eq!(groups(2, &[]), ["paths", "rays", "hits"], "nothing to be seen in the mirror");
    assert_eq!(groups(2, &[dark]), ["paths", "rays", "hits", "next rays"]);
    assert_eq!(groups(0, &[light()]), ["paths", "rays", "hits", "lit points", "shadow rays"]);
    let all = groups(2, &[light()]);
    assert_eq!(all, ["paths", "rays", "hits", "lit points", "shadow rays", "next rays"]);
}

#[test]
fn differentials_have_storage_where_a_trilinear_texture_can_be_mirrored() {
    let folder = folder();
    put_texture(folder.path());
    let of = |bounces, filter: &str| {
        let worn = with(with(mirror(), "texture", "t.png"), "filter", filter);
        let scene = scene(bounces, &camera(), &[light()], &[worn, behind()]);
        let prepared = prepare_in(folder.path(), &scene, Options::default());
        let groups = Batch::bytes_per_path(&prepared);
        let bytes = groups.into_iter().find(|(name, _)| *name == "differentials");
        assert_eq!(Batch::new(&prepared, 100).bytes(), 0, "nothing is stored before it is written");
        let is_planned = prepared.plan.has(Effect::RayDifferentials);
        (is_planned, bytes.map_or(0, |(_, bytes)| bytes), counters(&prepared).footprints)
    };
    for filter in ["nearest", "bilinear"] {
        assert_eq!(of(2, filter), (false, 0, 0), "{filter}");
    }
    assert_eq!(of(0, "trilinear"), (true, 0, PIXELS), "camera rays need no column");
    // Each look-up counts once, and so does each mirror ray, which meets the other wall.
    assert_eq!(of(2, "trilinear"), (true, 96, 2 * PIXELS));
}

/// Only what is seen counts: lights show their own colour.
#[test]
fn the_filter_of_a_light_asks_for_nothing() {
    let mut light = area_light(30.0);
    light["shape"]["texture"] = "missing.png".into();
    light["shape"]["filter"] = "trilinear".into();
    let prepared = prepare(&scene(1, &camera(), &[light], &[mirror()]));
    assert!(!prepared.plan.has(Effect::RayDifferentials));
    assert_eq!(counters(&prepared).footprints, 0);
}
