//! The scenes of the price list: base scenes, and variants that each add one effect.
//!
//! They show a field of hills in front of a wall, all of triangles, in a view that each effect
//! changes widely. A variant is a [patch](patched) of the scene that it is added to.

use std::path::Path;

use serde_json::{Value, json};

use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_image::write::{Transfer, write};

/// A scene of the list.
#[derive(Clone, Debug)]
pub struct Variant {
    /// The effect that it adds.
    pub name: &'static str,
    /// The index of the scene that it is added to.
    pub added_to: Option<usize>,
    /// Whether anything shows it.
    pub reached: bool,
    /// The scene, in the format of scene files.
    pub scene: Value,
}

/// Number of hills along each side of the field, and of mesh vertices along each side.
const HILLS: f64 = 4.0;
const CORNERS: u32 = 48;

/// Positions of lights: above the field on either side; and below it and behind the wall, which no
/// front faces.
const ABOVE: [f64; 3] = [3.0, 4.0, 2.0];
const LEFT: [f64; 3] = [-3.0, 4.0, 2.0];
const BELOW: [f64; 3] = [0.0, -6.0, -3.0];

/// Texels along each side of the texture, and of its squares.
const TEXELS: u32 = 64;
const SQUARE: u32 = 8;

/// The first scenes, by their number.
const DARK: usize = 0;
const AMBIENT: usize = 1;
const LIT: usize = 2;

/// The scenes. Their texture is written to `folder`.
///
/// # Errors
/// If it cannot be written.
pub fn variants(folder: &Path) -> Result<Vec<Variant>> {
    let picture = folder.join("checkers.png");
    write(&checkers()?, &picture, Transfer::Linear)?;
    let picture = picture.display().to_string();
    let dim = patched(&base(), &lights([lamp(0.0, ABOVE)]));
    let mut variants = vec![
        Variant { name: "no light", added_to: None, reached: true, scene: base() },
        Variant { name: "ambient light", added_to: None, reached: true, scene: dim },
    ];
    for (patches, reached) in [(reached(&picture), true), (unreached(&picture), false)] {
        for (name, added_to, patch) in patches {
            let scene = patched(&variants[added_to].scene, &patch);
            variants.push(Variant { name, added_to: Some(added_to), reached, scene });
        }
    }
    Ok(variants)
}

/// An effect, the scene that it is added to, and the patch.
type Row = (&'static str, usize, Value);

/// Visible effects.
fn reached(picture: &str) -> Vec<Row> {
    let sky = json!({"sky": [0.2, 0.3, 0.4], "ground": [0.15, 0.1, 0.05]});
    let glowing_map = each(json!({"material": glow(), "emissionmap": {"file": picture}}));
    vec![
        ("a point light", AMBIENT, lights([lamp(60.0, ABOVE)])),
        ("a spot light", AMBIENT, lights([spot(60.0, [-3.0, -4.0, -2.0])])),
        ("a directional light", AMBIENT, lights([sun([-3.0, -4.0, -2.0], 0.0)])),
        ("a sun of 5 degrees, 16 points", AMBIENT, lights([sun([-3.0, -4.0, -2.0], 5.0)])),
        ("an area light, 4 x 4", AMBIENT, lights([panel()])),
        ("a hemisphere light", LIT, json!({"scene": {"ambient": sky}})),
        ("a second point light", LIT, lights([lamp(60.0, ABOVE), lamp(60.0, LEFT)])),
        ("smooth shading", LIT, smooth()),
        ("vertex colours", LIT, colored()),
        ("mirrors, 1 bounce", LIT, mirrors(0.5, 1)),
        ("mirrors, 4 bounces", LIT, mirrors(0.5, 4)),
        ("a texture, nearest", LIT, textured(picture, "nearest")),
        ("a texture, bilinear", LIT, textured(picture, "bilinear")),
        ("a texture, trilinear", LIT, textured(picture, "trilinear")),
        ("emission", LIT, each(json!({"material": glow()}))),
        ("an emission map", LIT, glowing_map),
        ("cut-outs", LIT, each(json!({"alpha": picture, "alphacutoff": 0.5}))),
        ("tinted highlights", LIT, each(json!({"material": tint()}))),
        ("a normal map", LIT, each(json!({"normalmap": {"file": picture}}))),
        ("a metal map", LIT, each(json!({"metalmap": {"file": picture}}))),
        ("an occlusion map", LIT, each(json!({"occlusionmap": {"file": picture}}))),
        ("antialiasing, 2 x 2", LIT, json!({"camera": {"antialias": 2}})),
        ("depth of field, 2 x 2", LIT, lens(0.2, 2)),
        ("quads", LIT, more((-2..=2).map(quad))),
        ("spheres", LIT, more((-2..=2).map(sphere))),
        ("instances, 4", LIT, instanced()),
    ]
}

/// Effects that nothing shows: the same image, the same work.
fn unreached(picture: &str) -> Vec<Row> {
    let mut shut = spot(60.0, [-3.0, -4.0, -2.0]);
    (shut["outer"], shut["inner"]) = (0.into(), 0.into());
    let flat = |key: &str, value: Value| {
        let points = [[0, 0, 0], [1, 1, 1], [2, 2, 2]];
        let triangle =
            json!({"type": "triangle", "points": points, "material": material([0.5; 3])});
        more([patched(&triangle, &json!({key: value}))])
    };
    let map = json!({"file": picture});
    let maps =
        each(json!({"normalmap": map, "metalmap": map, "occlusionmap": map, "material": tint()}));
    vec![
        ("a mirror without bounces", LIT, mirrors(0.5, 0)),
        ("bounces without a mirror", LIT, mirrors(0.0, 8)),
        ("a lens of aperture 0", LIT, lens(0.0, 4)),
        ("a light without power", LIT, lights([lamp(60.0, ABOVE), lamp(0.0, LEFT)])),
        ("a light behind everything", LIT, lights([lamp(60.0, BELOW), lamp(60.0, ABOVE)])),
        (
            "a directional light from below",
            LIT,
            lights([lamp(60.0, ABOVE), sun([0.0, 4.0, 1.0], 0.0)]),
        ),
        ("a spot light of 0 degrees", LIT, lights([lamp(60.0, ABOVE), shut])),
        ("a textured triangle without area", LIT, flat("texture", picture.into())),
        ("emission of a triangle without area", LIT, flat("material", glow())),
        ("cut-outs at an alpha of 0", LIT, each(json!({"alpha": picture, "alphacutoff": 0.0}))),
        ("maps without light", DARK, maps),
        ("a texture without light", DARK, textured(picture, "bilinear")),
        ("mirrors without light", DARK, mirrors(0.5, 4)),
        ("smooth shading without light", DARK, smooth()),
        ("vertex colours without light", DARK, colored()),
    ]
}

/// The scene with a patch: objects are merged, other values replaced. A patch of the shapes is for
/// each of them if it is an object; if it is a list, for one after the other, and what is left over
/// is added.
fn patched(scene: &Value, patch: &Value) -> Value {
    let Value::Object(changes) = patch else { return patch.clone() };
    let mut scene = if scene.is_object() { scene.clone() } else { json!({}) };
    for (key, change) in changes {
        let old = scene[key].take();
        scene[key] = match (old, change) {
            (Value::Array(old), Value::Object(_)) => {
                old.iter().map(|one| patched(one, change)).collect()
            }
            (Value::Array(mut old), Value::Array(new)) if key == "shapes" => {
                old.resize(old.len().max(new.len()), json!({}));
                let mut new = new.iter();
                old.iter().map(|one| new.next().map_or(one.clone(), |n| patched(one, n))).collect()
            }
            (old, change) => patched(&old, change),
        };
    }
    scene
}

/// A patch of every shape.
fn each(patch: Value) -> Value {
    json!({"scene": {"shapes": patch}})
}

/// A patch that adds shapes to the field and the wall.
fn more(shapes: impl IntoIterator<Item = Value>) -> Value {
    each([json!({}), json!({})].into_iter().chain(shapes).collect())
}

fn base() -> Value {
    json!({
        "nbounces": 0,
        "camera": {"type": "pinhole", "width": 320, "height": 240, "fov": 50,
                   "location": [0.0, 1.6, 3.2], "look": [0.0, 0.1, 0.0]},
        "scene": {"backgroundcolor": [0.1, 0.2, 0.3], "lightsources": [],
                  "shapes": [field(), wall()]},
    })
}

fn material(color: [f64; 3]) -> Value {
    json!({"ks": 0.2, "kd": 0.8, "specularexponent": 20, "diffusecolor": color})
}

/// Gentle hills, seen from above.
fn field() -> Value {
    let place = |i: u32| f64::from(i) / f64::from(CORNERS - 1);
    let turn = HILLS * std::f64::consts::TAU;
    // Sines whose sum is the height, and whose derivatives give the normal.
    let height = 0.05;
    let corners: Vec<[f64; 2]> =
        (0..CORNERS * CORNERS).map(|i| [place(i % CORNERS), place(i / CORNERS)]).collect();
    let points: Vec<[f64; 3]> = corners
        .iter()
        .map(|&[u, v]| {
            let y = height * (libm::sin(turn * u) + libm::sin(turn * v));
            [4.0 * u - 2.0, y, 2.0 - 4.0 * v]
        })
        .collect();
    let slope = |x: f64| height * turn * libm::cos(turn * x) / 4.0;
    let normals: Vec<[f64; 3]> = corners.iter().map(|&[u, v]| [-slope(u), 1.0, slope(v)]).collect();
    let corner = |x: u32, y: u32| y * CORNERS + x;
    let squares = (0..CORNERS - 1).flat_map(|y| (0..CORNERS - 1).map(move |x| (x, y)));
    let indices: Vec<[u32; 3]> = squares
        .flat_map(|(x, y)| {
            let [a, b] = [corner(x, y), corner(x, y + 1)];
            [[a, b, b + 1], [a, b + 1, a + 1]]
        })
        .collect();
    json!({"type": "trimesh", "points": points, "indices": indices, "normals": normals,
           "sides": "front", "uvs": corners, "material": material([0.8, 0.6, 0.3])})
}

/// An upright wall behind the field, facing the camera.
fn wall() -> Value {
    let points = [[-2.0, -0.2, -2.0], [-2.0, 1.5, -2.0], [2.0, 1.5, -2.0], [2.0, -0.2, -2.0]];
    json!({"type": "trimesh", "points": points, "indices": [[0, 1, 2], [0, 2, 3]],
           "sides": "front", "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]], "material": material([0.4, 0.5, 0.7])})
}

/// These lights, which share one ambient light: it looks the same for any number.
fn lights<const N: usize>(lights: [Value; N]) -> Value {
    /// A power of two, so that its shares add up without rounding.
    const AMBIENT: f64 = 0.125;
    json!({"scene": {"ambient": AMBIENT / N as f64, "lightsources": lights.to_vec()}})
}

fn lamp(intensity: f64, position: [f64; 3]) -> Value {
    json!({"type": "pointlight", "intensity": intensity, "position": position, "color": [1, 1, 1]})
}

/// A spot above the field that lights only along `direction`.
fn spot(intensity: f64, direction: [f64; 3]) -> Value {
    let mut spot = lamp(intensity, ABOVE);
    spot["type"] = "spotlight".into();
    spot["direction"] = json!(direction);
    spot["inner"] = 10.into();
    spot["outer"] = 30.into();
    spot
}

/// A light along `direction`, with 16 points on a patch with this `angle`.
fn sun(direction: [f64; 3], angle: f64) -> Value {
    json!({"type": "directionallight", "intensity": 1.0, "color": [1, 1, 1], "direction": direction,
           "angle": angle, "samples": 16})
}

/// A square above the field.
fn panel() -> Value {
    let points = [[-0.5, 3.0, 0.5], [-0.5, 3.0, 1.5], [0.5, 3.0, 1.5], [0.5, 3.0, 0.5]];
    json!({"type": "arealight", "intensity": 60.0, "color": [1, 1, 1], "sampling": "jittered",
           "samples": 4, "shape": {"type": "plane", "points": points}})
}

/// Only the field has normals.
fn smooth() -> Value {
    each(json!([{"shading": "smooth"}]))
}

/// Gives each point a colour by its position.
fn colored() -> Value {
    let color = |uv: &Value| json!([uv[0], uv[1], 0.5]);
    let colors = |shape: Value| {
        let uvs = shape["uvs"].as_array().into_iter().flatten();
        json!({"colors": uvs.map(color).collect::<Value>()})
    };
    each([field(), wall()].map(colors).to_vec().into())
}

fn mirrors(kr: f64, bounces: u32) -> Value {
    json!({"nbounces": bounces, "scene": {"shapes": {"material": {"kr": kr}}}})
}

fn textured(picture: &str, filter: &str) -> Value {
    each(json!({"texture": picture, "filter": filter}))
}

fn glow() -> Value {
    json!({"emission": [0.2, 0.1, 0.05]})
}

fn tint() -> Value {
    json!({"specularcolor": [1.0, 0.7, 0.3]})
}

/// The field as four instances, each a quarter of its size.
fn instanced() -> Value {
    let quarter = |(x, z): (i32, i32)| json!({"shape": "field", "transform": {"scale": 0.5, "translate": [x, 0, z]}});
    let instances = [(-1, -1), (-1, 1), (1, -1), (1, 1)].map(quarter).to_vec();
    json!({"scene": {"shapes": [{"name": "field", "hidden": true}], "instances": instances}})
}

fn lens(aperture: f64, samples: u32) -> Value {
    json!({"camera": {"type": "thinlens", "aperture": aperture, "focal": 3.5,
                      "nsamplesx": samples, "nsamplesy": samples}})
}

/// The `i`th quad of an upright row above the field.
fn quad(i: i32) -> Value {
    let (left, right) = (f64::from(i) * 0.7 - 0.3, f64::from(i) * 0.7 + 0.3);
    let points = [[left, 0.1, 0.0], [left, 0.7, 0.0], [right, 0.7, 0.0], [right, 0.1, 0.0]];
    json!({"type": "plane", "points": points, "material": material([0.9, 0.2, 0.2])})
}

fn sphere(i: i32) -> Value {
    json!({"type": "sphere", "center": [f64::from(i) * 0.7, 0.4, 0.0], "radius": 0.3,
           "material": material([0.9, 0.2, 0.2])})
}

/// Squares of two colours.
fn checkers() -> Result<Film> {
    let color = |i: u32| {
        let [x, y] = [i % TEXELS / SQUARE, i / TEXELS / SQUARE];
        if (x + y).is_multiple_of(2) { [0.9, 0.8, 0.6] } else { [0.3, 0.2, 0.1] }
    };
    let mut film = Film::new(TEXELS, TEXELS)?;
    (0_u32..).zip(film.pixels_mut()).for_each(|(i, pixel)| *pixel = color(i));
    Ok(film)
}
