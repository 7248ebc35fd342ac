//! The loop that times variants of one thing side by side.
//!
//! A round runs every variant once, so that slow phases of the machine affect all of them alike.
//! The first to run and the direction change from round to round, so that none always finds the
//! caches and the clock as the same other left them.
//!
//! Each run has its processor time, of all threads of the process, beside its wall-clock time.
//! While other programs use the processors, the process gets less of their time in a second: a round
//! in which it got clearly less than in the best round is *busy*. Shares of whole rounds are
//! compared, as several threads may have to wait for one another even on an idle machine, alike in
//! every round. Busy rounds are left out and measured again; how many is part of the result.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::summary::ENOUGH;
use wavecrest_base::error::Result;

/// Number and duration of timed rounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundLimits {
    /// Untimed rounds at the start, at least 1.
    pub warmup: usize,
    /// Largest number of timed rounds, without busy ones.
    pub most: usize,
    /// Total seconds of each variant, unless `most` is reached before.
    pub seconds: f64,
}

/// The duration of some work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Seconds of wall-clock time.
    pub seconds: f64,
    /// Seconds of processor time of all threads of the process; `None` on systems that do not tell.
    pub processor: Option<f64>,
}

/// The timed runs of each variant, round by round, with what is kept of each.
pub type TimedRuns<T> = Vec<Vec<(Timing, T)>>;

/// Numbers of rounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Rounds {
    /// Those that count.
    pub rounds: usize,
    /// Those that were left out because the machine was busy.
    pub left_out: usize,
    /// Those that were busy too, but are not left out: there were too few others.
    pub busy: usize,
}

/// That the machine was busy, in how many of all rounds; `None` if in none.
pub(crate) fn busy(all: impl IntoIterator<Item = Rounds>) -> Option<String> {
    let add = |[a, b, c]: [usize; 3], one: Rounds| [a + one.rounds, b + one.left_out, c + one.busy];
    let [rounds, out, busy] = all.into_iter().fold([0; 3], add);
    let (used, all) = (out + busy, rounds + out);
    (used > 0)
        .then(|| format!("The machine was busy in {used} of {all} rounds, {out} of them left out: close other programs"))
}

/// Threads that get less than this share of the processors that they could use wait for them, or have too little
/// work to share. With one other program on two processors it is 0.75, on an idle machine 0.96.
const LEAST_USED: f64 = 0.85;

/// That threads waited for processors, or for work: even the best of some runs got no larger of these `shares` of
/// the processors that its threads could use.
pub(crate) fn waiting(shares: impl Iterator<Item = f64>) -> Option<String> {
    let best = shares.reduce(f64::max).filter(|best| *best < LEAST_USED)?;
    Some(format!(
        "The threads got {:.0} % of the processors: close other programs, or render a larger image",
        100.0 * best
    ))
}

/// A round that got less than this share of the processor time of the best round, for each second,
/// is busy: on an idle machine, rounds differ by 1 to 2 per cent.
const LEAST_SHARE: f64 = 0.95;

/// Shorter rounds in seconds are never busy: waking the threads takes a considerable part of them.
pub(crate) const SHORT: f64 = 0.02;

/// Largest number of rounds, busy or not, as a multiple of those that are to be kept.
const TRIES: usize = 2;

/// Runs all of `variants` in turn as in `schedule`. `run` receives the number of a variant and
/// returns the duration of its run, with whatever else is to be kept of it, or `None` to end the
/// measurement without a result. If too few rounds are quiet, those of the others that got most processor time count too.
/// Before each run, `progress` receives the runs that are done, without those of busy rounds,
/// and the expected total.
///
/// # Errors
/// Those of `run`.
pub fn measure<T>(
    variants: usize,
    schedule: &RoundLimits,
    mut run: impl FnMut(usize) -> Result<Option<(Timing, T)>>,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Option<(TimedRuns<T>, Rounds)>> {
    let mut runs: TimedRuns<T> = (0..variants).map(|_| Vec::new()).collect();
    let (mut round, mut all) = (0_usize, Vec::new());
    let warmup = schedule.warmup.max(1);
    let (mut done, mut planned) = (0, schedule.planned(0, 0.0));
    let is_quiet = loop {
        for turn in 0..variants {
            let step = if round.is_multiple_of(2) { turn } else { variants - turn };
            let variant = (round + step) % variants;
            let before = (round.min(warmup) + done) * variants + turn;
            progress(before as u64, ((warmup + planned) * variants) as u64);
            let Some(found) = run(variant)? else { return Ok(None) };
            if round >= warmup {
                runs[variant].push(found);
            }
        }
        round += 1;
        if round <= warmup {
            continue;
        }
        all.push(runs.iter().filter_map(|runs| Some(runs.last()?.0)).sum());
        let is_quiet = quiet(&all);
        done = is_quiet.iter().filter(|quiet| **quiet).count();
        let seconds = |runs: &Vec<(Timing, T)>| {
            let quiet = runs.iter().zip(&is_quiet).filter(|(_, quiet)| **quiet);
            quiet.map(|((timing, _), _)| timing.seconds).sum::<f64>()
        };
        planned = schedule.planned(done, runs.iter().map(seconds).fold(f64::INFINITY, f64::min));
        if done >= planned || all.len() >= TRIES * planned {
            break is_quiet;
        }
    };
    let mut busy: Vec<usize> = (0..all.len()).filter(|round| !is_quiet[*round]).collect();
    let share = |round: &usize| all[*round].processors().unwrap_or_default();
    busy.sort_by(|a, b| share(b).total_cmp(&share(a)));
    busy.truncate(planned.saturating_sub(done));
    for runs in &mut runs {
        let mut round = 0..;
        let is_kept = |round| is_quiet[round] || busy.contains(&round);
        runs.retain(|_| round.next().is_some_and(is_kept));
    }
    let (rounds, busy) = (done + busy.len(), busy.len());
    Ok(Some((runs, Rounds { rounds, left_out: all.len() - rounds, busy })))
}

/// The numbers of up to `most` rounds, of which none but the first starts after so many `seconds`.
pub(crate) fn rounds(most: usize, seconds: f64) -> impl Iterator<Item = usize> {
    let start = Instant::now();
    (0..most).take_while(move |round| *round == 0 || start.elapsed().as_secs_f64() <= seconds)
}

/// Which of some rounds of the same work are not busy.
pub fn quiet(rounds: &[Timing]) -> Vec<bool> {
    let share = |round: &Timing| round.processors().filter(|_| round.seconds >= SHORT);
    let best = rounds.iter().filter_map(share).fold(0.0, f64::max);
    rounds
        .iter()
        .map(|round| share(round).is_none_or(|share| share >= LEAST_SHARE * best))
        .collect()
}

impl RoundLimits {
    /// The estimated total number of rounds after `done` of them, in which the fastest variant took
    /// `shortest` seconds: enough for an interval, and for the requested seconds.
    fn planned(&self, done: usize, shortest: f64) -> usize {
        let wanted = match done {
            0 => 1,
            _ if shortest >= self.seconds => done,
            _ => (self.seconds / shortest * done as f64).ceil().max(done as f64 + 1.0) as usize,
        };
        wanted.max(ENOUGH).min(self.most.max(1))
    }
}

impl Timing {
    /// Does `work`, and measures it.
    pub fn of<R>(work: impl FnOnce() -> R) -> (R, Self) {
        let (start, before) = (Instant::now(), processor_seconds(false));
        let result = work();
        let seconds = start.elapsed().as_secs_f64();
        let processor = before.zip(processor_seconds(false)).map(|(before, after)| after - before);
        (result, Self { seconds, processor })
    }

    /// The number of processors that worked for the process on average.
    pub fn processors(&self) -> Option<f64> {
        Some(self.processor? / self.seconds).filter(|processors| processors.is_finite())
    }
}

impl std::iter::Sum for Timing {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        let none = Self { seconds: 0.0, processor: Some(0.0) };
        all.fold(none, |sum, one| Self {
            seconds: sum.seconds + one.seconds,
            processor: sum.processor.zip(one.processor).map(|(a, b)| a + b),
        })
    }
}

/// Processor time so far: of this thread, or of all threads of this process.
#[cfg(unix)]
pub(crate) fn processor_seconds(of_thread: bool) -> Option<f64> {
    use rustix::time::{ClockId, clock_gettime};
    let clock = if of_thread { ClockId::ThreadCPUTime } else { ClockId::ProcessCPUTime };
    let time = clock_gettime(clock);
    Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

#[cfg(not(unix))]
pub(crate) fn processor_seconds(_: bool) -> Option<f64> {
    None
}

#[cfg(test)]
mod tests;
