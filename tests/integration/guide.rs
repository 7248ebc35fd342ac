//! The guide says what works: its commands are run, one after the other, in one folder with its scenes.

use std::path::Path;
use std::process::{Command, Output};

use crate::support::{folder, repository};

/// A fenced part of the guide.
struct Block {
    /// What follows the fence: the language, and what is to be done with it.
    mark: String,
    text: String,
    line: usize,
}

fn blocks() -> Vec<Block> {
    let guide = std::fs::read_to_string(repository("GUIDE.md")).expect("the guide");
    let mut blocks: Vec<Block> = Vec::new();
    let mut is_open = false;
    for (number, line) in guide.lines().enumerate() {
        match (line.strip_prefix("```"), is_open) {
            (Some(mark), false) => {
                blocks.push(Block { mark: mark.to_owned(), text: String::new(), line: number + 1 });
                is_open = true;
            }
            (Some(_), true) => is_open = false,
            (None, true) => {
                let block = blocks.last_mut().expect("one is open");
                block.text += line;
                block.text.push('\n');
            }
            (None, false) => {}
        }
    }
    assert!(!is_open, "the last block is not closed");
    blocks
}

/// Runs a line as a shell does in which `wavecrest` is the program.
fn run(line: &str, folder: &Path) -> Output {
    let line = format!("wavecrest() {{ \"$WAVECREST\" \"$@\"; }}\n{line}");
    let mut shell = Command::new("sh");
    shell.args(["-euc", &line]).env("WAVECREST", env!("CARGO_BIN_EXE_wavecrest"));
    shell.current_dir(folder).output().expect("the shell runs")
}

#[test]
#[cfg(unix)]
fn every_command_of_the_guide_works() {
    let folder = folder();
    let mut commands = 0;
    for Block { mark, text, line } in blocks() {
        match mark.split_whitespace().collect::<Vec<_>>()[..] {
            ["json", file] => std::fs::write(folder.path().join(file), text).expect("a file"),
            ["sh", "run"] => {
                for command in text.lines() {
                    let output = run(command, folder.path());
                    let told = String::from_utf8_lossy(&output.stderr);
                    let code = output.status.code();
                    assert_eq!(code, Some(0), "GUIDE.md, line {line}: {command}\n{told}");
                    // How well a time can be told depends on the machine, and on how it is built.
                    let is_timed = command.starts_with("wavecrest bench");
                    let warns = !is_timed && told.contains("warning");
                    assert!(!warns, "GUIDE.md, line {line}: {command}\n{told}");
                    commands += 1;
                }
            }
            ["sh"] => {}
            _ => panic!("GUIDE.md, line {line}: what is to be done with {mark:?}?"),
        }
    }
    assert!(commands > 25, "{commands} commands only");
    for file in ["ball.png", "knot.png", "all.exr", "map.png", "bench.html"] {
        assert!(folder.path().join(file).is_file(), "{file}");
    }
}

/// What cannot be run is at least understood: each command and option is there.
#[test]
fn commands_that_are_not_tried_have_no_unknown_option() {
    let folder = folder();
    for Block { mark, text, line } in blocks() {
        for command in text.lines().filter(|_| mark == "sh") {
            let words: Vec<&str> = command.split_whitespace().collect();
            let ["wavecrest", first, ..] = words[..] else {
                panic!("GUIDE.md, line {line}: {command}")
            };
            let name = if first.contains('.') { "render" } else { first };
            let mut help = crate::support::wavecrest(folder.path());
            let output = help.args([name, "--help"]).output().expect("the command runs");
            let help = String::from_utf8_lossy(&output.stdout).into_owned();
            let options = words.iter().filter(|word| word.starts_with("--"));
            for option in options.filter_map(|word| word.split('=').next()) {
                assert!(help.contains(option), "GUIDE.md, line {line}: {option}");
            }
        }
    }
}

/// The counts of the README are those of the commands that it names.
#[test]
fn the_readme_counts_what_the_self_test_counts() {
    let readme = std::fs::read_to_string(repository("README.md")).expect("the README");
    let scene = ["selftest", "scenes/TriMesh.json", "--case", "35", "--json"];
    let found = crate::support::run(&repository(""), &scene).stdout;
    let found: serde_json::Value = serde_json::from_slice(&found).expect("JSON");
    let trials = found["scene"]["trials"].as_array().expect("one for each precision");
    let counts = |precision: &str, of: &str| {
        let trial = trials.iter().find(|trial| trial["precision"] == precision).expect("a trial");
        ["tried", "failed"].map(|count| trial[of][count].as_u64().expect("a count"))
    };
    // Thousands are set apart.
    let grouped = |n: u64| format!("{} {:03}", n / 1000, n % 1000);
    let ([tried, lost], [also_tried, none]) = (counts("fast", "leaks"), counts("exact", "leaks"));
    assert_eq!((tried, none), (also_tried, 0));
    for of in ["self_hits", "agreement"] {
        let [tried, failed] = counts("exact", of);
        assert!(tried > 10_000 && failed == 0, "{of}: {failed} of {tried}");
    }
    let words = format!(
        "Of {} rays aimed at triangle edges in `TriMesh.json`, `fast` precision loses {}",
        grouped(tried),
        grouped(lost)
    );
    assert!(readme.contains(&words), "{words}");
    let cases = format!("{} hard cases", wavecrest_report::selftest::CASES.len());
    assert!(readme.contains(&cases), "{cases}");
}
