//! Primitives with rays at them: what they meet in exact precision, and what fast precision loses.

use serde::Serialize;

use xxhash_rust::xxh3::Xxh3;

use super::Case;
use super::agreement::{by_reference, compare};
use super::prelude::*;

/// A ray; `None` for inputs that are skipped.
type Aim = Box<dyn Fn(&mut InputRng) -> Option<Ray> + Send + Sync>;

/// Primitives, and rays at them.
pub(super) struct World {
    geometry: Geometry,
    aim: Aim,
    /// Whether every ray meets something, or none: [`ALL_HIT`], [`ALL_MISS`] or [`MIXED`].
    is_met: Option<bool>,
}

/// What the rays of a world meet: something, nothing, or either.
pub(super) const ALL_HIT: Option<bool> = Some(true);
pub(super) const ALL_MISS: Option<bool> = Some(false);
pub(super) const MIXED: Option<bool> = None;

/// The number of worlds of a case, the number of rays in all of them together, in full, and what makes one.
pub(super) type Worlds = (usize, usize, fn(&mut InputRng) -> World);

/// What fast precision loses.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Losses {
    /// Rays.
    pub tried: u64,
    /// Those that pass what they meet.
    pub leaks: u64,
    /// Those that meet what is not there, such as the surface that they leave.
    pub false_hits: u64,
}

/// A hit farther than another by this part of t is another one, and not rounded otherwise.
const BEYOND: f32 = 1.0 / 1024.0;

impl World {
    pub(super) fn new(
        geometry: Geometry,
        is_met: Option<bool>,
        aim: impl Fn(&mut InputRng) -> Option<Ray> + Send + Sync + 'static,
    ) -> Self {
        Self { geometry, aim: Box::new(aim), is_met }
    }
}

impl Case {
    /// Each world with its rays, and the tree in which they are searched. Brute force, which is slow, gets a tenth of
    /// the rays.
    fn each<T: Send>(
        &self,
        effort: &Effort,
        of: impl Fn(World, Vec<Ray>, Preset) -> T + Sync,
    ) -> Vec<T> {
        let Some((worlds, rays, make)) = self.worlds else { return Vec::new() };
        let one = |n: usize| {
            let world = make(&mut InputRng::new(effort, [self.number, 0], n));
            // Each tree in turn, starting with the next in every round, so that worlds of each kind have all.
            let preset = Preset::ALL[(n + n / Preset::ALL.len()) % Preset::ALL.len()];
            let slower = if preset == Preset::Brute { 10 } else { 1 };
            let count = effort.of([rays / 100, rays]) / worlds / slower;
            let rays = (0..count).into_par_iter();
            let aim = |i| (world.aim)(&mut InputRng::new(effort, [self.number, 1 + n as u32], i));
            let rays = rays.filter_map(aim).collect();
            of(world, rays, preset)
        };
        (0..worlds).into_par_iter().map(one).collect()
    }

    /// Every kernel at every level must answer as the reference; returns the hash of its answers, and
    /// of the number of degenerate triangles.
    pub(super) fn exact_hits(&self, effort: &Effort) -> (Outcome, u64) {
        let answers = self.each(effort, |world, rays, preset| {
            let mut accel = effort.accel(world.geometry, preset);
            let answered = by_reference(&mut accel, &rays);
            let mut outcome = compare(&mut accel, &answered);
            let hits = answered.iter().flat_map(|(_, answers)| answers).map(|(hit, ..)| hit);
            for (ray, hit) in rays.iter().zip(hits.clone()) {
                let is_right = world.is_met.is_none_or(|is_met| is_met != hit.is_miss());
                outcome.check(is_right, || format!("{ray}: {hit:?}"));
            }
            let bits = hits.flat_map(|hit| [hit.t.to_bits(), hit.primitive]);
            let bits = hash(bits.chain([accel.left_out() as u32]));
            (outcome.with_context(|| preset.name().to_owned()), bits)
        });
        let bits = hash(answers.iter().flat_map(|(_, bits)| [*bits as u32, (bits >> 32) as u32]));
        (answers.into_iter().map(|(outcome, _)| outcome).sum(), bits)
    }

    /// The trees and rays in exact precision, for tests that know what the rays meet.
    pub fn inputs(&self, effort: &Effort) -> Vec<(Accel, Vec<Ray>)> {
        self.each(effort, |world, rays, preset| (effort.accel(world.geometry, preset), rays))
    }

    /// What fast precision loses of its rays, if it has any.
    pub fn fast(&self, effort: &Effort) -> Option<Losses> {
        self.worlds?;
        let effort = Effort { precision: Precision::Fast, ..*effort };
        let exact = Effort { precision: Precision::Exact, ..effort };
        let losses = self.each(&effort, |world, rays, preset| {
            let hits = |effort: &Effort| {
                let accel = effort.accel(world.geometry.clone(), preset);
                let mut hits = vec![Hit::MISS; rays.len()];
                accel.closest_of(&rays[..], &mut hits, &mut accel.traversal());
                hits
            };
            let (exact, fast) = (hits(&exact), hits(&effort));
            let count = |of: fn(&(&Hit, &Hit)) -> bool, is_met| {
                let wrong = |pair: &(&Hit, &Hit)| {
                    of(pair) || world.is_met == Some(is_met) && pair.1.is_miss() == is_met
                };
                exact.iter().zip(&fast).filter(wrong).count() as u64
            };
            Losses {
                tried: rays.len() as u64,
                leaks: count(|(exact, fast)| is_beyond(fast, exact), true),
                false_hits: count(|(exact, fast)| is_beyond(exact, fast), false),
            }
        });
        let sum = |of: fn(&Losses) -> u64| losses.iter().map(of).sum();
        let (tried, leaks) = (sum(|one| one.tried), sum(|one| one.leaks));
        Some(Losses { tried, leaks, false_hits: sum(|one| one.false_hits) })
    }
}

/// The hash of these words, in their order.
pub(super) fn hash(words: impl Iterator<Item = u32>) -> u64 {
    let mut hash = Xxh3::new();
    words.for_each(|word| hash.update(&word.to_le_bytes()));
    hash.digest()
}

/// Whether `hit` is behind another.
fn is_beyond(hit: &Hit, other: &Hit) -> bool {
    let is_behind = hit.is_miss() || hit.t - other.t > other.t.abs() * BEYOND;
    !other.is_miss() && is_behind
}
