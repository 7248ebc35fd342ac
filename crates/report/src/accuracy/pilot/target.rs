//! Renders for a target error: as a pilot chooses, then with more points while the error that the
//! image may have is above the target.

use std::path::Path;
use std::time::Instant;

use super::{Chosen, MOST_SIDE, MeasuredError, SAMPLERS, best, choices};
use crate::plot::number::figure;
use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::math::sampling::Points;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{Rendered, Watch};

/// Largest number of renders for one target error.
const MOST_RENDERS: u32 = 4;

/// The last render for a target error.
#[derive(Clone, Debug)]
pub struct Reached {
    /// Its choice of samples.
    pub choice: Chosen,
    /// What `render` returned.
    pub rendered: Rendered,
    /// Its error, if it is finished.
    pub found: Option<MeasuredError>,
    /// Whether it is below that of the render before.
    pub falls: bool,
    /// The number of renders.
    pub renders: u32,
    /// Seconds of the pilot.
    pub pilot: f64,
}

impl Reached {
    /// The warning that the error may still be above `target`, if so.
    pub fn unreached(&self, target: f64, file: &Path) -> Option<Warning> {
        let found = self.found.filter(|found| found.at_most > target)?;
        let most = figure(found.at_most);
        let falls = if self.falls { "" } else { ", and does not fall with more samples" };
        let message = format!("the target error {target} was not reached: it may be {most}{falls}");
        let remedy = "choose a larger error";
        let error = Error::new(ErrorKind::Usage, message).remedy(remedy).in_file(file);
        Some(Warning::from_error(&error))
    }
}

/// Renders `scene` until the error is at most `target`, as far as its measurement can tell, or does not become
/// smaller. A tree with `preset` is replaced by the one that the expected rays are worth. `render` returns the
/// image with its error; without one, no other render follows. `None` if `watch` ends the pilot.
///
/// # Errors
/// As [`choices`] and `render`.
pub fn reach(
    scene: &mut PreparedScene,
    mut preset: Option<&mut Preset>,
    target: f64,
    seed: u64,
    watch: &dyn Watch,
    mut render: impl FnMut(&PreparedScene, &Chosen) -> Result<(Rendered, Option<MeasuredError>)>,
) -> Result<Option<Reached>> {
    let original = scene.original();
    let start = Instant::now();
    let choices = choices(scene, SAMPLERS, target, seed, watch)?;
    let pilot = start.elapsed().as_secs_f64();
    let Some(mut choice) = best(&choices, target) else { return Ok(None) };
    let (mut renders, mut before) = (0, f64::INFINITY);
    loop {
        renders += 1;
        scene.resample(&original, &choice.samples());
        if let Some(preset) = preset.as_deref_mut() {
            let (held, rays) = (scene.accel.geometry().held(), scene.expected_rays());
            let best = Preset::choose(held as u64, rays);
            if best != *preset {
                scene.accel.rebuild(best);
                *preset = best;
            }
        }
        let (rendered, found) = render(scene, &choice)?;
        let falls = found.is_none_or(|found| found.error < before);
        let missed =
            found.filter(|found| found.at_most > target && falls && renders < MOST_RENDERS);
        before = found.map_or(before, |found| found.error);
        match missed.and_then(|missed| finer(&choice, missed, target)) {
            Some(next) => choice = next,
            None => return Ok(Some(Reached { choice, rendered, found, falls, renders, pilot })),
        }
    }
}

/// More points after an error that may be above `target`, as for independent points: this suffices
/// for any sampler. At most twice the side: the next error tells whether more are of use. `None` if as many as possible do
/// not suffice.
fn finer(choice: &Chosen, missed: MeasuredError, target: f64) -> Option<Chosen> {
    let now = choice.points.side;
    let wanted = f64::from(now) * missed.at_most / target;
    let side = (wanted.ceil() as u32).clamp(now + 1, 2 * now);
    let points = Points { side, ..choice.points };
    let more = f64::from(points.count()) / f64::from(choice.points.count());
    let error = missed.error / more.sqrt();
    let seconds = choice.seconds * more;
    (wanted <= f64::from(MOST_SIDE)).then_some(Chosen { points, error, seconds, ..*choice })
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
    use super::*;
    use wavecrest_core::math::sampling::Sampling;

    #[test]
    fn a_target_out_of_reach_ends_and_no_step_is_long() {
        let points = |side| Points { sampling: Sampling::Sobol, side };
        let axis = Axis::Pixel("");
        let choice = |side| Chosen { axis, points: points(side), error: 0.5, seconds: 2.0 };
        let finer = |side, excess| {
            finer(&choice(side), MeasuredError { error: 3.0, at_most: excess, share: 1.0 }, 1.0)
        };
        let next = finer(4, 1.5).unwrap();
        assert_eq!((next.points.side, next.error, next.seconds), (6, 2.0, 4.5));
        assert_eq!(finer(4, 1.0001).unwrap().points.side, 5);
        assert_eq!(finer(4, 200.0).unwrap().points.side, 8);
        assert!(finer(4, 300.0).is_none() && finer(MOST_SIDE, 1.0001).is_none());
    }
}
