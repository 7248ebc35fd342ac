//! Inputs that no person would write, on any compiler: those that failed once (`corpus/`), and a number
//! of new ones that follow from a seed each. The same targets are tried without end by the fuzzers of
//! `fuzz/`: CONTRIBUTING.md says how.
//!
//! `WAVECREST_FUZZ=17 cargo test --test fuzz` tries the inputs of seed 17 again;
//! `WAVECREST_FUZZ=0..1000000` tries as many.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stderr,
    clippy::print_stdout,
    unreachable_pub,
    reason = "a target fails by a panic, and the tests say where; the fuzzers reach it"
)]

mod mutate;
mod rays;
#[path = "../seeds.rs"]
mod seeds;
mod targets;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use mutate::Numbers;
use seeds::asked_for;

/// A function of `targets.rs`.
type Target = fn(&[u8]) -> bool;

/// How long one input may take: a thousand times as long as any does.
const PATIENCE: Duration = Duration::from_secs(60);

fn folder(kind: &str, name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/fuzz")).join(kind).join(name)
}

/// Every file of a folder, by name; none if there is no such folder.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), std::fs::read(path).expect("a file"))).collect()
}

fn seeds(name: &str) -> Vec<Vec<u8>> {
    let seeds: Vec<_> = files(&folder("seeds", name)).into_iter().map(|(_, bytes)| bytes).collect();
    assert!(!seeds.is_empty(), "{name} has no seeds");
    seeds
}

/// Whether `target` holds for `bytes`. What does not is written to a file.
fn holds(name: &str, target: Target, bytes: &[u8]) -> Result<bool, PathBuf> {
    catch_unwind(AssertUnwindSafe(|| target(bytes))).map_err(|_| {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-{name}"));
        std::fs::write(&path, bytes).expect("a file for the input that failed");
        path
    })
}

/// Tries `target` with what `input` makes of each seed. Of the usual inputs some are accepted and
/// some are not, or they would say little.
fn try_seeds(name: &str, target: Target, usual: u64, input: impl Fn(&mut Numbers) -> Vec<u8>) {
    let seeds = asked_for(0..usual);
    let (current, alone) = (AtomicU64::new(seeds.start), std::env::var("WAVECREST_FUZZ").is_ok());
    let again = |seed: u64| format!("WAVECREST_FUZZ={seed} cargo test --test fuzz {name}");
    let mut accepted = 0;
    std::thread::scope(|scope| {
        // Dropped when all is done, which ends the watch.
        let (_done, waiting) = std::sync::mpsc::channel::<()>();
        let current = &current;
        scope.spawn(move || {
            let mut last = None;
            while waiting.recv_timeout(PATIENCE) == Err(std::sync::mpsc::RecvTimeoutError::Timeout)
            {
                let seed = Some(current.load(Ordering::Relaxed));
                if seed == last {
                    eprintln!("{name}: no end to seed {seed:?}: {}", again(last.unwrap_or(0)));
                    std::process::abort();
                }
                last = seed;
            }
        });
        for seed in seeds.clone() {
            current.store(seed, Ordering::Relaxed);
            match holds(name, target, &input(&mut Numbers::new(seed))) {
                Ok(is_accepted) => accepted += u64::from(is_accepted),
                Err(path) => {
                    let file = path.display();
                    panic!("{name}: seed {seed} fails, input {file}; again: {}", again(seed));
                }
            }
        }
    });
    let tried = seeds.end - seeds.start;
    println!("{name}: {accepted} of {tried} accepted");
    if !alone {
        assert!(accepted * 50 > tried && accepted < tried, "{accepted} of {tried} accepted");
    }
}

/// Tries what failed once, and the seeds.
fn replay(name: &str, target: Target) {
    for (path, bytes) in files(&folder("corpus", name)) {
        assert!(holds(name, target, &bytes).is_ok(), "{} fails", path.display());
    }
    for (path, bytes) in files(&folder("seeds", name)) {
        assert_eq!(holds(name, target, &bytes), Ok(true), "{} is refused", path.display());
    }
}

/// Two tests for each target.
macro_rules! targets {
    ($($name:ident $count:literal $input:expr;)+) => {
        $(
            mod $name {
                use super::*;

                #[test]
                fn what_failed_once_holds() {
                    replay(stringify!($name), targets::$name);
                }

                #[test]
                fn inputs_of_many_seeds_hold() {
                    try_seeds(stringify!($name), targets::$name, $count, $input);
                }
            }
        )+

        #[test]
        fn no_folder_is_left_out() {
            for kind in ["corpus", "seeds"] {
                for entry in std::fs::read_dir(folder(kind, "")).expect("a folder") {
                    let name = entry.expect("an entry").file_name();
                    assert!([$(stringify!($name)),+].iter().any(|n| name == *n), "{kind}/{name:?}");
                }
            }
        }
    };
}

targets! {
    scene 3000 { let seeds = seeds("scene"); move |numbers| mutate::json(&seeds, numbers) };
    ply 20_000 { let seeds = seeds("ply"); move |numbers| mutate::file(&seeds, numbers) };
    obj 20_000 { let seeds = seeds("obj"); move |numbers| mutate::file(&seeds, numbers) };
    stl 20_000 { let seeds = seeds("stl"); move |numbers| mutate::file(&seeds, numbers) };
    mtl 20_000 { let seeds = seeds("mtl"); move |numbers| mutate::file(&seeds, numbers) };
    gltf 3000 { let seeds = seeds("gltf"); move |numbers| mutate::json(&seeds, numbers) };
    accel 200 mutate::bytes;
}
