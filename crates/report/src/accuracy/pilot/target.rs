//! Renders for a target error: as a pilot chooses, then with more points while the error that the
//! image may have is above the target.

use super::{Chosen, MOST_SIDE, MeasuredError, Pilot};
use wavecrest_base::error::Result;
use wavecrest_core::math::sampling::Points;

/// Largest number of renders for one target error.
const MOST_RENDERS: u32 = 4;

/// The last render for a target error.
#[derive(Clone, Debug)]
pub struct Reached<T> {
    /// Its choice of samples.
    pub choice: Chosen,
    /// What `render` returned.
    pub rendered: T,
    /// Its error, if it can be measured.
    pub found: Option<MeasuredError>,
    /// The number of renders.
    pub renders: u32,
}

/// Renders until the error is at most `target`, as far as its measurement can tell, or cannot become
/// smaller. `render` returns the error of its image; without one, no other render follows. `None` if
/// the pilot has no choice.
///
/// # Errors
/// As `render`.
pub fn reach<T>(
    pilot: &Pilot,
    target: f64,
    mut render: impl FnMut(&Chosen) -> Result<(T, Option<MeasuredError>)>,
) -> Result<Option<Reached<T>>> {
    let Some(mut choice) = pilot.for_error(target) else { return Ok(None) };
    let mut renders = 0;
    loop {
        renders += 1;
        let (rendered, found) = render(&choice)?;
        let missed = found.filter(|found| found.at_most > target && renders < MOST_RENDERS);
        match missed.and_then(|found| finer(&choice, found.at_most / target)) {
            Some(next) => choice = next,
            None => return Ok(Some(Reached { choice, rendered, found, renders })),
        }
    }
}

/// More points after an error `excess` times the target, as for independent points: this suffices
/// for any sampler. `None` if there are as many as possible.
fn finer(choice: &Chosen, excess: f64) -> Option<Chosen> {
    let now = choice.points.side;
    let side = ((f64::from(now) * excess).ceil() as u32).clamp(now, MOST_SIDE);
    let points = Points { side: side.max(MOST_SIDE.min(now + 1)), ..choice.points };
    let more = f64::from(points.count()) / f64::from(choice.points.count());
    let error = choice.error / more.sqrt();
    let seconds = choice.seconds * more;
    (points.side > now).then_some(Chosen { points, error, seconds, ..*choice })
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
    use super::*;
    use wavecrest_core::math::sampling::Sampling;

    #[test]
    fn a_target_out_of_reach_ends_at_the_most_points() {
        let points = |side| Points { sampling: Sampling::Sobol, side };
        let choice =
            |side| Chosen { axis: Axis::Pixel, points: points(side), error: 0.5, seconds: 2.0 };
        let next = finer(&choice(4), 1.5).unwrap();
        assert_eq!((next.points.side, next.seconds), (6, 4.5));
        assert_eq!(finer(&choice(4), 1.0001).unwrap().points.side, 5);
        assert_eq!(finer(&choice(4), 1e30).unwrap().points.side, MOST_SIDE);
        assert!(finer(&choice(MOST_SIDE), 1e30).is_none());
    }
}
