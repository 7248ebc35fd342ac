//! The scenes of the price list: base scenes, and variants that each add one effect.
//!
//! They show a field of hills in front of a wall, all of triangles, in a view that each effect
//! changes widely.

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

/// The scenes. Their texture is written to `folder`.
///
/// # Errors
/// If it cannot be written.
pub fn variants(folder: &Path) -> Result<Vec<Variant>> {
    let picture = folder.join("checkers.png");
    write(&checkers()?, &picture, Transfer::Linear)?;
    let picture = picture.display().to_string();
    let mut list = List::default();
    let dark = list.first("no light", base());
    let ambient = list.first("ambient light", with_lights(base(), [lamp(0.0, ABOVE)]));
    let lit = list.add("a point light", ambient, |scene| {
        *scene = with_lights(base(), [lamp(60.0, ABOVE)]);
    });
    add_reached(&mut list, ambient, lit, &picture);
    add_unreached(&mut list, dark, lit, &picture);
    Ok(list.variants)
}

/// Visible effects.
fn add_reached(list: &mut List, ambient: usize, lit: usize, picture: &str) {
    list.add("a spot light", ambient, |scene| {
        *scene = with_lights(base(), [spot(60.0, [-3.0, -4.0, -2.0])]);
    });
    list.add("a directional light", ambient, |scene| {
        *scene = with_lights(base(), [sun([-3.0, -4.0, -2.0], 0.0)]);
    });
    list.add("a sun of 5 degrees, 16 points", ambient, |scene| {
        *scene = with_lights(base(), [sun([-3.0, -4.0, -2.0], 5.0)]);
    });
    list.add("an area light, 4 x 4", ambient, |scene| {
        *scene = with_lights(base(), [panel()]);
    });
    list.add("a hemisphere light", lit, |scene| {
        let sky = json!({"sky": [0.2, 0.3, 0.4], "ground": [0.15, 0.1, 0.05]});
        scene["scene"]["ambient"] = sky;
    });
    list.add("a second point light", lit, |scene| {
        *scene = with_lights(base(), [lamp(60.0, ABOVE), lamp(60.0, LEFT)]);
    });
    list.add("smooth shading", lit, smooth);
    list.add("vertex colours", lit, colored);
    list.add("mirrors, 1 bounce", lit, |scene| mirrors(scene, 0.5, 1));
    list.add("mirrors, 4 bounces", lit, |scene| mirrors(scene, 0.5, 4));
    list.add("a texture, nearest", lit, |scene| textured(scene, picture, "nearest"));
    list.add("a texture, bilinear", lit, |scene| textured(scene, picture, "bilinear"));
    list.add("a texture, trilinear", lit, |scene| textured(scene, picture, "trilinear"));
    list.add("emission", lit, |scene| glow(shapes(scene)));
    list.add("an emission map", lit, |scene| {
        glow(shapes(scene));
        mapped(scene, "emissionmap", picture);
    });
    list.add("cut-outs", lit, |scene| cut_out(scene, picture, 0.5));
    list.add("tinted highlights", lit, tint);
    list.add("a normal map", lit, |scene| mapped(scene, "normalmap", picture));
    list.add("a metal map", lit, |scene| mapped(scene, "metalmap", picture));
    list.add("an occlusion map", lit, |scene| mapped(scene, "occlusionmap", picture));
    list.add("antialiasing, 2 x 2", lit, |scene| scene["camera"]["antialias"] = 2.into());
    list.add("depth of field, 2 x 2", lit, |scene| lens(scene, 0.2, 2));
    list.add("quads", lit, |scene| add_shapes(scene, (-2..=2).map(quad)));
    list.add("spheres", lit, |scene| add_shapes(scene, (-2..=2).map(sphere)));
    list.add("instances, 4", lit, instanced);
}

/// Effects that nothing shows: the same image, the same work.
fn add_unreached(list: &mut List, dark: usize, lit: usize, picture: &str) {
    list.without("a mirror without bounces", lit, |scene| mirrors(scene, 0.5, 0));
    list.without("bounces without a mirror", lit, |scene| mirrors(scene, 0.0, 8));
    list.without("a lens of aperture 0", lit, |scene| lens(scene, 0.0, 4));
    list.without("a light without power", lit, |scene| {
        *scene = with_lights(base(), [lamp(60.0, ABOVE), lamp(0.0, LEFT)]);
    });
    list.without("a light behind everything", lit, |scene| {
        *scene = with_lights(base(), [lamp(60.0, BELOW), lamp(60.0, ABOVE)]);
    });
    list.without("a directional light from below", lit, |scene| {
        *scene = with_lights(base(), [lamp(60.0, ABOVE), sun([0.0, 4.0, 1.0], 0.0)]);
    });
    list.without("a spot light of 0 degrees", lit, |scene| {
        let mut shut = spot(60.0, [-3.0, -4.0, -2.0]);
        shut["outer"] = 0.into();
        shut["inner"] = 0.into();
        *scene = with_lights(base(), [lamp(60.0, ABOVE), shut]);
    });
    list.without("a textured triangle without area", lit, |scene| {
        let points = [[0, 0, 0], [1, 1, 1], [2, 2, 2]];
        let triangle = json!({"type": "triangle", "points": points, "texture": picture,
                              "material": material([0.5; 3])});
        add_shapes(scene, [triangle]);
    });
    list.without("emission of a triangle without area", lit, |scene| {
        let points = [[0, 0, 0], [1, 1, 1], [2, 2, 2]];
        let mut triangle =
            json!({"type": "triangle", "points": points, "material": material([0.5; 3])});
        glow([&mut triangle]);
        add_shapes(scene, [triangle]);
    });
    list.without("cut-outs at an alpha of 0", lit, |scene| cut_out(scene, picture, 0.0));
    list.without("maps without light", dark, |scene| {
        for key in ["normalmap", "metalmap", "occlusionmap"] {
            mapped(scene, key, picture);
        }
        tint(scene);
    });
    list.without("a texture without light", dark, |scene| textured(scene, picture, "bilinear"));
    list.without("mirrors without light", dark, |scene| mirrors(scene, 0.5, 4));
    list.without("smooth shading without light", dark, smooth);
    list.without("vertex colours without light", dark, colored);
}

#[derive(Default)]
struct List {
    variants: Vec<Variant>,
}

impl List {
    /// Appends a base scene. Returns its index.
    fn first(&mut self, name: &'static str, scene: Value) -> usize {
        self.push(Variant { name, added_to: None, reached: true, scene })
    }

    /// Appends a changed copy of the scene at `base`.
    fn add(&mut self, name: &'static str, base: usize, change: impl FnOnce(&mut Value)) -> usize {
        let mut scene = self.variants[base].scene.clone();
        change(&mut scene);
        self.push(Variant { name, added_to: Some(base), reached: true, scene })
    }

    /// As [`List::add`], with an invisible change.
    fn without(&mut self, name: &'static str, base: usize, change: impl FnOnce(&mut Value)) {
        let place = self.add(name, base, change);
        self.variants[place].reached = false;
    }

    fn push(&mut self, variant: Variant) -> usize {
        self.variants.push(variant);
        self.variants.len() - 1
    }
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
           "uvs": corners, "material": material([0.8, 0.6, 0.3])})
}

/// An upright wall behind the field, facing the camera.
fn wall() -> Value {
    let points = [[-2.0, -0.2, -2.0], [-2.0, 1.5, -2.0], [2.0, 1.5, -2.0], [2.0, -0.2, -2.0]];
    json!({"type": "trimesh", "points": points, "indices": [[0, 1, 2], [0, 2, 3]],
           "uvs": [[0, 0], [0, 1], [1, 1], [1, 0]], "material": material([0.4, 0.5, 0.7])})
}

fn shapes(scene: &mut Value) -> impl Iterator<Item = &mut Value> {
    scene["scene"]["shapes"].as_array_mut().into_iter().flatten()
}

fn add_shapes(scene: &mut Value, new: impl IntoIterator<Item = Value>) {
    if let Some(shapes) = scene["scene"]["shapes"].as_array_mut() {
        shapes.extend(new);
    }
}

/// The scene with these lights, which share one ambient light: it looks the same for any number.
fn with_lights<const N: usize>(mut scene: Value, lights: [Value; N]) -> Value {
    /// A power of two, so that its shares add up without rounding.
    const AMBIENT: f64 = 0.125;
    scene["scene"]["ambient"] = (AMBIENT / N as f64).into();
    scene["scene"]["lightsources"] = lights.to_vec().into();
    scene
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

fn smooth(scene: &mut Value) {
    for shape in shapes(scene).filter(|shape| shape["normals"].is_array()) {
        shape["shading"] = "smooth".into();
    }
}

/// Gives each point a colour by its position.
fn colored(scene: &mut Value) {
    for shape in shapes(scene) {
        let color = |uv: &Value| json!([uv[0], uv[1], 0.5]);
        let colors = shape["uvs"].as_array().map(|uvs| uvs.iter().map(color).collect::<Value>());
        shape["colors"] = colors.unwrap_or_default();
    }
}

fn mirrors(scene: &mut Value, kr: f64, bounces: u32) {
    scene["nbounces"] = bounces.into();
    for shape in shapes(scene) {
        shape["material"]["kr"] = kr.into();
    }
}

fn textured(scene: &mut Value, picture: &str, filter: &str) {
    for shape in shapes(scene) {
        shape["texture"] = picture.into();
        shape["filter"] = filter.into();
    }
}

fn glow<'a>(shapes: impl IntoIterator<Item = &'a mut Value>) {
    for shape in shapes {
        shape["material"]["emission"] = json!([0.2, 0.1, 0.05]);
    }
}

/// The darker squares are holes.
fn cut_out(scene: &mut Value, picture: &str, threshold: f64) {
    for shape in shapes(scene) {
        shape["alpha"] = picture.into();
        shape["alphacutoff"] = threshold.into();
    }
}

/// The field as four instances, each a quarter of its size.
fn instanced(scene: &mut Value) {
    for field in shapes(scene).filter(|shape| shape["normals"].is_array()) {
        field["name"] = "field".into();
        field["hidden"] = true.into();
    }
    let quarter = |(x, z): (i32, i32)| json!({"shape": "field", "transform": {"scale": 0.5, "translate": [x, 0, z]}});
    scene["scene"]["instances"] = [(-1, -1), (-1, 1), (1, -1), (1, 1)].map(quarter).to_vec().into();
}

fn tint(scene: &mut Value) {
    for shape in shapes(scene) {
        shape["material"]["specularcolor"] = json!([1.0, 0.7, 0.3]);
    }
}

fn mapped(scene: &mut Value, key: &str, picture: &str) {
    for shape in shapes(scene) {
        shape[key] = json!({"file": picture});
    }
}

fn lens(scene: &mut Value, aperture: f64, samples: u32) {
    let camera = &mut scene["camera"];
    camera["type"] = "thinlens".into();
    camera["aperture"] = aperture.into();
    camera["focal"] = 3.5.into();
    camera["nsamplesx"] = samples.into();
    camera["nsamplesy"] = samples.into();
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
