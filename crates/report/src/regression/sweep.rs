//! Compares two sweeps of error against time.
//!
//! Settings that differ only in the number of points form a series. If their error falls with that
//! number, the ratio is of the time to an equal error: a ratio of errors is converted to one of
//! times by the power with which the error fell with the time before. Otherwise time and error at
//! equal settings are two ratios. Rounds with the same seed are compared: two programs with the
//! same random numbers make the same errors, which cancel. On one machine the unit of time is a
//! [yardstick](crate::measure::yardstick) of the same minute, and rounds in which other programs took the
//! processors are left out.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::{
    Change, LEAST_ROUNDS, LogRatios, Regression, SIGNIFICANCE, Side, TOLERANCE, log_ratio,
};
use crate::accuracy::fit::slope;
use crate::accuracy::reference::FLOOR;
use crate::accuracy::setting::{Target, converges, series_of, words_of};
use crate::accuracy::store::{
    Circumstances, PointRecord, PreparedRecord, Record, SceneRecord, SweepHeader, TrialRecord, all,
    busy_rounds, known, read,
};
use crate::summary::median;
use wavecrest_base::error::Result;
use wavecrest_image::compare::compare as compare_films;
use wavecrest_image::read::read as read_film;

/// Range of the powers with which a mean squared error falls with time: that of independent points
/// is -1.
const POWERS: [f64; 2] = [-2.5, -0.5];

/// Shorter times in seconds are not compared: such renders mostly start threads and allocate
/// buffers, and such scenes are not worth a comparison of their loading.
const LEAST_TIME: f64 = 0.001;

/// The records of a sweep.
struct Sweep<'a> {
    folder: &'a Path,
    header: SweepHeader,
    records: Vec<Record>,
}

/// The renders of a setting on one side, by seed.
type Renders<'a> = BTreeMap<u64, &'a PointRecord>;

/// The renders of a scene on one side: by series, then key.
type SeriesRenders<'a> = BTreeMap<(Target, String), BTreeMap<&'a str, Renders<'a>>>;

/// The logarithms of ratios at one setting, round by round.
type Logs = Vec<Vec<f64>>;

/// Compares the sweeps in two folders.
///
/// # Errors
/// If one of them cannot be read.
pub fn compare(before: &Path, after: &Path) -> Result<Regression> {
    let open = |folder| {
        let (header, records) = read(folder)?;
        Ok(Sweep { folder, header, records })
    };
    let sides = [open(before)?, open(after)?];
    let mut regression = Regression {
        before: side(&sides[0]),
        after: side(&sides[1]),
        tolerance: TOLERANCE,
        ..Regression::default()
    };
    let mut found = Vec::new();
    for scene in all::<SceneRecord>(&sides[0].records) {
        let name = &scene.scene;
        let other = all(&sides[1].records).find(|other: &&SceneRecord| other.scene == *name);
        match other {
            None => regression.warnings.push(format!("`{name}` is missing after")),
            Some(other) if other.size != scene.size => regression.warnings.push(format!(
                "`{name}` differs in size: {:?} before, {:?} after",
                scene.size, other.size
            )),
            Some(other) => {
                if other.fingerprint != scene.fingerprint {
                    let warning =
                        "differs before and after: another scene, or prepared in another way";
                    regression.warnings.push(format!("`{name}` {warning}"));
                }
                points(name, &sides, &mut found, &mut regression.warnings);
                found.extend(preparation(name, &sides));
                regression.changes.extend(changes(name, &sides)?);
            }
        }
    }
    // All verdicts together.
    let chance = SIGNIFICANCE / found.len() as f64;
    regression.ratios = found.into_iter().map(|found| found.judged(chance)).collect();
    Ok(regression)
}

fn side(sweep: &Sweep<'_>) -> Side {
    let last = all::<Circumstances>(&sweep.records).last();
    Side {
        path: sweep.folder.display().to_string(),
        version: sweep.header.version.clone(),
        commit: last.and_then(|c| c.commit.clone()),
        machine: last.map(|c| c.machine.clone()).unwrap_or_default(),
    }
}

/// Compares every series of a scene, and all of them together.
fn points(
    scene: &str,
    sides: &[Sweep<'_>; 2],
    found: &mut Vec<LogRatios>,
    warnings: &mut Vec<String>,
) {
    let mut units = sides.each_ref().map(|side| units(scene, &side.records));
    let on_one_machine = side(&sides[0]).machine == side(&sides[1]).machine;
    if !on_one_machine || units.iter().any(BTreeMap::is_empty) {
        units = Default::default();
    }
    let [busy, others] = sides.each_ref().map(|side| busy_rounds(scene, &side.records).1);
    let busy = &busy | &others;
    if !busy.is_empty() {
        let rounds = busy.len();
        warnings.push(format!("`{scene}`: rounds left out because the machine was busy: {rounds}"));
    }
    let [before, after] = sides.each_ref().map(|side| series(scene, &side.records));
    let mut everything = Logs::new();
    for ((target, name), keys) in &before {
        let what = words_of(name, *target);
        let Some(others) = after.get(&(*target, name.clone())) else {
            warnings.push(format!("`{scene}`: {what} is missing after"));
            continue;
        };
        let falls = keys.len() > 1 && keys.keys().all(|key| converges(key));
        let floors =
            sides.each_ref().map(|side| if falls { floor(scene, *target, side) } else { 0.0 });
        let common = keys.iter().filter_map(|(key, one)| Some([one, others.get(key)?]));
        let pairs: Vec<[&Renders<'_>; 2]> = common
            .filter(|pair| pair.iter().zip(floors).all(|(one, floor)| mse(one) >= floor))
            .collect();
        let power = if falls { Some(power(&pairs)) } else { None };
        let seeds = pairs.iter().flatten().map(|one| one.keys().copied().collect());
        let seeds: BTreeSet<u64> = seeds.reduce(|a, b| &a & &b).unwrap_or_default();
        let error =
            |[before, after]: [&PointRecord; 2]| log_ratio(before.error.mse, after.error.mse);
        let time = |[before, after]: [&PointRecord; 2]| {
            let [one, other] = [(before, &units[0]), (after, &units[1])]
                .map(|(point, units)| point.seconds / units.get(&point.seed).unwrap_or(&1.0));
            log_ratio(one, other) - power.map_or(0.0, |power| error([before, after]) / power)
        };
        let takes_time =
            |pair: &[&Renders<'_>; 2]| pair.iter().any(|one| seconds(one) >= LEAST_TIME);
        let timed: Vec<_> = pairs.iter().copied().filter(takes_time).collect();
        let times = logs(&timed, seeds.difference(&busy), time);
        let of = if power.is_some() { "time at equal error" } else { "time" };
        found.extend(together(scene, what.clone(), of, &times));
        let errors = logs(&pairs, seeds.iter(), |pair| error(pair) / 2.0);
        found.extend(together(scene, what, "error", &errors));
        everything.extend(times);
    }
    found.extend(together(scene, "all settings".to_owned(), "time at equal error", &everything));
}

/// The unit of time in the round of each seed: the median of its yardsticks. Old sweeps have none:
/// then times are in seconds.
fn units(scene: &str, records: &[Record]) -> BTreeMap<u64, f64> {
    let mut rounds: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    let has_unit = |p: &&PointRecord| p.scene == scene && p.yardstick > 0.0;
    for point in all::<PointRecord>(records).filter(has_unit) {
        rounds.entry(point.seed).or_default().push(point.yardstick);
    }
    rounds.into_iter().map(|(seed, yardsticks)| (seed, median(&yardsticks))).collect()
}

fn series<'a>(scene: &str, records: &'a [Record]) -> SeriesRenders<'a> {
    let mut series = SeriesRenders::new();
    for point in all::<PointRecord>(records).filter(|point| point.scene == scene) {
        let keys = series.entry((point.target, series_of(&point.key))).or_default();
        keys.entry(&point.key).or_default().insert(point.seed, point);
    }
    series
}

/// The mean squared error up to which an error is noise of the reference.
fn floor(scene: &str, target: Target, sweep: &Sweep<'_>) -> f64 {
    let floor = known(&sweep.records, scene, target).map_or(0.0, |r| FLOOR * r.standard_error);
    floor * floor
}

fn mse(renders: &Renders<'_>) -> f64 {
    renders.values().map(|p| p.error.mse).sum::<f64>() / renders.len() as f64
}

fn seconds(renders: &Renders<'_>) -> f64 {
    median(&renders.values().map(|p| p.seconds).collect::<Vec<_>>())
}

/// The logarithm of a ratio at each setting, in the rounds of these seeds.
fn logs<'a>(
    pairs: &[[&Renders<'_>; 2]],
    seeds: impl Iterator<Item = &'a u64> + Clone,
    log: impl Fn([&PointRecord; 2]) -> f64,
) -> Logs {
    let of = |pair: &[&Renders<'_>; 2]| {
        seeds.clone().map(|seed| log(pair.map(|one| one[seed]))).collect()
    };
    pairs.iter().map(of).collect()
}

/// The comparison of several settings as one; `None` for too few rounds.
fn together(scene: &str, what: String, of: &'static str, settings: &Logs) -> Option<LogRatios> {
    let rounds = settings.iter().map(Vec::len).min().filter(|rounds| *rounds >= LEAST_ROUNDS)?;
    let round = |n: usize| median(&settings.iter().map(|logs| logs[n]).collect::<Vec<_>>());
    Some(LogRatios { scene: scene.to_owned(), what, of, logs: (0..rounds).map(round).collect() })
}

/// The power with which the mean squared error fell with time before.
fn power(pairs: &[[&Renders<'_>; 2]]) -> f64 {
    let points = pairs.iter().map(|[before, _]| (seconds(before), vec![mse(before)]));
    slope(&points.collect::<Vec<_>>()).map_or(-1.0, |found| found.value.clamp(POWERS[0], POWERS[1]))
}

/// The time of loading and building.
fn preparation(scene: &str, sides: &[Sweep<'_>; 2]) -> Vec<LogRatios> {
    let [before, after] = sides.each_ref().map(|side| {
        let mut times: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for p in all::<PreparedRecord>(&side.records).filter(|p| p.scene == scene) {
            times.entry(&p.key).or_default().push(p.time.load + p.time.build);
        }
        times
    });
    let one = |(key, before): (&&str, &Vec<f64>)| {
        let after = after.get(key).filter(|_| median(before) >= LEAST_TIME)?;
        let logs = before.iter().zip(after).map(|(before, after)| log_ratio(*before, *after));
        together(scene, words_of(key, Target::Scene), "loading time", &vec![logs.collect()])
    };
    before.iter().filter_map(one).collect()
}

/// Deterministic values that changed.
fn changes(scene: &str, sides: &[Sweep<'_>; 2]) -> Result<Vec<Change>> {
    let mut changes = Vec::new();
    // Rays that leak or hit their own triangle again.
    let share = |[tried, failed]: [u64; 2]| failed as f64 / tried.max(1) as f64;
    let [before, after] = sides.each_ref().map(|side| {
        all(&side.records).filter(|t: &&TrialRecord| t.scene == scene).collect::<Vec<_>>()
    });
    for before in before {
        let Some(after) = after.iter().find(|t| t.precision == before.precision) else { continue };
        let pairs = [[before.leaks, after.leaks], [before.self_hits, after.self_hits]];
        for (what, counts) in ["leaks", "self-hits"].into_iter().zip(pairs) {
            let [old, new] = counts.map(share);
            if old != new {
                let words = counts.map(|[tried, failed]| format!("{failed} of {tried}"));
                let what = format!("{what}, {}", before.precision);
                changes.push(Change::new(scene, what, words, new > old));
            }
        }
    }
    for target in Target::ALL {
        changes.extend(references(scene, target, sides)?);
    }
    Ok(changes)
}

/// References that differ by more than their standard errors allow.
fn references(scene: &str, target: Target, sides: &[Sweep<'_>; 2]) -> Result<Option<Change>> {
    let [Some(before), Some(after)] =
        sides.each_ref().map(|side| known(&side.records, scene, target))
    else {
        return Ok(None);
    };
    let [one, other] = [(&sides[0], before), (&sides[1], after)]
        .map(|(side, reference)| read_film(&side.folder.join(&reference.file)));
    let distance = compare_films(&one?, &other?)?.rmse;
    let expected = libm::hypot(before.standard_error, after.standard_error);
    let words = [
        format!("a standard error of {:.1e}", before.standard_error),
        format!("{distance:.1e} from it, with a standard error of {:.1e}", after.standard_error),
    ];
    let what = format!("the reference for the {}", target.name());
    let differs = distance > FLOOR * expected && distance > 0.0;
    Ok(differs.then(|| Change::new(scene, what, words, true)))
}
