//! A disk that is full and a folder that takes nothing cost no file that was there.

#![cfg(target_os = "linux")]

use std::path::Path;
use std::process::{Command, Stdio};

use super::{files, run_silently, with_scene};
use crate::parts::ball;
use crate::support::{bytes, folder, text};

/// Runs `script` where `disk` is a disk of 64 KiB, or says why not.
#[allow(clippy::print_stdout, reason = "a test that is skipped says so")]
fn on_small_disk(folder: &Path, script: &str) -> Option<String> {
    std::fs::create_dir(folder.join("disk")).expect("a folder");
    let script = format!("mount -t tmpfs -o size=64k none disk || exit 77\nset -e\n{script}");
    let output = Command::new("unshare")
        .args(["--user", "--map-root-user", "--mount", "sh", "-c", &script])
        .env("WAVECREST", env!("CARGO_BIN_EXE_wavecrest"))
        .current_dir(folder)
        .output();
    let output = match output {
        Ok(output) => output,
        Err(error) => {
            println!("SKIPPED: there is no unshare: {error}");
            return None;
        }
    };
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    match output.status.code() {
        Some(0) => Some(out.to_owned()),
        // Its own code, or that of the script, where the system does not let us have a disk.
        Some(1 | 77) if err.contains("unshare") || err.contains("mount") => {
            println!("SKIPPED: no small disk can be made here: {err}");
            None
        }
        code => panic!("{code:?}: {out}{err}"),
    }
}

#[test]
fn a_full_disk_leaves_the_older_image_and_nothing_else() {
    let folder = with_scene(&ball([200, 100], 1).to_string());
    // 240000 bytes do not fit, 64 x 48 pixels do.
    let script = "\
        $WAVECREST ball.json disk/out.pfm --width 64 --height 48\n\
        cp disk/out.pfm older.pfm\n\
        $WAVECREST ball.json disk/out.pfm 2>told && exit 3\n\
        cat told\n\
        cmp disk/out.pfm older.pfm\n\
        ls -A disk";
    let Some(said) = on_small_disk(folder.path(), script) else { return };
    assert_eq!(
        said,
        "error: disk/out.pfm: cannot write the file: the disk is full; \
         free some space or write to another disk\nout.pfm\n"
    );
}

/// The render goes on without its checkpoint, and says so.
#[test]
fn a_checkpoint_on_a_full_disk_does_not_stop_the_render() {
    let folder = with_scene(&ball([100, 100], 1).to_string());
    run_silently(folder.path(), &["ball.json", "usual.exr"]);
    let script = "\
        $WAVECREST -q ball.json out.exr --checkpoint disk/kept 2>told\n\
        cat told\n\
        ls -A disk";
    let Some(said) = on_small_disk(folder.path(), script) else { return };
    assert_eq!(
        said,
        "warning: disk/kept: cannot write the file: the disk is full; \
         free some space or write to another disk\n"
    );
    assert!(bytes(folder.path(), "out.exr") == bytes(folder.path(), "usual.exr"));
}

/// Opened, a pipe would wait for a writer, and its length is not known.
#[test]
fn pipes_are_no_images_and_no_parts() {
    let folder = folder();
    let made = Command::new("mkfifo").arg(folder.path().join("pipe")).status();
    assert!(made.expect("mkfifo runs").success());
    for (arguments, what) in [
        (&["merge", "pipe", "-o", "out.png"][..], "part"),
        (&["merge", "/dev/stdin", "-o", "out.png"], "part"),
        (&["diff", "pipe", "pipe"], "image"),
        (&["diff", "/dev/stdin", "pipe"], "image"),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_wavecrest"));
        command.current_dir(folder.path()).args(arguments);
        command.stdin(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the command runs");
        let _open = child.stdin.take();
        let output = child.wait_with_output().expect("a child");
        let file = arguments[1];
        let words = "it is not a regular file; name a regular file";
        assert_eq!(
            text(&output.stderr),
            format!("error: {file}: cannot read the {what}: {words}\n")
        );
        assert_eq!(output.status.code(), Some(2));
    }
    assert_eq!(files(folder.path()), ["pipe"]);
}
