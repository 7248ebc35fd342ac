//! Lights, ambient light, shadows and mirrors.

use glam::DVec3;
use serde_json::{Value, json};

use super::{Eye, Lamp, Phong, plus, times};
use crate::support::{
    BACKGROUND, assert_near, image, matte, pixel, point_light, scene, sphere, wall, with,
};

/// The report's "low value", where a scene gives none of its own.
const AMBIENT: f64 = 0.08;

const EYE: Eye = Eye { size: [33, 25], fov: 50.0, distance: 5.0 };
/// In the middle of the image, whose ray is the view axis.
const MIDDLE: (u32, u32) = (16, 12);
/// The middle, two corners, an edge and a place of no account.
const PIXELS: [(u32, u32); 5] = [MIDDLE, (0, 0), (32, 24), (32, 11), (7, 19)];

const MATTE: Phong = Phong { ks: 0.0, kd: 0.8, exponent: 1.0, color: [0.9, 0.5, 0.25] };
const LAMP: Lamp = Lamp {
    position: DVec3::new(1.0, 2.0, 3.0),
    intensity: 20.0,
    color: [1.0, 0.75, 0.5],
    falloff: "linear",
};

/// What a wall in the plane z = 0 shows at a pixel when nothing is in the way.
fn on_wall(x: u32, y: u32, material: Phong, lamps: &[Lamp]) -> [f64; 3] {
    let point = EYE.on_wall(x, y, 0.0);
    let view = (EYE.origin() - point).normalize();
    let ambient = times(material.color, AMBIENT * lamps.len() as f64);
    lamps
        .iter()
        .fold(ambient, |sum, lamp| plus(sum, lamp.reflected(material, point, DVec3::Z, view)))
}

#[track_caller]
fn check_wall(material: Phong, lamps: &[Lamp], tolerance: f64) {
    let lights: Vec<Value> = lamps.iter().map(|lamp| lamp.json()).collect();
    let film = image(&scene(0, &EYE.json(), &lights, &[wall(50.0, 0.0, material.json())]));
    for (x, y) in PIXELS {
        let what = format!("pixel {x},{y}");
        let expected = on_wall(x, y, material, lamps);
        assert_near(pixel(&film, x, y), expected, tolerance, &what);
    }
}

#[test]
fn every_falloff_follows_its_formula() {
    for (falloff, intensity) in [("linear", 20.0), ("inverse-square", 60.0), ("none", 1.0)] {
        check_wall(MATTE, &[Lamp { falloff, intensity, ..LAMP }], 1e-5);
    }
}

#[test]
fn highlights_follow_blinn_and_phong() {
    // The light stands where it is mirrored to the eye within the image.
    let lamp = Lamp { position: DVec3::new(0.5, 0.3, 4.0), ..LAMP };
    for exponent in [0.0, 1.0, 12.5, 40.0] {
        check_wall(Phong { ks: 0.7, kd: 0.3, exponent, ..MATTE }, &[lamp], 1e-5);
    }
}

#[test]
fn lights_add_up() {
    let other = Lamp { position: DVec3::new(-3.0, 0.5, 1.0), color: [0.2, 0.9, 1.0], ..LAMP };
    check_wall(Phong { ks: 0.4, exponent: 8.0, ..MATTE }, &[LAMP, other, LAMP], 1e-5);
}

#[test]
fn a_ball_is_shaded_by_its_own_normals() {
    let material = Phong { ks: 0.5, exponent: 10.0, ..MATTE };
    let ball = sphere([0.0; 3], 1.5, material.json());
    let film = image(&scene(0, &EYE.json(), &[LAMP.json()], &[ball]));
    for (x, y) in [MIDDLE, (20, 9), (16, 6), (11, 14)] {
        let direction = EYE.direction(x, y).normalize();
        let middle = -EYE.origin().dot(direction);
        let root = (middle * middle - (5.0 * 5.0 - 1.5 * 1.5)).sqrt();
        let point = EYE.origin() + direction * (middle - root);
        let normal = point / 1.5;
        let lit = LAMP.reflected(material, point, normal, -direction);
        let faces = normal.dot(LAMP.position - point) > 0.0;
        let expected = plus(times(material.color, AMBIENT), times(lit, f64::from(u8::from(faces))));
        assert_near(pixel(&film, x, y), expected, 1e-5, &format!("pixel {x},{y}"));
    }
}

#[test]
fn ambient_light_is_added_once_for_each_light_whether_it_shines_or_not() {
    let dark = point_light(0.0, [0.0, 0.0, 3.0], [1.0; 3]);
    for ambient in [0.0, AMBIENT, 0.3] {
        for lights in 0..4 {
            let mut scene = scene(
                0,
                &EYE.json(),
                &vec![dark.clone(); lights],
                &[wall(50.0, 0.0, MATTE.json())],
            );
            scene["scene"]["ambient"] = ambient.into();
            let expected = times(MATTE.color, ambient * lights as f64);
            let found = pixel(&image(&scene), MIDDLE.0, MIDDLE.1);
            assert_near(found, expected, 1e-7, &format!("{lights} lights, ambient {ambient}"));
        }
    }
}

#[test]
fn a_point_in_shadow_shows_its_ambient_light_alone() {
    // The ball stands half way between the light and the middle of the wall, out of the view axis.
    let ball = sphere([0.5, 1.0, 1.5], 0.25, MATTE.json());
    let shapes = [wall(50.0, 0.0, MATTE.json()), ball];
    let film = image(&scene(0, &EYE.json(), &[LAMP.json()], &shapes));
    let ambient = times(MATTE.color, AMBIENT);
    assert_near(pixel(&film, MIDDLE.0, MIDDLE.1), ambient, 1e-7, "in the shadow");
    let (x, y) = (30, 23);
    assert_near(pixel(&film, x, y), on_wall(x, y, MATTE, &[LAMP]), 1e-5, "beside it");
}

/// Of a back, even where it would mirror; where a shape is lit from both sides it is as its front; and what is behind the
/// light takes none away.
#[test]
fn a_back_is_ambient_and_nothing_behind_a_light_shades() {
    let wall = |material| wall(50.0, 0.0, material);
    let away = |wall| with(wall, "normal", -1);
    let beyond = sphere([2.0, 4.0, 6.0], 0.5, MATTE.json());
    let bright = with(crate::support::wall(50.0, 9.0, MATTE.json()), "sides", "both");
    let two_sided = with(away(wall(MATTE.json())), "sides", "both");
    for (what, bounces, shapes, is_lit) in [
        ("behind the light", 0, vec![wall(MATTE.json()), beyond], true),
        ("a back", 3, vec![away(wall(with(MATTE.json(), "kr", 0.5))), bright], false),
        ("both sides", 0, vec![two_sided], true),
    ] {
        let film = image(&scene(bounces, &EYE.json(), &[LAMP.json()], &shapes));
        for (x, y) in PIXELS {
            let (lit, ambient) = (on_wall(x, y, MATTE, &[LAMP]), times(MATTE.color, AMBIENT));
            let (expected, tolerance) = if is_lit { (lit, 1e-5) } else { (ambient, 1e-7) };
            assert_near(pixel(&film, x, y), expected, tolerance, what);
        }
    }
}

#[test]
fn the_background_is_for_primary_rays_alone() {
    let black = with(matte(0.0, [0.0; 3]), "kr", 1.0);
    let film = image(&scene(4, &EYE.json(), &[LAMP.json()], &[wall(1.0, 0.0, black)]));
    assert_near(pixel(&film, MIDDLE.0, MIDDLE.1), [0.0; 3], 0.0, "mirrored into the void");
    assert_near(pixel(&film, 0, 0), BACKGROUND, 0.0, "beside the mirror");
}

#[test]
fn a_mirror_adds_kr_times_what_it_shows_to_its_own_colour() {
    let (x, y) = MIDDLE;
    // The view axis goes back on itself and meets the far wall at (0, 0, 10), which faces it.
    let far = Phong { color: [0.1, 0.6, 0.9], ..MATTE };
    let facing = with(wall(50.0, 10.0, far.json()), "normal", json!([0, 0, -1]));
    let seen = LAMP.reflected(far, DVec3::Z * 10.0, -DVec3::Z, -DVec3::Z);
    let seen = plus(seen, times(far.color, AMBIENT));
    for kr in [0.0, 0.25, 1.0] {
        let mirror = wall(50.0, 0.0, with(MATTE.json(), "kr", kr));
        let film = image(&scene(1, &EYE.json(), &[LAMP.json()], &[mirror, facing.clone()]));
        let expected = plus(on_wall(x, y, MATTE, &[LAMP]), times(seen, kr));
        assert_near(pixel(&film, x, y), expected, 1e-5, &format!("kr {kr}"));
    }
}

#[test]
fn a_hall_of_mirrors_shows_a_geometric_series() {
    let (front, back) = ([0.5, 0.2, 0.1], [0.1, 0.3, 0.4]);
    let mirror = |color| with(matte(0.0, color), "kr", 0.9);
    let shapes = [
        wall(1e4, 0.0, mirror(front)),
        with(wall(1e4, 7.0, mirror(back)), "normal", json!([0, 0, -1])),
    ];
    // A light of no strength: each mirror then shows its colour as ambient light, and no more.
    let dark = point_light(0.0, [0.0, 0.0, 3.0], [1.0; 3]);
    for bounces in (0..=50).chain([1000]) {
        let mut scene = scene(bounces, &EYE.json(), std::slice::from_ref(&dark), &shapes);
        scene["scene"]["ambient"] = 1.0.into();
        let film = image(&scene);
        let term =
            |k: u32| times(if k.is_multiple_of(2) { front } else { back }, 0.9_f64.powi(k as i32));
        let expected = (0..=bounces).map(term).fold([0.0; 3], plus);
        for (x, y) in PIXELS {
            assert_near(pixel(&film, x, y), expected, 1e-4, &format!("{bounces} bounces"));
        }
    }
}

#[test]
fn a_mirror_shows_the_sky_and_the_ground_where_nothing_else_is() {
    let (sky, ground) = ([0.2, 0.5, 0.9], [0.4, 0.2, 0.1]);
    // Black apart from what it mirrors, so that the sky is there for the mirror alone.
    let black = Phong { ks: 0.0, kd: 0.0, exponent: 1.0, color: [0.0; 3] };
    let mut scene = scene(1, &EYE.json(), &[], &[wall(50.0, 0.0, with(black.json(), "kr", 0.75))]);
    scene["scene"]["ambient"] = json!({"sky": sky, "ground": ground, "up": [0, 0, 2]});
    let film = image(&scene);
    for (x, y) in PIXELS {
        // Mirrored in z = 0, the way up is that of the view in reverse.
        let height = -EYE.direction(x, y).normalize().z;
        let share = (1.0 + height) / 2.0;
        let expected = times(plus(times(sky, share), times(ground, 1.0 - share)), 0.75);
        assert_near(pixel(&film, x, y), expected, 1e-6, &format!("pixel {x},{y}"));
    }
}
