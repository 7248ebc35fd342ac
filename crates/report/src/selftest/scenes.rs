//! Scenes made in code, and their images with every tracer, batch size and instruction level.

use super::prelude::*;
pub(super) use crate::patch::with;
use wavecrest_core::film::Film;
use wavecrest_core::math::simd::Level;
use wavecrest_core::plan::schedule::{PASSES, unplanned};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{self, RenderOptions, Rendered, TracerKind};
use wavecrest_scene::load::{LoadOptions, load_str};
use wavecrest_scene::systems;

/// A prepared scene with its warnings, one after another.
pub(super) struct WarnedScene {
    pub(super) scene: PreparedScene,
    pub(super) warnings: String,
}

fn prepare_by(options: systems::Options<'_>, json: &str) -> Result<WarnedScene> {
    let loaded = load_str(json, "scene.json".as_ref(), &LoadOptions::default())?;
    let extracted = systems::extract(loaded.world, options)?;
    let file = extracted.file().to_owned();
    let scene = extracted.build(Preset::VeryFast);
    let more = systems::warnings(&scene, &file);
    let warnings = loaded.warnings.iter().chain(&more).map(ToString::to_string).collect();
    Ok(WarnedScene { scene, warnings })
}

/// The prepared `scene`.
pub(super) fn prepare(effort: &Effort, scene: &Value) -> Result<WarnedScene> {
    let options = systems::Options { precision: effort.precision, ..Default::default() };
    prepare_by(options, &scene.to_string())
}

/// The prepared `scene` with all of its shapes: for rays from anywhere, and not from its camera alone.
pub(super) fn prepare_whole(effort: &Effort, scene: &Value) -> Result<WarnedScene> {
    let passes = unplanned(&PASSES);
    let precision = effort.precision;
    let options = systems::Options { precision, passes: &passes, ..Default::default() };
    prepare_by(options, &scene.to_string())
}

/// Whether a scene is refused with an error of this kind that contains these words.
pub(super) fn refused(text: &str, kind: ErrorKind, named: &str) -> Outcome {
    let error = prepare_by(systems::Options::default(), text).err();
    let said = error.as_ref().map(ToString::to_string).unwrap_or_default();
    let is_right = error.is_some_and(|error| error.kind() == kind) && said.contains(named);
    Outcome::of(is_right, || format!("{said:?} does not name {named} of {text}"))
}

/// Whether a scene is read, but refused at this path.
pub(super) fn refused_at(scene: &Value, path: &str) -> Outcome {
    refused(&scene.to_string(), ErrorKind::Scene, path)
}

/// Ways to render, which must not change the image: both tracers, on one thread and on several, in
/// batches of the default size and in small ones that are not a multiple of a vector.
const WAYS: [(TracerKind, usize, usize); 4] = [
    (TracerKind::Wavefront, 1, 1024),
    (TracerKind::Wavefront, 3, 13),
    (TracerKind::Recursive, 1, 1024),
    (TracerKind::Recursive, 2, 1024),
];

fn render(
    effort: &Effort,
    scene: &PreparedScene,
    (tracer, threads, batch): (TracerKind, usize, usize),
) -> Result<Rendered> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| Error::new(ErrorKind::Usage, "no threads").because(error))?;
    let options = RenderOptions { tracer, seed: effort.seed, batch, ..Default::default() };
    pool.install(|| render::render(scene, &options, &()))
}

/// The image of `scene` by brute force.
pub(super) fn by_brute_force(effort: &Effort, scene: &Value) -> Result<Film> {
    let mut scene = prepare(effort, scene)?.scene;
    scene.accel.rebuild(Preset::Brute);
    Ok(render(effort, &scene, WAYS[0])?.film)
}

/// Renders a scene in every way at all instruction levels, and checks each image.
pub(super) fn every_way_to_render(
    effort: &Effort,
    mut scene: PreparedScene,
    judge: &dyn Fn(&Rendered) -> Outcome,
) -> Outcome {
    let mut outcome = Outcome::default();
    for level in Level::available() {
        let Some(token) = level.token() else { continue };
        scene.accel.level = token;
        for way in WAYS {
            let judged = render(effort, &scene, way).map(|rendered| judge(&rendered));
            let context = || format!("{} {way:?}", level.name());
            outcome.add(Outcome::from(judged).with_context(context));
        }
    }
    outcome
}

/// Checks an image: its pixels are finite, show what they must, and are those of `like`, if there
/// is one. Only pixels that are known count as tested.
pub(super) fn judged(rendered: &Rendered, picture: &Picture, like: Option<&Film>) -> Outcome {
    let Rendered { film, counters, .. } = rendered;
    let mut outcome = Outcome::default();
    for (index, &pixel) in (0_u32..).zip(film.pixels()) {
        let (x, y) = (index % film.width(), index / film.width());
        let like = like.and_then(|like| like.pixel(x, y));
        let known = (picture.shows)(x, y, pixel);
        let is_same = like.is_none_or(|like| like.map(f32::to_bits) == pixel.map(f32::to_bits));
        let is_right = pixel.iter().all(|value| value.is_finite()) && is_same;
        if known.is_some() || like.is_some() || !is_right {
            outcome.check(is_right && known != Some(false), || {
                let other = like.map_or(String::new(), |like| format!(" and not {like:?}"));
                format!("pixel ({x}, {y}) is {pixel:?}{other}")
            });
        }
    }
    let counts = [counters.invalid, counters.lights_at_surface];
    let is_right = counts[0] == 0 && picture.at_surface.is_none_or(|count| counts[1] == count);
    outcome.check(is_right, || format!("{counts:?} invalid samples and lights at a surface"));
    outcome
}

/// A pinhole camera, with the directions of its rays in double precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eye {
    pub(super) location: DVec3,
    pub(super) look: DVec3,
    pub(super) up: DVec3,
    /// Degrees across the shorter side.
    pub(super) fov: f64,
    pub(super) size: [u32; 2],
}

impl Eye {
    /// A camera that looks at the origin, with y up.
    pub(super) fn at(location: DVec3, fov: f64, size: [u32; 2]) -> Self {
        Self { location, look: DVec3::ZERO, up: DVec3::Y, fov, size }
    }

    /// A camera above the origin, which its centre pixel sees if `side` is odd; rows of pixels are
    /// then on the axes.
    pub(super) fn above(fov: f64, side: u32) -> Self {
        Self { up: DVec3::Z, ..Self::at(DVec3::Y * 5.0, fov, [side; 2]) }
    }

    /// The direction through the centre of a pixel, of unit length.
    pub(super) fn direction(&self, x: u32, y: u32) -> DVec3 {
        let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let [width, height] = self.size.map(f64::from);
        let forward = (self.look - self.location).normalize();
        let right = forward.cross(self.up).normalize();
        let up = right.cross(forward);
        let edge = 2.0 * libm::tan(self.fov.to_radians() / 2.0) / width.min(height);
        let (across, upward) = ((x - width / 2.0) * edge, (height / 2.0 - y) * edge);
        (forward + right * across + up * upward).normalize()
    }

    /// Where a direction meets the plane y = 0.
    pub(super) fn on_floor(&self, direction: DVec3) -> DVec3 {
        self.location - direction * (self.location.y / direction.y)
    }
}

/// The default background: no surface has this colour.
pub(super) const BACKGROUND: [f64; 3] = [0.125, 0.25, 0.5];

/// A scene with these parts, without bounces and ambient light: unlit points are black.
pub(super) fn scene(eye: &Eye, lights: &[Value], shapes: &[Value]) -> Value {
    json!({
        "nbounces": 0,
        "camera": {"type": "pinhole", "width": eye.size[0], "height": eye.size[1], "fov": eye.fov,
                   "location": eye.location.to_array(), "look": eye.look.to_array(),
                   "up": eye.up.to_array()},
        "scene": {"backgroundcolor": BACKGROUND, "ambient": 0, "lightsources": lights,
                  "shapes": shapes}
    })
}

/// A white point light.
pub(super) fn point_light(intensity: f64, position: DVec3, falloff: &str) -> Value {
    json!({"type": "pointlight", "intensity": intensity, "position": position.to_array(),
           "color": [1, 1, 1], "falloff": falloff})
}

/// A material without highlight or mirror.
pub(super) fn matte(color: [f64; 3]) -> Value {
    json!({"ks": 0, "kd": 0.8, "specularexponent": 1, "diffusecolor": color})
}

/// A white one.
pub(super) fn white() -> Value {
    matte([1.0; 3])
}

/// A sphere.
pub(super) fn sphere(center: DVec3, radius: f64, material: Value) -> Value {
    json!({"type": "sphere", "center": center.to_array(), "radius": radius, "material": material})
}

/// A plane, lit from both sides.
pub(super) fn plane(points: [DVec3; 4], material: Value) -> Value {
    json!({"type": "plane", "points": points.map(|p| p.to_array()), "sides": "both",
           "material": material})
}

/// The parallelogram with this centre and these half sides.
pub(super) fn square([center, u, v]: [DVec3; 3], material: Value) -> Value {
    plane([center - u - v, center - u + v, center + u + v, center + u - v], material)
}

/// A part of the plane y = 0, up to `half` along both axes, seen from its front: u grows along z and v
/// along x.
pub(super) fn floor(half: f64, material: Value) -> Value {
    square([DVec3::ZERO, DVec3::Z * half, DVec3::X * half], material)
}

/// A mesh, lit from both sides.
pub(super) fn mesh(points: &[DVec3], triangles: &[[u32; 3]], material: Value) -> Value {
    let points: Vec<[f64; 3]> = points.iter().map(|p| p.to_array()).collect();
    json!({"type": "trimesh", "points": points, "indices": triangles, "sides": "both",
           "material": material})
}
