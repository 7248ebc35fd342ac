//! A copy of the sources with all faults in it, each behind a switch, and what is built from it.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::faults::{FAULTS, Fault};

/// Names the fault that is turned on, by its number; 0 is none.
const SWITCH: &str = "WAVECREST_PLANTED";

/// What every crate imports, and so can ask.
const BASE: &str = "crates/base/src/lib.rs";

/// Added to it.
const ASK: &str = "
/// Whether the fault of that number is turned on.
#[inline(always)]
pub fn is_planted(number: u32) -> bool {
    static NUMBER: std::sync::LazyLock<Option<u32>> =
        std::sync::LazyLock::new(|| std::env::var(\"WAVECREST_PLANTED\").ok()?.parse().ok());
    *NUMBER == Some(number)
}
";

/// Where instructions are chosen, and what makes it one level alone, as for fuzzers: the copy builds in half the time.
const LEVELS: &str = "crates/core/src/math/simd.rs";
const ONE_LEVEL: [(&str, &str); 3] =
    [("cfg!(fuzzing)", "true"), ("not(fuzzing)", "any()"), ("all(fuzzing, ", "all(")];

/// What the copy holds.
const PARTS: [&str; 8] =
    ["Cargo.toml", "Cargo.lock", "benches", "crates", "python", "scenes", "src", "tests"];

/// Kinds of files that are copied: sources and what they include.
const KINDS: [&str; 7] = ["rs", "toml", "lock", "css", "js", "json", "txt"];

/// Images, which are linked to.
const IMAGES: &str = "textures";

/// The repository.
fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

impl Fault {
    /// The text of its file.
    pub(crate) fn source(&self) -> String {
        read(&repository().join(self.file))
    }

    /// Where the right expression stands in a text, whatever its lines.
    pub(crate) fn places(&self, text: &str) -> Vec<Range<usize>> {
        let (text, right) = (characters(text), characters(self.right));
        let is_right =
            |window: &&[(usize, char)]| window.iter().map(|c| c.1).eq(right.iter().map(|c| c.1));
        let range = |window: &[(usize, char)]| {
            let (last, character) = window[window.len() - 1];
            window[0].0..last + character.len_utf8()
        };
        text.windows(right.len()).filter(is_right).map(range).collect()
    }

    fn plant(&self, number: usize, mut text: String) -> String {
        let place = self.places(&text)[0].clone();
        let (wrong, right) = (self.wrong, &text[place.clone()]);
        let either =
            format!("(if wavecrest_base::is_planted({number}) {{ {wrong} }} else {{ {right} }})");
        text.replace_range(place, &either);
        text
    }
}

/// The characters of a text with their places, but those that rustfmt puts in where it breaks a line: white space, and a
/// comma before a closing bracket.
fn characters(text: &str) -> Vec<(usize, char)> {
    let mut all: Vec<(usize, char)> = Vec::new();
    for (at, character) in text.char_indices().filter(|(_, c)| !c.is_whitespace()) {
        let closes = matches!(character, ')' | ']' | '}');
        if closes && all.last().is_some_and(|(_, last)| *last == ',') {
            all.pop();
        }
        all.push((at, character));
    }
    all
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The command with all faults in it, and the tests of properties.
pub(crate) struct Planted {
    command: PathBuf,
    properties: PathBuf,
}

impl Planted {
    /// Builds them, and what they depend on, in a target directory of their own.
    pub(crate) fn build() -> Self {
        let scratch = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let tree = scratch.join("planted");
        for part in PARTS {
            copy(&repository().join(part), &tree, Path::new(part));
        }
        let images = repository().join(IMAGES).canonicalize().expect("a folder");
        let link = tree.join(IMAGES);
        let is_linked = link.exists() || std::os::unix::fs::symlink(images, link).is_ok();
        assert!(is_linked, "images are linked to");
        // Not the usual directory: cargo knows crates by their place in the workspace, and would mix up the two.
        let target = scratch.join("planted-target");
        let built = |arguments: &[&str]| {
            let output = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
                .args(arguments)
                .args(["--locked", "--message-format=json", "--target-dir"])
                .arg(&target)
                .current_dir(&tree)
                .output()
                .expect("cargo starts");
            let errors = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "the faults do not compile:\n{errors}");
            let program = String::from_utf8_lossy(&output.stdout).lines().find_map(program_of);
            program.expect("cargo names what it built")
        };
        let properties = ["test", "--no-run", "--package=wavecrest-core", "--test=properties"];
        Self { command: built(&["build", "--package=wavecrest"]), properties: built(&properties) }
    }

    /// What the self-test says of a case with the fault turned on.
    pub(crate) fn selftest(&self, fault: usize, case: u32) -> Output {
        let case = case.to_string();
        let mut command = Command::new(&self.command);
        command.args(["selftest", "--quiet", "--precision", "exact", "--case", &case]);
        command.env(SWITCH, fault.to_string()).output().expect("the command starts")
    }

    /// What the properties of a case say.
    pub(crate) fn properties(&self, fault: usize, case: u32) -> Output {
        let mut command = Command::new(&self.properties);
        command.arg(format!("hc{case:02}_"));
        command.env(SWITCH, fault.to_string()).output().expect("the tests start")
    }
}

/// The program that a line of cargo's says was built.
fn program_of(line: &str) -> Option<PathBuf> {
    let message: serde_json::Value = serde_json::from_str(line).ok()?;
    Some(PathBuf::from(message["executable"].as_str()?))
}

/// Copies what is at `from` to its place in the tree. What has not changed is left as it is, and not built again.
fn copy(from: &Path, tree: &Path, place: &Path) {
    if from.is_dir() {
        for entry in fs::read_dir(from).expect("a folder") {
            let entry = entry.expect("an entry");
            copy(&entry.path(), tree, &place.join(entry.file_name()));
        }
    } else if from.extension().is_some_and(|kind| KINDS.iter().any(|known| kind == *known)) {
        let (text, to) = (changed(place, read(from)), tree.join(place));
        if fs::read_to_string(&to).is_ok_and(|old| old == text) {
            return;
        }
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        fs::write(to, text).expect("a file");
    }
}

/// The text of the file at `place` with the faults that belong there.
fn changed(place: &Path, mut text: String) -> String {
    for (number, fault) in (1..).zip(FAULTS).filter(|(_, fault)| place == Path::new(fault.file)) {
        text = fault.plant(number, text);
    }
    if place == Path::new(BASE) {
        text.push_str(ASK);
    }
    if place == Path::new(LEVELS) {
        text = ONE_LEVEL.iter().fold(text, |text, (many, one)| text.replace(many, one));
    }
    text
}
