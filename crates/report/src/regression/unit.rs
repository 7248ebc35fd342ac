//! The speed of the machine in each round of a sweep: times are compared in this unit, and rounds
//! in which the machine was busy are left out.

use std::collections::{BTreeMap, BTreeSet};

use super::LEAST_ROUNDS;
use crate::accuracy::store::{PointRecord, Record, all};
use crate::summary::median;

/// The unit of time in the round of each seed.
pub(super) type Unit = BTreeMap<u64, f64>;

/// The units of both sides of a comparison on one machine; empty, so that times are in seconds, if
/// one side has no yardstick.
pub(super) fn units(scene: &str, sides: [&[Record]; 2]) -> [Unit; 2] {
    let mut units = sides.map(|records| unit(scene, records));
    if !units.iter().all(|unit| unit.values().all(|seconds| *seconds > 0.0)) {
        return Default::default();
    }
    // Times remain in seconds of the machine as it was before.
    let usual = median(&units[0].values().copied().collect::<Vec<_>>());
    units.iter_mut().flat_map(|unit| unit.values_mut()).for_each(|seconds| *seconds /= usual);
    units
}

/// The machine counts as busy in a round whose yardstick took this many times that of the fastest
/// round.
const BUSY: f64 = 1.25;

/// The rounds in which the machine was busy on either side; `None` if too few others remain to
/// compare times.
pub(super) fn busy(units: &[Unit; 2]) -> Option<BTreeSet<u64>> {
    let rounds = || units.iter().flatten();
    let least = rounds().map(|(_, seconds)| *seconds).fold(f64::INFINITY, f64::min);
    let is_busy = |(seed, seconds): (&u64, &f64)| (*seconds > BUSY * least).then_some(*seed);
    let busy: BTreeSet<u64> = rounds().filter_map(is_busy).collect();
    let left = |unit: &Unit| unit.keys().filter(|seed| !busy.contains(seed)).count();
    let has_enough = |unit: &Unit| unit.is_empty() || left(unit) >= LEAST_ROUNDS;
    units.iter().all(has_enough).then_some(busy)
}

/// The median of the yardsticks of each round.
fn unit(scene: &str, records: &[Record]) -> Unit {
    let mut rounds: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    for point in all::<PointRecord>(records).filter(|point| point.scene == scene) {
        rounds.entry(point.seed).or_default().push(point.yardstick);
    }
    rounds.into_iter().map(|(seed, yardsticks)| (seed, median(&yardsticks))).collect()
}
