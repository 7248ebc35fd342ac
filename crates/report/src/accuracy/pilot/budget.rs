//! Renders within a time.
//!
//! Nothing has to be known before: the first render has one point, and each other one as many as the pace
//! of those before leaves time for. One that turns out too slow ends, and another
//! one has fewer. At the end of the time the last finished render counts: an image is there in time if
//! there is time for one point.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{Chosen, MOST_SIDE};
use crate::accuracy::setting::Axis;
use wavecrest_base::error::Result;
use wavecrest_core::math::sampling::{Points, Sampling};

/// Seconds since the start of the work.
pub type Clock<'a> = &'a (dyn Fn() -> f64 + Sync);

/// The share of the remaining time to plan for: the rest is for a machine that becomes slower.
const PLANNED_SHARE: f64 = 0.9;

/// The time to write an image and to end, as a share of the budget, and seconds for each pixel. Measured: 11 ns
/// for PPM, 22 for PNG, 26 for PFM and 68 for EXR, on one thread.
const ENDING_SHARE: f64 = 0.02;
const WRITING: f64 = 1e-7;

/// The share of its time after which the pace of a render is judged. Before that, few tiles are
/// finished.
const JUDGED_SHARE: f64 = 0.125;

/// A render ends if it would take more than this share of its time beyond it: parts of an image
/// differ in their cost.
const EXCESS: f64 = 0.1;

/// The share of the time of a render with one point that another one is expected to take.
const FIRST_SHARE: f64 = 0.25;

/// Lower bound on the cost of a point, relative to the mean time of a point of a render.
const LEAST_SHARE: f64 = 0.25;

/// The largest factor between the points of two renders, so that a wrong first time costs little, and the
/// smallest one that is worth another render.
const MOST_GROWTH: f64 = 64.0;
const LEAST_GROWTH: f64 = 1.25;

/// A time to finish within.
#[derive(Clone, Copy)]
pub struct Budget<'a> {
    clock: Clock<'a>,
    end: f64,
}

impl<'a> Budget<'a> {
    /// `seconds` from the start of the clock, for an image of so many pixels.
    pub fn new(clock: Clock<'a>, seconds: f64, pixels: f64) -> Self {
        Self { clock, end: seconds * (1.0 - ENDING_SHARE) - WRITING * pixels }
    }

    /// Seconds left until the image should be written.
    pub fn left(&self) -> f64 {
        (self.end - (self.clock)()).max(0.0)
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

/// The pace of a render, which ends it once it is certain to take too long, unless it is the first.
pub struct Pace<'a> {
    clock: Clock<'a>,
    start: f64,
    is_first: bool,
    seconds: f64,
    in_flight: f64,
    /// The finished share, as bits of a double.
    done: AtomicU64,
    /// The expected seconds, once they are too many.
    expected: OnceLock<f64>,
}

impl<'a> Pace<'a> {
    fn new(budget: &Budget<'a>, is_first: bool, overhead: Overhead) -> Self {
        Self {
            clock: budget.clock,
            start: (budget.clock)(),
            is_first,
            seconds: budget.left(),
            in_flight: overhead.in_flight,
            done: AtomicU64::new(0.0_f64.to_bits()),
            expected: OnceLock::new(),
        }
    }

    /// The number of pixels finished, and of all.
    pub fn progress(&self, done: u64, all: u64) {
        self.done.store((done as f64 / all as f64).to_bits(), Ordering::Relaxed);
    }

    /// Whether the render must end.
    pub fn is_late(&self) -> bool {
        self.excess().is_some() && !self.is_first
    }

    /// The seconds that the first render will take, once they are certain to be more than there were.
    pub fn overrun(&self) -> Option<f64> {
        self.excess().filter(|_| self.is_first && self.seconds > 0.0)
    }

    fn excess(&self) -> Option<f64> {
        if let Some(&expected) = self.expected.get() {
            return Some(expected);
        }
        let (seconds, spent) = (self.seconds, self.spent());
        if spent < JUDGED_SHARE * seconds {
            return None;
        }
        let done = f64::from_bits(self.done.load(Ordering::Relaxed));
        let all = |in_flight: f64| spent / (done + in_flight).min(1.0);
        // As if everything in flight were finished: the least that the render will take.
        if spent < seconds && all(self.in_flight) <= (1.0 + EXCESS) * seconds {
            return None;
        }
        Some(*self.expected.get_or_init(|| all(self.in_flight / 2.0)))
    }

    fn spent(&self) -> f64 {
        (self.clock)() - self.start
    }
}

/// The last of some renders within `budget`, with its choice of points along `axis`, and their number.
/// `render` returns whether it finished; it must end when the pace is late, and may end otherwise, after
/// which no other follows.
///
/// # Errors
/// As `render`.
pub fn in_time<T>(
    axis: Axis,
    budget: &Budget<'_>,
    overhead: Overhead,
    mut render: impl FnMut(&Chosen, &Pace<'_>) -> Result<(T, bool)>,
) -> Result<(Chosen, T, u32)> {
    let choice = |side, seconds| {
        let points = Points { sampling: Sampling::Sobol, side };
        Chosen { points, axis, error: f64::INFINITY, seconds }
    };
    let mut renders = 1;
    let pace = Pace::new(budget, true, overhead);
    let (mut image, is_finished) = render(&choice(1, 0.0), &pace)?;
    let mut last = choice(1, pace.spent());
    if !is_finished {
        return Ok((last, image, renders));
    }
    // Seconds for each more point, and the most of them: fewer after each render that is too slow. Part of the
    // first time does not depend on the points, and to try too many costs little.
    let (mut each, mut most) = (FIRST_SHARE * last.seconds, f64::INFINITY);
    loop {
        let count = f64::from(last.points.count());
        let seconds = budget.left() * PLANNED_SHARE / (1.0 + overhead.measuring);
        let affordable = count + (seconds - last.seconds) / each;
        let wanted = affordable.min(most).min(MOST_GROWTH * count);
        let next = choice((wanted.max(0.0).sqrt() as u32).min(MOST_SIDE), 0.0);
        let more = f64::from(next.points.count());
        if more < LEAST_GROWTH * count {
            return Ok((last, image, renders));
        }
        renders += 1;
        let pace = Pace::new(budget, false, overhead);
        let (found, is_finished) = render(&next, &pace)?;
        let spent = pace.spent();
        let of = |seconds: f64| {
            ((seconds - last.seconds) / (more - count)).max(LEAST_SHARE * seconds / more)
        };
        match pace.expected.get() {
            _ if is_finished => {
                each = of(spent);
                (last, image) = (Chosen { seconds: spent, ..next }, found);
            }
            Some(&expected) => {
                each = of(expected);
                // A slower machine may look faster for a moment.
                most = more / 2.0;
            }
            None => return Ok((next, found, renders)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    /// Tiles of a render.
    const TILES: u32 = 100;

    const OVERHEAD: Overhead = Overhead { measuring: 0.1, in_flight: 0.02 };

    /// Renders within some seconds, a pixel, which take `first` seconds, 0.01 s for each point, and a factor more
    /// for each half of an image from so many points on: the points of each render, those of the image, and the
    /// seconds of all.
    fn rendered(
        seconds: f64,
        first: f64,
        (from, slowness): (u32, [f64; 2]),
    ) -> (Vec<u32>, u32, f64) {
        let now = Mutex::new(0.0);
        let clock = || *now.lock().expect("one thread");
        let mut points = Vec::new();
        let budget = Budget::new(&clock, seconds, 1.0);
        let done = in_time(Axis::Pixel(""), &budget, OVERHEAD, |choice, pace| {
            let count = choice.points.count();
            points.push(count);
            for tile in 0..TILES {
                if pace.is_late() {
                    return Ok((0, false));
                }
                let slower = slowness[usize::from(tile >= TILES / 2)];
                let slower = if count >= from { slower } else { 1.0 };
                let all = (first + 0.01 * f64::from(count)) * slower;
                *now.lock().expect("one thread") += all / f64::from(TILES);
                pace.progress(u64::from(tile) + 1, u64::from(TILES));
            }
            Ok((count, true))
        });
        let (choice, image, renders) = done.expect("nothing fails");
        assert_eq!((choice.points.count(), renders as usize), (image, points.len()));
        (points, image, clock())
    }

    #[test]
    fn most_of_the_time_is_used_and_none_beyond_it() {
        for first in [0.0, 0.1, 1.0] {
            let (points, image, seconds) = rendered(10.0, first, (0, [1.0; 2]));
            assert_eq!(points.last(), Some(&image));
            assert!(seconds > 7.0 && seconds < 9.8, "{points:?}: {seconds}");
            assert!(image > 200, "{points:?}");
        }
    }

    #[test]
    fn a_slow_render_ends_and_another_has_fewer_points() {
        for slowness in [2.0, 6.0, 50.0] {
            let (points, image, seconds) = rendered(10.0, 0.01, (300, [slowness; 2]));
            assert!(points.iter().max() > Some(&image), "{points:?}");
            assert!(seconds < 10.0 && image >= 16, "{slowness}: {points:?}: {seconds}");
        }
    }

    /// The image before stays.
    #[test]
    fn a_render_that_is_not_finished_in_time_does_not_count() {
        let (points, image, seconds) = rendered(10.0, 0.01, (100, [1.0, 20.0]));
        assert!(image < 100 && points.last() >= Some(&image), "{points:?}");
        assert!(seconds < 10.0, "{seconds}");
    }

    #[test]
    fn costly_tiles_at_the_start_do_not_end_a_render() {
        let (points, image, _) = rendered(10.0, 0.01, (300, [1.05, 0.95]));
        assert_eq!(points.iter().max(), Some(&image), "{points:?}");
    }

    #[test]
    fn one_point_is_rendered_to_the_end() {
        assert_eq!(rendered(0.0, 1.0, (0, [5.0; 2])).0, [1]);
    }
}
