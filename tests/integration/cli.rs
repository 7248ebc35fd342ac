//! The command, run as a user runs it.

// Arguments, formats, what changes the image and what does not, names of files.
mod rendering;

// Statistics, and images on standard output.
mod outputs;

// What signals leave behind.
mod signals;

// Disks that are full, and files that are none.
mod whole_files;

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
use std::process::{Command, Stdio};

use exr::prelude::{AttributeValue, FlatSamples, read_first_flat_layer_from_file};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::support::{
    bytes, edited, film, folder, json_in, matte, pinhole, point_light, put, put_image, repository,
    run, scene, text, wall, wavecrest, with,
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
    // How many processors there are depends on the machine.
    let of_threads = |line: &&str| line.starts_with("warning: more threads than processors");
    let lines: Vec<&str> = text(&output.stderr).lines().filter(|line| !of_threads(line)).collect();
    let is_silent = lines.iter().all(|line| is_summary(line)) && lines.len() <= 1;
    assert!(is_silent, "{arguments:?}: {lines:?}");
    assert_eq!(text(&output.stdout), "", "{arguments:?}");
    assert_eq!(output.status.code(), Some(0), "{arguments:?}");
}

/// Whether a line is the one that a render or a merge prints after success: names, counts in groups of three digits, times.
fn is_summary(line: &str) -> bool {
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    let is_count = |text: &str| {
        let mut groups = text.split(' ');
        groups.next().is_some_and(|first| is_number(first) && first.len() <= 3)
            && groups.all(|group| is_number(group) && group.len() == 3)
    };
    line.split("  ").skip(1).any(|part| match part.split_once(" s traced, ") {
        Some((traced, all)) => {
            is_number(traced) && all.strip_suffix(" s in all").is_some_and(is_number)
        }
        None => part.ends_with(" parts"),
    }) && line.split("  ").filter_map(|part| part.strip_suffix(" rays")).all(is_count)
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
fn command(folder: &Path, line: &str) -> Command {
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
    // Pictures of one pixel of four that differs in green, from the first.
    for (name, green) in
        [("black.exr", 0.0), ("green.pfm", 0.5), ("more.pfm", 0.6), ("none.pfm", f32::NAN)]
    {
        put_image(at, name, [2, 2], |x, y| [0.0, if (x, y) == (0, 1) { green } else { 0.0 }, 0.0]);
    }
    folder
}

/// What an EXR has beside its pixels: attributes of ours and of the program, and names of channels.
fn said_by_exr(file: &Path) -> String {
    let image = read_first_flat_layer_from_file(file).expect("an EXR");
    let own = &image.layer_data.attributes;
    let software = own.software_name.iter().map(|text| format!("software: {text}\n"));
    let text = |value: &AttributeValue| match value {
        AttributeValue::Text(text) => text.to_string(),
        other => panic!("{other:?}"),
    };
    let others = own.other.iter().map(|(name, value)| format!("{name}: {}\n", text(value)));
    let mut all: Vec<String> = software.chain(others).collect();
    all.sort();
    let channels =
        image.layer_data.channel_data.list.iter().map(|channel| match channel.sample_data {
            FlatSamples::U32(_) => format!("{} (integers)", channel.name),
            _ => channel.name.to_string(),
        });
    all.concat() + &channels.collect::<Vec<_>>().join(", ")
}

/// What a file says of the program and its work: what an EXR has beside its pixels, the texts of a PNG, comments of others.
fn said_by(file: &Path) -> String {
    if file.extension().is_some_and(|extension| extension == "exr") {
        return said_by_exr(file);
    }
    let content = std::fs::read(file).expect("a file");
    let mut said = Vec::new();
    for at in 4..content.len() {
        let (before, rest) = content.split_at(at);
        if let (Some(length), Some(text)) = (before.last_chunk(), rest.strip_prefix(b"tEXt")) {
            let text = &text[..u32::from_be_bytes(*length) as usize];
            said.push(String::from_utf8_lossy(text).replace('\0', ": "));
        }
    }
    let lines = String::from_utf8_lossy(&content);
    said.extend(lines.lines().filter(|line| line.starts_with("# ")).map(str::to_owned));
    if said.is_empty() { "nothing".to_owned() } else { said.join("\n") }
}

/// A file of a folder, or, after `:`, what a JSON file has at a place.
fn content(folder: &Path, of: &str) -> Vec<u8> {
    match of.split_once(':') {
        Some((file, place)) => {
            let json = json_in(folder, file);
            json.pointer(place).unwrap_or_else(|| panic!("{of}")).to_string().into_bytes()
        }
        None => bytes(folder, of),
    }
}

/// Runs the commands of a transcript one after the other in one folder. An answer is what is printed, what becomes of the
/// files there, and the exit code; after `>` is the file that gets what is printed. Other lines are not for the command:
/// `write NAME` makes a file of the lines that follow, `scene NAME OF` one of the scene OF, edited as the lines say, and
/// `copy NAME OF` a copy; `same` tells whether files, or places in JSON files, are equal, `show` what is there, `pixel`
/// what an image has at a place, and `said` what files say of how they were made.
fn session(topic: &str) {
    let folder = with_files();
    let at = folder.path();
    let contents = || -> Vec<(String, Vec<u8>)> {
        let is_file = |name: &String| at.join(name).is_file();
        files(at).into_iter().filter(is_file).map(|name| (name.clone(), bytes(at, &name))).collect()
    };
    let run = |line: &str, target: Option<&str>| {
        let before = contents();
        let output = command(at, line).output().expect("the command runs");
        let after = contents();
        let changed = after.iter().filter(|file| !before.contains(file));
        let changed: String = changed.map(|(name, _)| format!("wrote {name}\n")).collect();
        let gone = before.iter().filter(|file| !after.iter().any(|(n, _)| *n == file.0));
        let gone: String = gone.map(|(name, _)| format!("removed {name}\n")).collect();
        let code = output.status.code().expect("it ends by itself");
        let mut printed = text(&output.stdout);
        if let Some(target) = target {
            put(at, target, std::mem::take(&mut printed));
        }
        let said = [printed, text(&output.stderr)].concat();
        let said = said.split_inclusive('\n').filter(|line| !is_summary(line.trim_end()));
        format!("{}{changed}{gone}exit {code}", said.collect::<String>())
    };
    transcript::check(topic, |line, more| {
        match line.split(' ').collect::<Vec<_>>()[..] {
            ["write", name] => put(at, name, more),
            ["folder", name] => std::fs::create_dir(at.join(name)).expect("a folder"),
            ["scene", name, of] => put(at, name, edited(json_in(at, of), more).to_string()),
            ["copy", name, of] => put(at, name, bytes(at, of)),
            ["said", name] => return said_by(&at.join(name)),
            ["same", first, ref others @ ..] => {
                let first = content(at, first);
                let differs = others.iter().find(|other| content(at, other) != first);
                return differs.map_or("yes".to_owned(), |other| format!("no, {other} differs"));
            }
            ["show", ref all @ ..] => {
                let shown = all.iter().map(|of| text(&content(at, of)).to_owned());
                return shown.collect::<Vec<_>>().join("\n");
            }
            ["pixel", name, ref places @ ..] => {
                let film = film(at, name);
                let shown = places.iter().map(|place| {
                    let (x, y) = place.split_once(',').expect("a place");
                    let [x, y] = [x, y].map(|number| number.parse().expect("a number"));
                    format!("{:?}", film.pixel(x, y).expect("a pixel"))
                });
                return shown.collect::<Vec<_>>().join("\n");
            }
            _ => {
                return match line.split_once(" > ") {
                    Some((line, target)) => run(line, Some(target)),
                    None => run(line, None),
                };
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
fn renders_write_what_was_asked_for_and_say_how() {
    session("renders");
}

#[test]
fn no_choice_of_how_to_render_changes_a_byte() {
    session("choices");
}

#[test]
fn commands_answer_alike_everywhere() {
    session("answers");
}

#[test]
fn files_without_a_camera_are_framed_as_asked_for_and_told() {
    session("framing");
}

#[test]
fn views_turns_and_looks_show_what_they_say() {
    session("views");
}

#[test]
fn each_of_several_images_is_as_if_it_were_alone() {
    session("several");
}

#[test]
fn shares_of_an_image_make_that_of_one_process() {
    session("shares");
}

#[test]
fn what_needs_more_memory_than_is_allowed_is_refused() {
    session("memory");
}

#[test]
fn the_self_test_tells_what_is_the_same_and_what_is_lost() {
    session("selftest");
}

#[test]
#[cfg(target_os = "linux")]
fn an_unwritable_file_is_an_error_before_the_scene_is_read() {
    session("unwritable");
}

#[test]
#[cfg(feature = "view")]
fn what_cannot_be_shown_is_named() {
    session("view");
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

/// A reader that has seen enough, such as `head`, closes the pipe: that is no error and no panic.
#[test]
fn standard_output_may_be_closed_early() {
    let folder = with_ball();
    for arguments in [["explain", "ball.json"], ["check", "ball.json"]] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_wavecrest"))
            .args(arguments)
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the command starts");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""), "{arguments:?}");
    }
}
