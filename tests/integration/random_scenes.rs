//! Random scenes of what lies in the way of rays all at once: shapes that nest, touch, are in one place, have holes, blend,
//! bend and absorb. However such a scene is rendered, it has one image, without what is not finite; so it has in another order
//! of the file where no two surfaces are in one place, and with one more shape that nothing can meet.
//!
//! `WAVECREST_FUZZ=17 cargo test --test integration random_scenes` tries seed 17 again, and writes its scene;
//! `WAVECREST_FUZZ=0..4000` tries as many, for which the release profile is made.

use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use image::{Rgba, RgbaImage};
use rayon::prelude::*;
use serde_json::{Value, json};
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::film::Film;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::random::Stream;
use wavecrest_core::math::simd::Level;
use wavecrest_core::plan::schedule::{PASSES, Pass, UNPLANNED};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, TracerKind, render};
use wavecrest_scene::load::{LoadOptions, load_str};
use wavecrest_scene::systems::{SceneOptions, extract};

use crate::seeds::asked_for;
use crate::support::{TRACERS, both, folder, options, prepare_in, put, with};

/// The seeds of the usual run.
const USUAL: Range<u64> = 0..60;

/// More, whose scenes had several images.
const ONCE_WRONG: [u64; 1] = [2333];

/// The ball in which one more shape is hidden, and how small it is there.
const DEN: ([f64; 3], f64) = ([11.0, -9.0, 7.0], 0.1);

/// How far behind the eye one more shape is where rays that are lit by what is near cannot meet it.
const BEHIND: f64 = 60.0;

/// Numbers from 0 to 1 that follow from a seed.
struct Numbers(Stream, u32);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.1 += 1;
        f64::from(self.0.uniform(self.1)[0])
    }

    fn below(&mut self, n: u32) -> u32 {
        (self.next() * f64::from(n)) as u32
    }
}

/// Makes texts of the grammar in `random_scenes.txt`.
struct Writer {
    n: Numbers,
    /// Whether no two surfaces are in one place; else all are on a grid.
    is_general: bool,
    /// Whether no ray is mirrored or bent, or goes on for ever.
    is_plain: bool,
    /// Where the scene is along each axis.
    place: f64,
}

impl Writer {
    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.n.below(all.len() as u32) as usize]
    }

    /// A text without its signs.
    fn written(&mut self, text: &str) -> String {
        let Some(at) = text.find(['<', '$', '@', '^', '~']) else { return text.to_owned() };
        let (before, rest) = (&text[..at], &text[at + 1..]);
        let (new, rest) = if text[at..].starts_with('<') {
            let (mut depth, mut choices) = (0, Vec::new());
            let ends = |sign: char| {
                depth += i32::from(sign == '<') - i32::from(sign == '>');
                depth < 0 || depth == 0 && sign == '|'
            };
            for choice in rest.split_inclusive(ends) {
                choices.push(choice);
                if choice.ends_with('>') {
                    break;
                }
            }
            let chosen = self.of(&choices);
            let length: usize = choices.iter().map(|choice| choice.len()).sum();
            (self.written(&chosen[..chosen.len() - 1]), &rest[length..])
        } else {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '.').unwrap_or(rest.len());
            (self.word(&text[at..at + 1], &rest[..end]), &rest[end..])
        };
        format!("{before}{new}{}", self.written(rest))
    }

    /// The text for a name or a number.
    fn word(&mut self, sign: &str, word: &str) -> String {
        if sign == "$" {
            let is_left_out = ["mirror", "glass", "metal", "looking", "sun"].contains(&word);
            let line = include_str!("random_scenes.txt")
                .lines()
                .find_map(|line| line.strip_prefix(word).and_then(|line| line.strip_prefix(": ")));
            let text = if self.is_plain && is_left_out { "" } else { line.expect("a name") };
            return self.written(text);
        }
        let size: f64 = word.parse().expect("a number");
        let any = (self.n.next() * 2.0 - 1.0) * size;
        let any = if self.is_general { any } else { (any * 2.0).round() / 2.0 };
        let number = match sign {
            "~" => any.abs().max(0.5),
            "^" => self.place + any,
            _ => any,
        };
        format!("{number:?}")
    }

    fn json(&mut self, text: &str) -> Value {
        let text = self.written(text);
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
    }
}

/// What a seed gives.
struct Trial {
    json: Value,
    /// One more shape, which nothing can meet.
    unseen: Value,
    is_general: bool,
    preset: Preset,
    kernel: KernelChoice,
    level: Level,
    by: RenderOptions,
}

impl Trial {
    fn of(seed: u64) -> Self {
        let mut n = Numbers(Stream { seed, pixel: 0, sample: 0, bounce: 0 }, 0);
        let (is_general, is_plain) = (n.below(2) == 0, n.below(4) == 0);
        let mut writer = Writer { n, is_general, is_plain, place: 0.0 };
        let mut json = writer.json("$scene");
        let shapes = json["scene"]["shapes"].as_array_mut().expect("shapes");
        for shape in shapes.clone().into_iter().skip(2).filter(|_| !is_general) {
            // Copies of one material, or of some.
            let every = writer.of(&[1, 2, 5, 100]);
            let materials: Vec<Value> = (0..every).map(|_| writer.json("$material")).collect();
            for copy in 0..writer.of(&[0, 0, 0, 0, 0, 0, 0, 0, 1, 8, 36, 70]) {
                let material = materials.get(copy % every).filter(|_| every < 100);
                shapes.push(with(
                    shape.clone(),
                    "material",
                    material.unwrap_or(&shape["material"]).clone(),
                ));
            }
        }
        writer.is_plain = false;
        let at = |key: &str, i: usize| json["camera"][key][i].as_f64().expect("a coordinate");
        let back = [0, 1, 2].map(|i| at("location", i) - at("look", i));
        let length = back.map(|x| x * x).iter().sum::<f64>().sqrt();
        let place = match is_plain {
            true => json!({"translate": back.map(|x| x / length * BEHIND)}),
            false => json!({"translate": DEN.0, "scale": DEN.1}),
        };
        Self {
            unseen: with(writer.json("$shape"), "transform", place),
            json,
            is_general,
            preset: writer.of(&Preset::ALL),
            kernel: writer.of(&KernelChoice::ALL),
            level: writer.of(&Level::available()),
            by: RenderOptions {
                tracer: writer.of(&TRACERS),
                batch: writer.of(&[1, 13, 64, 1024]),
                ..options()
            },
        }
    }

    /// The scene with one more shape, or in another order.
    fn other(&self, fault: &str) -> Value {
        let mut json = self.json.clone();
        if let Some(Value::Array(shapes)) = json.pointer_mut("/scene/shapes") {
            match fault {
                "unseen" => shapes.insert(shapes.len() / 2, self.unseen.clone()),
                "order" => shapes.reverse(),
                _ => {}
            }
        }
        json
    }

    /// What changes the image of the scene and should not; nothing if it is refused.
    fn faults(&self, folder: &Path) -> Option<Vec<&'static str>> {
        let prepared = |json: &Value, passes: &'static [Pass]| -> Option<PreparedScene> {
            let file = folder.join("s.json");
            let loaded = load_str(&json.to_string(), &file, &LoadOptions::default()).ok()?;
            let options = SceneOptions { passes, ..SceneOptions::default() };
            Some(extract(loaded.world, options).ok()?.build(Preset::Fast))
        };
        let image = |scene: &PreparedScene, options: &RenderOptions| {
            render(scene, options, &()).unwrap_or_else(|error| panic!("{error}"))
        };
        let mut scene = prepared(&self.json, &PASSES)?;
        let usual = image(&scene, &options());
        let is_finite = |film: &Film| film.pixels().as_flattened().iter().all(|x| x.is_finite());
        let mut faults = Vec::new();
        if usual.counters.invalid > 0 || !is_finite(&usual.film) {
            faults.push("not finite");
        }
        let mut expect = |fault, film: Option<Film>| {
            if !film.is_some_and(|film| film.same_bits(&usual.film)) {
                faults.push(fault);
            }
        };
        let recursive = RenderOptions { tracer: TracerKind::Recursive, ..options() };
        expect("recursive", Some(image(&scene, &recursive).film));
        scene.accel.rebuild(Preset::Brute);
        expect("brute", Some(image(&scene, &options()).film));
        scene.accel.rebuild(self.preset);
        scene.accel.kernel = self.kernel;
        scene.accel.level = self.level.token().expect("it is available");
        expect("setting", Some(image(&scene, &self.by).film));
        let others = [("unplanned", &UNPLANNED), ("unseen", &PASSES), ("order", &PASSES)];
        for (fault, passes) in
            others.into_iter().filter(|(fault, _)| self.is_general || *fault != "order")
        {
            let scene = prepared(&self.other(fault), passes);
            expect(fault, scene.map(|scene| image(&scene, &options()).film));
        }
        Some(faults)
    }

    /// The faults, of which one may be that there is no image at all.
    fn tried(&self, folder: &Path) -> Option<Vec<&'static str>> {
        catch_unwind(AssertUnwindSafe(|| self.faults(folder))).unwrap_or(Some(vec!["panic"]))
    }
}

/// Writes the images that the grammar names.
fn put_pictures(folder: &Path) {
    let save = |name: &str, texel: fn(u32, u32) -> [u8; 4]| {
        let image = RgbaImage::from_fn(4, 4, |x, y| Rgba(texel(x, y)));
        image.save(folder.join(name)).expect("an image");
    };
    save("holes.png", |x, y| [200, 90, 255, if (x + y) % 2 == 0 { 255 } else { 0 }]);
    save("ramp.png", |x, y| [80 * x as u8, 60 * y as u8, 99, 15 * (x + 4 * y) as u8]);
}

#[test]
fn random_scenes_have_one_image() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("random-scenes");
    std::fs::create_dir_all(&folder).expect("a folder");
    put_pictures(&folder);
    let mut seeds: Vec<u64> = asked_for(USUAL).collect();
    if seeds.len() > 1 {
        seeds.extend(ONCE_WRONG);
    }
    let asked = seeds.len();
    let found = seeds.into_par_iter().filter_map(|seed| {
        let trial = Trial::of(seed);
        let faults = trial.tried(&folder)?;
        let Some(fault) = faults.first() else { return Some(None) };
        for (name, json) in [("scene", &trial.json), ("other", &trial.other(fault))] {
            put(&folder, &format!("{seed}-{name}.json"), format!("{json:#}"));
        }
        let Trial { preset, kernel, level, by, .. } = trial;
        Some(Some(format!("{seed}: {faults:?}; {preset:?}, {kernel:?}, {level:?}, {by:?}")))
    });
    let found: Vec<Option<String>> = found.collect();
    assert!(found.len() * 10 > asked * 8, "only {} of {asked} are tried", found.len());
    let faults: Vec<&str> = found.iter().flatten().map(String::as_str).collect();
    assert!(faults.is_empty(), "in {}:\n{}", folder.display(), faults.join("\n"));
}

/// A scene of a few shapes and lights all around the eye, near the origin or far from it.
fn around_the_eye(seed: u64) -> Value {
    let mut n = Numbers(Stream { seed, pixel: 1, sample: 0, bounce: 0 }, 0);
    let place = [0.0, 0.0, 5_000.0][n.below(3) as usize];
    Writer { n, is_general: true, is_plain: false, place }.json("$around")
}

/// Neither does leaving it out, in any frame and precision.
#[test]
fn what_is_out_of_view_changes_no_bit_of_any_scene() {
    let folder = folder();
    put_pictures(folder.path());
    let is_left_out = |seed: &u64| {
        let json = around_the_eye(*seed);
        let precision = Precision::ALL[*seed as usize % Precision::ALL.len()];
        let [mut planned, mut all] = [&PASSES, &UNPLANNED].map(|passes| {
            prepare_in(
                folder.path(),
                &json,
                SceneOptions { passes, precision, ..SceneOptions::default() },
            )
        });
        let frames = planned.path.as_ref().map_or(0..=0, |path| path.frames());
        for frame in frames {
            for scene in [&mut planned, &mut all] {
                let moved = scene.path.as_ref().and_then(|path| path.at(frame));
                scene.camera = moved.unwrap_or(scene.camera);
            }
            let [found, expected] = [both(&planned), both(&all)];
            for (found, expected) in found.iter().zip(&expected) {
                let same = found.film.same_bits(&expected.film);
                assert!(same, "{seed}, {precision:?}, frame {frame}: {json}");
            }
        }
        planned.plan.decisions().iter().any(|decision| decision.reason.contains("in view"))
    };
    let left_out = (0..600).into_par_iter().filter(is_left_out).count();
    assert!(left_out > 100, "{left_out}");
}
