//! Cut-outs: what has little alpha is not there, for rays of any kind.

use std::path::Path;

use image::{Rgba, RgbaImage};
use serde_json::{Value, json};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_scene::systems::SceneOptions;

use crate::support::{
    assert_near, both, edited, folder, image_of, matte, options, pinhole, pixel, point_light,
    prepare_in, render_on, scene, sphere, wall, with,
};

/// A folder with an image whose left half is there, green, and whose right half is not.
fn with_image() -> tempfile::TempDir {
    let folder = folder();
    let texel = |x, _| Rgba([0, 255, 0, if x < 2 { 255 } else { 0 }]);
    RgbaImage::from_fn(4, 4, texel).save(folder.path().join("half.png")).expect("an image");
    folder
}

fn prepared(json: &Value, folder: &Path) -> PreparedScene {
    prepare_in(folder, json, SceneOptions::default())
}

fn cut_out(shape: Value) -> Value {
    let shape = with(with(shape, "texture", "half.png"), "alphacutoff", 0.5);
    with(with(shape, "filter", "nearest"), "sides", "both")
}

/// A wall of which the left half is there, as shapes of each kind have it.
fn walls() -> [Value; 3] {
    let corners = [[-2, -2, 0], [-2, 2, 0], [2, 2, 0], [2, -2, 0]];
    let mesh = json!({"type": "trimesh", "points": corners, "indices": [[0, 1, 2], [0, 2, 3]],
                      "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]], "material": matte(1.0, [0.5; 3])});
    let triangle = json!({"type": "triangle", "points": [[-2, -2, 0], [-2, 6, 0], [2, -2, 0]],
                          "wrap": "clamp", "material": matte(1.0, [0.5; 3])});
    [wall(2.0, 0.0, matte(1.0, [0.5; 3])), mesh, triangle]
}

/// What is behind shows where nothing is, in a mirror too, and it casts no shadow there.
#[test]
fn camera_rays_shadow_rays_and_mirror_rays_pass_where_nothing_is() {
    let folder = with_image();
    for shape in walls() {
        // Straight before the camera; behind it a wall that the lamp is before, beside the camera's axis.
        let behind = wall(8.0, -2.0, matte(1.0, [1.0, 0.0, 0.0]));
        let lamp = point_light(50.0, [0.0, 0.0, 6.0], [1.0; 3]);
        let mut json = scene(1, &pinhole([16, 16], 40.0, 6.0), &[lamp], &[cut_out(shape), behind]);
        json["scene"]["ambient"] = 0.into();
        let scene = prepared(&json, folder.path());
        let film = image_of(&scene, 0);
        let is_green = |x| pixel(&film, x, 8)[1] > 0.0 && pixel(&film, x, 8)[0] == 0.0;
        let is_red = |x| pixel(&film, x, 8)[0] > 0.0 && pixel(&film, x, 8)[1] == 0.0;
        assert!(is_green(5) && is_red(10), "{json}");
        let counted = render_on(1, &scene, &options()).counters.tests.cutouts;
        assert!(counted > 0);
        // The lamp stands where the camera does: the wall's shadow is hidden behind it, and seen from its right side.
        let aside = edited(json, "/camera/location [6, 0, 6]\n/camera/look [1.3, 0, -2]");
        let whole = edited(aside.clone(), "/scene/shapes/0/alphacutoff 0");
        let [shadowed, whole] =
            [aside, whole].map(|json| image_of(&prepared(&json, folder.path()), 0));
        assert!(!shadowed.same_bits(&whole));
    }
}

/// Through the hole of a shell its inside is met, by rays of any kind: opaque, it shades as much as a whole ball;
/// half transparent, light passes once where it passes a whole one twice.
#[test]
fn behind_a_hole_is_the_far_side() {
    let folder = with_image();
    let lamp = with(point_light(1.0, [0.0, 0.0, 6.0], [1.0; 3]), "falloff", "none");
    let camera = with(pinhole([64, 64], 60.0, 3.0), "location", json!([0, 0, -4]));
    let camera = with(camera, "look", json!([0, 0, -5]));
    let shadow = |ball: Option<Value>| {
        let floor = wall(9.0, -6.0, matte(1.0, [1.0; 3]));
        let shapes: Vec<Value> = [floor].into_iter().chain(ball).collect();
        let mut json = scene(0, &camera, std::slice::from_ref(&lamp), &shapes);
        json["scene"]["ambient"] = 0.into();
        let [wavefront, recursive] = both(&prepared(&json, folder.path()));
        assert!(wavefront.film.same_bits(&recursive.film));
        wavefront.film
    };
    let ball = |opacity: f64| sphere([0.0; 3], 1.0, with(matte(1.0, [1.0; 3]), "opacity", opacity));
    let [open, whole] = [None, Some(ball(0.5))].map(shadow);
    assert_eq!(pixel(&whole, 32, 32)[0], pixel(&open, 32, 32)[0] * 0.25);
    // The hole faces the lamp, or the floor, from which shadow rays come.
    for angle in [-90, 90] {
        let shell = |opacity: f64| {
            with(cut_out(ball(opacity)), "transform", json!({"rotate": [0, angle, 0]}))
        };
        assert!(shadow(Some(shell(1.0))).same_bits(&shadow(Some(ball(1.0)))), "{angle}");
        let once = shadow(Some(shell(0.5)));
        assert_eq!(pixel(&once, 32, 32)[0], pixel(&open, 32, 32)[0] * 0.5, "{angle}");
    }
}

/// Between texels alpha is weighted, and what is there is what has as much as the threshold.
#[test]
fn the_threshold_moves_the_edge() {
    let folder = with_image();
    let share = |cutoff: f64| {
        let shape = with(cut_out(wall(1.0, 0.0, matte(1.0, [0.5; 3]))), "filter", "bilinear");
        let shape = with(with(shape, "wrap", "clamp"), "alphacutoff", cutoff);
        let lamp = point_light(50.0, [0.0, 0.0, 6.0], [1.0; 3]);
        let camera = with(pinhole([64, 4], 20.0, 5.671_281_819_617_709), "fovaxis", "x");
        let json = scene(0, &camera, &[lamp], &[shape]);
        let film = image_of(&prepared(&json, folder.path()), 0);
        (0..64).filter(|&x| pixel(&film, x, 2)[1] > 0.26).count() as f64 / 64.0
    };
    // Alpha falls from 1 to 0 between 3/8 and 5/8.
    for (cutoff, right) in [(0.25, 0.5625), (0.5, 0.5), (0.75, 0.4375), (1.0, 0.375)] {
        let found = share(cutoff);
        assert_near([found; 3], [right; 3], 0.02, &format!("{cutoff}"));
    }
}
