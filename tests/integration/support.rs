//! Loading, rendering and running the command.

mod files;

use std::cell::OnceCell;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::{Value, json};
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::film::Film;
use wavecrest_core::plan::Effect;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, TracerKind, render};
use wavecrest_scene::load::{LoadOptions, LoadedScene, load, load_str};
use wavecrest_scene::systems::{self, Extracted, SceneOptions};

pub(crate) use files::*;

/// Both tracers.
pub(crate) const TRACERS: [TracerKind; 2] = [TracerKind::Wavefront, TracerKind::Recursive];

/// When a test began to use these helpers, and its name: the harness runs each in a thread of its own.
struct Timed(Instant, Option<String>);

impl Drop for Timed {
    fn drop(&mut self) {
        if let (Some(file), Some(test)) = (std::env::var_os("WAVECREST_TEST_TIMES"), &self.1) {
            let line = format!("{:.1} s  {test}\n", self.0.elapsed().as_secs_f64());
            let file = std::fs::OpenOptions::new().create(true).append(true).open(file);
            // A file that cannot be written fails no test.
            let _ = file.and_then(|mut file| file.write_all(line.as_bytes()));
        }
    }
}

/// Begins to time a test, once in each.
fn begin() {
    let begun = || Timed(Instant::now(), std::thread::current().name().map(str::to_owned));
    thread_local!(static TIMED: OnceCell<Timed> = const { OnceCell::new() });
    TIMED.with(|timed| _ = timed.get_or_init(begun));
}

/// A file or folder of the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    begin();
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The files in a folder of the repository with this extension, in the order of their names.
pub(crate) fn files_in(folder: &str, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(repository(folder)).expect("the folder is there");
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .collect();
    files.sort();
    files
}

/// Every scene of `scenes/` and `scenes/hard/`, each with a name of its own. Those of
/// `scenes/large/` need meshes that have to be generated first.
pub(crate) fn scene_files() -> Vec<(String, PathBuf)> {
    let named = |prefix: &str, folder: &str| -> Vec<(String, PathBuf)> {
        let name = |path: &Path| format!("{prefix}{}", stem(path));
        files_in(folder, "json").into_iter().map(|path| (name(&path), path)).collect()
    };
    let mut scenes = named("", "scenes");
    scenes.extend(named("hard-", "scenes/hard"));
    assert!(scenes.len() > 30, "scenes/ holds {} scenes only", scenes.len());
    scenes
}

/// The name of a file without its extension.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().expect("a file name").to_string_lossy().into_owned()
}

/// A scene file at a size that a test can afford: its own shape, its longest side at most `longest` pixels, and no more
/// than `most_rays` rays, which scenes with thousands of samples reach in a few pixels.
pub(crate) fn load_small(path: &Path, longest: u32, most_rays: u64) -> LoadedScene {
    let read =
        |options: LoadOptions| load(path, &options).unwrap_or_else(|error| panic!("{error}"));
    let first = extract(Ok(read(LoadOptions::default())), SceneOptions::default());
    let first = first.unwrap_or_else(|error| panic!("{error}"));
    let [width, height] = first.scene().camera.size();
    let rays_a_pixel =
        first.scene().expected_rays() as f64 / (f64::from(width) * f64::from(height));
    let longest_affordable = (most_rays as f64 / rays_a_pixel).sqrt();
    let scale = f64::from(longest).min(longest_affordable) / f64::from(width.max(height));
    let side = |length: u32| Some(((f64::from(length) * scale.min(1.0)).round() as u32).max(1));
    let (width, height) = (side(width), side(height));
    let allow_outside = true;
    read(LoadOptions { width, height, allow_outside, strict: true, ..LoadOptions::default() })
}

/// The same made ready, but for its tree.
pub(crate) fn extract_small(path: &Path, longest: u32, most_rays: u64) -> Extracted {
    let extracted = extract(Ok(load_small(path, longest, most_rays)), SceneOptions::default());
    extracted.unwrap_or_else(|error| panic!("{error}"))
}

fn extract(loaded: Result<LoadedScene>, options: SceneOptions) -> Result<Extracted> {
    systems::extract(loaded?.world, options)
}

/// What was loaded, made ready.
pub(crate) fn ready(loaded: Result<LoadedScene>) -> PreparedScene {
    ready_by(loaded, SceneOptions::default())
}

/// The same with these options.
pub(crate) fn ready_by(loaded: Result<LoadedScene>, options: SceneOptions) -> PreparedScene {
    extract(loaded, options).unwrap_or_else(|error| panic!("{error}")).build(Preset::Fast)
}

/// What was loaded, made ready, or what is wrong with it.
pub(crate) fn try_ready(loaded: Result<LoadedScene>) -> Result<PreparedScene> {
    Ok(extract(loaded, SceneOptions::default())?.build(Preset::Fast))
}

/// A scene written in a test, made ready. Relative paths start from the repository.
pub(crate) fn prepare(scene: &Value) -> PreparedScene {
    prepare_in(&repository(""), scene, SceneOptions::default())
}

/// A scene whose files are in `folder`, made ready.
pub(crate) fn prepare_in(folder: &Path, scene: &Value, options: SceneOptions) -> PreparedScene {
    let file = folder.join("s.json");
    ready_by(load_str(&scene.to_string(), &file, &LoadOptions::default()), options)
}

/// A scene that is said to be at `file`, made ready, or what is wrong with it.
pub(crate) fn try_prepare(scene: &Value, file: &Path) -> Result<PreparedScene> {
    try_ready(load_str(&scene.to_string(), file, &LoadOptions::default()))
}

/// Renders on a pool of `threads` threads.
pub(crate) fn render_on(
    threads: usize,
    scene: &PreparedScene,
    options: &RenderOptions,
) -> Rendered {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let rendered = pool.install(|| render(scene, options, &()));
    rendered.unwrap_or_else(|error| panic!("{error}"))
}

/// Renders with both tracers, checks that they agree to the last bit, and returns one image.
pub(crate) fn image(scene: &Value) -> Film {
    image_of(&prepare(scene), 0)
}

/// As [`image()`], of a scene that is ready, with other random numbers.
pub(crate) fn image_of(scene: &PreparedScene, seed: u64) -> Film {
    let [wavefront, recursive] =
        TRACERS.map(|tracer| render_on(1, scene, &RenderOptions { tracer, seed, ..options() }));
    assert!(wavefront.film.same_bits(&recursive.film), "the tracers disagree");
    assert_eq!(wavefront.counters.invalid, 0, "samples are not finite");
    wavefront.film
}

/// Renders with both tracers in batches of a size that is no multiple of a vector.
pub(crate) fn both(scene: &PreparedScene) -> [Rendered; 2] {
    TRACERS.map(|tracer| {
        let options = RenderOptions { tracer, batch: ODD, ..options() };
        render(scene, &options, &()).unwrap_or_else(|error| panic!("{error}"))
    })
}

/// As [`both`], on one thread: how many threads have columns is left to chance.
pub(crate) fn both_alone(scene: &PreparedScene) -> [Rendered; 2] {
    TRACERS.map(|tracer| render_on(1, scene, &RenderOptions { tracer, batch: ODD, ..options() }))
}

/// The size of the batches of [`both`].
pub(crate) const ODD: usize = 29;

/// Whether an effect is in the plan of a scene, and why.
pub(crate) fn reason(scene: &PreparedScene, effect: Effect) -> (bool, &str) {
    let found = scene.plan.decisions().iter().find(|decision| decision.effect == effect);
    found.map(|found| (found.present, found.reason.as_str())).expect("a decision")
}

/// The options of a render that nothing is asked of.
pub(crate) fn options() -> RenderOptions {
    begin();
    RenderOptions::default()
}

/// The pixel in column `x` and row `y`.
pub(crate) fn pixel(film: &Film, x: u32, y: u32) -> [f64; 3] {
    film.pixel(x, y).expect("a pixel of the image").map(f64::from)
}

/// The greatest difference of two values of images of one size.
pub(crate) fn difference(a: &Film, b: &Film) -> f32 {
    let pairs = a.pixels().as_flattened().iter().zip(b.pixels().as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// How alike two images are: `yes`, to the last bit; within the least power of ten that their values differ by; or `no`.
pub(crate) fn likeness(a: &Film, b: &Film) -> String {
    if a.same_bits(b) {
        return "yes".to_owned();
    }
    let worst = f64::from(difference(a, b));
    let power = (-6..=-2).find(|&power| worst <= 10_f64.powi(power));
    power.map_or("no".to_owned(), |power| format!("within 1e{power}"))
}

/// Every place of an image, row by row.
pub(crate) fn places(width: u32, height: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// Checks that three values are within `tolerance` of three others.
#[track_caller]
pub(crate) fn assert_near(found: [f64; 3], expected: [f64; 3], tolerance: f64, what: &str) {
    let near = |(a, b): (f64, f64)| (a - b).abs() <= tolerance;
    let all_near = found.into_iter().zip(expected).all(near);
    assert!(all_near, "{what}: {found:?} is not within {tolerance} of {expected:?}");
}

/// The background of the scenes that [`scene()`] makes: a colour that no surface in them has.
pub(crate) const BACKGROUND: [f64; 3] = [0.125, 0.25, 0.5];

/// A scene of these parts.
pub(crate) fn scene(bounces: u32, camera: &Value, lights: &[Value], shapes: &[Value]) -> Value {
    json!({
        "nbounces": bounces,
        "camera": camera,
        "scene": {"backgroundcolor": BACKGROUND, "lightsources": lights, "shapes": shapes}
    })
}

/// A scene of shapes that show their own colour or texture, whatever lights them.
pub(crate) fn plain(bounces: u32, camera: &Value, shapes: &[Value]) -> Value {
    let dark = point_light(0.0, [0.0, 9.0, 9.0], [1.0; 3]);
    edited(scene(bounces, camera, &[dark], shapes), "/scene/ambient 1")
}

/// A pinhole camera on +z that looks at the origin with +y up.
pub(crate) fn pinhole(size: [u32; 2], fov: f64, distance: f64) -> Value {
    json!({
        "type": "pinhole", "width": size[0], "height": size[1], "fov": fov,
        "location": [0.0, 0.0, distance], "look": [0.0, 0.0, 0.0]
    })
}

/// A pinhole camera with a lens of this aperture, focused at `focal`, with so many points across and down.
pub(crate) fn thin_lens(camera: Value, aperture: f64, focal: f64, [x, y]: [u32; 2]) -> Value {
    let camera = with(with(camera, "type", "thinlens"), "aperture", aperture);
    with(with(with(camera, "focal", focal), "nsamplesx", x), "nsamplesy", y)
}

/// A point light.
pub(crate) fn point_light(intensity: f64, position: [f64; 3], color: [f64; 3]) -> Value {
    json!({"type": "pointlight", "intensity": intensity, "position": position, "color": color})
}

/// A material without highlight or mirror.
pub(crate) fn matte(kd: f64, color: [f64; 3]) -> Value {
    json!({"ks": 0.0, "kd": kd, "specularexponent": 1.0, "diffusecolor": color})
}

/// A sphere.
pub(crate) fn sphere(center: [f64; 3], radius: f64, material: Value) -> Value {
    json!({"type": "sphere", "center": center, "radius": radius, "material": material})
}

/// A square about the origin in the plane z = `z`, whose front is seen from +z.
pub(crate) fn wall(half: f64, z: f64, material: Value) -> Value {
    let points = [[-half, -half, z], [-half, half, z], [half, half, z], [half, -half, z]];
    json!({"type": "plane", "points": points, "material": material})
}

/// `value` with `key` set.
pub(crate) fn with(mut value: Value, key: &str, to: impl Into<Value>) -> Value {
    value[key] = to.into();
    value
}

/// `value` with the members of `more`.
pub(crate) fn merged(mut value: Value, more: &Value) -> Value {
    for (key, new) in more.as_object().expect("an object") {
        value[key] = new.clone();
    }
    value
}

/// `value` with other values at some places: a line for each, a JSON pointer and what comes there, or nothing to take
/// away what is there. The last member of a place may be new, and `-` is the end of a list.
pub(crate) fn edited(mut value: Value, changes: &str) -> Value {
    for change in changes.lines() {
        let (place, new) = change.split_once(' ').unwrap_or((change, "null"));
        let new = serde_json::from_str(new).unwrap_or_else(|error| panic!("{change}: {error}"));
        let (parent, key) = place.rsplit_once('/').expect("a place");
        let number = || key.parse::<usize>().expect("a number");
        match value.pointer_mut(parent).unwrap_or_else(|| panic!("{change}: no such place")) {
            Value::Object(members) if place == change => drop(members.shift_remove(key)),
            Value::Array(items) if place == change => drop(items.remove(number())),
            Value::Array(items) if key == "-" => items.push(new),
            Value::Array(items) => items[number()] = new,
            parent => parent[key] = new,
        }
    }
    value
}

/// `value` edited as the lines say: with those that begin with `+`, and with those that begin with `-` instead.
pub(crate) fn alternatives(value: &Value, changes: &str) -> [Value; 2] {
    ["+ ", "- "].map(|mark| {
        let is_other = |line: &&str| !line.starts_with(['+', '-']);
        let lines = changes
            .lines()
            .filter_map(|line| line.strip_prefix(mark).or_else(|| Some(line).filter(is_other)));
        edited(value.clone(), &lines.collect::<Vec<_>>().join("\n"))
    })
}
