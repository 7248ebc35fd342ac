//! Renders within a time.
//!
//! A pilot predicts how many points a render has time for. On a busy machine the render can turn out
//! much slower, so its pace is watched: once it is certain to take too long, it ends, and begins
//! again with as many points as the remaining time allows at that pace.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{Chosen, Pilot};
use wavecrest_base::error::Result;

/// Seconds since the start of the work.
pub type Clock<'a> = &'a (dyn Fn() -> f64 + Sync);

/// The share of the remaining time that a pilot may take.
const PILOT_SHARE: f64 = 0.25;

/// The share of the remaining time to plan for: the rest is for writing and for the error of the
/// pilot.
const PLANNED_SHARE: f64 = 0.9;

/// The share of its time after which the pace of a render is judged. Before that, few tiles are
/// finished.
const JUDGED_SHARE: f64 = 0.125;

/// A render is too slow if it would exceed its time by more than this share of it, and still has so
/// much before it. Parts of an image may differ as much in their cost, and beginning again is a loss
/// too.
const EXCESS: f64 = 0.5;

/// A time to finish within.
#[derive(Clone, Copy)]
pub struct Budget<'a> {
    clock: Clock<'a>,
    end: f64,
}

impl<'a> Budget<'a> {
    /// `seconds` from the start of the clock.
    pub fn new(clock: Clock<'a>, seconds: f64) -> Self {
        Self { clock, end: seconds }
    }

    /// Seconds left.
    pub fn left(&self) -> f64 {
        (self.end - (self.clock)()).max(0.0)
    }

    /// Whether a pilot that starts now may still begin work of some seconds.
    pub fn for_pilot(&self) -> impl Fn(f64) -> bool + use<'a> {
        let (clock, end) = (self.clock, (self.clock)() + PILOT_SHARE * self.left());
        move |seconds| clock() + seconds <= end
    }
}

/// What a render has to do beside the choice of its points.
#[derive(Clone, Copy, Debug)]
pub struct Overhead {
    /// The work to measure its error, as a share of that of the render.
    pub measuring: f64,
    /// The largest share of the image that is unfinished on all threads at once.
    pub in_flight: f64,
}

/// The pace of a render, which ends it once it is certain to take too long.
pub struct Pace<'a> {
    clock: Clock<'a>,
    start: f64,
    /// Its seconds; `None` for a render that cannot have fewer points.
    seconds: Option<f64>,
    in_flight: f64,
    /// The finished share, as bits of a double.
    done: AtomicU64,
    /// The expected seconds, once they are too many.
    expected: OnceLock<f64>,
}

impl<'a> Pace<'a> {
    fn new(budget: &Budget<'a>, choice: &Chosen, overhead: Overhead) -> Self {
        let seconds = budget.left() / (1.0 + overhead.measuring);
        Self {
            clock: budget.clock,
            start: (budget.clock)(),
            seconds: (choice.points.side > 1).then_some(seconds),
            in_flight: overhead.in_flight,
            done: AtomicU64::new(0.0_f64.to_bits()),
            expected: OnceLock::new(),
        }
    }

    /// The number of pixels finished, and of all.
    pub fn progress(&self, done: u64, all: u64) {
        self.done.store((done as f64 / all as f64).to_bits(), Ordering::Relaxed);
    }

    /// The seconds that the render was expected to take in all when it became too slow.
    pub fn expected(&self) -> Option<f64> {
        self.expected.get().copied()
    }

    /// Whether the render must end.
    pub fn is_late(&self) -> bool {
        let Some(seconds) = self.seconds else { return false };
        if self.expected().is_some() {
            return true;
        }
        let spent = (self.clock)() - self.start;
        if spent < JUDGED_SHARE * seconds {
            return false;
        }
        let done = f64::from_bits(self.done.load(Ordering::Relaxed));
        let all = |in_flight: f64| spent / (done + in_flight).min(1.0);
        // As if everything in flight were finished: the least that the render will take.
        let least = all(self.in_flight);
        if least - seconds.max(spent) <= EXCESS * seconds {
            return false;
        }
        self.expected.get_or_init(|| all(self.in_flight / 2.0));
        true
    }
}

/// Renders with the choice of `pilot` that has the least error within `budget`, and with fewer
/// points while a render is too slow. `render` returns whether it finished; it must end when the
/// pace is late. The result is that of the last render, with its choice; `None` if the pilot has no
/// choice.
///
/// # Errors
/// As `render`.
pub fn in_time<T>(
    pilot: &Pilot,
    budget: &Budget<'_>,
    overhead: Overhead,
    mut render: impl FnMut(&Chosen, &Pace<'_>) -> Result<(T, bool)>,
) -> Result<Option<(Chosen, T)>> {
    let (mut slower, mut most) = (1.0, f64::INFINITY);
    loop {
        let seconds = budget.left() * PLANNED_SHARE / (1.0 + overhead.measuring);
        let Some(choice) = pilot.for_time(f64::min(seconds / slower, most)) else {
            return Ok(None);
        };
        let pace = Pace::new(budget, &choice, overhead);
        let (result, is_finished) = render(&choice, &pace)?;
        match pace.expected() {
            Some(expected) if !is_finished => {
                slower = expected / choice.seconds;
                // A slower machine may look faster for a moment: the points become fewer each time.
                most = choice.seconds / 2.0;
            }
            _ => return Ok(Some((choice, result))),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::super::{Axis, Curve, Sampling};
    use super::*;

    /// Tiles of a render.
    const TILES: u32 = 100;

    const OVERHEAD: Overhead = Overhead { measuring: 0.1, in_flight: 0.02 };

    /// A pilot that found a second and 0.01 s for each point.
    fn pilot() -> Pilot {
        let errors = vec![(4.0, 0.1), (16.0, 0.05)];
        let (sampling, axis, seconds) = (Sampling::Sobol, Axis::Lights, [1.0, 0.01]);
        Pilot { curves: vec![Curve { sampling, axis, errors, seconds }] }
    }

    /// Renders within some seconds on a machine that is as many times slower than the pilot found in
    /// each half of an image: the points of each render, and the seconds of all.
    fn rendered(seconds: f64, slowness: [f64; 2]) -> (Vec<u32>, f64) {
        let now = Mutex::new(0.0);
        let clock = || *now.lock().expect("one thread");
        let mut points = Vec::new();
        let done = in_time(&pilot(), &Budget::new(&clock, seconds), OVERHEAD, |choice, pace| {
            points.push(choice.points.count());
            for tile in 0..TILES {
                if pace.is_late() {
                    return Ok(((), false));
                }
                let slower = slowness[usize::from(tile >= TILES / 2)];
                *now.lock().expect("one thread") += choice.seconds * slower / f64::from(TILES);
                pace.progress(u64::from(tile) + 1, u64::from(TILES));
            }
            Ok(((), true))
        });
        let (choice, ()) = done.expect("nothing fails").expect("the pilot has a choice");
        assert_eq!(points.last(), Some(&choice.points.count()));
        (points, clock())
    }

    #[test]
    fn a_render_that_keeps_its_pace_is_not_disturbed() {
        let (points, seconds) = rendered(10.0, [1.0; 2]);
        assert_eq!(points, [26 * 26], "27 * 27 would take more than 9 s with their measurement");
        assert!((seconds - 7.76).abs() < 1e-9, "{seconds}");
    }

    /// Without a look at the clock they would take up to 47 s.
    #[test]
    fn a_slow_render_begins_again_and_ends_in_time() {
        for slowness in [2.0, 3.0, 6.0] {
            let (points, seconds) = rendered(10.0, [slowness; 2]);
            assert!(points.len() == 2 && points[1] < points[0], "{slowness}: {points:?}");
            assert!(seconds < 10.5, "{slowness}: {seconds} s");
        }
        let (points, seconds) = rendered(10.0, [50.0; 2]);
        assert!(points.last() == Some(&1) && seconds < 75.0, "{points:?}: {seconds} s");
    }

    #[test]
    fn costly_tiles_at_the_start_do_not_end_a_render() {
        assert_eq!(rendered(10.0, [1.4, 0.6]).0.len(), 1);
    }

    /// With most of the image finished, a start with a few points would waste it.
    #[test]
    fn a_render_near_its_end_goes_on() {
        let (points, seconds) = rendered(10.0, [1.0, 4.0]);
        assert!(points.len() == 1 && (19.0..20.0).contains(&seconds), "{points:?}: {seconds} s");
        let (points, seconds) = rendered(10.0, [1.8, 20.0]);
        assert!(points == [26 * 26, 1] && seconds < 20.0, "{points:?}: {seconds} s");
    }

    #[test]
    fn one_point_is_rendered_to_the_end() {
        assert_eq!(rendered(0.0, [5.0; 2]).0, [1]);
    }

    #[test]
    fn a_pilot_has_a_part_of_the_time_left() {
        let clock = || 2.0;
        let fits = Budget::new(&clock, 10.0).for_pilot();
        assert!(fits(2.0) && !fits(2.1));
        let late = Budget::new(&clock, 1.0).for_pilot();
        assert!(!late(0.1));
    }
}
