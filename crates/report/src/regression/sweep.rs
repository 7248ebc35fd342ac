//! Compares two sweeps of error against time.
//!
//! Settings that differ only in the number of points form a series. If their error falls with that
//! number, the ratio is of the time to an equal error: a ratio of errors is converted to one of
//! times by the power with which the error fell with the time before. Otherwise time and error at
//! equal settings are two ratios. Each is the geometric mean over the settings, of typical times
//! and of means of squared errors, seed by seed: two programs with the same random numbers make the
//! same errors, which cancel. On one machine the unit of time is a [yardstick](crate::yardstick) of
//! the same minute.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::unit::{Unit, busy, units};
use super::{Change, Estimate, Found, Regression, Side, log_ratio, typical};
use crate::accuracy::reference::FLOOR;
use crate::accuracy::setting::{Target, converges, series_of, words_of};
use crate::accuracy::store::{
    Circumstances, Header, PointRecord, PreparedRecord, Record, Recorded, ReferenceRecord,
    SceneRecord, TrialRecord, all, read,
};
use crate::summary::median;
use wavecrest_base::error::Result;
use wavecrest_image::compare::compare as compare_films;
use wavecrest_image::read::read as read_film;

/// Range of the powers with which a mean squared error falls with time: that of independent points
/// is -1.
const POWERS: [f64; 2] = [-2.5, -0.5];

/// The records of a sweep.
struct Sweep<'a> {
    folder: &'a Path,
    header: Header,
    records: Vec<Record>,
}

/// Renders shorter than this in seconds mostly start threads and allocate buffers: their times are
/// not compared.
const LEAST_RENDER: f64 = 0.001;

/// The results of a setting on one side, seed by seed.
#[derive(Clone)]
struct Column {
    seconds: Vec<f64>,
    squares: Vec<f64>,
}

/// A setting on both sides.
type Pair = [Column; 2];

/// The renders of a scene on one side: by series, then key, then seed.
type Series<'a> = BTreeMap<(Target, String), BTreeMap<&'a str, BTreeMap<u64, &'a PointRecord>>>;

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
    let mut regression =
        Regression { before: side(&sides[0]), after: side(&sides[1]), ..Regression::default() };
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
                regression.changes.extend(changes(name, &sides)?);
            }
        }
    }
    Ok(regression.judged(found))
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

/// Compares every series of a scene, all of them together, and the preparation.
fn points(scene: &str, sides: &[Sweep<'_>; 2], found: &mut Vec<Found>, warnings: &mut Vec<String>) {
    let on_one_machine = side(&sides[0]).machine == side(&sides[1]).machine;
    let records = sides.each_ref().map(|side| side.records.as_slice());
    let units = if on_one_machine { units(scene, records) } else { Default::default() };
    let busy = busy(&units);
    let quiet = busy.is_some();
    warnings.extend(about_busy_rounds(scene, busy.as_ref()));
    let busy = busy.unwrap_or_default();
    let [before, after] = sides.each_ref().map(|side| series(scene, &side.records));
    let (mut everything, mut short) = (Vec::new(), 0);
    for ((target, name), keys) in &before {
        let what = words_of(name, *target);
        let Some(others) = after.get(&(*target, name.clone())) else {
            warnings.push(format!("`{scene}`: {what} is missing after"));
            continue;
        };
        let falls = keys.keys().all(|key| converges(key));
        let floors =
            sides.each_ref().map(|side| if falls { floor(scene, *target, side) } else { 0.0 });
        let pairs = pairs([keys, others], floors, &units, &busy);
        let timed: Vec<Pair> =
            pairs.iter().filter(|pair| quiet && takes_time(pair)).cloned().collect();
        short += pairs.len() - timed.len();
        // Errors do not depend on how busy the machine is.
        let all = self::pairs([keys, others], floors, &units, &BTreeSet::new());
        let falls = falls && timed.len() > 1;
        let power = if falls { Some(power(&timed)) } else { None };
        let curves = if falls { curves(&pairs) } else { Vec::new() };
        let of = if power.is_some() { "time at equal error" } else { "time" };
        for (of, estimate) in [(of, time(&[(&timed, power)])), ("error", error(&all))] {
            let new = |estimate| Found::new(scene, what.clone(), of, estimate);
            found.extend(estimate.map(|e| Found { curves: curves.clone(), ..new(e) }));
        }
        everything.push((timed, power));
    }
    if quiet && short > 0 {
        let limit = LEAST_RENDER * 1e3;
        warnings.push(format!(
            "`{scene}`: only the errors of {short} settings are compared: they render in less than {limit} ms"
        ));
    }
    found.extend(together(scene, &everything));
    if quiet {
        found.extend(preparation(scene, sides));
    }
}

/// A warning about rounds left out because the machine was busy; `busy` is `None` if too few others
/// remain.
fn about_busy_rounds(scene: &str, busy: Option<&BTreeSet<u64>>) -> Option<String> {
    let cause = "the machine was busy";
    match busy.map(BTreeSet::len) {
        Some(0) => None,
        Some(rounds) => Some(format!("`{scene}`: rounds left out because {cause}: {rounds}")),
        None => Some(format!("`{scene}`: only errors are compared because {cause}")),
    }
}

/// All series of a scene as one.
fn together(scene: &str, series: &[(Vec<Pair>, Option<f64>)]) -> Option<Found> {
    let series: Vec<_> = series.iter().map(|(pairs, power)| (&**pairs, *power)).collect();
    let new =
        |estimate| Found::new(scene, "all settings".to_owned(), "time at equal error", estimate);
    time(&series).map(|estimate| Found { overall: true, ..new(estimate) })
}

fn series<'a>(scene: &str, records: &'a [Record]) -> Series<'a> {
    let mut series = Series::new();
    for point in all::<PointRecord>(records).filter(|point| point.scene == scene) {
        let keys = series.entry((point.target, series_of(&point.key))).or_default();
        keys.entry(&point.key).or_default().insert(point.seed, point);
    }
    series
}

/// The mean squared error up to which an error is noise of the reference.
fn floor(scene: &str, target: Target, sweep: &Sweep<'_>) -> f64 {
    let floor = reference(scene, target, sweep).map_or(0.0, |r| FLOOR * r.standard_error);
    floor * floor
}

fn reference<'a>(scene: &str, target: Target, sweep: &'a Sweep<'_>) -> Option<&'a ReferenceRecord> {
    all(&sweep.records).find(|r: &&ReferenceRecord| r.scene == scene && r.target == target)
}

/// The common settings of both sides, with their common seeds.
fn pairs<'a>(
    [before, after]: [&BTreeMap<&str, BTreeMap<u64, &'a PointRecord>>; 2],
    floors: [f64; 2],
    units: &[Unit; 2],
    busy: &BTreeSet<u64>,
) -> Vec<Pair> {
    let common: Vec<_> =
        before.iter().filter_map(|(key, one)| Some([one, after.get(key)?])).collect();
    let seeds = |of: &BTreeMap<u64, &PointRecord>| of.keys().copied().collect::<BTreeSet<_>>();
    let all = common.iter().flatten().map(|of| seeds(of));
    let seeds = &all.reduce(|a, b| &a & &b).unwrap_or_default() - busy;
    let column = |of: &BTreeMap<u64, &'a PointRecord>, unit: &Unit| {
        let points = || seeds.iter().filter_map(|seed| of.get(seed));
        let time = |p: &&PointRecord| p.seconds / unit.get(&p.seed).copied().unwrap_or(1.0);
        let squares = points().map(|p| p.error.mse).collect();
        Column { seconds: points().map(time).collect(), squares }
    };
    let pairs = common.into_iter().map(|[a, b]| [column(a, &units[0]), column(b, &units[1])]);
    let is_above_noise =
        |pair: &Pair| pair.iter().zip(floors).all(|(column, floor)| mean(&column.squares) >= floor);
    pairs.filter(is_above_noise).collect()
}

fn takes_time(pair: &Pair) -> bool {
    pair.iter().any(|column| median(&column.seconds) >= LEAST_RENDER)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

impl Column {
    fn time(&self, rounds: &[usize]) -> f64 {
        typical(&self.seconds, rounds)
    }

    fn square(&self, rounds: &[usize]) -> f64 {
        rounds.iter().filter_map(|round| self.squares.get(*round)).sum::<f64>()
            / rounds.len() as f64
    }
}

/// The ratio of times: at equal error along a power, if any.
fn time(series: &[(&[Pair], Option<f64>)]) -> Option<Estimate> {
    let pairs = || series.iter().flat_map(|(pairs, power)| pairs.iter().map(move |p| (p, power)));
    let (rounds, count) = (pairs().map(|(pair, _)| pair[0].seconds.len()).min()?, pairs().count());
    let log = |([before, after], power): (&Pair, &Option<f64>), rounds: &[usize]| {
        let error = power.map(|p| log_ratio(before.square(rounds), after.square(rounds)) / p);
        log_ratio(before.time(rounds), after.time(rounds)) - error.unwrap_or(0.0)
    };
    Estimate::of(rounds, |rounds| pairs().map(|pair| log(pair, rounds)).sum::<f64>() / count as f64)
}

/// The ratio of root mean squared errors.
fn error(pairs: &[Pair]) -> Option<Estimate> {
    let log = |[before, after]: &Pair, rounds: &[usize]| {
        log_ratio(before.square(rounds), after.square(rounds)) / 2.0
    };
    Estimate::of(pairs.first()?[0].seconds.len(), |rounds| {
        pairs.iter().map(|pair| log(pair, rounds)).sum::<f64>() / pairs.len() as f64
    })
}

/// The power with which the mean squared error fell with time before, by least squares in
/// logarithms.
fn power(pairs: &[Pair]) -> f64 {
    let logs: Vec<[f64; 2]> = pairs
        .iter()
        .map(|[before, _]| [median(&before.seconds), mean(&before.squares)].map(libm::log))
        .collect();
    let middle = [0, 1].map(|axis| mean(&logs.iter().map(|log| log[axis]).collect::<Vec<_>>()));
    let sum = |axis: usize| -> f64 {
        logs.iter().map(|log| (log[0] - middle[0]) * (log[axis] - middle[axis])).sum()
    };
    let power = sum(1) / sum(0);
    if power.is_finite() { power.clamp(POWERS[0], POWERS[1]) } else { -1.0 }
}

/// Root mean squared error against time, before and after.
fn curves(pairs: &[Pair]) -> Vec<Vec<[f64; 2]>> {
    let point = |c: &Column| [median(&c.seconds), mean(&c.squares).sqrt()];
    let curve = |side: usize| {
        let mut points: Vec<[f64; 2]> = pairs.iter().map(|pair| point(&pair[side])).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        points
    };
    vec![curve(0), curve(1)]
}

/// Preparation times below this in seconds are not compared: a scene is prepared a few times in a
/// row in a sweep, and so short a time is not significant.
const LEAST_PREPARATION: f64 = 0.01;

/// The preparation, if measured often enough.
fn preparation(scene: &str, sides: &[Sweep<'_>; 2]) -> Vec<Found> {
    let times = sides.each_ref().map(|side| {
        let mut times: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for p in all::<PreparedRecord>(&side.records).filter(|p| p.scene == scene) {
            times.entry(&p.key).or_default().push(p.time.load + p.time.build);
        }
        times
    });
    let [before, after] = &times;
    let one = |(key, before): (&&str, &Vec<f64>)| {
        let after = after.get(key)?;
        let takes_time = median(before).max(median(after)) >= LEAST_PREPARATION;
        let estimate = Estimate::of_times(before, after).filter(|_| takes_time)?;
        Some(Found::new(scene, words_of(key, Target::Scene), "loading time", estimate))
    };
    before.iter().filter_map(one).collect()
}

/// Deterministic values that changed.
fn changes(scene: &str, sides: &[Sweep<'_>; 2]) -> Result<Vec<Change>> {
    let mut changes = Vec::new();
    // Rays that leak or hit their own triangle again.
    let same = |a: &TrialRecord, b: &TrialRecord| {
        (&*a.scene, &a.scene, &a.precision) == (scene, &b.scene, &b.precision)
    };
    let share = |[tried, failed]: [u64; 2]| failed as f64 / tried.max(1) as f64;
    for sides in both(sides, same) {
        for (what, counts) in [
            ("leaks", sides.map(|trial| trial.leaks)),
            ("self-hits", sides.map(|trial| trial.self_hits)),
        ] {
            let [before, after] = counts.map(share);
            if before != after {
                let words = counts.map(|[tried, failed]| format!("{failed} of {tried}"));
                let what = format!("{what}, {}", sides[0].precision);
                changes.push(Change::new(scene, what, words, after > before));
            }
        }
    }
    for target in Target::ALL {
        changes.extend(references(scene, target, sides)?);
    }
    Ok(changes)
}

/// The records of one kind that are the same on both sides but for their results.
fn both<'a, R: Recorded>(
    sides: &'a [Sweep<'_>; 2],
    same: impl Fn(&R, &R) -> bool,
) -> Vec<[&'a R; 2]> {
    let pair = |before: &'a R| {
        let after = all::<R>(&sides[1].records).find(|after| same(before, after))?;
        Some([before, after])
    };
    all::<R>(&sides[0].records).filter_map(pair).collect()
}

/// References that differ by more than their standard errors allow.
fn references(scene: &str, target: Target, sides: &[Sweep<'_>; 2]) -> Result<Option<Change>> {
    let [Some(before), Some(after)] = sides.each_ref().map(|s| reference(scene, target, s)) else {
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
