//! `render --shard`, `merge`, `--checkpoint`, signals, and files that appear whole or not at all.

mod signals;
mod whole_files;

use serde_json::Value;

use super::{command, files, run_silently, with_ball, with_scene};
use crate::parts::ball;
use crate::support::{bytes, folder, json_in, put, run, text};

/// A scene whose render takes some seconds of a processor: 64 x 64 pixels of 576 samples, in two blocks.
fn long() -> Value {
    ball([64, 64], 24)
}

#[test]
fn a_shard_can_come_from_slurm() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "2.part", "--shard", "2/3"]);
    let expected = units_of(&bytes(folder.path(), "2.part"));
    let slurm = |id, min, max, count| {
        let task = |name, value| format!("SLURM_ARRAY_TASK_{name}={value} ");
        [task("ID", id), task("MIN", min), task("MAX", max), task("COUNT", count)].concat()
    };
    for (asked, variables) in [
        ("auto", &*slurm(8, 7, 9, 3)),
        ("auto", &slurm(1, 0, 2, 3)),
        ("auto/3", &slurm(2, 2, 2, 1)),
        ("auto/3", "SLURM_ARRAY_TASK_ID=2 "),
    ] {
        let line = format!("{variables}wavecrest -q ball.json auto.part --shard {asked}");
        let output = command(folder.path(), &line).output().expect("the command runs");
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""), "{line}");
        assert_eq!(units_of(&bytes(folder.path(), "auto.part")), expected, "{line}");
    }
}

/// A part without what it says of the command that made it.
fn units_of(part: &[u8]) -> (Value, Vec<u8>) {
    let length = u32::from_le_bytes(part[12..16].try_into().expect("four bytes")) as usize;
    let mut header: Value = serde_json::from_slice(&part[16..16 + length]).expect("JSON");
    header.as_object_mut().expect("an object").remove("command").expect("a command");
    // The hash of a unit goes by the header, so it differs too: the first unit's sums.
    let start = 16 + length + 8;
    (header, part[start..start + 24 + 24 * 64].to_vec())
}

#[test]
fn a_complete_checkpoint_leaves_nothing_to_render() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "usual.exr"]);
    let arguments = ["ball.json", "out.exr", "--checkpoint", "kept", "--resume"];
    let output = run(folder.path(), &arguments);
    let told = "no checkpoint kept yet: starting from the beginning\n";
    assert!(output.status.success() && text(&output.stderr).starts_with(told));
    std::fs::remove_file(folder.path().join("out.exr")).expect("it is there");
    let output = run(folder.path(), &[&arguments[..], &["--stats", "stats.json"]].concat());
    let told = "resuming from kept: 100 % is done\n";
    assert!(output.status.success() && text(&output.stderr).starts_with(told));
    let stats = json_in(folder.path(), "stats.json");
    assert_eq!((&stats["resumed"], &stats["rays"]["primary"]), (&1.0.into(), &0.into()));
    assert!(bytes(folder.path(), "out.exr") == bytes(folder.path(), "usual.exr"));
    run_silently(folder.path(), &[&arguments[..], &["-q"]].concat());
}

/// Samples that are not finite are counted by whoever renders them, again by who goes on, and by who merges.
#[test]
fn samples_that_are_not_finite_are_reported_for_every_kind_of_render() {
    let folder = folder();
    let scene = super::probing::scene(1e-15, 1e12);
    put(folder.path(), "strong.json", scene);
    let warning = |arguments: &[&str]| {
        let output = run(folder.path(), &[arguments, &["--seed", "2"]].concat());
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        let told = text(&output.stderr).lines().find(|line| line.starts_with("warning: "));
        told.expect("a warning").to_owned()
    };
    let count = |warning: &str| -> u64 {
        let number = warning.split(' ').nth(1).expect("a number");
        number.parse().expect("a number")
    };
    let plain = warning(&["strong.json", "plain.exr"]);
    assert!(count(&plain) > 100 && plain.contains("count as black; the first is "), "{plain}");
    for resume in [&["--checkpoint", "kept"][..], &["--checkpoint", "kept", "--resume"]] {
        assert_eq!(warning(&[&["strong.json", "kept.exr"], resume].concat()), plain);
    }
    let shards = ["1/2", "2/2"].map(|shard| {
        count(&warning(&["strong.json", &format!("{}.part", &shard[..1]), "--shard", shard]))
    });
    assert_eq!(shards.iter().sum::<u64>(), count(&plain));
    let output = run(folder.path(), &["merge", "1.part", "2.part", "-o", "merged.exr"]);
    let told = format!("warning: {} samples were not finite and count as black\n", count(&plain));
    assert!(output.status.success() && text(&output.stderr).ends_with(&told));
    for name in ["kept.exr", "merged.exr"] {
        assert!(bytes(folder.path(), name) == bytes(folder.path(), "plain.exr"), "{name}");
    }
}
