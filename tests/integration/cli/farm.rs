//! `render --shard`, `merge`, `--checkpoint`, signals, and files that appear whole or not at all.

mod signals;
mod whole_files;

use std::path::Path;

use serde_json::Value;

use super::{files, run, run_silently, run_wrongly, text, with_ball, with_scene};
use crate::parts::ball;
use crate::support::{folder, wavecrest};

/// A scene whose render takes some seconds of a processor: 64 x 64 pixels of 576 samples, in two blocks.
fn long() -> Value {
    ball([64, 64], 24)
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn merged_files_are_those_of_one_process_in_every_format() {
    let folder = with_ball();
    for number in ["3", "1", "2"] {
        let (part, shard) = (format!("{number}.part"), format!("{number}/3"));
        run_silently(folder.path(), &["ball.json", &part, "--shard", &shard]);
    }
    for name in ["ppm", "png", "exr", "pfm"] {
        for options in [&[][..], &["--transfer", "srgb"]] {
            let (whole, merged) = (format!("whole.{name}"), format!("merged.{name}"));
            run_silently(folder.path(), &[&["ball.json", &whole], options].concat());
            let parts = ["merge", "2.part", "3.part", "1.part", "2.part", "-o", &merged];
            run_silently(folder.path(), &[&parts, options].concat());
            assert!(bytes(folder.path(), &whole) == bytes(folder.path(), &merged), "{name}");
        }
    }
}

#[test]
fn a_shard_can_come_from_the_scheduler() {
    let folder = with_ball();
    let shard = |asked: &str, variables: &[(&str, &str)]| {
        let mut command = wavecrest(folder.path());
        command.args(["-q", "ball.json", "auto.part", "--shard", asked]);
        for name in ["SLURM_ARRAY_TASK_ID", "SGE_TASK_ID", "PBS_ARRAY_INDEX", "LSB_JOBINDEX"] {
            command.env_remove(name);
        }
        command.envs(variables.iter().copied());
        let output = command.output().expect("the command runs");
        (output.status.code(), text(&output.stderr).to_owned())
    };
    let slurm = |id, min, max, count| {
        [
            ("SLURM_ARRAY_TASK_ID", id),
            ("SLURM_ARRAY_TASK_MIN", min),
            ("SLURM_ARRAY_TASK_MAX", max),
            ("SLURM_ARRAY_TASK_COUNT", count),
        ]
    };
    let sge = [
        ("SGE_TASK_ID", "2"),
        ("SGE_TASK_FIRST", "1"),
        ("SGE_TASK_LAST", "3"),
        ("SGE_TASK_STEPSIZE", "1"),
    ];
    let aws = [("AWS_BATCH_JOB_ARRAY_INDEX", "1"), ("AWS_BATCH_JOB_ARRAY_SIZE", "3")];
    let google = [("BATCH_TASK_INDEX", "1"), ("BATCH_TASK_COUNT", "3")];
    let expected = {
        run_silently(folder.path(), &["ball.json", "2.part", "--shard", "2/3"]);
        units_of(&bytes(folder.path(), "2.part"))
    };
    for (asked, variables) in [
        ("auto", &slurm("8", "7", "9", "3")[..]),
        ("auto", &slurm("1", "0", "2", "3")),
        ("auto/3", &slurm("2", "2", "2", "1")),
        ("auto", &sge),
        ("auto", &aws),
        ("auto/3", &aws[..1]),
        ("auto", &google),
        ("auto/3", &[("JOB_COMPLETION_INDEX", "1")]),
        ("auto/3", &[("PBS_ARRAY_INDEX", "2")]),
        ("auto/3", &[("SGE_TASK_ID", "undefined"), ("LSB_JOBINDEX", "2")]),
    ] {
        assert_eq!(shard(asked, variables), (Some(0), String::new()), "{variables:?}");
        assert_eq!(units_of(&bytes(folder.path(), "auto.part")), expected, "{variables:?}");
        std::fs::remove_file(folder.path().join("auto.part")).expect("it is there");
    }
    for (asked, variables, told) in [
        ("auto", &[][..], "no array job of a scheduler was found; name the shard instead"),
        ("auto", &[("PBS_ARRAY_INDEX", "2")], "does not say how many shards there are"),
        ("auto", &slurm("3", "1", "7", "3"), "the task numbers of the array have gaps"),
        ("auto/3", &[("PBS_ARRAY_INDEX", "4")], "the task has no shard: PBS_ARRAY_INDEX, found 4"),
        ("auto/3", &[("LSB_JOBINDEX", "0")], "number the tasks of the array from 1 to 3"),
    ] {
        let (code, said) = shard(asked, variables);
        assert_eq!(code, Some(2), "{variables:?}");
        assert!(said.contains(told), "{said}");
        assert_eq!(files(folder.path()), ["2.part", "ball.json"]);
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
fn shards_and_parts_that_make_no_sense_are_refused_before_the_scene_is_read() {
    let folder = with_ball();
    run_wrongly(
        folder.path(),
        &["no.json", "out.png", "--shard", "1/2"],
        "out.png: a shard must be written to a .part file; \
         use a name such as out-1.part, and join all parts with wavecrest merge",
    );
    run_wrongly(
        folder.path(),
        &["no.json", "out.png", "--checkpoint", "out.png"],
        "out.png: this file is also the output; write to another file",
    );
    run_wrongly(
        folder.path(),
        &["ball.json", "out.png", "--checkpoint", "ball.json"],
        "ball.json: this file is also the scene; write to another file",
    );
    run_wrongly(
        folder.path(),
        &["merge", "no.part", "-o", "out.png"],
        "no.part: cannot read the part: there is no such file; check the path",
    );
    run_wrongly(
        folder.path(),
        &["merge", "ball.json", "-o", "out.pmp"],
        "out.pmp: unknown image format, found .pmp; \
         did you mean .ppm? use .ppm, .png, .exr or .pfm",
    );
    for (arguments, told) in [
        (&["ball.json", "a.part", "--shard", "0/2"][..], "shards are numbered from 1 to 2"),
        (&["ball.json", "a.part", "--shard", "3/2"], "shards are numbered from 1 to 2"),
        (&["ball.json", "a.part", "--shard", "1"], "such as 3/7"),
        (&["ball.json", "a.part", "--shard", "auto/0"], "such as auto/7"),
        (&["ball.json", "a.png", "--resume"], "--checkpoint"),
        (&["ball.json", "a.png", "--every", "5"], "--checkpoint"),
        (&["ball.json", "a.png", "--checkpoint", "k", "--every", "0"], "a number above 0"),
        (&["ball.json", "a.png", "--checkpoint", "k", "--time-budget", "5"], "cannot be used"),
        (&["ball.json", "a.part", "--shard", "1/2", "--stats", "s"], "cannot be used"),
        (&["merge", "-o", "a.png"], "<PART>"),
    ] {
        let output = run(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(told), "{arguments:?}: {}", text(&output.stderr));
    }
    assert_eq!(files(folder.path()), ["ball.json"]);
}

#[test]
fn a_merge_that_lacks_a_shard_leaves_the_older_image() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "1.part", "--shard", "1/2"]);
    std::fs::write(folder.path().join("out.png"), "precious").expect("a file");
    run_wrongly(
        folder.path(),
        &["merge", "1.part", "-o", "out.png"],
        "shard 2/2 is missing; render it with --shard 2/2, or add its file, and merge again",
    );
    run_silently(folder.path(), &["ball.json", "2.part", "--shard", "2/2", "--seed", "7"]);
    run_wrongly(
        folder.path(),
        &["merge", "1.part", "2.part", "-o", "out.png"],
        "2.part: the seed differs from that of 1.part, found 7; \
         1.part has 0; merge parts of one image",
    );
    assert_eq!(bytes(folder.path(), "out.png"), b"precious");
}

#[test]
fn a_complete_checkpoint_leaves_nothing_to_render() {
    let folder = with_ball();
    run_silently(folder.path(), &["ball.json", "usual.exr"]);
    let command = ["ball.json", "out.exr", "--checkpoint", "kept", "--resume"];
    let output = run(folder.path(), &command);
    let told = "no checkpoint kept yet: starting from the beginning\n";
    assert!(output.status.success() && text(&output.stderr).starts_with(told));
    std::fs::remove_file(folder.path().join("out.exr")).expect("it is there");
    let output = run(folder.path(), &[&command[..], &["--stats", "stats.json"]].concat());
    let told = "resuming from kept: 100 % is done\n";
    assert!(output.status.success() && text(&output.stderr).starts_with(told));
    let stats: Value = serde_json::from_slice(&bytes(folder.path(), "stats.json")).expect("JSON");
    assert_eq!((&stats["resumed"], &stats["rays"]["primary"]), (&1.0.into(), &0.into()));
    assert!(bytes(folder.path(), "out.exr") == bytes(folder.path(), "usual.exr"));
    run_wrongly(
        folder.path(),
        &command[..4],
        "kept: the checkpoint exists already; resume from it with --resume, or remove it",
    );
    run_wrongly(
        folder.path(),
        &["no.json", "out.exr", "--checkpoint", "kept"],
        "kept: the checkpoint exists already; resume from it with --resume, or remove it",
    );
    run_silently(folder.path(), &[&command[..], &["-q"]].concat());
}

/// Samples that are not finite are counted by whoever renders them, again by who goes on, and by who merges.
#[test]
fn samples_that_are_not_finite_are_reported_for_every_kind_of_render() {
    let folder = folder();
    let scene = super::probing::scene(1e-15, 1e12);
    std::fs::write(folder.path().join("strong.json"), scene).expect("a file");
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
