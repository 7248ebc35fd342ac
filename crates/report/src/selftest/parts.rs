//! The parts of a case, as data, and what runs them.
//!
//! A part makes inputs from random numbers, each with the answer that follows from its
//! construction: a world of primitives with rays and what they must meet; a scene and what its
//! pixels must show; a scene that must be refused; or a value of a kernel. The runners ask every
//! kernel, instruction level, preset and tracer, and count what is wrong.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;
use serde_json::Value;

use super::case::{Effort, Outcome};
use super::numbers::Numbers;
use super::scenes::{self, Prepared};
use super::ways::{RAYS_OF_A_TASK, blocks, hits_of, in_order, with_every_kernel};
use wavecrest_base::error::{ErrorKind, Result};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, Hit, KernelChoice};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::math::ray::Ray;

/// A part of a case.
#[derive(Clone, Copy, Debug)]
pub(super) enum Part {
    /// Worlds, and the number of rays in all of them together, in full.
    Rays(usize, usize, fn(&mut Numbers) -> World),
    /// The number of inputs in full, and what a kernel answers to each.
    Values(usize, fn(&mut Numbers) -> Outcome),
    /// The numbers of inputs, quick and in full, and the images of each.
    Images([usize; 2], fn(&mut Numbers) -> Vec<Picture>),
    /// The number of inputs in full, and a scene of each that must be refused.
    Refused(usize, fn(&mut Numbers) -> Refusal),
    /// What is none of these.
    Own(fn(&Effort) -> Outcome),
}

impl Part {
    /// Runs part number `part` of the case with that number.
    pub(super) fn run(self, effort: &Effort, case: u32, part: u32) -> Outcome {
        let numbers = |place: u32, n| Numbers::new(effort, [case, part << 16 | place], n);
        let each = |count, ask: &(dyn Fn(&mut Numbers) -> Outcome + Sync)| {
            in_order(blocks(count, RAYS_OF_A_TASK).map(|block| {
                let one = |n| ask(&mut numbers(0, n)).with_context(|| format!("input {n}"));
                block.map(one).sum()
            }))
        };
        match self {
            Self::Rays(worlds, rays, make) => {
                let of_world = |n: usize| {
                    let world = make(&mut numbers(0, n));
                    let rays = (0..effort.of(rays) / worlds).into_par_iter();
                    let aimed = rays.filter_map(|i| (world.aim)(&mut numbers(1 + n as u32, i)));
                    let outcome = world.traced(effort, aimed.collect());
                    outcome.with_context(|| format!("world {n}"))
                };
                in_order((0..worlds).into_par_iter().map(of_world))
            }
            Self::Values(count, value) => each(effort.of(count), &value),
            Self::Images([quick, full], pictures) => {
                let of_input = |n| {
                    let all = pictures(&mut numbers(0, n));
                    let shown = all.iter().map(|picture| picture.shown(effort));
                    shown.sum::<Outcome>().with_context(|| format!("input {n}"))
                };
                in_order((0..effort.either(quick, full)).into_par_iter().map(of_input))
            }
            Self::Refused(count, refusal) => {
                // At least once around the list of a part that has one.
                let count = effort.of(count).max(count.min(LISTED));
                each(count, &|numbers| refusal(numbers).tried(effort))
            }
            Self::Own(run) => run(effort),
        }
    }
}

/// The most scenes of a list of those that must be refused.
const LISTED: usize = 32;

/// Whether the hit of a ray is right; `None` if that is open.
type Judge = dyn Fn(&Ray, Hit) -> Option<bool> + Send + Sync;

/// What a ray must meet.
#[derive(Clone)]
pub(super) enum Expected {
    Nothing,
    /// One of these primitives, at a t in this range.
    Hit {
        of: Range<u32>,
        t: [f64; 2],
    },
    /// Whatever this says.
    Such(Arc<Judge>),
}

impl Expected {
    /// Anything.
    pub(super) const ANYTHING: Self =
        Self::Hit { of: 0..u32::MAX, t: [f64::NEG_INFINITY, f64::INFINITY] };

    /// Anything up to `t`.
    pub(super) fn until(t: f64) -> Self {
        Self::Hit { of: 0..u32::MAX, t: [f64::NEG_INFINITY, t] }
    }

    /// Anything at most `off` from `t`.
    pub(super) fn near(t: f64, off: f64) -> Self {
        Self::Hit { of: 0..u32::MAX, t: [t - off, t + off] }
    }

    /// One of these primitives.
    pub(super) fn of(of: Range<u32>) -> Self {
        Self::Hit { of, t: [f64::NEG_INFINITY, f64::INFINITY] }
    }

    /// This primitive at this t, to the last bit.
    pub(super) fn exactly(hit: Hit) -> Self {
        let t = f64::from(hit.t);
        if hit.is_miss() {
            return Self::Nothing;
        }
        Self::Hit { of: hit.primitive..hit.primitive + 1, t: [t; 2] }
    }

    /// Whatever `judge` says.
    pub(super) fn such(judge: impl Fn(&Ray, Hit) -> Option<bool> + Send + Sync + 'static) -> Self {
        Self::Such(Arc::new(judge))
    }

    fn judge(&self, ray: &Ray, hit: Hit) -> Option<bool> {
        match self {
            Self::Nothing => Some(hit.is_miss()),
            Self::Hit { of, t: [low, high] } => {
                let t = f64::from(hit.t);
                Some(of.contains(&hit.primitive) && t >= *low && t <= *high)
            }
            Self::Such(judge) => judge(ray, hit),
        }
    }
}

impl fmt::Debug for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => write!(f, "nothing"),
            Self::Hit { of, t } => write!(f, "one of {of:?} at {t:?}"),
            Self::Such(_) => write!(f, "what the construction says"),
        }
    }
}

/// A ray of an input, and what it must meet; `None` for inputs that are skipped.
type Aim = Box<dyn Fn(&mut Numbers) -> Option<(Ray, Expected)> + Send + Sync>;

/// Primitives, and rays at them.
pub(super) struct World {
    geometry: Geometry,
    presets: &'static [Preset],
    /// Whether the hits of every tree must also be those of brute force.
    like_brute_force: bool,
    aim: Aim,
    /// Why there is no world.
    failure: Option<String>,
}

impl World {
    /// With a tree of each of these presets. Brute force, which is slow, gets a tenth of the rays.
    pub(super) fn new(
        geometry: Geometry,
        presets: &'static [Preset],
        aim: impl Fn(&mut Numbers) -> Option<(Ray, Expected)> + Send + Sync + 'static,
    ) -> Self {
        Self { geometry, presets, like_brute_force: false, aim: Box::new(aim), failure: None }
    }

    /// The world of a scene, with the rays that `aim` makes for it.
    pub(super) fn of_scene<A>(
        prepared: Result<Prepared>,
        presets: &'static [Preset],
        aim: impl FnOnce(&Prepared) -> A,
    ) -> Self
    where
        A: Fn(&mut Numbers) -> Option<(Ray, Expected)> + Send + Sync + 'static,
    {
        match prepared {
            Ok(prepared) => {
                let aim = aim(&prepared);
                Self::new(prepared.scene.accel.geometry().clone(), presets, aim)
            }
            Err(error) => {
                let none = Self::new(Geometry::default(), &[], |_| None);
                Self { failure: Some(error.to_string()), ..none }
            }
        }
    }

    /// Where every kernel and tree must have the hits of the reference by brute force.
    pub(super) fn like_brute_force(
        geometry: Geometry,
        presets: &'static [Preset],
        ray: impl Fn(&mut Numbers) -> Option<Ray> + Send + Sync + 'static,
    ) -> Self {
        let aim = move |numbers: &mut Numbers| Some((ray(numbers)?, Expected::Nothing));
        Self { like_brute_force: true, ..Self::new(geometry, presets, aim) }
    }

    fn traced(&self, effort: &Effort, mut aimed: Vec<(Ray, Expected)>) -> Outcome {
        let mut outcome = Outcome::default();
        if let Some(failure) = &self.failure {
            outcome.check(false, || failure.clone());
        }
        if self.like_brute_force {
            let rays: Vec<Ray> = aimed.iter().map(|(ray, _)| *ray).collect();
            let mut accel = effort.accel(self.geometry.clone(), Preset::Brute);
            accel.kernel = KernelChoice::Reference;
            for ((_, expected), hit) in aimed.iter_mut().zip(hits_of(&accel, &rays)) {
                *expected = Expected::exactly(hit);
            }
        }
        for &preset in self.presets {
            let mut accel = effort.accel(self.geometry.clone(), preset);
            let step = if preset == Preset::Brute { 10 } else { 1 };
            let asked = aimed.iter().step_by(step).cloned();
            let (rays, expected): (Vec<_>, Vec<_>) = asked.unzip();
            let ask = |accel: &Accel| {
                let all = rays.par_chunks(RAYS_OF_A_TASK).zip(expected.par_chunks(RAYS_OF_A_TASK));
                in_order(all.map(|(rays, expected)| ask(accel, rays, expected)))
            };
            let asked = with_every_kernel(&mut accel, ask);
            outcome.add(asked.with_context(|| preset.name().to_owned()));
        }
        outcome
    }
}

/// Checks the closest hits of these rays, and that what is hit blocks shadow rays.
fn ask(accel: &Accel, rays: &[Ray], expected: &[Expected]) -> Outcome {
    let (mut hits, mut blocked) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
    let mut traversal = accel.traversal();
    accel.closest_of(rays, &mut hits, &mut traversal);
    accel.occluded_of(rays, &mut blocked, &mut traversal);
    let mut outcome = Outcome::default();
    for (i, (ray, &hit)) in rays.iter().zip(&hits).enumerate() {
        if let Some(is_right) = expected[i].judge(ray, hit) {
            outcome.check(is_right, || format!("{ray}: {hit:?} and not {:?}", expected[i]));
        }
        outcome.check(blocked[i] != hit.is_miss(), || {
            format!("{ray}: {hit:?}, but as a shadow ray {}", blocked[i])
        });
    }
    outcome
}

/// Whether the pixel in this column and row is right; `None` if that is open.
type Shows = Box<dyn Fn(u32, u32, [f32; 3]) -> Option<bool> + Send + Sync>;

/// A scene, and what its image must show.
pub(super) struct Picture {
    pub(super) scene: Value,
    /// For each of these the scene is built and rendered anew.
    pub(super) presets: &'static [Preset],
    pub(super) shows: Shows,
    /// The scene that has the same image, by brute force.
    pub(super) like: Option<Value>,
    /// The number of lights that are at a surface; `None` if that is open.
    pub(super) at_surface: Option<u64>,
    /// Whether to keep what nobody sees.
    pub(super) whole: bool,
}

impl Picture {
    /// Each pixel is as `shows` says.
    pub(super) fn new(
        scene: Value,
        shows: impl Fn(u32, u32, [f32; 3]) -> Option<bool> + Send + Sync + 'static,
    ) -> Self {
        let (shows, presets): (Shows, _) = (Box::new(shows), &[Preset::VeryFast]);
        Self { scene, presets, shows, like: None, at_surface: None, whole: false }
    }

    /// The image is, bit for bit, that of the scene `like`.
    pub(super) fn same(scene: Value, like: &Value) -> Self {
        Self { like: Some(like.clone()), ..Self::new(scene, |_, _, _| None) }
    }

    /// The image is also that of the scene by brute force.
    pub(super) fn like_itself(self) -> Self {
        Self { like: Some(self.scene.clone()), ..self }
    }

    fn shown(&self, effort: &Effort) -> Outcome {
        let image = |like: &Value| scenes::image(effort, like, Preset::Brute);
        let all = self.like.as_ref().map(image).transpose().map(|like| {
            let judge = |rendered: &_| scenes::judged(rendered, self, like.as_ref());
            let of = |&preset: &Preset| {
                let prepare = if self.whole { scenes::prepare_whole } else { scenes::prepare };
                let outcome = prepare(effort, &self.scene, preset)
                    .map(|prepared| scenes::every_way_to_render(effort, prepared.scene, &judge));
                Outcome::from(outcome).with_context(|| preset.name().to_owned())
            };
            self.presets.iter().map(of).sum()
        });
        Outcome::from(all).with_context(|| {
            let text = self.scene.to_string();
            if text.len() > MOST_OF_A_SCENE { "a scene".to_owned() } else { text }
        })
    }
}

/// Bytes of the largest scene that is printed if it fails.
const MOST_OF_A_SCENE: usize = 2048;

/// The text of a scene that must be refused, with an error of this kind that contains these words.
pub(super) struct Refusal {
    pub(super) text: String,
    pub(super) kind: ErrorKind,
    pub(super) named: String,
}

impl Refusal {
    /// A scene that is read, but refused at this path.
    pub(super) fn at(scene: &Value, path: &str) -> Self {
        Self { text: scene.to_string(), kind: ErrorKind::Scene, named: path.to_owned() }
    }

    pub(super) fn tried(&self, effort: &Effort) -> Outcome {
        let file = Path::new("scene.json");
        let prepared = scenes::prepare_text(effort, &self.text, file, Preset::VeryFast);
        let said = prepared.err().map(|error| (error.kind(), error.to_string()));
        let is_right = said
            .as_ref()
            .is_some_and(|(kind, said)| *kind == self.kind && said.contains(&self.named));
        let Self { text, named, .. } = self;
        Outcome::of(is_right, || format!("{said:?} does not name {named} of {text}"))
    }
}
