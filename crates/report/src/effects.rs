//! The cost of each effect: a price list, measured on this machine.
//!
//! [`scenes`] makes a small scene, and variants of it that each add one effect. All run with both
//! tracers in the [rounds](crate::measure) of one measurement. The price of an effect is the ratio
//! of its scene's time to that of the scene that it was added to, round by round. Images are
//! checked: both tracers give the same, in every round, and an effect that nothing shows leaves the
//! image and the work unchanged.
//!
//! | key | unit | meaning |
//! |---|---|---|
//! | `version`, `machine` | | as in [`super::bench`] |
//! | `image.width`, `.height`, `.samples_per_pixel` | pixels, rays | the size of all images |
//! | `simd`, `kernel`, `precision`, `batch` | | the settings |
//! | `rounds`, `left_out`, `busy` | | timed rounds, each of one run of every scene with each tracer; others as in [`super::bench`] |
//! | `difference` | | the difference that ended the measurement, or `null`: see [`RunDifference`] |
//! | `effects` | | one entry for each scene, empty if images differ: |
//! | `.effect`, `.added_to` | | the effect, and the scene that it was added to (`null` for the first scenes) |
//! | `.reached` | | whether anything shows it |
//! | `.simulated` | | the effects in its plan |
//! | `.rays`, `.samples` | | the counts of one render |
//! | `.bytes_per_path` | bytes | in the columns of the wavefront |
//! | `.wavefront`, `.recursive` | | the cost with this tracer: |
//! | `.seconds` | seconds | of a run, as in [`super::bench`] |
//! | `.seconds_per_mray` | seconds | the median for 10^6 rays of any kind |
//! | `.price` | | seconds over those of the scene that it was added to: median and interval, as in [`super::bench`]; `null` for the first scenes |
//! | `.nanoseconds_a_hit` | ns | of a map: the processor time that it adds for each hit on a surface; `null` for other effects, and if the system does not tell it |

mod list;
pub mod scenes;

use crate::bench::equal::RunDifference;
use crate::bench::{Machine, Ratio};
use crate::measure::{RoundLimits, Rounds, Timing};
use crate::statistics::Rays;
use crate::summary::{Summary, median};
use scenes::SceneVariant;
use wavecrest_base::error::Result;
use wavecrest_core::plan::Effect;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{Rendered, TracerKind};
use wavecrest_core::wavefront::batch::Batch;

pub use list::{Cost, EffectSetting, Price, PriceList, text};

/// A prepared scene of the list.
#[derive(Debug)]
pub struct EffectScene {
    /// Its effect.
    pub variant: SceneVariant,
    /// The scene.
    pub scene: PreparedScene,
}

const TRACERS: [TracerKind; 2] = [TracerKind::Wavefront, TracerKind::Recursive];

/// Runs `trace` on all `entries` with both tracers as in `schedule`. `progress` receives the runs
/// done and the expected total.
///
/// # Errors
/// Those of `trace`.
pub fn measure(
    entries: &[EffectScene],
    setting: EffectSetting,
    schedule: &RoundLimits,
    mut trace: impl FnMut(&PreparedScene, TracerKind) -> Result<Rendered>,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<PriceList> {
    let mut firsts: Vec<Rendered> = Vec::new();
    let mut list = PriceList {
        version: env!("CARGO_PKG_VERSION"),
        machine: Machine::this(),
        image: entries.first().map(|entry| (&entry.scene).into()),
        setting,
        rounds: Rounds::default(),
        difference: None,
        effects: Vec::new(),
    };
    let run = |variant: usize| {
        let (index, tracer) = (variant / TRACERS.len(), TRACERS[variant % TRACERS.len()]);
        let EffectScene { variant, scene } = &entries[index];
        let (rendered, timing) = Timing::of(|| trace(scene, tracer));
        let rendered = rendered?;
        let timing = timing.lasting(rendered.seconds);
        // The first round is in the order of the entries, a base before what is added to it.
        if firsts.len() == index {
            firsts.push(rendered.clone());
        }
        // What nothing shows must look like the scene without it.
        let expected = if variant.reached { index } else { variant.added_to.unwrap_or(index) };
        let names = [&*format!("{} ({tracer:?})", variant.name), "the first render"];
        list.difference = RunDifference::of(names, &rendered, &firsts[expected]);
        Ok(list.difference.is_none().then_some((timing, ())))
    };
    let measured = crate::measure::measure(TRACERS.len() * entries.len(), schedule, run, progress)?;
    let Some(measured) = measured else { return Ok(list) };
    list.rounds = measured.rounds;
    let all = |of: fn(&Timing) -> f64| -> Vec<Vec<f64>> {
        let each = |runs: &Vec<(Timing, ())>| runs.iter().map(|(timing, ())| of(timing)).collect();
        measured.variants.iter().map(each).collect()
    };
    let (seconds, processor) = (all(|t| t.seconds), all(|t| t.processor.unwrap_or(f64::NAN)));
    list.effects = firsts
        .iter()
        .enumerate()
        .filter_map(|(index, first)| price(entries, [&seconds, &processor], index, first))
        .collect();
    Ok(list)
}

fn price(
    entries: &[EffectScene],
    [seconds, processor]: [&[Vec<f64>]; 2],
    index: usize,
    first: &Rendered,
) -> Option<Price> {
    let EffectScene { variant, scene } = &entries[index];
    let rays = Rays::from(&first.counters);
    let hits = (first.counters.look_ups.plain + first.counters.look_ups.mapped) as f64;
    let has_images = !scene.appearance.images.is_empty() || scene.plan.has(Effect::CutOuts);
    let map_of = variant.added_to.filter(|_| variant.reached && has_images);
    let cost = |tracer: usize| {
        let place = |entry: usize| entry * TRACERS.len() + tracer;
        let ratio = |base| Ratio::of(seconds, place(index), place(base));
        let summary = Summary::of(&seconds[place(index)])?;
        let time = |entry: usize| median(&processor[place(entry)]);
        let a_hit = |base| 1e9 * (time(index) - time(base)) / hits;
        Some(Cost {
            seconds_per_mray: summary.median / rays.all().max(1) as f64 * 1e6,
            price: variant.added_to.and_then(ratio),
            nanoseconds_a_hit: map_of.map(a_hit),
            seconds: summary,
        })
    };
    let present = scene.plan.decisions().iter().filter(|decision| decision.present);
    Some(Price {
        effect: variant.name.clone(),
        added_to: variant.added_to.map(|base| entries[base].variant.name.clone()),
        reached: variant.reached,
        simulated: present.map(|decision| decision.effect.name()).collect(),
        rays,
        samples: (&first.counters).into(),
        bytes_per_path: Batch::bytes_per_path(scene).iter().map(|(_, bytes)| bytes).sum(),
        wavefront: cost(0)?,
        recursive: cost(1)?,
    })
}

#[cfg(test)]
mod tests;
