//! Textures, transforms, sides of surfaces and units of length.

use serde_json::{Value, json};
use wavecrest_core::film::Film;
use wavecrest_scene::systems::Options;

use super::Eye;
use crate::support::{
    BACKGROUND, assert_near, difference, folder, image, image_of, matte, pixel, plain, point_light,
    prepare_in, put_image, scene, sphere, wall, with,
};

const EYE: Eye = Eye { size: [21, 21], fov: 40.0, distance: 5.0 };

const RED: [f64; 3] = [1.0, 0.0, 0.0];
const GREEN: [f64; 3] = [0.0, 1.0, 0.0];
const BLUE: [f64; 3] = [0.0, 0.0, 1.0];
/// As eighths of 255 would be rounded in 8 bits; a transfer curve would make it 0.21.
const GREY: [f64; 3] = [128.0 / 255.0; 3];

/// The image of a shape that wears four texels: red and green above, blue and grey below.
fn textured(shape: Value, camera: &Value) -> Film {
    let folder = folder();
    let texels = [RED, GREEN, BLUE, GREY].map(|color| color.map(|value| value as f32));
    put_image(folder.path(), "four.png", [2, 2], |x, y| texels[(2 * y + x) as usize]);
    let shape = with(with(shape, "texture", "four.png"), "filter", "nearest");
    let scene = plain(0, camera, &[with(shape, "material", matte(0.5, [0.3, 0.2, 0.1]))]);
    image_of(&prepare_in(folder.path(), &scene, Options::default()), 0)
}

#[track_caller]
fn check(film: &Film, expected: &[((u32, u32), [f64; 3])]) {
    for &((x, y), color) in expected {
        assert_near(pixel(film, x, y), color, 1e-6, &format!("pixel {x},{y}"));
    }
}

const UP_LEFT: (u32, u32) = (7, 7);
const UP_RIGHT: (u32, u32) = (13, 7);
const DOWN_LEFT: (u32, u32) = (7, 13);
const DOWN_RIGHT: (u32, u32) = (13, 13);

const UPRIGHT: [((u32, u32), [f64; 3]); 4] =
    [(UP_LEFT, RED), (UP_RIGHT, GREEN), (DOWN_LEFT, BLUE), (DOWN_RIGHT, GREY)];

fn square() -> Value {
    json!([[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [1, -1, 0]])
}

#[test]
fn a_picture_on_a_plane_is_upright() {
    check(&textured(json!({"type": "plane", "points": square()}), &EYE.json()), &UPRIGHT);
}

#[test]
fn a_picture_on_a_plane_turns_with_its_points() {
    // The bottom left is now where the top left was: a quarter turn clockwise.
    let points = json!([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]]);
    let film = textured(json!({"type": "plane", "points": points}), &EYE.json());
    let turned = [(UP_LEFT, BLUE), (UP_RIGHT, RED), (DOWN_LEFT, GREY), (DOWN_RIGHT, GREEN)];
    check(&film, &turned);
}

#[test]
fn a_triangle_keeps_the_lower_left_half_of_a_picture() {
    let points = json!([[-1, -1, 0], [-1, 1, 0], [1, -1, 0]]);
    let film = textured(json!({"type": "triangle", "points": points}), &EYE.json());
    let (high, low) = ((6, 8), (12, 14));
    check(&film, &[(high, RED), (DOWN_LEFT, BLUE), (low, GREY), (UP_RIGHT, BACKGROUND)]);
}

#[test]
fn a_mesh_wears_its_picture_by_its_own_coordinates() {
    let mesh = json!({"type": "trimesh", "points": square(), "indices": [[0, 1, 2], [0, 2, 3]],
                      "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]]});
    check(&textured(mesh.clone(), &EYE.json()), &UPRIGHT);
    let mirrored = with(mesh, "uvs", json!([[1, 0], [1, 1], [0, 1], [0, 0]]));
    let swapped = [(UP_LEFT, GREEN), (UP_RIGHT, RED), (DOWN_LEFT, GREY), (DOWN_RIGHT, BLUE)];
    check(&textured(mirrored, &EYE.json()), &swapped);
}

#[test]
fn an_image_repeats_or_clamps_at_its_edge() {
    // Twice across: the left half of the mesh is one picture, the right half the next.
    let mesh = json!({"type": "trimesh", "points": square(), "indices": [[0, 1, 2], [0, 2, 3]],
                      "uvs": [[0, 0], [0, 1], [2, 1], [2, 0]]});
    let row = |film: &Film| [6, 8, 12, 14].map(|x| pixel(film, x, 7));
    assert_eq!(row(&textured(mesh.clone(), &EYE.json())), [RED, GREEN, RED, GREEN]);
    let clamped = textured(with(mesh, "wrap", "clamp"), &EYE.json());
    assert_eq!(row(&clamped), [RED, GREEN, GREEN, GREEN]);
}

#[test]
fn a_ball_shows_the_middle_of_its_picture_to_plus_z() {
    let ball = json!({"type": "sphere", "center": [0, 0, 0], "radius": 1});
    check(&textured(ball.clone(), &EYE.json()), &UPRIGHT);
    // From +x the left edge of the picture is right, behind the ball: u = 0.5 to 1 is seen.
    let from_x = with(EYE.json(), "location", json!([5, 0, 0]));
    let right_half = [(UP_LEFT, GREEN), (UP_RIGHT, GREEN), (DOWN_LEFT, GREY), (DOWN_RIGHT, GREY)];
    check(&textured(ball.clone(), &from_x), &right_half);
    // Turned with the ball: a quarter about y brings that half to the front.
    let turned = with(ball, "transform", json!({"rotate": [0, -90, 0]}));
    check(&textured(turned, &EYE.json()), &right_half);
}

fn disk(normal: [f64; 3], material: Value) -> Value {
    json!({"type": "disk", "center": [0, 0, 0], "normal": normal, "radius": 1, "material": material})
}

#[test]
fn a_picture_fills_the_square_around_a_disk() {
    check(&textured(disk([0.0, 0.0, 1.0], white()), &EYE.json()), &UPRIGHT);
    // One that faces up, seen from above with -z at the top.
    let above = with(with(EYE.json(), "location", json!([0, 5, 0])), "up", json!([0, 0, -1]));
    check(&textured(disk([0.0, 1.0, 0.0], white()), &above), &UPRIGHT);
    let turned = with(disk([0.0, 1.0, 0.0], white()), "transform", json!({"rotate": [90, 0, 0]}));
    check(&textured(turned, &EYE.json()), &UPRIGHT);
    // The corners of the square are not there.
    let film = textured(disk([0.0, 0.0, 1.0], white()), &EYE.json());
    check(&film, &[((5, 5), BACKGROUND), ((15, 15), BACKGROUND), ((11, 5), GREEN)]);
}

#[test]
fn a_disk_is_lit_on_its_front_and_moves_with_its_transform() {
    for (normal, is_front) in [([0.3, -0.2, 1.0], true), ([0.3, -0.2, -1.0], false)] {
        assert_eq!(is_lit(&lit(disk(normal, white()))), is_front);
        let both = with(disk(normal, white()), "sides", "both");
        assert!(is_lit(&lit(both)));
        let inward = with(disk(normal, white()), "transform", json!({"scale": [1, 1, -1]}));
        assert_eq!(is_lit(&lit(inward)), !is_front);
    }
    let moved = json!({"scale": 0.5, "rotate": [0, 90, 0], "translate": [0.25, 0, 0.5]});
    let moved = with(disk([-1.0, 0.0, 0.0], white()), "transform", moved);
    let direct = json!({"type": "disk", "center": [0.25, 0, 0.5], "normal": [0, 0, 1],
                        "radius": 0.5, "material": white()});
    assert!(lit(moved).same_bits(&lit(direct)));
}

/// A triangle without any symmetry, in the plane z = 0, seen from its front.
const CORNERS: [[f64; 3]; 3] = [[-1.0, -0.5, 0.0], [-0.25, 1.0, 0.0], [1.0, -0.75, 0.0]];

fn white() -> Value {
    matte(0.75, [1.0; 3])
}

/// The three flat shapes on the same corners; the quad has one more.
fn flat_shapes(corners: [[f64; 3]; 3]) -> [Value; 3] {
    let [a, b, c] = corners;
    let d: Vec<f64> = (0..3).map(|i| a[i] + c[i] - b[i]).collect();
    [
        json!({"type": "triangle", "points": [a, b, c], "material": white()}),
        json!({"type": "plane", "points": [a, b, c, d], "material": white()}),
        json!({"type": "trimesh", "size": 3, "points": [a, b, c], "material": white(),
               "sides": "front"}),
    ]
}

fn lit(shape: Value) -> Film {
    let light = point_light(30.0, [1.0, 2.0, 6.0], [1.0, 0.5, 0.25]);
    image(&scene(0, &EYE.json(), &[light], &[shape]))
}

/// Whether the middle of the image is lit; panics where it shows no surface.
fn is_lit(film: &Film) -> bool {
    let found = pixel(film, 10, 10);
    assert!(found != BACKGROUND, "there is nothing");
    // White with one light: its ambient part is 0.08 in every channel, and light is red most.
    found[0] > 0.1
}

#[test]
fn the_front_of_a_flat_shape_is_where_its_corners_run_clockwise() {
    let [a, b, c] = CORNERS;
    assert!(flat_shapes([a, b, c]).into_iter().all(|shape| is_lit(&lit(shape))));
    assert!(!flat_shapes([c, b, a]).into_iter().any(|shape| is_lit(&lit(shape))));
}

#[test]
fn a_normal_flips_a_face_or_picks_the_side_it_points_to() {
    let [a, b, c] = CORNERS;
    for front in flat_shapes([a, b, c]).into_iter().take(2) {
        for (normal, expected) in [
            (json!(1), true),
            (json!(-1), false),
            (json!([0, 0, 1]), true),
            (json!([5, 3, -0.5]), false),
        ] {
            let film = lit(with(front.clone(), "normal", normal.clone()));
            assert_eq!(is_lit(&film), expected, "{normal}");
        }
    }
    let back = flat_shapes([c, b, a])[0].clone();
    assert!(is_lit(&lit(with(back, "normal", json!([0, 0, 1])))));
}

#[test]
fn parts_of_a_transform_act_as_scale_then_rotation_then_translation() {
    let parts = json!({"scale": [2, 1, 1], "rotate": [0, 0, 90], "translate": [-0.125, 0.25, -1]});
    let moved = CORNERS.map(|[x, y, z]| [-0.125 - y, 2.0 * x + 0.25, z - 1.0]);
    let matrix = json!([[0, -1, 0, -0.125], [2, 0, 0, 0.25], [0, 0, 1, -1], [0, 0, 0, 1]]);
    for (shape, direct) in flat_shapes(CORNERS).into_iter().zip(flat_shapes(moved)) {
        let expected = lit(direct);
        assert!(is_lit(&expected));
        for transform in [&parts, &matrix] {
            let found = lit(with(shape.clone(), "transform", transform.clone()));
            assert!(found.same_bits(&expected), "{transform}");
        }
    }
}

#[test]
fn a_ball_is_moved_and_scaled_by_its_transform() {
    let moved = with(
        sphere([0.5, 0.0, 0.25], 0.5, white()),
        "transform",
        json!({"scale": 2, "translate": [-1.0, 0.25, 0.5]}),
    );
    assert!(lit(moved).same_bits(&lit(sphere([0.0, 0.25, 1.0], 1.0, white()))));
}

#[test]
fn a_mirrored_shape_keeps_its_front() {
    let mirrored = CORNERS.map(|[x, y, z]| [-x, y, z]);
    let [a, b, c] = mirrored;
    for (shape, direct) in flat_shapes(CORNERS).into_iter().zip(flat_shapes([c, b, a])) {
        let found = lit(with(shape.clone(), "transform", json!({"scale": [-1, 1, 1]})));
        assert!(is_lit(&found), "{}", shape["type"]);
        let expected = lit(direct);
        assert!(difference(&found, &expected) <= 1e-6, "mirrored");
        // Mirrored through the plane that it lies in, its front is behind.
        let inward = lit(with(shape, "transform", json!({"scale": [1, 1, -1]})));
        assert!(!is_lit(&inward));
    }
}

/// A band of four triangles across the view, as a strip, from its clockwise side.
fn strip() -> Value {
    let points: Vec<[f64; 3]> =
        (0..6).map(|i| [f64::from(i / 2) - 1.0, f64::from(i % 2) - 0.5, 0.0]).collect();
    json!({"type": "trimesh", "size": 6, "points": points, "material": white()})
}

/// A pixel within each of the strip's triangles.
fn triangles_lit(film: &Film) -> [bool; 4] {
    [(6, 11), (9, 9), (12, 11), (14, 9)].map(|(x, y)| {
        let found = pixel(film, x, y);
        assert!(found != BACKGROUND, "there is nothing at {x},{y}");
        found[0] > 0.1
    })
}

#[test]
fn a_strip_without_normal_is_lit_on_both_sides_or_faces_one() {
    let lit_before_and_behind = |strip: Value| {
        let turned = with(strip.clone(), "transform", json!({"rotate": [0, 180, 0]}));
        [strip, turned].map(|strip| triangles_lit(&lit(strip)))
    };
    assert_eq!(lit_before_and_behind(strip()), [[true; 4]; 2]);
    let one_sided = with(strip(), "sides", "front");
    assert_eq!(lit_before_and_behind(one_sided), [[true; 4], [false; 4]]);
}

#[test]
fn a_strip_with_normal_keeps_its_winding_but_where_it_is_flipped() {
    let with_normal =
        |normal: [i32; 4]| triangles_lit(&lit(with(strip(), "normal", json!(normal))));
    assert_eq!(with_normal([0, 0, 0, 0]), [true, false, true, false]);
    assert_eq!(with_normal([0, -1, 0, -1]), [true; 4]);
    assert_eq!(with_normal([-1, 0, 0, 0]), [false, false, true, false]);
}

#[test]
fn indices_name_the_corners_clockwise_from_the_front() {
    let points = json!([[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [1, -1, 0]]);
    let mesh = |indices: Value| {
        json!({"type": "trimesh", "points": points, "indices": indices, "material": white(),
               "sides": "front"})
    };
    let film = lit(mesh(json!([[0, 1, 2], [0, 3, 2]])));
    assert!(pixel(&film, 7, 7)[0] > 0.1, "clockwise: lit");
    assert_near(pixel(&film, 13, 13), [0.08; 3], 1e-6, "counter-clockwise: ambient");
    let quad = lit(wall(1.0, 0.0, white()));
    assert!(lit(mesh(json!([[0, 1, 2], [0, 2, 3]]))).same_bits(&quad), "as the plane");
}

/// Something of everything, in units of `s`.
fn everything(s: f64, falloff: &str, intensity: f64) -> Value {
    let p = |x: f64, y: f64, z: f64| json!([x * s, y * s, z * s]);
    let shiny = json!({"ks": 0.4, "kd": 0.6, "specularexponent": 20, "kr": 0.3,
                       "diffusecolor": [0.9, 0.6, 0.2]});
    let camera = json!({
        "type": "thinlens", "width": 40, "height": 30, "fov": 50, "aperture": 0.3 * s,
        "focal": 5.7 * s, "nsamplesx": 2, "nsamplesy": 2, "antialias": 1,
        "location": p(0.4, 1.3, 5.1), "look": p(0.0, 0.1, -0.2)
    });
    let square = json!({"type": "plane", "points":
        [p(-1.1, 4.0, 0.3), p(-1.1, 4.1, 1.9), p(0.7, 4.1, 1.9), p(0.7, 4.0, 0.3)]});
    let lights = [
        json!({"type": "pointlight", "intensity": intensity, "position": p(2.3, 3.1, 2.7),
               "color": [1, 0.9, 0.7], "falloff": falloff}),
        json!({"type": "arealight", "intensity": intensity, "color": [0.5, 0.6, 1],
               "sampling": "jittered", "samples": 2, "shape": square, "falloff": falloff}),
    ];
    let shapes = [
        json!({"type": "plane", "material": shiny, "points":
            [p(-3.0, -1.0, 3.0), p(-3.0, -1.0, -3.0), p(3.0, -1.0, -3.0), p(3.0, -1.0, 3.0)]}),
        json!({"type": "sphere", "center": p(-0.7, -0.3, 0.2), "radius": 0.7 * s,
               "material": shiny}),
        json!({"type": "triangle", "material": shiny,
               "points": [p(0.3, -0.9, -0.7), p(0.9, 1.3, -0.9), p(1.9, -0.8, -0.1)]}),
        json!({"type": "trimesh", "material": shiny, "size": 4,
               "points": [p(0.5, -0.9, 1.1), p(0.6, 0.1, 1.0), p(1.3, -0.8, 1.2), p(1.2, 0.2, 0.7)]}),
        json!({"type": "disk", "center": p(0.8, 0.9, -1.4), "normal": [0.3, 0.1, 1],
               "radius": 0.6 * s, "material": shiny}),
    ];
    scene(3, &camera, &lights, &shapes)
}

#[test]
fn hc08_a_scene_in_units_up_to_2_to_the_16_times_as_long_or_as_short_gives_the_same_bits() {
    for (falloff, power) in [("linear", 1), ("inverse-square", 2), ("none", 0)] {
        let unit = image(&everything(1.0, falloff, 25.0));
        for s in [16, 8, -8, -16].map(|power| 2.0_f64.powi(power)) {
            let scaled = image(&everything(s, falloff, 25.0 * s.powi(power)));
            assert!(scaled.same_bits(&unit), "{falloff}, times {s}");
        }
    }
}
