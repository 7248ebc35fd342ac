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

#![allow(missing_docs, reason = "the table above says it once, for the JSON and for the fields")]

pub mod scenes;

use serde::Serialize;

use crate::bench::equal::RunDifference;
use crate::bench::page::machine;
use crate::bench::{Machine, Ratio, TimedRender};
use crate::measure::{RoundLimits, Rounds, Timing, busy};
use crate::page::{Block, Cell, Table};
use crate::statistics::ImageSize;
use crate::summary::{Summary, median};
use scenes::SceneVariant;
use wavecrest_base::error::Result;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::counters::{Counters, RayCounts, SampleCounts};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::plan::Effect;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{Rendered, TracerKind};
use wavecrest_core::wavefront::batch::Batch;

/// A prepared scene of the list.
#[derive(Debug)]
pub struct EffectScene {
    /// Its effect.
    pub variant: SceneVariant,
    /// The scene.
    pub scene: PreparedScene,
}

/// The list.
#[derive(Clone, Debug, Serialize)]
pub struct PriceList {
    pub version: &'static str,
    pub machine: Machine,
    pub image: Option<ImageSize>,
    #[serde(flatten)]
    pub setting: EffectSetting,
    #[serde(flatten)]
    pub rounds: Rounds,
    pub difference: Option<RunDifference>,
    pub effects: Vec<Price>,
}

/// The settings of the renders.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct EffectSetting {
    pub simd: Level,
    pub kernel: KernelChoice,
    pub precision: Precision,
    pub batch: usize,
}

/// The cost of one effect.
#[derive(Clone, Debug, Serialize)]
pub struct Price {
    pub effect: String,
    pub added_to: Option<String>,
    pub reached: bool,
    pub simulated: Vec<&'static str>,
    pub rays: RayCounts,
    pub samples: SampleCounts,
    pub bytes_per_path: usize,
    pub wavefront: TracerCost,
    pub recursive: TracerCost,
}

/// The cost with one tracer.
#[derive(Clone, Debug, Serialize)]
pub struct TracerCost {
    pub seconds: Summary,
    pub seconds_per_mray: f64,
    pub price: Option<Ratio>,
    pub nanoseconds_a_hit: Option<f64>,
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
    mut trace: impl FnMut(&PreparedScene, TracerKind) -> Result<TimedRender>,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<PriceList> {
    let mut firsts: Vec<Rendered> = Vec::new();
    let mut list = PriceList {
        version: env!("CARGO_PKG_VERSION"),
        machine: Machine::this(),
        image: entries.first().map(|entry| ImageSize::of(&entry.scene)),
        setting,
        rounds: Rounds::default(),
        difference: None,
        effects: Vec::new(),
    };
    let run = |variant: usize| {
        let (index, tracer) = (variant / TRACERS.len(), TRACERS[variant % TRACERS.len()]);
        let EffectScene { variant, scene } = &entries[index];
        let TimedRender { timing, rendered } = trace(scene, tracer)?;
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
    let Some((runs, rounds)) = measured else { return Ok(list) };
    list.rounds = rounds;
    let all = |of: fn(&Timing) -> f64| -> Vec<Vec<f64>> {
        let each = |runs: &Vec<(Timing, ())>| runs.iter().map(|(timing, ())| of(timing)).collect();
        runs.iter().map(each).collect()
    };
    let (seconds, processor) = (all(|t| t.seconds), all(|t| t.processor.unwrap_or(f64::NAN)));
    let price = |(index, first)| price(entries, [&seconds, &processor], index, first);
    list.effects = firsts.iter().enumerate().filter_map(price).collect();
    Ok(list)
}

fn price(
    entries: &[EffectScene],
    [seconds, processor]: [&[Vec<f64>]; 2],
    index: usize,
    first: &Rendered,
) -> Option<Price> {
    let EffectScene { variant, scene } = &entries[index];
    let Counters { rays, samples, .. } = first.counters;
    let hits = (samples.plain + samples.mapped) as f64;
    let has_images = !scene.appearance.images.is_empty() || scene.plan.has(Effect::CutOuts);
    let map_of = variant.added_to.filter(|_| variant.reached && has_images);
    let cost = |tracer: usize| {
        let place = |entry: usize| entry * TRACERS.len() + tracer;
        let ratio = |base| Ratio::of(seconds, place(index), place(base));
        let summary = Summary::of(&seconds[place(index)])?;
        let time = |entry: usize| median(&processor[place(entry)]);
        let a_hit = |base| 1e9 * (time(index) - time(base)) / hits;
        Some(TracerCost {
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
        samples,
        bytes_per_path: Batch::bytes_per_path(scene).iter().map(|(_, bytes)| bytes).sum(),
        wavefront: cost(0)?,
        recursive: cost(1)?,
    })
}

/// The list for a terminal: the machine, and the cost of each effect with both tracers.
pub fn text(list: &PriceList) -> String {
    let facts = Block::Facts(machine(&list.machine));
    if let Some(differs) = &list.difference {
        return crate::text::text(&[facts, Block::Warning(differs.words())]);
    }
    let table = |caption: &str, reached: bool| {
        let header = "effect|added to|>wavefront|>ns a ray|>map, ns a hit|>recursive|>ns a ray|>map, ns a hit|>bytes a path";
        let rows = list.effects.iter().filter(|p| p.reached == reached).map(row).collect();
        Block::Table(Table::new(caption, header, rows))
    };
    let [width, height] = list.image.map_or([0; 2], |image| [image.width, image.height]);
    let busy = busy([list.rounds]).map_or_else(String::new, |words| format!(" {words}."));
    let lead = format!(
        "Each effect is added on its own to a small scene of {width} x {height} pixels. The ratio is the time with the effect \
         over the time without it, round by round, in {} rounds.{busy} For maps there are also the \
         nanoseconds of a processor that they add for each hit on a surface. Bytes are those of the columns of the wavefront \
         tracer.",
        list.rounds.rounds
    );
    crate::text::text(&[
        facts,
        Block::Paragraph(lead),
        table("Effects in view: ratios of times", true),
        table("Effects that nothing in view shows: same image, same work", false),
    ])
}

fn row(p: &Price) -> Vec<Cell> {
    let costs = [&p.wavefront, &p.recursive].map(cells).concat();
    let names = vec![Cell::text(&p.effect), Cell::text(p.added_to.as_deref().unwrap_or("nothing"))];
    [names, costs, vec![Cell::figure(p.bytes_per_path as f64)]].concat()
}

/// The ratio, the time of a ray, and what a map adds for each hit.
fn cells(cost: &TracerCost) -> Vec<Cell> {
    let ratio = cost.price.as_ref().map_or_else(|| Cell::text("1"), Ratio::cell);
    let a_hit = cost.nanoseconds_a_hit.filter(|ns| ns.is_finite());
    let a_hit = a_hit.map_or_else(Cell::default, |ns| Cell::decimals(ns, 1));
    vec![ratio, Cell::decimals(cost.seconds_per_mray * 1e3, 1), a_hit]
}
