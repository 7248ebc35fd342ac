//! What is planted is found, and nothing where nothing is: sweeps are written by the store that sweeps write, with
//! times and errors as a machine and a sampler would give them, and compared as the command compares them.

use std::path::Path;

use rand::RngExt;

use super::*;
use crate::accuracy::fit::generator;
use crate::accuracy::setting::Target;
use crate::accuracy::store::tests::sample;
use crate::accuracy::store::{
    Errors, PointRecord, PreparedRecord, Record, ReferenceRecord, SceneRecord, Store, SweepHeader,
};
use crate::bench::Preparation;
use crate::measure::Timing;
use wavecrest_core::film::Film;
use wavecrest_core::math::random::Generator;
use wavecrest_image::write::{Transfer, write};

/// How often each thing is tried.
const TRIES: u64 = 20;

const SEEDS: u64 = 16;

/// Noise of a machine and of samplers.
struct Noise(Generator);

impl Noise {
    fn unit(&mut self) -> f64 {
        self.0.random_range(0..1_usize << 30) as f64 / f64::from(1 << 30)
    }

    /// About normal, with a standard deviation of 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }

    /// A factor on a time: a spread of 1 per cent, and one render of ten that something else slows down.
    fn time(&mut self) -> f64 {
        let slow = if self.unit() < 0.1 { 1.0 + self.unit() / 2.0 } else { 1.0 };
        libm::exp(0.01 * self.normal()) * slow
    }
}

/// What a program is like.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Program {
    /// The machine's noise in this run.
    run: u64,
    /// A factor on the time of every render.
    slower: f64,
    /// A factor on the time of all that the machine does.
    machine: f64,
    /// The power with which the squared error of jittered points falls.
    jittered: f64,
    /// Whether samplers draw other random numbers.
    reseeded: bool,
    /// Whether something else ran for some rounds.
    disturbed: bool,
}

const USUAL: Program = Program {
    run: 1,
    slower: 1.0,
    machine: 1.0,
    jittered: -1.5,
    reseeded: false,
    disturbed: false,
};

fn sweep(folder: &Path, program: Program) {
    let header = SweepHeader { version: "1".into(), longest: 8, most: 256, least: 16 };
    let mut store = Store::open(folder, &header).unwrap();
    let name = "a".to_owned();
    let file = "a.json".into();
    let scene =
        SceneRecord { scene: name, file, fingerprint: "1".into(), size: [2, 2], primitives: 1 };
    store.admit(scene).unwrap();
    write(&Film::new(2, 2).unwrap(), &folder.join("a-scene.exr"), Transfer::Linear).unwrap();
    store
        .add(Record::Reference(ReferenceRecord {
            scene: "a".into(),
            target: Target::Scene,
            file: "a-scene.exr".into(),
            samples: 64,
            replicates: 4,
            standard_error: 1e-6,
            seconds: 1.0,
        }))
        .unwrap();
    let mut machine = Noise(generator(program.run));
    for _ in 0..6 {
        let time = Preparation { load: 0.01 * machine.time(), build: 0.02 * machine.time() };
        let record = PreparedRecord { scene: "a".into(), key: "exact".into(), time };
        store.add(Record::Prepared(record)).unwrap();
    }
    for seed in 0..SEEDS {
        for (number, (key, n, power)) in settings(program).into_iter().enumerate() {
            let numbers = seed * 1000 + number as u64 + if program.reseeded { 1 << 20 } else { 0 };
            let spread = libm::exp(0.1 * Noise(generator(numbers)).normal());
            let mse = libm::pow(n, power) * 1e-3 * spread;
            // Yardsticks and renders do not suffer alike.
            let [busy, busier] =
                if program.disturbed && seed % 5 > 3 { [1.4, 1.7] } else { [1.0; 2] };
            let own = program.slower * busy * machine.time();
            let seconds = (0.01 + 0.004 * n) * program.machine * own;
            let yardstick = 0.001 * program.machine * busier * machine.time();
            store.add(point(key, seed, [seconds, 1.0 / busy, yardstick], mse)).unwrap();
        }
    }
}

/// Keys, numbers of points, and powers.
fn settings(program: Program) -> Vec<(String, f64, f64)> {
    let mut settings = Vec::new();
    for (sampler, power) in [("random", -1.0), ("jittered", program.jittered), ("sobol", -1.55)] {
        for side in [2, 4, 8, 16] {
            let n = f64::from(side * side);
            settings.push((format!("exact lights={sampler}:{side}"), n, power));
        }
    }
    settings.extend(["fast", "exact"].map(|name| (name.to_owned(), 16.0, -1.0)));
    settings
}

fn point(key: String, seed: u64, [seconds, share, yardstick]: [f64; 3], mse: f64) -> Record {
    let timing = Some(Timing { seconds, processor: Some(share * seconds) });
    let error = Errors { mse, relative_mse: mse, bias: 0.0, flip: 0.0 };
    Record::Point(PointRecord { key, seconds, yardstick, timing, error, ..sample(seed) })
}

/// What is found of `after` in each try, against the usual program in another run.
fn tries(after: Program) -> Vec<Regression> {
    let one = |number| {
        let folder = tempfile::tempdir().unwrap();
        let sides = ["before", "after"].map(|name| folder.path().join(name));
        sweep(&sides[0], Program { run: 2 * number, ..USUAL });
        sweep(&sides[1], Program { run: 2 * number + 1, ..after });
        Regression::of(&sides[0], &sides[1]).unwrap()
    };
    (1..=TRIES).map(one).collect()
}

fn worse(found: &Regression) -> Vec<String> {
    let worse = found.ratios.iter().filter(|ratio| ratio.verdict == Verdict::Worse);
    worse.map(|ratio| format!("{}, {}", ratio.what, ratio.of)).collect()
}

/// Of each program, what is worse in every try, and what in none.
#[test]
fn what_is_worse_is_found_and_nothing_else() {
    let overall = Some("all settings, time at equal error");
    let jittered = Some("jittered points on lights, time at equal error");
    let slower = Program { slower: 1.03, ..USUAL };
    let everything: &[&str] = &[""];
    for (after, expected, never) in [
        (USUAL, None, everything),
        // Nor where the machine is slower in the second run,
        (Program { machine: 1.1, ..USUAL }, None, everything),
        // nor where the samplers draw other random numbers,
        (Program { reseeded: true, ..USUAL }, None, everything),
        // nor where something else ran for some rounds, which hide nothing.
        (Program { disturbed: true, ..USUAL }, None, everything),
        (Program { disturbed: true, ..slower }, overall, &[]),
        (slower, overall, &[", error"]),
        // The strata of one dimension are forgotten: the error falls as that of independent points.
        (Program { jittered: -1.0, ..USUAL }, jittered, &["random", "sobol"]),
    ] {
        for found in tries(after) {
            let worse = worse(&found);
            let finds = expected.is_none_or(|name| worse.iter().any(|what| what == name));
            let is_never = |what: &String| never.iter().any(|part| what.contains(part));
            assert!(finds && !worse.iter().any(is_never), "{after:?} {worse:?} {}", found.text());
            let is_busy = |warning: &String| warning.ends_with("busy: 3");
            assert_eq!(found.warnings.iter().any(is_busy), after.disturbed, "{after:?}");
            // Time and error of 3 samplers and 2 precisions, all together, and 1 build.
            assert_eq!(found.ratios.len(), 12, "{after:?}");
            assert!(after != USUAL || found.count(Verdict::Better) == 0, "{found:?}");
            let times = found.ratios.iter().filter(|ratio| ratio.of == "time at equal error");
            for ratio in times.filter(|_| after == slower) {
                assert!(ratio.low < 1.03 && 1.03 < ratio.high, "{ratio:?}");
            }
        }
    }
}

#[test]
fn an_interval_has_to_miss_1_by_more_than_the_tolerance() {
    let judged = |logs: &[f64]| {
        let (scene, what) = (String::new(), String::new());
        LogRatios { scene, what, of: "time", logs: logs.to_vec() }.judged(SIGNIFICANCE)
    };
    assert_eq!(judged(&[0.0; 4]).verdict, Verdict::Same);
    assert_eq!(judged(&[0.009; 4]).verdict, Verdict::Same, "within the tolerance");
    assert_eq!(judged(&[0.02; 4]).verdict, Verdict::Worse);
    assert_eq!(judged(&[-0.02; 4]).verdict, Verdict::Better);
    // A slow half of a run is no slower program.
    let half: Vec<f64> = (0..16).map(|n| if n < 8 { 0.06 } else { 0.0 }).collect();
    assert_eq!(judged(&half).verdict, Verdict::Same);
    // Student's distribution with 3 degrees of freedom, both tails together 1 per cent: 5.841, and
    // 3 per cent more in the approximation used.
    let found = judged(&[-0.03, -0.01, 0.01, 0.03]);
    let reach = 5.841 * (0.002_f64 / 3.0 / 4.0).sqrt();
    assert!((libm::log(found.high) - reach).abs() < 0.05 * reach, "{found:?}");
    assert_eq!(log_ratio(0.0, 0.0), 0.0);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error = Regression::of(folder.path(), folder.path()).unwrap_err().to_string();
    assert!(error.contains("cannot read the records of a sweep"), "{error}");
}
