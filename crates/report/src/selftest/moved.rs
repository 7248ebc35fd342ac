//! Moved and scaled scenes, which must look the same.

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::case::{Effort, Outcome};
use super::convex::{Mesh, globe};
use super::scenes::{self, Eye, PRESETS, camera_rays, every_image, pixels};
use super::ways::every_way;
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, Hit};
use wavecrest_core::film::Film;
use wavecrest_core::math::ray::Ray;

/// The grid of vertices: at coordinates of 2^17 it is the resolution of single precision.
const STEP: f64 = 1.0 / 64.0;

/// The radius of the globe.
const RADIUS: f64 = 64.0;

/// Largest share of the pixels of a moved scene that may show another primitive.
const LARGEST_SHARE_OF_OTHERS: f64 = 1e-4;

/// The camera and the light, relative to the centre of the globe.
const EYE: DVec3 = DVec3::new(120.0, 80.0, 150.0);
const LIGHT: DVec3 = DVec3::new(-40.0, 190.0, 160.0);

fn eye(effort: &Effort, by: DVec3) -> Eye {
    let size = effort.either([48, 40], [128, 120]);
    Eye { look: by, ..Eye::at(EYE + by, 40.0, size) }
}

fn hits(accel: &Accel, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit::MISS; rays.len()];
    accel.closest_of(rays, &mut hits, &mut accel.traversal());
    hits
}

/// The offsets of scenes: powers of two, along several diagonals.
fn moves(effort: &Effort) -> Vec<DVec3> {
    let diagonals = [DVec3::ONE, DVec3::new(1.0, -1.0, 0.0), DVec3::new(0.0, 0.0, -1.0)];
    let powers = effort.either(vec![0, 9, 16, 17], (0..=17).collect());
    powers
        .into_iter()
        .flat_map(|k| diagonals.map(|diagonal| diagonal * libm::exp2(f64::from(k))))
        .collect()
}

/// Case 7.
pub(super) fn moved(effort: &Effort) -> Outcome {
    let mut outcome = Outcome::default();
    for by in [DVec3::ZERO].into_iter().chain(moves(effort)) {
        let context = || format!("moved by {by}");
        let asked = same_primitives(effort, by).map(|all| all.allowing(LARGEST_SHARE_OF_OTHERS));
        outcome.add(Outcome::from(asked).with_context(context));
        outcome.add(no_acne(effort, by).with_context(context));
    }
    outcome
}

/// A globe, and a sphere beside it, with a white light.
fn lit_globe(effort: &Effort, mesh: &Mesh, by: DVec3) -> Value {
    let positions: Vec<_> = mesh.positions.iter().map(|p| p + by.as_vec3()).collect();
    let shapes = [scenes::mesh(&positions, &mesh.triangles, scenes::matte([1.0; 3]))];
    let light = scenes::point_light(1000.0, LIGHT + by, "none");
    scenes::scene(0, &eye(effort, by).json(), &[light], &shapes)
}

/// Compares every pixel's ray, in every way of tracing, with the scene that is not moved.
fn same_primitives(effort: &Effort, by: DVec3) -> Result<Outcome> {
    let mesh = globe(6, RADIUS, STEP);
    let unmoved = lit_globe(effort, &mesh, DVec3::ZERO);
    let unmoved = scenes::prepare(effort, &unmoved, Preset::Brute)?.scene;
    let expected = hits(&unmoved.accel, &camera_rays(&unmoved));
    let found = PRESETS.into_iter().map(|preset| {
        let scene = scenes::prepare(effort, &lit_globe(effort, &mesh, by), preset)?.scene;
        let rays = camera_rays(&scene);
        Ok(every_way(scene.accel, &rays, |i, _, hit| {
            let context = || format!("{hit:?} and unmoved {:?}", expected[i]);
            (hit.primitive != expected[i].primitive).then(context)
        }))
    });
    found.sum()
}

/// No part of a convex shape that faces the light is in its own shadow.
fn no_acne(effort: &Effort, by: DVec3) -> Outcome {
    // Closer to a face's plane than this, rounding decides whether the light is in front of it.
    let doubtful = 64.0 * f64::from(f32::EPSILON) * (by.abs().max_element() + 256.0);
    let mesh = globe(6, RADIUS, STEP);
    // Expected values are computed at the scene's original place, where the numbers are exact.
    let still = eye(effort, DVec3::ZERO);
    let on_mesh = |direction: DVec3| {
        let seen = mesh.seen(EYE, direction);
        seen.is_some_and(|triangle| mesh.height(triangle, LIGHT) > doubtful)
    };
    let mut outcome = lit_is_bright(effort, &lit_globe(effort, &mesh, by), &still, on_mesh);
    let ball = scenes::sphere(by, RADIUS, scenes::matte([1.0; 3]));
    let light = scenes::point_light(1000.0, LIGHT + by, "none");
    let scene = scenes::scene(0, &eye(effort, by).json(), &[light], &[ball]);
    let on_ball = |direction: DVec3| {
        let nearest = -EYE.dot(direction);
        let beside = RADIUS * RADIUS - (EYE + direction * nearest).length_squared();
        if beside < 1.0 {
            return false;
        }
        let point = EYE + direction * (nearest - beside.sqrt());
        point.normalize().dot(LIGHT - point) > doubtful
    };
    outcome.add(lit_is_bright(effort, &scene, &still, on_ball));
    outcome
}

/// No pixel whose direction `faces_light` is dark.
fn lit_is_bright(
    effort: &Effort,
    scene: &Value,
    eye: &Eye,
    faces_light: impl Fn(DVec3) -> bool,
) -> Outcome {
    let lit: Vec<bool> = eye.pixels().map(|(x, y)| faces_light(eye.direction(x, y))).collect();
    let mut outcome = every_image(effort, scene, &PRESETS, |rendered| {
        pixels(&rendered.film, |x, y, pixel| {
            let is_lit = lit[(y * eye.size[0] + x) as usize];
            (is_lit && pixel == [0.0; 3]).then(|| "it faces the light".to_owned())
        })
    });
    let count = lit.iter().filter(|lit| **lit).count();
    outcome.check(count >= lit.len() / 10, || format!("only {count} pixels face the light"));
    outcome
}

/// The axes of a scene's coordinates: lengths in units of `unit`, with the axes permuted by `turn`,
/// where 1 is x to y to z to x.
#[derive(Clone, Copy)]
struct Axes {
    unit: f64,
    turn: usize,
}

/// Neither scaled nor permuted.
const STILL: Axes = Axes { unit: 1.0, turn: 0 };

impl Axes {
    fn direction(self, x: f64, y: f64, z: f64) -> [f64; 3] {
        let mut turned = [x, y, z];
        turned.rotate_right(self.turn);
        turned
    }

    fn point(self, x: f64, y: f64, z: f64) -> [f64; 3] {
        self.direction(x * self.unit, y * self.unit, z * self.unit)
    }

    fn ball(self) -> Value {
        let center = self.point(1.3, 0.1, 0.4);
        json!({"type": "sphere", "center": center, "radius": 0.9 * self.unit,
               "material": shiny([0.4, 0.9, 0.4], 0.5)})
    }

    fn flat_shapes(self) -> Vec<Value> {
        let point = |x, y, z| self.point(x, y, z);
        let ball = globe(3, 1.0, 1.0 / 1024.0);
        let points = ball.positions.iter().map(|p| {
            let p = p.as_dvec3();
            point(0.8 * p.x - 1.5, 0.8 * p.y + 0.4, 0.8 * p.z + 0.3)
        });
        let normals =
            ball.positions.iter().map(|p| self.direction(p.x.into(), p.y.into(), p.z.into()));
        vec![
            json!({"type": "plane", "sides": "both", "material": shiny([0.7, 0.6, 0.5], 0.3),
                   "points": [point(-4.0, -1.0, 4.0), point(-4.0, -1.3, -4.0),
                              point(4.0, -1.3, -4.0), point(4.0, -1.0, 4.0)]}),
            json!({"type": "triangle", "sides": "both", "material": shiny([0.2, 0.7, 0.9], 0.2),
                   "points": [point(-2.0, -0.7, -2.0), point(0.3, 2.1, -2.4),
                              point(2.2, -0.9, -1.7)]}),
            json!({"type": "trimesh", "sides": "both", "material": shiny([0.9, 0.3, 0.2], 0.1),
                   "points": points.collect::<Vec<_>>(), "normals": normals.collect::<Vec<_>>(),
                   "indices": ball.triangles, "shading": "smooth"}),
        ]
    }

    /// A spherical light.
    fn bulb(self) -> Value {
        let center = self.point(0.1, 2.9, 1.7);
        let bulb = json!({"type": "sphere", "center": center, "radius": 0.2 * self.unit});
        json!({"type": "arealight", "intensity": 9.0 * self.unit, "color": [1, 1, 1],
               "sampling": "random", "samples": 3, "shape": bulb})
    }

    /// Lights that fall off with the distance or its square grow with the unit.
    fn other_lights(self) -> Vec<Value> {
        let (unit, point) = (self.unit, |x, y, z| self.point(x, y, z));
        let panel = json!({"type": "plane", "points": [point(1.0, 3.0, 0.0), point(1.0, 3.1, 1.0),
                                                       point(2.0, 3.2, 1.0), point(2.0, 3.1, 0.0)]});
        vec![
            json!({"type": "pointlight", "intensity": 30.0 * unit, "color": [1, 0.9, 0.8],
                   "position": point(-3.1, 4.3, 3.7)}),
            json!({"type": "pointlight", "intensity": 0.3, "position": point(3.1, 2.3, 2.9),
                   "color": [0.3, 0.9, 0.8], "falloff": "none"}),
            json!({"type": "arealight", "intensity": 0.9 * unit * unit, "color": [0.8, 0.9, 1.0],
                   "falloff": "inverse-square", "sampling": "jittered", "samples": 2,
                   "shape": panel}),
        ]
    }
}

fn shiny(color: [f64; 3], kr: f64) -> Value {
    json!({"ks": 0.4, "kd": 0.7, "specularexponent": 30.5, "diffusecolor": color, "kr": kr})
}

/// A scene with everything, in these axes.
fn everything(effort: &Effort, axes: Axes, has_balls: bool) -> Value {
    let (mut shapes, mut lights) = (axes.flat_shapes(), axes.other_lights());
    if has_balls {
        shapes.push(axes.ball());
        lights.push(axes.bulb());
    }
    let unit = axes.unit;
    let [width, height] = effort.either([40, 30], [100, 75]);
    json!({
        "nbounces": 4,
        "camera": {"type": "thinlens", "width": width, "height": height, "fov": 50,
                   "location": axes.point(0.4, 1.3, 6.1), "look": axes.point(0.1, 0.2, 0.0),
                   "up": axes.direction(0.1, 1.0, 0.05), "aperture": 0.1 * unit,
                   "focal": 6.0 * unit, "nsamplesx": 2, "nsamplesy": 2},
        "scene": {"backgroundcolor": scenes::BACKGROUND, "lightsources": lights, "shapes": shapes}
    })
}

/// Case 8.
pub(super) fn scaled(effort: &Effort) -> Outcome {
    let still = scenes::image(effort, &everything(effort, STILL, true), Preset::Brute);
    let mut outcome = Outcome::from(still.map(|image| same_at_every_scale(effort, &image)));
    outcome.add(turned(effort).into());
    outcome
}

fn same_at_every_scale(effort: &Effort, expected: &Film) -> Outcome {
    let mut outcome = Outcome::default();
    for k in effort.either(vec![-20, -7, 0, 20], (-20..=20).collect()) {
        let scene = everything(effort, Axes { unit: libm::exp2(f64::from(k)), ..STILL }, true);
        let images = every_image(effort, &scene, &PRESETS, |r| scenes::same(&r.film, expected));
        outcome.add(images.with_context(|| format!("scaled by 2^{k}")));
    }
    outcome
}

/// With permuted axes, every ray hits the same triangles and quads at the same t, and the image is
/// the same. Spherical lights have an axis of their own.
fn turned(effort: &Effort) -> Result<Outcome> {
    let still = everything(effort, STILL, false);
    let image = scenes::image(effort, &still, Preset::Brute)?;
    let still = scenes::prepare(effort, &still, Preset::Brute)?.scene;
    let rays = camera_rays(&still);
    let expected = hits(&still.accel, &rays);
    let mut outcome = Outcome::default();
    for turn in [1, 2] {
        let turned = |v: Vec3| {
            let mut turned = v.to_array();
            turned.rotate_right(turn);
            Vec3::from(turned)
        };
        let rays: Vec<Ray> =
            rays.iter().map(|ray| Ray::new(turned(ray.origin), turned(ray.direction))).collect();
        let turned = everything(effort, Axes { turn, ..STILL }, false);
        let images = every_image(effort, &turned, &PRESETS, |r| scenes::same(&r.film, &image));
        outcome.add(images.with_context(|| format!("axes turned by {turn}")));
        for preset in PRESETS {
            let scene = scenes::prepare(effort, &turned, preset)?.scene;
            outcome.add(every_way(scene.accel, &rays, |i, _, hit| {
                let context =
                    || format!("axes turned by {turn}: {hit:?} and not {:?}", expected[i]);
                (hit != expected[i]).then(context)
            }));
        }
    }
    Ok(outcome)
}
