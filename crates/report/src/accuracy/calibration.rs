//! Whether requested errors are met: the pilot's choice is rendered and compared with the
//! reference, which the pilot does not know.

use std::collections::BTreeMap;

use super::pilot::{Axis, Pilot};
use super::reference::Reference;
use super::setting::{Structure, Target};
use super::store::{CalibrationRecord, Record, Store, all};
use super::subject::Subject;
use super::sweep::Progress;
use wavecrest_base::error::Result;
use wavecrest_core::prepared::Samples;
use wavecrest_core::render::{RenderOptions, render};
use wavecrest_image::compare::compare;

/// Requested errors.
const ASKED: [f64; 4] = [0.04, 0.02, 0.01, 0.005];

/// Number of pilots for each error, with different random numbers.
const SEEDS: u64 = 3;

/// Choices with a longer expected time in seconds are skipped.
const MOST_SECONDS: f64 = 20.0;

/// Tests the requested errors, unless done already.
///
/// # Errors
/// If the scene can no longer be rendered, or a record cannot be written.
pub fn run(
    subject: &mut Subject,
    references: &BTreeMap<&'static str, Reference>,
    store: &mut Store,
    progress: &dyn Progress,
) -> Result<()> {
    let scene = subject.name();
    let target = match Axis::of(&subject.facts()) {
        Axis::Pixel => Target::Pixel,
        Axis::Lens | Axis::Lights => Target::Scene,
    };
    let Some(reference) = references.get(target.name()) else { return Ok(()) };
    progress.stage(&format!("{scene}: errors asked for"), SEEDS);
    for seed in 0..SEEDS {
        progress.step();
        if all(&store.records).any(|c: &CalibrationRecord| c.scene == scene && c.seed == seed) {
            continue;
        }
        let prepared = subject.prepare(&Structure::default())?;
        // With the file's samples, not those of the last render.
        prepared.scene.resample(&prepared.original, &Samples::default());
        let pilot = Pilot::run(&mut prepared.scene, &prepared.original, seed)?;
        for asked in ASKED {
            let choice = pilot.for_error(asked).filter(|choice| choice.seconds < MOST_SECONDS);
            let Some(choice) = choice else { continue };
            prepared.scene.resample(&prepared.original, &choice.samples());
            let options = RenderOptions { seed, ..RenderOptions::default() };
            let film = render(&prepared.scene, &options, &())?.film;
            let made = compare(&film, &reference.film)?.rmse;
            let (scene, expected) = (scene.clone(), choice.error);
            let record = CalibrationRecord { scene, seed, asked, expected, made };
            store.add(Record::Calibration(record))?;
        }
    }
    Ok(())
}
