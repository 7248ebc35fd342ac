//! Ambient light by the normal, and what is in its way.

use std::f64::consts::PI;

use serde_json::{Value, json};

use wavecrest_scene::systems::SceneOptions;

use crate::support::{
    assert_near, folder, image, image_of, matte, merged, pinhole, pixel, prepare_in, scene, sphere,
    wall, with,
};

/// White light from everywhere, as `more` has it.
fn white(more: &Value) -> Value {
    merged(json!({"sky": [1, 1, 1]}), more)
}

/// What a white floor shows below `place`, with these shapes on it.
fn on_floor(place: [f64; 2], shapes: &[Value], ambient: &Value) -> f64 {
    let camera = with(pinhole([1, 1], 1e-3, 5.0), "location", json!([place[0], place[1], 5]));
    let camera = with(camera, "look", json!([place[0], place[1], 0]));
    let floor = wall(50.0, 0.0, matte(0.0, [1.0; 3]));
    let shapes: Vec<Value> = shapes.iter().cloned().chain([floor]).collect();
    let mut scene = scene(0, &camera, &[], &shapes);
    scene["scene"]["ambient"] = ambient.clone();
    pixel(&image(&scene), 0, 0)[0]
}

/// A black wall on the floor, above the line through the origin and `along`.
fn upright(along: [f64; 2], height: f64) -> Value {
    let end = |sign: f64, z: f64| [sign * along[0], sign * along[1], z];
    let points = [end(-1e5, 0.0), end(1e5, 0.0), end(1e5, height), end(-1e5, height)];
    json!({"type": "plane", "points": points, "sides": "both", "material": matte(0.0, [0.0; 3])})
}

/// Every way to spread 4096 rays, with the error that it may have.
fn samplers() -> [(Value, f64); 3] {
    [("random", 4096, 0.03), ("jittered", 64, 0.004), ("sobol", 4096, 0.003)].map(
        |(sampling, samples, error)| (json!({"sampling": sampling, "samples": samples}), error),
    )
}

/// A long wall of the height h at the distance x hides (1 - x / sqrt(x^2 + h^2)) / 2.
#[test]
fn a_wall_hides_its_part_of_the_sky_above_a_floor() {
    for (samples, error) in samplers() {
        for (distance, height) in [(1.0, 1.0), (0.5, 2.0), (2.0, 0.5), (1.0, 1e5)] {
            let hidden = 0.5 * (1.0 - distance / f64::hypot(distance, height));
            let wall = upright([0.0, 1.0], height);
            let found = on_floor([distance, 0.0], &[wall], &white(&samples));
            let what = format!("{samples}: {distance} from a wall of {height}");
            assert!(
                (found - (1.0 - hidden)).abs() < error,
                "{what}: {found}, not {}",
                1.0 - hidden
            );
        }
    }
}

#[test]
fn a_corner_of_two_walls_leaves_a_quarter_and_of_a_sharp_one_an_eighth() {
    for (samples, error) in samplers() {
        for (degrees, place) in [(90.0_f64, [1.0, 2.0]), (45.0, [2.0, 1.0])] {
            let other = [degrees.to_radians().cos(), degrees.to_radians().sin()];
            let walls = [upright([1.0, 0.0], 1e5), upright(other, 1e5)];
            let found = on_floor(place, &walls, &white(&samples));
            assert!((found - degrees / 360.0).abs() < error, "{samples}, {degrees}: {found}");
        }
    }
}

/// Of a wall at the distance x, rays of the length d meet what is above the chord at x / d of the
/// unit disk, in which directions by their cosine are spread evenly.
#[test]
fn rays_look_no_farther_than_their_distance() {
    for (samples, error) in samplers() {
        let wall = [upright([0.0, 1.0], 1e5)];
        for (length, error) in [(0.99, 1e-6), (1.25, error), (2.0, error), (40.0, error)] {
            let chord = f64::min(1.0 / length, 1.0);
            let hidden = (chord.acos() - chord * f64::sqrt(1.0 - chord * chord)) / PI;
            let ambient = with(white(&samples), "distance", length);
            let found = on_floor([1.0, 0.0], &wall, &ambient);
            assert!((found - (1.0 - hidden)).abs() < error, "{samples}, {length}: {found}");
        }
    }
}

/// A ball without anything near it, with few rays: to their rounding as bright as without rays.
#[test]
fn light_that_arrives_has_no_noise() {
    let ambient = json!({"sky": [0.9, 0.6, 0.3], "ground": [0.1, 0.2, 0.3], "up": [1, 2, 3]});
    let ball = sphere([0.0; 3], 1.0, matte(0.0, [0.5, 0.7, 0.9]));
    let mut scene = scene(0, &pinhole([16, 16], 40.0, 4.0), &[], &[ball]);
    let mut film = |samples: u32| {
        scene["scene"]["ambient"] = with(ambient.clone(), "samples", samples);
        image(&scene)
    };
    let (plain, traced) = (film(0), film(3));
    for (x, y) in (0..16).flat_map(|y| (0..16).map(move |x| (x, y))) {
        assert_near(pixel(&traced, x, y), pixel(&plain, x, y), 1e-6, &format!("{x}, {y}"));
    }
}

/// A pane before a background B that refracts the share t, has the opacity o and, where it is lit, the
/// mirror m, in light A from everywhere: o (1 - t) (A + m A) + o t (R A + (1 - R) B) + (1 - o) B, where it
/// mirrors R = 2 F / (1 + F).
#[test]
fn of_ambient_light_a_pane_scatters_what_it_does_not_refract() {
    let (light, beyond) = ([0.5, 0.4, 0.3], [0.1, 0.2, 0.9]);
    let once = f64::powi(0.5 / 2.5, 2);
    let mirrored = 2.0 * once / (1.0 + once);
    let corners = [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]];
    for (t, opacity) in [(0.0, 0.4), (0.25, 1.0), (0.7, 0.6), (1.0, 0.5), (1.0, 1.0)] {
        for (normal, mirror) in [(1, 0.3), (-1, 0.0)] {
            let more = json!({"kr": 0.3, "kt": t, "opacity": opacity, "thin": true});
            let pane = json!({"type": "plane", "points": corners, "normal": [0, 0, normal],
                              "material": merged(matte(0.5, [1.0; 3]), &more)});
            let mut scene = scene(1, &pinhole([1, 1], 1e-3, 5.0), &[], &[pane]);
            scene["scene"]["backgroundcolor"] = json!(beyond);
            let expected = std::array::from_fn(|i| {
                let (around, behind) = (light[i], beyond[i]);
                let refracted = mirrored * around + (1.0 - mirrored) * behind;
                let own = (1.0 - t) * (1.0 + mirror) * around + t * refracted;
                opacity * own + (1.0 - opacity) * behind
            });
            for samples in [0, 3] {
                scene["scene"]["ambient"] = json!({"sky": light, "samples": samples});
                let what = format!("{t} refracted, {opacity} opaque, {normal}, {samples} rays");
                assert_near(pixel(&image(&scene), 0, 0), expected, 1e-6, &what);
            }
        }
    }
}

/// Surroundings a + b h, by the height h of a direction, are reflected as a + (2 / 3) b n.up.
#[test]
fn surroundings_light_surfaces_by_their_normals() {
    for (up, height) in [([0.0, 0.0, 1.0], 1.0), ([0.0, 3.0, 4.0], 0.8), ([0.0, 0.0, -1.0], -1.0)] {
        for (zenith, horizon, nadir) in [(0.5, 0.5, 0.5), (1.0, 0.6, 0.2)] {
            let gray = |value: f64| [value; 3];
            let around = json!({"zenith": gray(zenith), "horizon": gray(horizon),
                                "nadir": gray(nadir), "up": up});
            let floor = wall(50.0, 0.0, matte(0.0, [0.5; 3]));
            let mut scene = scene(0, &pinhole([1, 1], 40.0, 5.0), &[], &[floor]);
            scene["scene"]["environment"] = around;
            for samples in [0, 2] {
                scene["scene"]["ambient"] = json!({"samples": samples});
                let expected = 0.5 * (horizon + (zenith - horizon) * height * 2.0 / 3.0);
                let found = pixel(&image(&scene), 0, 0);
                assert_near(found, [expected; 3], 2e-4, &format!("{up:?} {zenith} {samples}"));
            }
        }
    }
}

/// White surroundings give white light, however few texels they have.
#[test]
fn images_of_any_size_light_surfaces() {
    let folder = folder();
    for (width, height) in [(1, 1), (2, 1), (64, 1), (4, 4), (31, 300)] {
        let image = image::RgbImage::from_pixel(width, height, image::Rgb([255; 3]));
        image.save(folder.path().join("sky.png")).expect("an image");
        let ball = sphere([0.0; 3], 1.0, matte(0.0, [0.5; 3]));
        let mut scene = scene(0, &pinhole([5, 5], 20.0, 4.0), &[], &[ball]);
        scene["scene"]["environment"] = json!({"file": "sky.png", "turn": 77, "up": [1, 2, 3]});
        scene["scene"]["ambient"] = json!({});
        let film = image_of(&prepare_in(folder.path(), &scene, SceneOptions::default()), 0);
        for (x, y) in [(2, 2), (1, 2), (2, 1), (3, 3)] {
            assert_near(pixel(&film, x, y), [0.5; 3], 2e-4, &format!("{width} x {height}"));
        }
    }
}

/// An image that is 1 / 2 + d.k / 2 in the direction d is reflected as 1 / 2 + n.k / 3: on a ball
/// more to the right, above, or in front.
#[test]
fn light_of_an_image_comes_from_where_it_is_seen() {
    let folder = folder();
    for axis in 0..3 {
        let texel = |x: u32, y: u32| {
            let around = (f64::from(x) + 0.5) / 128.0 * 2.0 * PI - PI;
            let up = PI / 2.0 - (f64::from(y) + 0.5) / 64.0 * PI;
            let towards = [around.sin() * up.cos(), up.sin(), -around.cos() * up.cos()];
            image::Rgb([(127.5 + 127.5 * towards[axis]).round() as u8; 3])
        };
        let image = image::RgbImage::from_fn(128, 64, texel);
        image.save(folder.path().join("sky.png")).expect("an image");
        let ball = sphere([0.0; 3], 1.0, matte(0.0, [1.0; 3]));
        let mut scene = scene(0, &pinhole([3, 3], 1.0, 50.0), &[], &[ball]);
        scene["camera"]["fov"] = 2.0.into();
        scene["scene"]["environment"] = json!({"file": "sky.png"});
        scene["scene"]["ambient"] = json!({});
        let film = image_of(&prepare_in(folder.path(), &scene, SceneOptions::default()), 0);
        // Rays through the middles of pixels are a third of the image apart.
        let off = 50.0 * (f64::to_radians(1.0)).tan() * 2.0 / 3.0;
        for (x, y) in [(1, 1), (0, 1), (2, 1), (1, 0), (1, 2)] {
            let [right, above] = [f64::from(x) - 1.0, 1.0 - f64::from(y)].map(|n| n * off);
            let normal = [right, above, f64::sqrt(1.0 - right * right - above * above)];
            let expected = 0.5 + normal[axis] / 3.0;
            assert_near(pixel(&film, x, y), [expected; 3], 0.01, &format!("{axis}: {x}, {y}"));
        }
    }
}
