//! The line that a render prints on success.

use std::time::Instant;

use super::args::{RenderArgs, Style};
use crate::common::{grouped, tell};
use wavecrest_core::counters::Counters;
use wavecrest_scene::memory;

/// The totals so far.
pub(super) struct Summary {
    start: Instant,
    rays: u64,
    traced_seconds: f64,
}

impl Summary {
    /// Empty totals of a command that began at `start`.
    pub(super) fn since(start: Instant) -> Self {
        Self { start, rays: 0, traced_seconds: 0.0 }
    }

    /// Adds a render with its seconds.
    pub(super) fn add(&mut self, counters: &Counters, seconds: f64) {
        self.rays += counters.primary_rays + counters.secondary_rays + counters.shadow_rays;
        self.traced_seconds += seconds;
    }

    /// Prints the line, unless notes are silenced or standard error is for programs: `name` is the
    /// output, `what` its size.
    pub(super) fn print(&self, args: &RenderArgs, name: &str, what: &str) {
        if args.scene_options.quiet || args.progress == Style::Json {
            return;
        }
        tell(&self.line(name, what, self.start.elapsed().as_secs_f64(), memory::peak()));
    }

    fn line(&self, name: &str, what: &str, all_seconds: f64, peak: Option<u64>) -> String {
        let [traced, all] = [self.traced_seconds, all_seconds].map(seconds);
        let memory = peak.map(|bytes| format!("  {} MB", grouped(bytes.div_ceil(1_000_000))));
        // The passes of `--as` count no rays.
        let rays = (self.rays > 0).then(|| format!("  {} rays", grouped(self.rays)));
        let (rays, memory) = (rays.unwrap_or_default(), memory.unwrap_or_default());
        format!("{name}  {what}{rays}  {traced} s traced, {all} s in all{memory}")
    }
}

/// Seconds to two digits or to the second, whichever says more.
fn seconds(seconds: f64) -> String {
    let digits = match seconds {
        s if s < 0.1 => 3,
        s if s < 10.0 => 2,
        s if s < 100.0 => 1,
        _ => 0,
    };
    format!("{seconds:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_one_line_with_units() {
        let mut summary = Summary::since(Instant::now());
        let counters = Counters {
            primary_rays: 900_000,
            secondary_rays: 21_000,
            shadow_rays: 600,
            ..Counters::default()
        };
        summary.add(&counters, 0.181);
        let line = summary.line("out.png", "1280x720", 0.5101, Some(107_300_000));
        assert_eq!(line, "out.png  1280x720  921 600 rays  0.18 s traced, 0.51 s in all  108 MB");
        summary.add(&counters, 200.0);
        let line = summary.line("a.part", "shard 1/3", 0.0123, None);
        assert_eq!(line, "a.part  shard 1/3  1 843 200 rays  200 s traced, 0.012 s in all");
    }
}
