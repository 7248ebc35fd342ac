//! The command, run as a user runs it.

// Arguments, formats, what changes the image and what does not, names of files.
mod rendering;

// Several outputs, layers, and what files say of how they were made.
mod outputs;

// Exit codes, messages, and what is left behind when something fails.
mod failures;

// Outputs that are inputs too.
mod overwriting;

// Shards, merge, checkpoints, signals.
mod farm;

// The JSON of `--stats`.
mod statistics;

// The other commands: check, explain, diff, generate; help.
mod commands;

// The commands that measure: bench, trace.
mod measuring;

// The command that sweeps error against time, and renders for an error or a time.
mod accuracy;

// The command that tells the story of a pixel.
mod probing;

// The command that tries hard cases.
mod selftest;

// Progress, the log, the image while it is not finished, and a viewer.
mod showing;

// Exit codes, and where they are told.
mod exits;

// Scripts for shells, and the manual.
mod shells;

use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;
use tempfile::TempDir;
use wavecrest_core::film::Film;
use wavecrest_image::read::read;

use crate::support::{folder, matte, pinhole, point_light, scene, sphere, wall, wavecrest, with};

/// A ball before a wall: 16 x 12 pixels, one light, one bounce.
fn ball() -> Value {
    let mirror = with(matte(0.7, [0.9, 0.3, 0.1]), "kr", 0.25);
    let shapes = [sphere([0.0; 3], 1.0, mirror), wall(4.0, -2.0, matte(0.8, [0.2, 0.4, 0.9]))];
    scene(
        1,
        &pinhole([16, 12], 40.0, 5.0),
        &[point_light(40.0, [2.0, 3.0, 4.0], [1.0; 3])],
        &shapes,
    )
}

/// A folder with the scene as `ball.json`.
fn with_ball() -> TempDir {
    with_scene(&ball().to_string())
}

fn with_scene(text: &str) -> TempDir {
    let folder = folder();
    std::fs::write(folder.path().join("ball.json"), text).expect("a file");
    folder
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    wavecrest(folder).args(arguments).output().expect("the command runs")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

/// Runs the command, which must succeed and print nothing but the line after success; returns nothing.
#[track_caller]
fn run_silently(folder: &Path, arguments: &[&str]) {
    let output = run(folder, arguments);
    let lines: Vec<&str> = text(&output.stderr).lines().collect();
    let is_silent = lines.iter().all(|line| is_summary(line)) && lines.len() <= 1;
    assert!(is_silent, "{arguments:?}: {lines:?}");
    assert_eq!(text(&output.stdout), "", "{arguments:?}");
    assert_eq!(output.status.code(), Some(0), "{arguments:?}");
}

/// Whether a line is the one that a render or a merge prints after success.
fn is_summary(line: &str) -> bool {
    line.contains("  ") && (line.contains(" s in all") || line.ends_with(" parts"))
}

/// Runs the command, which must fail with exactly this message.
#[track_caller]
fn run_wrongly(folder: &Path, arguments: &[&str], message: &str) {
    let output = run(folder, arguments);
    assert_eq!(text(&output.stderr), format!("error: {message}\n"), "{arguments:?}");
    assert_eq!(text(&output.stdout), "", "{arguments:?}");
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
}

/// The names of the files in a folder.
fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |e: std::io::Result<std::fs::DirEntry>| e.expect("an entry").file_name();
    let mut names: Vec<String> = entries.map(|e| name(e).to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn film(path: PathBuf) -> Film {
    read(&path).unwrap_or_else(|error| panic!("{error}"))
}
