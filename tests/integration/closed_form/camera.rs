//! Silhouettes, angles of view and lenses.

use std::f64::consts::PI;

use glam::DVec3;
use serde_json::{Value, json};
use wavecrest_core::film::Film;

use super::Eye;
use crate::support::{
    self, BACKGROUND, assert_near, edited, image, matte, pinhole, pixel, places, plain,
    point_light, scene, sphere, wall, with,
};

/// The image of shapes that show their diffuse colour and nothing else.
fn shown(camera: &Value, shapes: &[Value]) -> Film {
    image(&plain(0, camera, shapes))
}

/// The same before black.
fn before_black(camera: &Value, shapes: &[Value]) -> Film {
    image(&edited(plain(0, camera, shapes), "/scene/backgroundcolor [0, 0, 0]"))
}

fn is_background(film: &Film, x: u32, y: u32) -> bool {
    pixel(film, x, y) == BACKGROUND
}

fn covered(film: &Film) -> usize {
    film.pixels().iter().filter(|p| p.map(f64::from) != BACKGROUND).count()
}

#[test]
fn the_edge_of_a_ball_is_where_rays_touch_it() {
    let eye = Eye { size: [160, 120], fov: 60.0, distance: 5.0 };
    let (center, radius) = (DVec3::new(1.1, -0.7, -0.5), 1.3);
    let ball = sphere(center.to_array(), radius, matte(1.0, [1.0; 3]));
    let film = shown(&eye.json(), &[ball]);
    let to_center = center - eye.origin();
    let mut near_edge = 0;
    for (x, y) in places(160, 120) {
        let direction = eye.direction(x, y).normalize();
        let distance = to_center.cross(direction).length();
        // A thousandth of the ball is a twentieth of a pixel.
        if (distance - radius).abs() < 1e-3 {
            near_edge += 1;
            continue;
        }
        assert_eq!(!is_background(&film, x, y), distance < radius, "pixel {x},{y}");
    }
    assert!(near_edge < 40, "{near_edge}");
}

/// Checks that the angle spans one side of the image exactly: a wall that ends a hundredth of a
/// pixel beyond the centres of the outermost pixels covers them, and one that ends before does not.
fn check_fov(size: [u32; 2], axis: Option<&str>, side: usize) {
    let (fov, distance) = (50.0_f64, 5.0);
    let half_image = distance * (fov / 2.0).to_radians().tan();
    let pixel = 2.0 * half_image / f64::from(size[side]);
    let outermost = half_image - pixel / 2.0;
    let camera = Eye { size, fov, distance }.json();
    let camera = axis.map_or(camera.clone(), |axis| with(camera, "fovaxis", axis));
    let middle = size.map(|length| length / 2);
    let last = size[side] - 1;
    let at = |i: u32| if side == 0 { (i, middle[1]) } else { (middle[0], i) };
    for (beyond, covers) in [(0.01, true), (-0.01, false)] {
        let wall = wall(outermost + beyond * pixel, 0.0, matte(1.0, [1.0; 3]));
        let film = shown(&camera, &[wall]);
        for (i, expected) in [(0, covers), (last, covers), (1, true), (last - 1, true)] {
            let (x, y) = at(i);
            let what = format!("{size:?} {axis:?}, {beyond}: pixel {x},{y}");
            assert_eq!(!is_background(&film, x, y), expected, "{what}");
        }
    }
}

#[test]
fn the_angle_of_view_spans_the_side_that_it_names() {
    check_fov([60, 40], None, 1);
    check_fov([40, 60], None, 0);
    for size in [[60, 40], [40, 60], [50, 50]] {
        check_fov(size, Some("x"), 0);
        check_fov(size, Some("y"), 1);
        let wide = size[0] > size[1];
        check_fov(size, Some("smaller"), usize::from(wide));
        check_fov(size, Some("larger"), usize::from(!wide));
    }
}

#[test]
fn the_image_is_upright_and_unmirrored_or_as_up_turns_it() {
    let eye = Eye { size: [30, 30], fov: 40.0, distance: 5.0 }.json();
    let ball = |x, y, color| sphere([x, y, 0.0], 0.5, matte(1.0, color));
    let shapes = [ball(0.9, 0.0, [1.0, 0.0, 0.0]), ball(0.0, 0.9, [0.0, 1.0, 0.0])];
    // Where +x and +y are.
    for (up, [x, y]) in [([0, 1, 0], [(22, 15), (15, 7)]), ([2, 0, 0], [(15, 7), (7, 15)])] {
        let film = shown(&with(eye.clone(), "up", json!(up)), &shapes);
        assert_near(pixel(&film, x.0, x.1), [1.0, 0.0, 0.0], 1e-6, "+x");
        assert_near(pixel(&film, y.0, y.1), [0.0, 1.0, 0.0], 1e-6, "+y");
        let is_free = |(x, y): (u32, u32)| is_background(&film, 29 - x, 29 - y);
        assert!(is_free(x) && is_free(y), "{up:?}");
    }
}

/// Angles and radii of points on the lens, where not their number is at stake.
const SAMPLES: u32 = 8;

fn thin_lens(eye: Eye, aperture: f64, focal: f64, sampling: &str) -> Value {
    let lens = crate::support::thin_lens(eye.json(), aperture, focal, [SAMPLES; 2]);
    with(lens, "sampling", sampling)
}

/// A white wall on the left half of the view, at this depth before the eye.
fn left_half(eye: Eye, depth: f64) -> Value {
    let z = eye.distance - depth;
    let points = [[-1e3, -1e3, z], [-1e3, 1e3, z], [0.0, 1e3, z], [0.0, -1e3, z]];
    json!({"type": "plane", "points": points, "material": matte(1.0, [1.0; 3])})
}

/// The share of a unit disk beyond the line at `distance` from its centre.
fn beyond(distance: f64) -> f64 {
    let q = distance.clamp(-1.0, 1.0);
    (q.acos() - q * (1.0 - q * q).sqrt()) / PI
}

/// An edge at depth z before a lens of aperture A focused at f is blurred over a circle of
/// confusion of diameter A |z - f| / z on the plane in focus: a pixel is lit as far as that circle,
/// about its place, lies on the wall.
#[test]
fn an_edge_out_of_focus_is_blurred_over_the_circle_of_confusion() {
    for (aperture, focal, depth) in [(2.0, 20.0, 30.0), (2.0, 20.0, 12.0), (0.5, 8.0, 20.0)] {
        for sampling in ["random", "jittered"] {
            check_blur(aperture, focal, depth, sampling);
        }
    }
}

fn check_blur(aperture: f64, focal: f64, depth: f64, sampling: &str) {
    const SIDE: u32 = 64;
    let eye = Eye { size: [64, 1], fov: 0.25, distance: 30.0 };
    let camera = thin_lens(eye, aperture, focal, sampling);
    let camera = with(with(camera, "nsamplesx", SIDE), "nsamplesy", SIDE);
    let film = before_black(&camera, &[left_half(eye, depth)]);
    let confusion = aperture * (depth - focal).abs() / depth;
    let share = |x| beyond(eye.direction(x, 0).x * focal / (confusion / 2.0));
    let n = f64::from(SIDE * SIDE);
    for x in 0..64 {
        let (found, expected) = (pixel(&film, x, 0)[0], share(x));
        let deviation = match sampling {
            // Of a share of independent points.
            "random" => (expected * (1.0 - expected) / n).sqrt(),
            // Only the cells that the edge cuts are uncertain, about twice the root of all.
            _ => (2.0 * n.sqrt() / 4.0).sqrt() / n,
        };
        let what = format!("{sampling}, A {aperture}, f {focal}, z {depth}, pixel {x}");
        assert!((found - expected).abs() < 5.0 * deviation + 1e-6, "{what}: {found}, {expected}");
    }
    let between = (0..64).filter(|&x| (0.1..0.9).contains(&share(x))).count();
    assert!(between >= 4, "the blur is to be seen: {between} pixels");
}

#[test]
fn what_lies_in_the_plane_in_focus_stays_sharp_out_to_the_corners() {
    // The wider the view, the further a sphere about the eye would be from the plane.
    let eye = Eye { size: [40, 40], fov: 90.0, distance: 10.0 };
    let tile = wall(6.3, 0.0, matte(1.0, [0.8, 0.6, 0.4]));
    let sharp = shown(&eye.json(), std::slice::from_ref(&tile));
    let lens = thin_lens(eye, 2.0, 10.0, "jittered");
    let found = shown(&lens, std::slice::from_ref(&tile));
    for (x, y) in places(40, 40) {
        assert_near(pixel(&found, x, y), pixel(&sharp, x, y), 1e-6, &format!("pixel {x},{y}"));
    }
    // The same tile out of focus is not the same.
    let blurred = shown(&thin_lens(eye, 2.0, 5.0, "jittered"), &[tile]);
    assert!(!blurred.same_bits(&found) && covered(&blurred) > covered(&sharp) + 40);
}

#[test]
fn aperture_0_is_a_pinhole_to_the_last_bit() {
    let eye = Eye { size: [31, 23], fov: 60.0, distance: 5.0 };
    let shapes = [
        sphere([0.3, 0.2, 0.5], 0.9, matte(0.8, [0.9, 0.4, 0.1])),
        wall(3.0, -1.0, matte(0.7, [0.2, 0.5, 0.8])),
    ];
    let light = point_light(30.0, [2.0, 3.0, 4.0], [1.0, 0.9, 0.8]);
    let of = |camera: &Value| image(&scene(0, camera, std::slice::from_ref(&light), &shapes));
    let pinhole = of(&eye.json());
    for sampling in ["random", "jittered"] {
        assert!(of(&thin_lens(eye, 0.0, 3.0, sampling)).same_bits(&pinhole), "{sampling}");
    }
    assert!(!of(&thin_lens(eye, 0.1, 3.0, "jittered")).same_bits(&pinhole), "a lens does differ");
    let antialiased = |camera| of(&with(camera, "antialias", 3));
    let lens = antialiased(thin_lens(eye, 0.0, 3.0, "jittered"));
    assert!(lens.same_bits(&antialiased(eye.json())), "with antialiasing");
}

#[test]
fn antialiasing_gives_an_edge_pixel_its_covered_share() {
    let eye = Eye { size: [9, 9], fov: 30.0, distance: 5.0 };
    // The edge at x = 0 cuts the middle column in halves.
    let camera = with(eye.json(), "antialias", 16);
    let film = before_black(&camera, &[left_half(eye, 5.0)]);
    for (x, expected) in [(3, 1.0), (4, 0.5), (5, 0.0)] {
        // Of 16 columns of cells none is cut: the edge runs between two of them.
        assert_near(pixel(&film, x, 4), [expected; 3], 1e-6, &format!("column {x}"));
    }
}

/// Sums of a pixel are in double precision: a quarter of a million rays through a lens add no error of their own.
#[test]
fn hc55_the_mean_of_many_rays_is_exact() {
    let glowing = with(matte(0.0, [0.0; 3]), "emission", json!([0.7, 0.1, 0.3]));
    let camera = support::thin_lens(pinhole([1, 1], 1.0, 5.0), 0.1, 5.0, [512, 512]);
    let film = image(&scene(0, &camera, &[], &[wall(50.0, 0.0, glowing)]));
    assert_near(pixel(&film, 0, 0), [0.7, 0.1, 0.3], 1e-7, "the mean");
}
