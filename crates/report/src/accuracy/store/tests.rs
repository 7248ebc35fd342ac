use super::*;
use crate::measure::Timing;

/// Of the scene `a`, whose times are known.
fn sample(seed: u64) -> PointRecord {
    PointRecord {
        scene: "a".into(),
        target: Truth::Scene,
        key: "exact".into(),
        seed,
        seconds: 0.1,
        timing: Timing { seconds: 0.1, processor: Some(0.2) },
        rays: 7,
        error: ImageErrors { mse: 0.25, relative_mse: 0.5, bias: -0.1, flip: 0.3 },
    }
}

#[test]
fn a_round_with_less_of_the_processors_is_busy() {
    let point = |(seed, processor)| {
        let timing = Timing { seconds: 0.5, processor: Some(processor) };
        Record::Point(PointRecord { timing, ..sample(seed) })
    };
    // Two settings in each round, of which another program disturbs the second of seed 2.
    let times = [(0, 1.0), (0, 0.9), (1, 0.99), (1, 0.89), (2, 1.0), (2, 0.5)];
    let records: Vec<Record> = times.into_iter().map(point).collect();
    assert_eq!(busy_rounds("a", &records), (3, BTreeSet::from([2])));
    assert_eq!(busy_rounds("b", &records), (0, BTreeSet::new()));
    let threads = rayon::current_num_threads() as f64;
    assert_eq!(largest_share("a", &records), Some((1.0 + 0.9) / threads));
    assert_eq!(largest_share("b", &records), None);
}
