//! What the line to a page passes, measured by what the page says that it has taken.
//!
//! Images are made small enough for [`PERIOD`], and wait on this side while the line is full: then a movement is not
//! shown behind many older ones. A page says how long it drew, which is no fault of the line's.

use std::collections::VecDeque;
use std::time::Duration;

use tokio::time::Instant;

/// The time between two images on a slow line: a little less than the eighth of a second that looks like movement.
const PERIOD: Duration = Duration::from_millis(80);
/// The shortest delay at which an image is sent before the last has been drawn: else there would be few.
const FAR: Duration = Duration::from_millis(25);
/// How long words wait behind an image. A page that is hidden draws none.
pub(super) const LATE: Duration = Duration::from_secs(1);
/// The least time that is measured: less is chance.
const SHORTEST: Duration = Duration::from_millis(1);
/// The bytes of a first part, while nothing is known, and the least of any: less is mostly heads.
const FIRST: usize = 64 << 10;
const LEAST: usize = 4 << 10;
/// The weight of what was measured before: half, so that a line that changes is soon known.
const BEFORE: f64 = 0.5;
/// The bytes of a pixel in a first JPEG: those of noise of a sample a pixel, about.
const DENSITY: f64 = 0.3;

/// The measure of one line.
pub(super) struct Line {
    /// The bytes that were taken, and the seconds that they were passed in.
    bytes: f64,
    seconds: f64,
    /// The least time until anything was answered, and when an empty message was sent that is not.
    delay: Option<Duration>,
    pinged: Option<Instant>,
    /// What has been sent and not taken: bytes, and when.
    under_way: VecDeque<(usize, Instant)>,
    /// When the last that was taken had arrived.
    arrived: Instant,
    /// The bytes of a pixel in the last JPEG.
    pub(super) density: f64,
}

impl Line {
    pub(super) fn new() -> Self {
        let under_way = VecDeque::new();
        let (arrived, density) = (Instant::now(), DENSITY);
        Self { bytes: 0.0, seconds: 0.0, delay: None, pinged: None, under_way, arrived, density }
    }

    /// Bytes a second.
    fn rate(&self) -> Option<f64> {
        (self.seconds > 0.0).then(|| self.bytes / self.seconds)
    }

    pub(super) fn is_known(&self) -> bool {
        self.rate().is_some()
    }

    /// Whether words are to wait, too: not until it is known, nor when its page draws nothing for a while.
    pub(super) fn is_full(&self) -> bool {
        let is_late = |(_, sent): &(usize, Instant)| sent.elapsed() >= LATE;
        self.is_known() && !self.has_room() && !self.under_way.front().is_some_and(is_late)
    }

    /// The bytes that are passed between two images.
    pub(super) fn budget(&self) -> usize {
        self.rate().map_or(FIRST, |rate| (rate * PERIOD.as_secs_f64()) as usize).max(LEAST)
    }

    /// Whether another image, or a part of one, may be sent: only a line of some length holds more than one.
    pub(super) fn has_room(&self) -> bool {
        let bytes = self.under_way.iter().map(|(bytes, _)| bytes).sum::<usize>() as f64;
        let far = self.delay.filter(|delay| *delay >= FAR).zip(self.rate());
        let held = far.map_or(0.0, |(delay, rate)| rate * (delay + PERIOD).as_secs_f64());
        self.under_way.is_empty() || bytes <= held
    }

    /// An empty message is sent, which is answered at once.
    pub(super) fn ping(&mut self, now: Instant) {
        self.pinged.get_or_insert(now);
    }

    /// It has been answered.
    pub(super) fn pong(&mut self, now: Instant) {
        let took = self.pinged.take().map(|sent| now.saturating_duration_since(sent));
        self.delay = self.delay.into_iter().chain(took).min();
    }

    /// So many bytes are sent.
    pub(super) fn send(&mut self, bytes: usize, now: Instant) {
        self.under_way.push_back((bytes, now));
    }

    /// The first of what is under way has been taken, and drawn in so many seconds.
    pub(super) fn taken(&mut self, drawing: f64, now: Instant) {
        let Some((bytes, sent)) = self.under_way.pop_front() else { return };
        let drawing = Duration::try_from_secs_f64(drawing).unwrap_or_default();
        let arrived = now.checked_sub(drawing).unwrap_or(sent).max(sent);
        // It was passed after what was before it, and after the delay, which cannot be longer than all of it took.
        self.delay = self.delay.map(|delay| delay.min(arrived - sent));
        let begun = self.arrived.max(sent + self.delay.unwrap_or_default());
        let seconds = arrived.saturating_duration_since(begun).max(SHORTEST).as_secs_f64();
        self.bytes = BEFORE * self.bytes + bytes as f64;
        self.seconds = BEFORE * self.seconds + seconds;
        self.arrived = arrived;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keeps a line of this rate and delay full of images for a while: what is passed between two is about this.
    #[test]
    fn the_rate_of_a_line_is_found_whatever_its_delay_and_the_drawing() {
        for (rate, delay) in [(1.25e5, 0.1), (1.25e6, 0.1), (1.25e5, 0.001), (1e8, 0.0002)] {
            let start = Instant::now();
            let at = |seconds: f64| start + Duration::from_secs_f64(seconds);
            let (mut line, mut now, mut free) = (Line::new(), 0.0, 0.0_f64);
            line.ping(start);
            line.pong(at(delay));
            for _ in 0..100 {
                let mut arrivals = Vec::new();
                while line.has_room() {
                    let bytes = line.budget();
                    line.send(bytes, at(now));
                    free = free.max(now) + bytes as f64 / rate;
                    arrivals.push(free + delay);
                }
                for arrival in arrivals {
                    now = arrival + 0.02;
                    line.taken(0.02, at(now));
                }
            }
            let found = line.budget() as f64 / PERIOD.as_secs_f64() / rate;
            assert!((0.8..1.25).contains(&found), "{rate} {delay}: {found}");
        }
        let mut line = Line::new();
        for drawing in [f64::NAN, -1.0, f64::INFINITY, 1e300, 1e9] {
            line.send(1, Instant::now());
            line.taken(drawing, Instant::now());
        }
        assert!(line.has_room() && line.budget() == LEAST);
    }
}
