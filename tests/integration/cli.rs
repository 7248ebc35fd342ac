//! The command, run as a user runs it.

// Arguments, formats, what changes the image and what does not, names of files.
mod rendering;

// Several outputs, layers, and what files say of how they were made.
mod outputs;

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

// Progress, the image while it is not finished, and a viewer.
mod showing;

// Scripts for shells, and the manual.
mod shells;

use std::path::Path;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::support::{
    bytes, edited, folder, matte, pinhole, point_light, put, put_image, repository, run, scene,
    text, wall, wavecrest, with,
};
use crate::transcript;

/// A ball before a wall: 16 x 12 pixels, one light, one bounce.
fn ball() -> Value {
    crate::parts::ball([16, 12], 1)
}

/// A folder with the scene as `ball.json`.
fn with_ball() -> TempDir {
    with_scene(&ball().to_string())
}

fn with_scene(text: &str) -> TempDir {
    let folder = folder();
    put(folder.path(), "ball.json", text);
    folder
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

/// The names of the files in a folder.
fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |e: std::io::Result<std::fs::DirEntry>| e.expect("an entry").file_name();
    let mut names: Vec<String> = entries.map(|e| name(e).to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// A command as in a shell: variables of its environment, `wavecrest`, and arguments.
fn command(folder: &Path, line: &str) -> assert_cmd::Command {
    let mut command = wavecrest(folder);
    // That of an array job in which the tests may run.
    command.env_remove("SLURM_ARRAY_TASK_ID");
    let (variables, arguments) = line.split_once("wavecrest").expect("a command");
    command.envs(variables.split_whitespace().filter_map(|word| word.split_once('=')));
    command.args(arguments.split_whitespace());
    command
}

/// The files that sessions begin with. `moving.json` shows `tex-1.png`; `s.obj` has a material for each of two images, in
/// the order in which `convert` numbers them the other way round.
fn with_files() -> TempDir {
    let folder = with_ball();
    let at = folder.path();
    let keys = json!([{"frame": 1, "location": [0, 0, 5]}, {"frame": 2, "location": [0, 1, 5]}]);
    let camera = with(pinhole([8, 6], 40.0, 5.0), "path", json!({"keys": keys}));
    let wall = with(wall(4.0, -2.0, matte(0.8, [0.2, 0.4, 0.9])), "texture", "tex-1.png");
    let light = point_light(40.0, [2.0, 3.0, 4.0], [1.0; 3]);
    put(at, "moving.json", scene(0, &camera, &[light], &[wall]).to_string());
    for (name, level) in [("tex-1.png", 0.2), ("s-image0.png", 0.4), ("s-image1.png", 0.8)] {
        put_image(at, name, [2, 2], |_, _| [level; 3]);
    }
    put(
        at,
        "s.obj",
        "mtllib s.mtl\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
         usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 2/2\n",
    );
    put(at, "s.mtl", "newmtl a\nmap_Kd s-image1.png\nnewmtl b\nmap_Kd s-image0.png\n");
    put(at, "t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder
}

/// Runs the commands of a transcript one after the other in one folder. An answer is what is printed, what becomes of the
/// files there, and the exit code. Two commands are its own: `write NAME` makes a file of the lines that follow, and
/// `scene NAME OF` one of the scene OF, edited as the lines say.
fn session(topic: &str) {
    let folder = with_files();
    let at = folder.path();
    let contents = || -> Vec<(String, Vec<u8>)> {
        let is_file = |name: &String| at.join(name).is_file();
        files(at).into_iter().filter(is_file).map(|name| (name.clone(), bytes(at, &name))).collect()
    };
    transcript::check(topic, |line, more| {
        match line.split(' ').collect::<Vec<_>>()[..] {
            ["write", name] => put(at, name, more),
            ["folder", name] => std::fs::create_dir(at.join(name)).expect("a folder"),
            ["scene", name, of] => {
                let of = serde_json::from_slice(&bytes(at, of)).expect("a scene");
                put(at, name, edited(of, more).to_string());
            }
            _ => {
                let before = contents();
                let output = command(at, line).output().expect("the command runs");
                let after = contents();
                let changed = after.iter().filter(|file| !before.contains(file));
                let changed: String = changed.map(|(name, _)| format!("wrote {name}\n")).collect();
                let gone = before.iter().filter(|file| !after.iter().any(|(n, _)| *n == file.0));
                let gone: String = gone.map(|(name, _)| format!("removed {name}\n")).collect();
                let code = output.status.code().expect("it ends by itself");
                let said = [text(&output.stdout), text(&output.stderr)].concat();
                let said = said.split_inclusive('\n').filter(|line| !is_summary(line.trim_end()));
                let said: String = said.collect();
                return format!("{said}{changed}{gone}exit {code}");
            }
        }
        String::new()
    });
}

#[test]
fn what_cannot_be_done_is_refused_in_words_and_leaves_no_file() {
    session("commands");
}

#[test]
fn no_command_writes_over_a_file_that_it_reads() {
    session("overwriting");
}

#[test]
fn parts_that_cannot_be_are_refused_in_words() {
    session("parts");
}

#[test]
fn files_without_a_camera_are_framed_as_asked_for_and_told() {
    session("framing");
}

/// Each exit code is given where it should be, and told alike in the help, the manual and the guide.
#[test]
fn exit_codes_are_documented_alike_everywhere() {
    let folder = folder();
    let said = |arguments: &[&str]| text(&run(folder.path(), arguments).stdout).to_owned();
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let help = words(&said(&["--help"]));
    let manual = words(&said(&["man"]));
    let guide = std::fs::read_to_string(repository("GUIDE.md")).expect("the guide");
    let guide = guide.replace('`', "");
    let page = said(&["man"]);
    let lines: Vec<&str> = page.lines().collect();
    let listed = lines.windows(3).filter(|rows| rows[0] == ".TP" && rows[1].parse::<u8>().is_ok());
    let listed: Vec<(&str, &str)> = listed.map(|rows| (rows[1], rows[2])).collect();
    assert!(listed.len() >= 5, "{listed:?}");
    for (code, meaning) in listed {
        assert!(help.contains(&format!("{code} {meaning}")), "{help}");
        assert!(manual.contains(&format!(".TP {code} {meaning}")), "{manual}");
        assert!(guide.contains(&format!("\n| {code} | {meaning} |\n")), "{code} {meaning}");
    }
}
