//! The parts of a case, as data, and what runs them.
//!
//! A part makes inputs from random numbers, each with the answer that follows from its
//! construction: a world of primitives with rays and what they must meet; a scene and what its
//! pixels must show; or what becomes of a value, or of a scene that must be refused. The runners ask
//! every kernel, instruction level, preset and tracer, and count what is wrong.

use std::ops::Range;

use super::agreement::agree;
use super::prelude::*;
use super::scenes::{self, WarnedScene};
use super::ways::{RAYS_OF_A_TASK, blocks, hits, in_order, with_every_kernel};

/// A part of a case.
#[derive(Clone, Copy, Debug)]
pub(super) enum CasePart {
    /// Worlds, and the number of rays in all of them together, in full.
    Rays(usize, usize, fn(&mut Numbers) -> World),
    /// The numbers of inputs, quick and in full, and the images of each.
    Images([usize; 2], fn(&mut Numbers) -> Vec<Picture>),
    /// The same, and what becomes of each.
    Values([usize; 2], fn(&mut Numbers) -> Outcome),
}

impl CasePart {
    /// Runs part number `part` of the case with that number.
    pub(super) fn run(self, effort: &Effort, case: u32, part: u32) -> Outcome {
        let numbers = |place: u32, n| Numbers::new(effort, [case, part << 16 | place], n);
        type Ask<'a> = &'a (dyn Fn(&mut Numbers) -> Outcome + Sync);
        let each = |[quick, full]: [usize; 2], tasks: usize, ask: Ask<'_>| {
            let count = effort.either(quick, full);
            in_order(blocks(count, count.div_ceil(tasks)).map(|block| {
                let one = |n| ask(&mut numbers(0, n)).with_context(|| format!("input {n}"));
                block.map(one).sum()
            }))
        };
        match self {
            Self::Rays(worlds, rays, make) => {
                let of_world = |n: usize| {
                    let (world, preset) = (make(&mut numbers(0, n)), preset_of(n));
                    let slower = if preset == Preset::Brute { 10 } else { 1 };
                    let rays = (0..effort.of(rays) / worlds / slower).into_par_iter();
                    let traced = world.aim.map(|aim| {
                        let aimed = rays.filter_map(|i| aim(&mut numbers(1 + n as u32, i)));
                        let (rays, expected): (Vec<_>, Vec<_>) = aimed.unzip();
                        if let Some(like) = world.like {
                            return agree(effort.accel(world.geometry, like), &rays, &[preset]);
                        }
                        let mut accel = effort.accel(world.geometry, preset);
                        with_every_kernel(&mut accel, |accel| {
                            let rays = rays.par_chunks(RAYS_OF_A_TASK);
                            let all = rays.zip(expected.par_chunks(RAYS_OF_A_TASK));
                            in_order(all.map(|(rays, expected)| ask(accel, rays, expected)))
                        })
                    });
                    let context = || format!("world {n}, {}", preset.name());
                    Outcome::from(traced).with_context(context)
                };
                in_order((0..worlds).into_par_iter().map(of_world))
            }
            Self::Images(count, pictures) => each(count, TASKS_OF_IMAGES, &|numbers| {
                let pictures = (numbers.index..).zip(pictures(numbers));
                pictures.map(|(n, picture)| picture.shown(effort, preset_of(n))).sum()
            }),
            Self::Values(count, value) => each(count, TASKS, &value),
        }
    }
}

/// The tree of the `n`th world: each in turn, starting with the next in every round, so that worlds
/// of each kind have all. Brute force, which is slow, gets a tenth of the rays.
fn preset_of(n: usize) -> Preset {
    Preset::ALL[(n + n / Preset::ALL.len()) % Preset::ALL.len()]
}

/// The most tasks for the inputs of a part.
const TASKS: usize = 1 << 10;

/// The same for images: a thread that waits for a render takes up others, which all need its stack.
const TASKS_OF_IMAGES: usize = 16;

/// What a ray must meet.
#[derive(Clone, Debug)]
pub(super) struct ExpectedHit {
    /// Whether it may also meet nothing.
    pub(super) or_nothing: bool,
    /// One of these primitives,
    pub(super) of: Range<u32>,
    /// at a t in this range.
    pub(super) t: [f64; 2],
}

impl ExpectedHit {
    pub(super) const NOTHING: Self = Self { or_nothing: true, of: 0..0, t: [0.0; 2] };

    pub(super) const ANYTHING: Self =
        Self { or_nothing: false, of: 0..u32::MAX, t: [f64::NEG_INFINITY, f64::INFINITY] };

    /// Anything up to `t`.
    pub(super) fn until(t: f64) -> Self {
        Self { t: [f64::NEG_INFINITY, t], ..Self::ANYTHING }
    }

    /// Anything at most `off` from `t`.
    pub(super) fn near(t: f64, off: f64) -> Self {
        Self { t: [t - off, t + off], ..Self::ANYTHING }
    }

    /// One of these primitives.
    pub(super) fn of(of: Range<u32>) -> Self {
        Self { of, ..Self::ANYTHING }
    }

    /// This primitive at this t, to the last bit.
    pub(super) fn exactly(Hit { t, primitive }: Hit) -> Self {
        if primitive == Hit::MISS.primitive {
            return Self::NOTHING;
        }
        Self { t: [t.into(); 2], ..Self::of(primitive..primitive + 1) }
    }

    fn is_met(&self, hit: Hit) -> bool {
        let [low, high] = self.t;
        let is_one = self.of.contains(&hit.primitive) && (low..=high).contains(&hit.t.into());
        if hit.is_miss() { self.or_nothing } else { is_one }
    }
}

/// A ray of an input, and what it must meet; `None` for inputs that are skipped.
type Aim = Box<dyn Fn(&mut Numbers) -> Option<(Ray, ExpectedHit)> + Send + Sync>;

/// Primitives, and rays at them.
pub(super) struct World {
    geometry: Geometry,
    /// The tree with which the reference finds the hits that all must have.
    like: Option<Preset>,
    /// Or why there is no world.
    aim: Result<Aim>,
}

impl World {
    /// Rays with what they must meet.
    pub(super) fn new(
        geometry: Geometry,
        aim: impl Fn(&mut Numbers) -> Option<(Ray, ExpectedHit)> + Send + Sync + 'static,
    ) -> Self {
        Self { geometry, like: None, aim: Ok(Box::new(aim)) }
    }

    /// The world of a scene, with the rays that `aim` makes for it.
    pub(super) fn of_scene<A>(
        prepared: Result<WarnedScene>,
        aim: impl FnOnce(&WarnedScene) -> A,
    ) -> Self
    where
        A: Fn(&mut Numbers) -> Option<(Ray, ExpectedHit)> + Send + Sync + 'static,
    {
        match prepared {
            Ok(prepared) => Self::new(prepared.scene.accel.geometry().clone(), aim(&prepared)),
            Err(error) => Self { aim: Err(error), ..Self::new(Geometry::default(), |_| None) },
        }
    }

    /// Where every kernel and tree must have the hits of the reference with a tree of `like`.
    pub(super) fn like(
        like: Preset,
        geometry: Geometry,
        ray: impl Fn(&mut Numbers) -> Ray + Send + Sync + 'static,
    ) -> Self {
        let aim = move |numbers: &mut Numbers| Some((ray(numbers), ExpectedHit::ANYTHING));
        Self { like: Some(like), ..Self::new(geometry, aim) }
    }
}

/// Checks the closest hits of these rays, and that what is hit blocks shadow rays.
fn ask(accel: &Accel, rays: &[Ray], expected: &[ExpectedHit]) -> Outcome {
    let (hits, blocked) = hits(accel, rays, &mut accel.traversal());
    let mut outcome = Outcome::default();
    for (((ray, expected), hit), blocked) in rays.iter().zip(expected).zip(hits).zip(blocked) {
        outcome.check(expected.is_met(hit), || format!("{ray}: {hit:?} and not {expected:?}"));
        outcome.check(blocked != hit.is_miss(), || {
            format!("{ray}: {hit:?}, but as a shadow ray {blocked}")
        });
    }
    outcome
}

/// Whether the pixel in this column and row is right; `None` if that is open.
type PixelCheck = Box<dyn Fn(u32, u32, [f32; 3]) -> Option<bool> + Send + Sync>;

/// A scene, and what its image must show.
pub(super) struct Picture {
    pub(super) scene: Value,
    pub(super) shows: PixelCheck,
    /// The scene that has the same image, by brute force.
    pub(super) like: Option<Value>,
    /// The number of lights that are at a surface; `None` if that is open.
    pub(super) at_surface: Option<u64>,
    /// Whether shapes, lights and textures that no ray of the camera reaches are kept too.
    pub(super) whole: bool,
}

impl Picture {
    /// Each pixel is as `shows` says.
    pub(super) fn new(
        scene: Value,
        shows: impl Fn(u32, u32, [f32; 3]) -> Option<bool> + Send + Sync + 'static,
    ) -> Self {
        Self { scene, shows: Box::new(shows), like: None, at_surface: None, whole: false }
    }

    /// The image is, bit for bit, that of the scene `like`.
    pub(super) fn same(scene: Value, like: &Value) -> Self {
        Self { like: Some(like.clone()), ..Self::new(scene, |_, _, _| None) }
    }

    /// The image is also that of the scene by brute force.
    pub(super) fn like_itself(self) -> Self {
        Self { like: Some(self.scene.clone()), ..self }
    }

    fn shown(&self, effort: &Effort, preset: Preset) -> Outcome {
        let rendered = || {
            let like = self.like.as_ref().map(|like| scenes::by_brute_force(effort, like));
            let like = like.transpose()?;
            let prepare = if self.whole { scenes::prepare_whole } else { scenes::prepare };
            let mut scene = prepare(effort, &self.scene)?.scene;
            scene.accel.rebuild(preset);
            let judge = |rendered: &_| scenes::judged(rendered, self, like.as_ref());
            Ok(scenes::every_way_to_render(effort, scene, &judge))
        };
        Outcome::from(rendered()).with_context(|| {
            let text = self.scene.to_string();
            let text = if text.len() > MOST_OF_A_SCENE { "a scene".to_owned() } else { text };
            format!("{}, {text}", preset.name())
        })
    }
}

/// Bytes of the largest scene that is printed if it fails.
const MOST_OF_A_SCENE: usize = 2048;
