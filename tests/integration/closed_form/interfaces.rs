//! Where surfaces touch, coincide, overlap or nest: each is an interface between two media, none is skipped,
//! and neither the order of shapes in the file nor the instruction level counts.

use serde_json::{Value, json};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::math::simd::Level;
use wavecrest_core::probe::{self, PathRecord};
use wavecrest_scene::systems::SceneOptions;

use super::transparency::{clear, close, fresnel};
use crate::support::{
    image_of, matte, pinhole, pixel, point_light, prepare, prepare_in, scene, sphere, wall, with,
};

fn glass(ior: f64) -> Value {
    clear(&json!({"kt": 1, "ior": ior}))
}

/// Of which a unit leaves this much of each channel.
const LEFT: [f64; 3] = [0.5, 0.6, 0.7];

fn jelly(more: &Value) -> Value {
    with(with(clear(more), "attenuationcolor", json!(LEFT)), "attenuationdistance", 1)
}

/// The faces of a block, by the corners of [`corners`], counter-clockwise from outside.
const FACES: [[usize; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/// The corners of a block across the z axis, as wide as twice `half`.
fn corners(half: f64, [low, high]: [f64; 2]) -> [[f64; 3]; 8] {
    let sides = [[-half, half], [-half, half], [low, high]];
    [0, 1, 2, 3, 4, 5, 6, 7].map(|i: usize| [0, 1, 2].map(|axis| sides[axis][i >> axis & 1]))
}

/// A closed block.
fn block(half: f64, ends: [f64; 2], material: &Value) -> Value {
    let halves = FACES.map(|[a, b, c, d]| [[a, c, b], [a, d, c]]).concat();
    let corners = corners(half, ends);
    json!({"type": "trimesh", "points": corners, "indices": halves, "material": material})
}

/// The same block of six separate faces.
fn faces(half: f64, ends: [f64; 2], material: &Value) -> [Value; 6] {
    let corners = corners(half, ends);
    FACES.map(|[a, b, c, d]| {
        let points = [a, d, c, b].map(|i| corners[i]);
        json!({"type": "plane", "points": points, "material": material})
    })
}

fn shining(z: f64) -> Value {
    wall(60.0, z, clear(&json!({"emission": [1, 1, 1]})))
}

/// A camera of one pixel that looks at the origin at this angle to the z axis, from 9 away.
fn at_angle(angle: f64) -> Value {
    let [x, z] = [angle.sin() * 9.0, angle.cos() * 9.0];
    json!({"type": "pinhole", "width": 1, "height": 1, "fov": 1e-3, "location": [x, 0.01, z],
           "look": [0, 0.01, 0]})
}

/// The path of the only pixel, which is the same in both tracers, at all levels, and for shapes in any order
/// of the file.
fn path(bounces: u32, camera: &Value, shapes: &[Value]) -> PathRecord {
    let mut found: Option<PathRecord> = None;
    for turn in 0..2 * shapes.len() {
        let mut shapes = shapes.to_vec();
        shapes.rotate_left(turn / 2);
        if turn % 2 == 1 {
            shapes.reverse();
        }
        let mut prepared = prepare(&scene(bounces, camera, &[], &shapes));
        for level in Level::available() {
            prepared.accel.level = level.token().expect("it is available");
            let mut record = probe::pixel(&prepared, [0, 0], None, 0, &|_| false);
            let shown = image_of(&prepared, 0).pixels()[0];
            assert_eq!(shown, record.paths[0].radiance.to_array(), "both tracers agree");
            let path = record.paths.remove(0);
            let known = found.get_or_insert_with(|| path.clone());
            assert_eq!(path.radiance, known.radiance, "{turn} {level:?}");
        }
    }
    found.expect("a path")
}

fn straight(bounces: u32, shapes: &[Value]) -> PathRecord {
    path(bounces, &at_angle(0.0), shapes)
}

#[test]
fn what_lies_in_the_plane_of_a_surface_is_seen() {
    let wall_of = |color: [f64; 3], z| wall(9.0, z, clear(&json!({"emission": color})));
    let film = wall(4.0, 0.0, clear(&json!({"opacity": 0.5, "emission": [0, 1, 0]})));
    let found = straight(0, &[wall_of([1.0, 0.0, 0.0], 0.0), film.clone()]);
    assert_eq!(found.radiance.to_array(), [0.5, 0.5, 0.0], "a film on a wall");
    let found = straight(0, &[film.clone(), film, wall_of([1.0, 0.0, 0.0], -1.0)]);
    assert_eq!(found.radiance.to_array(), [0.25, 0.75, 0.0], "two films in one plane");
    for angle in [0.0, 0.5, 1.0_f64] {
        let table = shining(0.0);
        for table in [table, block(40.0, [-1.0, 0.0], &clear(&json!({"emission": [1, 1, 1]})))] {
            let block = block(20.0, [0.0, 1.0], &glass(1.5));
            let found = path(1, &at_angle(angle), &[block, table]);
            close(found.radiance.x, 1.0 - fresnel(angle, 1.5), "glass on a table");
        }
    }
}

/// Panes of one index that touch are one pane, also where light would leave none of them, and of any number.
#[test]
fn touching_panes_are_one() {
    for angle in [0.0, 0.5, 1.1_f64] {
        for count in [1, 2, 30] {
            let pane = |i: u32| {
                let z = f64::from(i) / f64::from(count);
                block(40.0, [z - 1.0, z - 1.0 + 1.0 / f64::from(count)], &glass(1.5))
            };
            let mut shapes = vec![shining(-3.0)];
            shapes.extend((0..count).map(pane));
            if count > 2 {
                // As they come, and from behind: more orders take long.
                shapes.truncate(31);
                for _ in 0..2 {
                    shapes.reverse();
                    let prepared = prepare(&scene(2, &at_angle(angle), &[], &shapes));
                    let once = 1.0 - fresnel(angle, 1.5);
                    close(pixel(&image_of(&prepared, 0), 0, 0)[0], once * once, "thirty panes");
                }
                continue;
            }
            let found = path(2, &at_angle(angle), &shapes);
            close(found.radiance.x, (1.0 - fresnel(angle, 1.5)).powi(2), "panes");
        }
    }
}

#[test]
fn light_is_absorbed_across_touching_solids() {
    for ior in [1.0, 1.5] {
        let jelly = jelly(&json!({"kt": 1, "ior": ior}));
        let blocks = [block(9.0, [0.0, 1.0], &jelly), block(9.0, [-1.0, 0.0], &jelly)];
        let found = straight(2, &[&blocks[..], &[shining(-3.0)]].concat());
        let passed = (1.0 - fresnel(0.0, ior)).powi(2);
        for (k, left) in LEFT.iter().enumerate() {
            close(found.radiance.to_array()[k], passed * left * left, "two blocks");
        }
    }
}

/// At slabs in contact only the change of the index counts, and light is bent by each.
#[test]
fn slabs_in_contact_have_one_surface_between_them() {
    let (angle, [one, other]) = (0.8_f64, [1.5, 1.8]);
    let slabs = [block(50.0, [0.0, 1.0], &glass(one)), block(50.0, [-2.0, 0.0], &glass(other))];
    let found = path(3, &at_angle(angle), &[&slabs[..], &[shining(-4.0)]].concat());
    let within = |ior: f64| (angle.sin() / ior).asin();
    let passed = (1.0 - fresnel(angle, one))
        * (1.0 - fresnel(within(one), other / one))
        * (1.0 - fresnel(angle, other));
    close(found.radiance.x, passed, "light");
    let met = found.bounces.iter().filter_map(|bounce| bounce.met.as_ref());
    let end = met.min_by(|a, b| a.point.z.total_cmp(&b.point.z)).expect("the wall").point.x;
    let expected = -(within(one).tan() + 2.0 * within(other).tan() + 2.0 * angle.tan());
    // It enters above the origin, at z = 1.
    assert!((end - angle.tan() - expected).abs() < 1e-4, "{end} {expected}");
}

#[test]
fn bodies_that_overlap_are_one() {
    let [a, b] = [[0.0, 1.0], [0.5, 1.5]].map(|ends| block(9.0, ends, &glass(1.5)));
    let found = straight(4, &[a.clone(), b, shining(-3.0)]);
    assert!((found.radiance.x - 0.9216).abs() < 2e-3 && found.bounces.len() > 4, "{found:?}");
    let of_faces = faces(9.0, [0.5, 1.5], &glass(1.5));
    let mut shapes = vec![a, shining(-3.0)];
    shapes.extend(of_faces);
    let prepared = prepare(&scene(2, &at_angle(0.0), &[], &shapes));
    close(pixel(&image_of(&prepared, 0), 0, 0)[0], 0.9216, "a block of six faces");
}

/// The reflectance of each surface on the way, straight through.
fn through(iors: &[f64]) -> f64 {
    iors.windows(2).map(|pair| 1.0 - fresnel(0.0, pair[1] / pair[0])).product()
}

#[test]
fn what_nests_has_its_own_medium() {
    let light = || shining(-6.0);
    // Each is left after all that is mirrored once: bounces end there.
    let ball = sphere([0.0, 0.01, 0.0], 0.5, glass(1.0));
    let found = straight(4, &[block(9.0, [-1.0, 1.0], &glass(1.5)), ball, light()]);
    close(found.radiance.x, through(&[1.0, 1.5, 1.0, 1.5, 1.0]), "a ball of air in glass");
    let water = block(4.0, [0.5, 1.0], &glass(1.333));
    let found = straight(4, &[block(9.0, [0.0, 1.5], &glass(1.5)), water, light()]);
    close(found.radiance.x, through(&[1.0, 1.5, 1.333, 1.5, 1.0]), "water in glass");
    // A bottom of glass, water that reaches into it or touches it, and ice above and below the surface.
    for bottom in [0.0, -0.25] {
        let glass_below = block(9.0, [-1.0, 0.0], &glass(1.5));
        let water = block(8.0, [bottom, 2.0], &glass(1.333));
        let found = straight(3, &[glass_below.clone(), water.clone(), light()]);
        close(found.radiance.x, through(&[1.0, 1.333, 1.5, 1.0]), "from above: 0.9372");
        let ice = block(1.0, [1.0, 2.25], &glass(1.31));
        let found = straight(4, &[glass_below, water, ice, light()]);
        close(found.radiance.x, through(&[1.0, 1.31, 1.333, 1.5, 1.0]), "ice in water");
    }
}

#[test]
fn the_highest_priority_decides() {
    let pair = |priority: f64| {
        let inner = with(glass(1.2), "priority", priority);
        [block(9.0, [-1.0, 1.0], &glass(1.6)), block(1.0, [-0.5, 0.5], &inner), shining(-6.0)]
    };
    close(straight(4, &pair(0.0)).radiance.x, through(&[1.0, 1.6, 1.2, 1.6, 1.0]), "nested");
    close(straight(2, &pair(-1.0)).radiance.x, through(&[1.0, 1.6, 1.0]), "hidden");
}

/// Whatever is thinner than the distance by which the origin of a ray is moved is entered and left.
#[test]
fn a_thin_ball_is_entered_and_left() {
    let thin = sphere([0.0, 0.01, 0.0], 1e-7, jelly(&json!({"kt": 1, "ior": 2})));
    let ball = sphere([0.0, 0.01, 0.0], 1.0, jelly(&json!({"kt": 1, "ior": 1.5})));
    let found = straight(2, &[thin, ball, shining(-6.0)]);
    for (k, left) in LEFT.iter().enumerate() {
        let passed = through(&[1.0, 1.5, 1.0]);
        close(found.radiance.to_array()[k], passed * left * left, "a thin ball in a ball");
    }
}

#[test]
fn paths_know_what_they_start_inside_of() {
    let inside = json!({"type": "pinhole", "width": 1, "height": 1, "fov": 1e-3,
                        "location": [0, 0.01, 0], "look": [0, 0.01, -1]});
    // Whatever it lets through.
    for more in [json!({"opacity": 0}), json!({"kt": 1, "ior": 1.33}), json!({})] {
        let ball = sphere([0.0; 3], 5.0, jelly(&more));
        let found = path(1, &inside, &[ball, shining(-2.0)]);
        for (k, left) in LEFT.iter().enumerate() {
            close(found.radiance.to_array()[k], left * left, "a camera in water");
        }
    }
    // The camera outside; the wall that it sees and the light that shines on it inside.
    let ball = sphere([0.0; 3], 3.0, jelly(&json!({"opacity": 0})));
    let seen = wall(2.0, -1.0, matte(1.0, [1.0; 3]));
    let lamp = with(point_light(1.0, [0.0, 0.0, 1.0], [1.0; 3]), "falloff", "none");
    let camera = with(pinhole([1, 1], 1e-3, 9.0), "location", json!([0, 0, 9]));
    let prepared = |shapes: &[Value]| {
        let mut json = scene(4, &camera, std::slice::from_ref(&lamp), shapes);
        json["scene"]["ambient"] = json!(0);
        pixel(&image_of(&prepare(&json), 0), 0, 0)
    };
    let (free, found) = (prepared(std::slice::from_ref(&seen)), prepared(&[ball, seen.clone()]));
    for (k, left) in LEFT.iter().enumerate() {
        close(found[k] / free[k], left.powi(4 + 2), "a light in water");
    }
}

/// A mirror that is also glass sends on more than it receives: its rays double at every bounce.
#[test]
fn rays_that_double_are_counted_and_end() {
    let pane = |i: u32| {
        let of = clear(&json!({"kt": 0.5, "kr": 2, "thin": true}));
        with(wall(90.0, -0.5 * f64::from(i), of), "sides", "both")
    };
    let mut shapes: Vec<Value> = (0..4).map(pane).collect();
    shapes.push(shining(-9.0));
    let prepared = prepare(&scene(64, &pinhole([1, 1], 1e-3, 9.0), &[], &shapes));
    let path = &probe::pixel(&prepared, [0, 0], None, 0, &|_| false).paths[0];
    assert_eq!(path.bounces.len(), wavecrest_core::prepared::MOST_RAYS as usize);
}

/// The share of light that balls around one another leave of each shell of this width, the innermost first.
fn left_by(ball: usize) -> f64 {
    0.96 + 0.001 * (ball * 37 % 40) as f64
}

/// Balls around the origin, the innermost first, each a shell wide.
fn nested(count: usize, more: &Value) -> Vec<Value> {
    let ball = |i: usize| {
        let of = with(
            clear(more),
            "attenuationcolor",
            json!([1.0; 3].map(|white: f64| white * left_by(i))),
        );
        sphere([0.0, 0.01, 0.0], (i + 1) as f64 / 16.0, with(of, "attenuationdistance", 0.0625))
    };
    (0..count).map(ball).collect()
}

/// From outside, from inside, and for light that shines through all of them.
#[test]
fn any_number_of_solids_nest() {
    const BALLS: usize = 64;
    let way: f64 = (0..BALLS).map(left_by).product();
    let inside = with(at_angle(0.0), "location", json!([0, 0.01, 0]));
    let inside = with(inside, "look", json!([0, 0.01, -1]));
    for more in [json!({"kt": 1, "ior": 1}), json!({"opacity": 0})] {
        let mut shapes = nested(BALLS, &more);
        shapes.push(shining(-5.0));
        for (camera, expected) in [(at_angle(0.0), way * way), (inside.clone(), way)] {
            for _ in 0..2 {
                shapes.reverse();
                let prepared = prepare(&scene(200, &camera, &[], &shapes));
                let path = probe::pixel(&prepared, [0, 0], None, 0, &|_| false);
                image_of(&prepared, 0);
                let found = f64::from(path.paths[0].radiance.x) / expected;
                assert!((found - 1.0).abs() < 1e-4, "nested balls: {found}");
            }
        }
        // Of a lamp on the other side, to a wall seen from this one.
        let lamp = with(point_light(1.0, [0.0, 0.01, 6.0], [1.0; 3]), "falloff", "none");
        let camera = with(pinhole([1, 1], 1e-3, 0.5), "location", json!([0, 0.01, -4.5]));
        let camera = with(camera, "look", json!([0, 0.01, -5]));
        let lit = |shapes: &[Value]| {
            let mut json = scene(2, &camera, std::slice::from_ref(&lamp), shapes);
            json["scene"]["ambient"] = json!(0);
            pixel(&image_of(&prepare(&json), 0), 0, 0)[0]
        };
        shapes[BALLS] = wall(9.0, -5.0, matte(1.0, [1.0; 3]));
        let found = lit(&shapes) / lit(&shapes[BALLS..]) / (way * way);
        assert!((found - 1.0).abs() < 1e-4, "light through nested balls: {found}");
    }
    // Of one index and without attenuation they are one body.
    let equal = (1..10).map(|i| sphere([0.0, 0.01, 0.0], f64::from(i), glass(1.5)));
    let shapes: Vec<Value> = equal.chain([shining(-20.0)]).collect();
    let camera = with(at_angle(0.0), "location", json!([0, 0.01, 15]));
    close(path(30, &camera, &shapes).radiance.x, through(&[1.0, 1.5, 1.0]), "one body");
}

/// All count, whatever their number and whatever they look like, in any tree; of solids the first.
#[test]
fn copies_in_one_place_count() {
    for [count, classes] in [[2, 1], [40, 1], [80, 3]] {
        let pane = |i: u32| {
            let of = clear(&json!({"opacity": 0.02, "specularexponent": 1 + i % classes}));
            wall(9.0, 0.0, of)
        };
        let mut shapes: Vec<Value> = (0..count).map(pane).collect();
        shapes.push(shining(-1.0));
        let mut prepared = prepare(&scene(0, &at_angle(0.3), &[], &shapes));
        for preset in [Preset::VeryFast, Preset::Brute, Preset::Fastest] {
            prepared.accel.rebuild(preset);
            let found = probe::pixel(&prepared, [0, 0], None, 0, &|_| false);
            image_of(&prepared, 0);
            close(found.paths[0].radiance.x, 0.98_f64.powi(count as i32), "copies");
        }
    }
    let tinted = clear(&json!({"kt": 1, "transmissioncolor": [0.5, 1, 1]}));
    let mut shapes = vec![sphere([0.0, 0.01, 0.0], 1.0, tinted); 3];
    shapes.push(shining(-3.0));
    let once = through(&[1.0, 1.5, 1.0]);
    let found = straight(4, &shapes).radiance;
    close(found.x, once * 0.25, "copies of a body, tinted where it is entered and left");
    close(found.y, once, "their other channels");
}

/// A faint mirror of what is bright, also after others, and whatever else is in the file.
#[test]
fn rays_end_by_what_they_could_show() {
    let bright = wall(60.0, 20.0, clear(&json!({"emission": [1000, 1000, 1000]})));
    let mirror = |kr: f64| wall(9.0, 0.0, clear(&json!({"kr": kr})));
    let unseen = |material: Value| sphere([500.0, 0.0, 0.0], 1.0, clear(&material));
    for (kr, expected) in [(0.0019, 1.9), (1e-5, 0.01), (1e-6, 0.0)] {
        for more in [json!({}), json!({"kt": 1}), json!({"emission": [1e9, 0, 0]})] {
            let shapes = [mirror(kr), bright.clone(), unseen(more)];
            close(path(3, &at_angle(0.2), &shapes).radiance.x, expected, "a faint mirror");
        }
    }
    // What surfaces reflect counts as white, and white after this mirror is less than half a level.
    let white = wall(60.0, 20.0, clear(&json!({"emission": [1, 1, 1]})));
    for more in [json!({"kr": 0.5}), json!({"kt": 1}), json!({"emission": [1e9, 0, 0]})] {
        let found = path(3, &at_angle(0.2), &[mirror(0.0019), white.clone(), unseen(more)]);
        assert_eq!(found.radiance.x, 0.0, "less than half a level");
    }
    // An image that is exposed longer shows it.
    let json = scene(3, &at_angle(0.2), &[], &[mirror(0.0019), white]);
    let exposed =
        prepare_in("".as_ref(), &json, SceneOptions { exposure: 8.0, ..SceneOptions::default() });
    close(pixel(&image_of(&exposed, 0), 0, 0)[0], 0.0019, "exposed");
}
