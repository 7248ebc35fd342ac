//! What goes through surfaces: Snell's law, Fresnel's equations, Beer's law, and opacity.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use serde_json::{Value, json};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::probe::{self, PathRecord};
use wavecrest_scene::systems::SceneOptions;

use crate::support::{
    assert_near, folder, image, image_of, matte, merged, pinhole, pixel, places, point_light,
    prepare, prepare_in, scene, sphere, wall, with,
};

/// Nothing but what goes through it is seen of such a surface.
pub(super) fn clear(more: &Value) -> Value {
    merged(matte(0.0, [0.0; 3]), more)
}

fn shining_wall() -> Value {
    wall(5.0, -10.0, clear(&json!({"emission": [1, 0.5, 0.25]})))
}

/// Two parallel square faces, 2 apart, whose fronts are outside, turned by `angle` about the y axis.
fn slab(half: f64, angle: f64, material: &Value) -> [Value; 2] {
    let turn = DQuat::from_rotation_y(angle);
    [1.0, -1.0].map(|z: f64| {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let corner = |[x, y]: [f64; 2]| (turn * DVec3::new(half * x, half * y, z)).to_array();
        let normal = (turn * DVec3::Z * z).to_array();
        json!({"type": "plane", "points": corners.map(corner), "normal": normal,
               "material": material})
    })
}

/// The only pixel's path, along the z axis from z = 9.
fn path(bounces: u32, shapes: &[Value]) -> PathRecord {
    let prepared = seen(bounces, &[], shapes);
    let record = probe::pixel(&prepared, [0, 0], None, 0, &|_| false);
    image_of(&prepared, 0);
    record.paths.into_iter().next().expect("a path")
}

fn seen(bounces: u32, lights: &[Value], shapes: &[Value]) -> PreparedScene {
    prepare(&scene(bounces, &pinhole([1, 1], 1e-3, 9.0), lights, shapes))
}

/// Fresnel's reflectances from the angles, averaged.
pub(super) fn fresnel(angle: f64, ior: f64) -> f64 {
    if angle == 0.0 {
        return ((ior - 1.0) / (ior + 1.0)).powi(2);
    }
    let beyond = (angle.sin() / ior).asin();
    let across = (angle - beyond).sin() / (angle + beyond).sin();
    let along = (angle - beyond).tan() / (angle + beyond).tan();
    (across * across + along * along) / 2.0
}

pub(super) fn close(found: impl Into<f64>, expected: f64, what: &str) {
    let found = found.into();
    assert!(
        (found - expected).abs() < 2e-6 * expected.abs().max(1.0),
        "{what}: {found} {expected}"
    );
}

#[test]
fn a_slab_moves_a_ray_by_snells_law_and_mirrors_by_fresnels() {
    for ior in [1.33, 1.5, 2.4] {
        for angle in [0.0, 0.05, 0.125, 0.2].map(|turns: f64| turns * TAU) {
            let glass = clear(&json!({"kt": 1, "ior": ior}));
            let [front, back] = slab(90.0, angle, &glass);
            let path = path(2, &[front, back, shining_wall()]);
            let mirrored = fresnel(angle, ior);
            let what = format!("ior {ior}, angle {angle}");
            close(path.radiance.x, (1.0 - mirrored).powi(2), &what);
            close(path.radiance.z, 0.25 * (1.0 - mirrored).powi(2), &what);
            let end = path.bounces.iter().filter_map(|bounce| bounce.met.as_ref());
            let end = end.max_by(|a, b| b.point.z.total_cmp(&a.point.z)).expect("the wall");
            let beyond = (angle.sin() / ior).asin();
            let aside = 2.0 * (angle - beyond).sin() / beyond.cos();
            assert!((end.point.x.abs() - aside).abs() < 1e-5, "{what}: {} {aside}", end.point.x);
        }
    }
}

#[test]
fn light_is_absorbed_by_beers_law() {
    let glass = json!({"kt": 1, "ior": 1.5, "attenuationcolor": [0.5, 0.1, 1],
                       "attenuationdistance": 3});
    for angle in [0.0, 0.5_f64] {
        let [front, back] = slab(90.0, angle, &clear(&glass));
        let path = path(2, &[front, back, shining_wall()]);
        let way = 2.0 / (angle.sin() / 1.5).asin().cos();
        let passed = (1.0 - fresnel(angle, 1.5)).powi(2);
        close(path.radiance.x, passed * 0.5_f64.powf(way / 3.0), "red");
        close(path.radiance.y, passed * 0.5 * 0.1_f64.powf(way / 3.0), "green");
        close(path.radiance.z, passed * 0.25, "blue");
    }
}

#[test]
fn a_thin_sheet_bends_nothing_and_mirrors_at_both_sides() {
    let angle = 0.7_f64;
    let [sheet, _] = slab(90.0, angle, &clear(&json!({"kt": 0.8, "ior": 1.5, "thin": true})));
    let path = path(1, &[sheet, shining_wall()]);
    let once = fresnel(angle, 1.5);
    close(path.radiance.x, 0.8 * (1.0 - 2.0 * once / (1.0 + once)), "red");
    let straight =
        path.bounces.iter().any(|b| b.met.as_ref().is_some_and(|met| met.point.z < -9.0));
    assert!(straight && path.bounces.last().expect("the wall").direction.x.abs() < 1e-6);
}

/// A ray that passes the centre of a ball at a distance b is turned by twice the difference of its
/// angles, and so meets the axis through the centre at b / sin of that; near the axis at n R / (2 (n - 1)).
#[test]
fn a_ball_lens_has_its_focus() {
    let (ior, radius) = (1.5, 1.0);
    for off in [0.01, 0.3, 0.9] {
        let ball = sphere([off, 0.0, 0.0], radius, clear(&json!({"kt": 1, "ior": ior})));
        let far = wall(50.0, -10.0, clear(&json!({"emission": [1, 1, 1]})));
        let path = path(2, &[ball, far]);
        let out = path
            .bounces
            .iter()
            .rev()
            .find(|b| b.met.as_ref().is_some_and(|met| met.point.z < -9.0));
        let out = out.expect("it reaches the wall").direction.as_dvec3();
        let (before, within) = ((off / radius).asin(), (off / radius / ior).asin());
        let turned = 2.0 * (before - within);
        let found = out.x.atan2(-out.z);
        assert!((found - turned).abs() < 2e-6, "{off}: {found} {turned}");
        if off < 0.1 {
            let focus = off / found.sin();
            assert!((focus - ior * radius / (2.0 * (ior - 1.0))).abs() < 1e-3, "{focus}");
        }
    }
}

/// From within, light beyond the critical angle is mirrored whole.
#[test]
fn nothing_leaves_beyond_the_critical_angle() {
    let glass = clear(&json!({"kt": 1, "ior": 1.5}));
    for (angle, leaves) in [(0.70, true), (0.72, true), (0.74, false), (0.76, false)] {
        let [face, _] = slab(90.0, angle, &glass);
        // Its front is beyond: the eye is inside.
        let face = with(face, "normal", (DQuat::from_rotation_y(angle) * DVec3::NEG_Z).to_array());
        let path = path(1, &[face, shining_wall()]);
        assert_eq!(path.radiance.x > 0.0, leaves, "{angle}");
    }
}

#[test]
fn a_ball_without_refraction_is_not_there() {
    let camera = || pinhole([24, 16], 40.0, 6.0);
    let ball = sphere([0.3, 0.1, 1.0], 1.0, clear(&json!({"kt": 1, "ior": 1})));
    let floor = json!({"type": "plane", "points": [[-9, -1, 9], [9, -1, 9], [9, -1, -9], [-9, -1, -9]],
                       "material": {"ks": 0.3, "kd": 0.7, "specularexponent": 20,
                                    "diffusecolor": [0.8, 0.6, 0.4]}});
    let light = point_light(90.0, [2.0, 4.0, 3.0], [1.0; 3]);
    let of = |shapes: &[Value]| image(&scene(4, &camera(), std::slice::from_ref(&light), shapes));
    let (with, without) = (of(&[floor.clone(), ball]), of(&[floor]));
    for (x, y) in places(24, 16) {
        assert_near(pixel(&with, x, y), pixel(&without, x, y), 1e-5, &format!("{x} {y}"));
    }
}

#[test]
fn thirty_panes_pass_their_shares() {
    let pane = |i: u32| wall(50.0, 3.0 - f64::from(i) * 0.01, clear(&json!({"opacity": 0.1})));
    let mut shapes: Vec<Value> = (0..30).map(pane).collect();
    shapes.push(shining_wall());
    for bounces in [0, 5] {
        close(path(bounces, &shapes).radiance.x, 0.9_f64.powi(30), "straight on is no bounce");
    }
    // Edge on, a pane has no width.
    let edge = json!({"type": "plane", "points": [[-1, 0, 5], [1, 0, 5], [1, 0, -5], [-1, 0, -5]],
                      "sides": "both", "material": clear(&json!({"opacity": 0.5}))});
    close(path(0, &[edge, shining_wall()]).radiance.x, 1.0, "edge on");
}

/// A shadow ray meets each surface once, with its angle to the normal, and its way inside.
#[test]
fn shadow_rays_lose_what_surfaces_keep() {
    let floor = wall(50.0, -3.0, matte(1.0, [1.0; 3]));
    let light = point_light(1000.0, [0.0, 0.0, 2.0], [1.0; 3]);
    let lit = |shapes: &[Value]| {
        let mut all = vec![floor.clone()];
        all.extend_from_slice(shapes);
        // From beside what the light passes.
        let camera = json!({"type": "pinhole", "width": 1, "height": 1, "fov": 1e-3,
                            "location": [60, 0, -2.5], "look": [0, 0, -3]});
        pixel(&image(&scene(4, &camera, std::slice::from_ref(&light), &all)), 0, 0)
    };
    let free = lit(&[]);
    assert!(free[0] > 0.1);
    let share = |shapes: &[Value]| {
        let found = lit(shapes);
        [0, 1, 2].map(|k| (found[k] - 0.08) / (free[k] - 0.08))
    };
    let thin = |z: f64, material: &Value| wall(20.0, z, material.clone());
    let pane = clear(&json!({"opacity": 0.25}));
    let two = share(&[thin(0.0, &pane), thin(1.0, &pane)]);
    close(two[0], 0.75 * 0.75, "two panes");
    let glass = clear(&json!({"kt": 1, "ior": 1.5, "transmissioncolor": [1, 0.5, 1],
                              "attenuationcolor": [0.5, 1, 1], "attenuationdistance": 4}));
    let [front, back] = slab(4.0, 0.3, &glass);
    let passed = share(&[front, back]);
    let once = 1.0 - fresnel(0.3, 1.5);
    let way = 2.0 / 0.3_f64.cos();
    close(passed[0], once * once * 0.5_f64.powf(way / 4.0), "absorbed");
    close(passed[1], once * once * 0.25, "coloured");
}

/// The alpha of a texture, and a map of either channel, multiply the opacity.
#[test]
fn images_give_opacity() {
    let folder = folder();
    let texel = |_, _| image::Rgba([51, 255, 255, 102]);
    let saved = image::RgbaImage::from_fn(2, 2, texel).save(folder.path().join("t.png"));
    saved.expect("an image");
    let pane = |key: &str, value: Value| {
        let pane = wall(20.0, 0.0, clear(&json!({"opacity": 0.5})));
        with(with(pane, "texture", "t.png"), key, value)
    };
    for (pane, opacity) in [
        (pane("alpha", json!("blend")), 0.5 * 0.4),
        (pane("opacitymap", json!({"file": "t.png"})), 0.5 * 0.2),
        (pane("opacitymap", json!({"file": "t.png", "channels": "alpha"})), 0.5 * 0.4),
    ] {
        let scene = scene(0, &pinhole([1, 1], 1e-3, 9.0), &[], &[pane, shining_wall()]);
        let prepared = prepare_in(folder.path(), &scene, SceneOptions::default());
        let found = pixel(&image_of(&prepared, 0), 0, 0);
        close(found[0], 1.0 - opacity, "red");
    }
}
