//! What rays see that hit nothing.

use serde_json::{Value, json};
use wavecrest_scene::systems::SceneOptions;

use crate::support::{
    assert_near, edited, folder, image_of, matte, pixel, prepare_in, scene, wall, with,
};

/// What a camera at the origin sees in a direction, and in a mirror that faces it there.
fn seen(environment: &Value, towards: [f64; 3]) -> [f64; 3] {
    let folder = folder();
    // Eight texels around and four from top to bottom: red by longitude, green by latitude.
    let texel = |x, y| image::Rgb([(x * 30) as u8, (y * 60) as u8, 255]);
    image::RgbImage::from_fn(8, 4, texel).save(folder.path().join("sky.png")).expect("an image");
    let up = if towards[1].abs() > 0.9 { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
    let camera = json!({"type": "pinhole", "width": 1, "height": 1, "fov": 1e-3,
                        "location": [0, 0, 0], "look": towards, "up": up});
    // A mirror behind the camera is not seen, and shapes elsewhere change nothing.
    let shapes = [wall(1.0, 50.0, with(matte(0.0, [0.0; 3]), "kr", 0.5))];
    let scene =
        edited(scene(1, &camera, &[], &shapes), &format!("/scene/environment {environment}"));
    pixel(&image_of(&prepare_in(folder.path(), &scene, SceneOptions::default()), 0), 0, 0)
}

#[test]
fn a_gradient_is_linear_in_the_height_of_the_direction() {
    let sky = json!({"zenith": [1, 0, 0], "horizon": [0, 1, 0], "nadir": [0, 0, 1],
                     "intensity": 2});
    for (towards, expected) in [
        ([0.0, 1.0, 0.0], [2.0, 0.0, 0.0]),
        ([1.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
        ([0.0, -1.0, 0.0], [0.0, 0.0, 2.0]),
        ([0.0, 0.6, -0.8], [1.2, 0.8, 0.0]),
        ([-0.8, -0.6, 0.0], [0.0, 0.8, 1.2]),
    ] {
        assert_near(seen(&sky, towards), expected, 1e-5, &format!("{towards:?}"));
    }
    let leaning = with(sky, "up", json!([3, 4, 0]));
    assert_near(seen(&leaning, [0.6, 0.8, 0.0]), [2.0, 0.0, 0.0], 1e-5, "the zenith leans");
}

#[test]
fn an_image_is_upright_and_not_mirrored_around_its_centre() {
    let sky = |turn: f64| json!({"file": "sky.png", "turn": turn});
    // Longitudes and latitudes of the middles of texels, from the centre of the image at -z.
    let towards = |around: f64, up: f64| {
        let (around, up) = ((around * 45.0).to_radians(), (up * 45.0).to_radians());
        [around.sin() * up.cos(), up.sin(), -around.cos() * up.cos()]
    };
    let texel = |x: f64, y: f64| [x * 30.0 / 255.0, y * 60.0 / 255.0, 1.0];
    for (around, up, x, y) in
        [(-0.5, 0.5, 3.0, 1.0), (0.5, 0.5, 4.0, 1.0), (2.5, -0.5, 6.0, 2.0), (-3.5, 1.5, 0.0, 0.0)]
    {
        let found = seen(&sky(0.0), towards(around, up));
        assert_near(found, texel(x, y), 2e-5, &format!("{around} {up}"));
    }
    // Turned counter-clockwise, as seen from above, what was ahead is to the left.
    assert_near(seen(&sky(45.0), towards(-0.5, 0.5)), texel(4.0, 1.0), 2e-5, "turned");
    assert_near(seen(&sky(0.0), [0.0, 1.0, 1e-4]), texel(3.5, 0.0), 0.5, "at the pole");
}
