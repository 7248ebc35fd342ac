//! The cost of each effect: a price list, measured on this machine.
//!
//! [`scenes`] makes a small scene, and variants of it that each add one effect. All variants run in
//! turn, with both tracers, round by round, so that slow phases of the machine affect all of them
//! alike. The price of an effect is the ratio of its scene's time to that of the scene that it was
//! added to, round by round. Images are checked: both tracers give the same, in every round, and an
//! effect that nothing shows leaves the image and the work unchanged.
//!
//! | key | unit | meaning |
//! |---|---|---|
//! | `version`, `machine` | | as in [`super::bench`] |
//! | `image.width`, `.height` | pixels | the size of all images |
//! | `simd`, `kernel`, `precision`, `batch` | | the settings |
//! | `rounds` | | timed rounds, each of one run of every scene with each tracer |
//! | `difference` | | the difference that ended the measurement, or `null`: the effect, the tracer, and the difference of its image or its work |
//! | `effects` | | one entry for each scene, empty if images differ: |
//! | `.effect`, `.added_to` | | the effect, and the scene that it was added to (`null` for the first scenes) |
//! | `.reached` | | whether anything shows it |
//! | `.simulated` | | the effects in its plan |
//! | `.rays`, `.samples` | | the counts of one render |
//! | `.bytes_per_path` | bytes | in the columns of the wavefront |
//! | `.wavefront`, `.recursive` | | the cost with this tracer: |
//! | `.seconds` | seconds | of a run, as in [`super::bench`] |
//! | `.seconds_per_mpixel`, `.seconds_per_mray` | seconds | the median for 10^6 pixels, and for 10^6 rays of any kind |
//! | `.price` | | seconds over those of the scene that it was added to: median and interval, as in [`super::bench`]; `null` for the first scenes |

mod list;
pub mod scenes;
mod text;

use crate::bench::Machine;
use crate::bench::measure::{Difference, Schedule, difference, order, seconds_of};
use scenes::Variant;
use wavecrest_base::error::Result;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{Rendered, TracerKind};
use wavecrest_core::wavefront::batch::Batch;

pub use list::{Cost, EffectDifference, Price, PriceList, Setting, Size};
pub use text::text;

/// A prepared scene of the list.
#[derive(Debug)]
pub struct Entry {
    /// Its effect.
    pub variant: Variant,
    /// The scene.
    pub scene: PreparedScene,
}

/// The results of an entry: its first render, and the seconds of each timed run.
struct Runs {
    first: Option<Rendered>,
    seconds: [Vec<f64>; TRACERS.len()],
}

const TRACERS: [TracerKind; 2] = [TracerKind::Wavefront, TracerKind::Recursive];

/// Runs `trace` on all `entries` in turn as in `schedule`, with rounds instead of pairs. `progress`
/// receives the rounds timed and the expected total.
///
/// # Errors
/// Those of `trace`.
pub fn measure(
    entries: &[Entry],
    setting: Setting,
    schedule: &Schedule,
    mut trace: impl FnMut(&PreparedScene, TracerKind) -> Result<Rendered>,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<PriceList> {
    let new = || Runs { first: None, seconds: Default::default() };
    let mut runs: Vec<Runs> = entries.iter().map(|_| new()).collect();
    for round in 0.. {
        for turn in 0..entries.len() {
            let index = (turn + round) % entries.len();
            for tracer in order(round) {
                let run = trace(&entries[index].scene, tracer)?;
                if let Some(difference) = runs[index].add(tracer, run, round >= schedule.warmup) {
                    return Ok(differs(entries, setting, index, difference));
                }
            }
        }
        if let Some((index, difference)) = unreached_differs(entries, &runs) {
            return Ok(differs(entries, setting, index, difference));
        }
        let done = runs.first().map_or(0, |runs| runs.seconds[0].len());
        let sums = runs.iter().flat_map(|runs| &runs.seconds).map(|seconds| seconds.iter().sum());
        let planned = schedule.planned(done, sums.reduce(f64::min).unwrap_or_default());
        progress(done as u64, planned as u64);
        if done >= planned || entries.is_empty() {
            break;
        }
    }
    let prices = (0..entries.len()).filter_map(|index| price(entries, &runs, index)).collect();
    let rounds = runs.first().map_or(0, |runs| runs.seconds[0].len());
    Ok(list(entries, setting, rounds, prices))
}

impl Runs {
    /// Adds a run, and returns its difference from the first.
    fn add(&mut self, tracer: TracerKind, run: Rendered, timed: bool) -> Option<Difference> {
        if timed {
            self.seconds[tracer as usize].push(seconds_of(&run));
        }
        match &self.first {
            Some(first) => difference(tracer, first, &run),
            None => {
                self.first = Some(run);
                None
            }
        }
    }
}

/// The first effect that nothing shows and that nevertheless changes the image or the work.
fn unreached_differs(entries: &[Entry], runs: &[Runs]) -> Option<(usize, Difference)> {
    entries.iter().enumerate().filter(|(_, entry)| !entry.variant.reached).find_map(|(index, e)| {
        let base = runs[e.variant.added_to?].first.as_ref()?;
        let run = runs[index].first.as_ref()?;
        Some((index, difference(TracerKind::Wavefront, base, run)?))
    })
}

fn differs(entries: &[Entry], setting: Setting, index: usize, difference: Difference) -> PriceList {
    let effect = entries[index].variant.name;
    let difference = Some(EffectDifference { effect, difference });
    PriceList { difference, ..list(entries, setting, 0, Vec::new()) }
}

fn list(entries: &[Entry], setting: Setting, rounds: usize, effects: Vec<Price>) -> PriceList {
    let [width, height] = entries.first().map_or([0; 2], |entry| entry.scene.camera.size());
    let (version, machine) = (env!("CARGO_PKG_VERSION"), Machine::this());
    let image = Size { width, height };
    PriceList { version, machine, image, setting, rounds, difference: None, effects }
}

fn price(entries: &[Entry], runs: &[Runs], index: usize) -> Option<Price> {
    let Entry { variant, scene } = &entries[index];
    let counters = &runs[index].first.as_ref()?.counters;
    let [wavefront, recursive] = TRACERS.map(|tracer| {
        let seconds = |index: usize| runs[index].seconds[tracer as usize].as_slice();
        Cost::new(seconds(index), variant.added_to.map(seconds), scene, counters)
    });
    let present = scene.plan.decisions().iter().filter(|decision| decision.present);
    Some(Price {
        effect: variant.name,
        added_to: variant.added_to.map(|base| entries[base].variant.name),
        reached: variant.reached,
        simulated: present.map(|decision| decision.effect.name()).collect(),
        rays: counters.into(),
        samples: counters.into(),
        bytes_per_path: Batch::bytes_per_path(scene).iter().map(|(_, bytes)| bytes).sum(),
        wavefront: wavefront?,
        recursive: recursive?,
    })
}

#[cfg(test)]
mod tests;
