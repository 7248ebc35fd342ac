//! Time by precision, effect and pass: the scene's effects are removed one after another.
//!
//! The time that removing each [`Layer`] saves in each pass is that layer's own time. The parts add
//! up to the whole. The cost of a layer depends on the order, which is that of [`Layer::ALL`]: a
//! mirror shows soft shadows, and pays for them.
//!
//! | key of `layers[]` | unit | meaning |
//! |---|---|---|
//! | `precision` | | the precision of hits |
//! | `load`, `build` | seconds | reading the scene and building its tree: medians |
//! | `parts[].effect` | | first `camera rays`, one through the centre of each pixel; then each effect added to those before it |
//! | `.passes` | seconds | its time in each pass, summed over threads |

#![allow(missing_docs, reason = "the table above says it once, for the JSON and for the fields")]

use serde::Serialize;

use super::SweepProgress;
use super::setting::{Setting, Structure};
use super::store::{LayerSeconds, LayersRecord, PreparedRecord, Record, Store, all};
use super::subject::Subject;
use crate::bench::Preparation;
use crate::measure::rounds;
use crate::summary::median;
use wavecrest_base::error::Result;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_scene::systems::overrides::{Layer, Overrides};

/// The rest when all layers are removed.
const CAMERA_RAYS: &str = "camera rays";

/// Largest number of renders of each, and the seconds after which no further round starts.
const ROUNDS: usize = 8;
const SHORT: f64 = 5.0;

/// The layers in one precision.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayersFindings {
    pub precision: String,
    #[serde(flatten)]
    pub before: Preparation,
    pub parts: Vec<PartFindings>,
}

/// A layer's time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartFindings {
    pub effect: String,
    pub passes: Vec<(String, f64)>,
}

/// Renders the scene with all its layers and with one layer less after another, in turn, in every
/// precision, unless done already.
///
/// # Errors
/// If the scene can no longer be rendered, or a record cannot be written.
pub fn run(
    subject: &mut Subject,
    store: &mut Store,
    progress: &dyn Fn(SweepProgress<'_>),
) -> Result<()> {
    let scene = subject.record.scene.clone();
    progress(SweepProgress::Stage(&format!("{scene}: time by effect")));
    for precision in Precision::ALL {
        let name = precision.name();
        let is_it = |l: &LayersRecord| l.scene == scene && l.precision == name;
        if !all(&store.records).any(is_it) {
            let steps = steps(subject, precision)?;
            let (scene, precision) = (scene.clone(), name.to_owned());
            store.add(Record::Layers(LayersRecord { scene, precision, steps }))?;
        }
    }
    Ok(())
}

/// The least time of several renders in each pass, as other programs can only add to a time.
fn steps(subject: &mut Subject, precision: Precision) -> Result<Vec<LayerSeconds>> {
    let facts = &subject.facts;
    let present = Layer::ALL.into_iter().filter(|layer| facts.has(*layer)).map(Some);
    let without: Vec<Option<Layer>> = std::iter::once(None).chain(present).collect();
    let mut steps: Vec<_> =
        without.iter().map(|layer| (layer.map(|l| l.name().to_owned()), Vec::new())).collect();
    for _ in rounds(ROUNDS, SHORT) {
        for (&without, (_, passes)) in without.iter().zip(&mut steps) {
            let overrides = Overrides { without, ..Overrides::default() };
            let structure = Structure { precision, overrides };
            let setting = Setting { structure, ..Setting::default() };
            let (rendered, _) = subject.timed(&setting, 0)?;
            for &(name, seconds) in &rendered.pass_seconds {
                match passes.iter_mut().find(|(known, _)| known == name) {
                    Some((_, least)) => *least = seconds.min(*least),
                    None => passes.push((name.to_owned(), seconds)),
                }
            }
        }
    }
    Ok(steps)
}

/// The precisions of a scene, in the order of rendering.
pub fn of(scene: &str, records: &[Record]) -> Vec<LayersFindings> {
    let found = |l: &LayersRecord| {
        // The key of a structure without overrides is its precision.
        let is_it = |p: &&PreparedRecord| p.scene == scene && p.key == l.precision;
        let before: Vec<Preparation> = all(records).filter(is_it).map(|p| p.time).collect();
        let each = |of: fn(&Preparation) -> f64| median(&before.iter().map(of).collect::<Vec<_>>());
        let before = Preparation { load: each(|s| s.load), build: each(|s| s.build) };
        LayersFindings { precision: l.precision.clone(), before, parts: parts(l) }
    };
    all(records).filter(|l: &&LayersRecord| l.scene == scene).map(found).collect()
}

/// The time that each layer saves. A step that takes longer than the one before does so by noise,
/// and counts as equal.
fn parts(LayersRecord { steps, .. }: &LayersRecord) -> Vec<PartFindings> {
    let Some((_, whole)) = steps.first() else { return Vec::new() };
    let mut left = whole.clone();
    let mut parts = Vec::new();
    for (layer, passes) in &steps[1..] {
        let without = |name: &str| passes.iter().find(|pass| pass.0 == name).map_or(0.0, |p| p.1);
        let saved = left.iter_mut().map(|(name, seconds)| {
            let before = std::mem::replace(seconds, seconds.min(without(name)));
            (name.clone(), before - *seconds)
        });
        let passes = saved.collect();
        parts.push(PartFindings { effect: layer.clone().unwrap_or_default(), passes });
    }
    parts.push(PartFindings { effect: CAMERA_RAYS.to_owned(), passes: left });
    parts.reverse();
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_add_up_to_the_whole_and_none_is_negative() {
        let passes = |[a, b]: [f64; 2]| vec![("intersect".to_owned(), a), ("shadow".to_owned(), b)];
        let step = |layer: Option<&str>, times| (layer.map(str::to_owned), passes(times));
        let record = LayersRecord {
            scene: "s".to_owned(),
            precision: "exact".to_owned(),
            steps: vec![
                step(None, [8.0, 4.0]),
                step(Some("mirrors"), [5.0, 4.5]),
                // A pass that does not run has no time.
                (Some("lights".to_owned()), vec![("intersect".to_owned(), 5.5)]),
            ],
        };
        let found = &of("s", &[Record::Layers(record)])[0];
        let part =
            |effect: &str, times| PartFindings { effect: effect.to_owned(), passes: passes(times) };
        let expected = [
            part(CAMERA_RAYS, [5.0, 0.0]),
            part("lights", [0.0, 4.0]),
            part("mirrors", [3.0, 0.0]),
        ];
        assert_eq!(found.parts, expected);
    }
}
