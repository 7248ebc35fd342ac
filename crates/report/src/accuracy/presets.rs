//! The fastest BVH preset for each number of samples: a slower build pays off if many rays use the
//! tree.
//!
//! | key of `presets[]` | unit | meaning |
//! |---|---|---|
//! | `preset` | | the BVH preset |
//! | `build`, `trace` | seconds | building, and tracing at the scene's own samples: medians |
//!
//! `crossings[]` are the presets that are fastest for some number of samples, each with the
//! smallest such number, relative to the scene's own.

use serde::Serialize;

use super::setting::Structure;
use super::store::{PresetRecord, Record, Store, all};
use super::subject::Subject;
use super::sweep::Progress;
use crate::summary::median;
use wavecrest_base::error::Result;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::render::{RenderOptions, render};

/// Largest number of builds and renders of each, and the seconds after which no further round
/// starts.
const ROUNDS: u32 = 5;
const SHORT: f64 = 10.0;

/// A preset.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs, reason = "see the module documentation")]
pub struct PresetFindings {
    pub preset: String,
    pub build: f64,
    pub trace: f64,
}

/// Builds and renders the scene with every preset, in turn, unless done already.
///
/// # Errors
/// If the scene can no longer be rendered, or a record cannot be written.
pub fn run(subject: &mut Subject, store: &mut Store, progress: &dyn Progress) -> Result<()> {
    let scene = subject.name();
    if all(&store.records).any(|p: &PresetRecord| p.scene == scene) {
        return Ok(());
    }
    progress.stage(&format!("{scene}: presets"), u64::from(ROUNDS));
    let start = std::time::Instant::now();
    let mut found = Vec::new();
    for round in 0..ROUNDS {
        if round > 0 && start.elapsed().as_secs_f64() > SHORT {
            break;
        }
        for preset in Preset::ALL.into_iter().filter(|preset| *preset != Preset::Brute) {
            let prepared = subject.build(&Structure::default(), preset)?;
            let seconds = render(&prepared.scene, &RenderOptions::default(), &())?.seconds;
            let (scene, preset) = (scene.clone(), preset.name().to_owned());
            found.push(PresetRecord { scene, preset, build: prepared.time.build, seconds });
        }
        progress.step();
    }
    // All at once, so that an interrupted sweep measures them again.
    found.into_iter().try_for_each(|record| store.add(Record::Preset(record)))
}

/// The presets of a scene, in the order of the tests.
pub fn of(scene: &str, records: &[Record]) -> Vec<PresetFindings> {
    let of_scene = || all::<PresetRecord>(records).filter(|p| p.scene == scene);
    let mut presets: Vec<&str> = Vec::new();
    for record in of_scene() {
        if !presets.contains(&&*record.preset) {
            presets.push(&record.preset);
        }
    }
    let found = |preset: &str| {
        let each = |of: fn(&PresetRecord) -> f64| {
            median(&of_scene().filter(|p| p.preset == preset).map(of).collect::<Vec<_>>())
        };
        let (build, trace) = (each(|p| p.build), each(|p| p.seconds));
        PresetFindings { preset: preset.to_owned(), build, trace }
    };
    presets.into_iter().map(found).collect()
}

impl PresetFindings {
    /// Seconds of building, and of tracing `samples` times the scene's own samples.
    pub fn in_all(&self, samples: f64) -> f64 {
        self.build + samples * self.trace
    }
}

/// Builds shorter than this share of the tracing time do not matter.
const LEAST_SHARE: f64 = 0.01;

/// Whether building takes enough time to matter.
pub fn matter(presets: &[PresetFindings]) -> bool {
    presets.iter().any(|preset| preset.build > LEAST_SHARE * preset.trace)
}

/// The fastest presets, from few samples to many, with the number from which each is fastest.
pub fn crossings(presets: &[PresetFindings]) -> Vec<(f64, String)> {
    let first = presets.iter().min_by(|a, b| a.build.total_cmp(&b.build));
    let mut crossings = Vec::new();
    let mut next = first.map(|first| (0.0, first));
    while let Some((samples, quickest)) = next {
        crossings.push((samples, quickest.preset.clone()));
        let meets = |other: &&PresetFindings| other.trace < quickest.trace;
        let at = |other: &PresetFindings| {
            (other.build - quickest.build) / (quickest.trace - other.trace)
        };
        let later = presets.iter().filter(meets).map(|other| (at(other), other));
        next = later.min_by(|a, b| a.0.total_cmp(&b.0));
    }
    crossings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_samples_are_worth_a_better_tree() {
        let preset =
            |name: &str, build, trace| PresetFindings { preset: name.to_owned(), build, trace };
        // The second is never the quickest; the others are from 0, from 1 and from 4 times the samples on.
        let presets = [
            preset("a", 1.0, 4.0),
            preset("b", 4.0, 3.5),
            preset("c", 2.0, 3.0),
            preset("d", 6.0, 2.0),
        ];
        let found = crossings(&presets);
        let expected = [(0.0, "a"), (1.0, "c"), (4.0, "d")];
        assert_eq!(found, expected.map(|(samples, name)| (samples, name.to_owned())));
        for samples in [0.5, 2.0, 9.0] {
            let quickest =
                presets.iter().min_by(|a, b| a.in_all(samples).total_cmp(&b.in_all(samples)));
            let last = found.iter().rfind(|(from, _)| *from <= samples).unwrap();
            assert_eq!(quickest.unwrap().preset, last.1);
        }
        assert_eq!(crossings(&[]), []);
    }
}
