//! The order of runs, their number, and which rounds are left out.

use super::*;

/// The run that is due.
#[derive(Clone, Copy)]
struct Turn {
    variant: usize,
    round: usize,
}

fn schedule(warmup: usize, most: usize, seconds: f64) -> RoundLimits {
    RoundLimits { warmup, most, seconds }
}

/// A run of this duration whose threads got these processors.
fn timing(seconds: f64, processors: f64) -> Timing {
    Timing { seconds, processor: Some(seconds * processors) }
}

type Measured = (TimedRuns<Turn>, Rounds);

/// The variants in the order in which they ran, and what was measured: of each run its turn.
fn run(
    schedule: RoundLimits,
    timing: impl Fn(Turn) -> Timing,
) -> (String, Measured, Vec<(u64, u64)>) {
    let (mut log, mut reported) = (String::new(), Vec::new());
    let one = |variant: usize| {
        let turn = Turn { variant, round: log.len() / 2 };
        log.push(if variant == 0 { 'A' } else { 'B' });
        Ok(Some((timing(turn), turn)))
    };
    let progress = &mut |done, all| reported.push((done, all));
    let measured = measure(2, &schedule, one, progress).unwrap().unwrap();
    (log, measured, reported)
}

fn rounds_kept(measured: &Measured) -> Vec<usize> {
    measured.0[0].iter().map(|(_, turn)| turn.round).collect()
}

#[test]
fn variants_take_turns_to_begin() {
    let (log, measured, _) = run(schedule(1, 4, 0.0), |_| timing(1.0, 2.0));
    assert_eq!(log, "ABBAABBAAB");
    assert_eq!(measured.1, Rounds { rounds: 4, left_out: 0, busy: 0 });
    for (variant, runs) in measured.0.iter().enumerate() {
        assert!(runs.iter().all(|(_, turn)| turn.variant == variant));
    }
    assert_eq!(rounds_kept(&measured), [1, 2, 3, 4]);
}

#[test]
fn short_runs_are_repeated_until_there_are_seconds_enough() {
    let rounds = |schedule, seconds| run(schedule, |_| timing(seconds, 1.0)).1.1.rounds;
    assert_eq!(rounds(schedule(1, 50, 1.0), 10.0), ENOUGH);
    assert_eq!(rounds(schedule(1, 50, 1.0), 0.0625), 16);
    assert_eq!(rounds(schedule(3, 50, 1.0), 0.001), 50);
    assert_eq!(rounds(schedule(1, 2, 1.0), 10.0), 2);
    assert_eq!(rounds(schedule(1, 50, 1.0), 0.0), 50);
    let never_without_a_warm_up = run(schedule(0, 1, 0.0), |_| timing(1.0, 1.0)).0;
    assert_eq!(never_without_a_warm_up, "ABBA");
}

#[test]
fn progress_rises_to_what_is_planned() {
    let (.., reported) = run(schedule(1, 50, 2.0), |_| timing(0.25, 1.0));
    // Two variants, and a round before those that are timed.
    let first = 2 * (1 + ENOUGH as u64);
    assert_eq!(reported[..5], [(0, first), (1, first), (2, first), (3, first), (4, 18)]);
    assert_eq!(reported.last(), Some(&(17, 18)));
}

#[test]
fn busy_rounds_are_left_out_and_measured_again() {
    let is_busy = |turn: Turn| [3, 5].contains(&turn.round) && turn.variant == 1;
    let (_, measured, _) =
        run(schedule(1, 6, 0.0), |turn| timing(1.0, if is_busy(turn) { 1.7 } else { 1.98 }));
    assert_eq!(rounds_kept(&measured), [1, 2, 4, 6, 7, 8]);
    assert_eq!((measured.1.left_out, measured.1.busy), (2, 0));
    // However long they take: a slower processor is none that another program uses.
    let slow = |turn: Turn| timing(if is_busy(turn) { 2.0 } else { 1.0 }, 1.98);
    assert_eq!(run(schedule(1, 6, 0.0), slow).1.1.left_out, 0);
    // Nor are rounds judged that are over before all threads are awake.
    let short = |turn: Turn| timing(1e-3, if is_busy(turn) { 0.5 } else { 1.98 });
    assert_eq!(run(schedule(1, 6, 0.0), short).1.1.left_out, 0);
}

#[test]
fn threads_that_never_get_what_they_could_use_are_told() {
    let told = waiting([0.5, 0.84].into_iter()).expect("a warning");
    assert!(told.starts_with("The threads got 84 % of the processors: "), "{told}");
    assert_eq!(waiting([0.9, 0.1].into_iter()), None);
    assert_eq!(waiting(std::iter::empty()), None);
}

#[test]
fn on_a_machine_that_stays_busy_the_best_rounds_are_kept() {
    let got = |round: usize| 1.0 + 0.1 * (round % 10) as f64;
    let (_, measured, _) = run(schedule(1, 6, 0.0), |turn| timing(1.0, got(turn.round)));
    assert_eq!(
        rounds_kept(&measured),
        [4, 5, 6, 7, 8, 9],
        "of 12: there are never more than two for one"
    );
    assert_eq!((measured.1.left_out, measured.1.busy), (6, 5));
}

#[test]
fn a_run_can_end_it() {
    let mut runs = 0;
    let one = |_| {
        runs += 1;
        Ok((runs < 7).then(|| (timing(1.0, 1.0), ())))
    };
    assert!(measure(3, &schedule(1, 9, 0.0), one, &mut |_, _| {}).unwrap().is_none());
    assert_eq!(runs, 7);
}
