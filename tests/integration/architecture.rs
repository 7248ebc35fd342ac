//! What the compiler does not check of the architecture, read from the sources themselves.
//!
//! Crates can only import downwards. Within the tracing core and the crate of scenes a table of arrows says the same of
//! their modules; it is tight: an import that is not listed fails, and so does a listed one that is not made. Test
//! modules may import anything.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::support::repository;

/// A module, and the modules of its crate that it imports.
type Arrows = (&'static str, &'static str);

/// The modules of the tracing core, bottom to top.
const OF_CORE: [Arrows; 13] = [
    ("math", ""),
    ("plan", ""),
    ("film", ""),
    ("kernels", "math"),
    ("counters", ""),
    ("geometry", "counters kernels math"),
    ("accel", "counters geometry kernels math"),
    ("prepared", "accel counters geometry kernels math plan"),
    ("tile", "counters kernels prepared"),
    ("wavefront", "accel counters geometry kernels math plan prepared tile"),
    ("recursive", "accel counters kernels math prepared tile"),
    ("probe", "accel counters geometry kernels math prepared recursive"),
    ("render", "counters film kernels prepared recursive tile wavefront"),
];

/// The modules of the crate of scenes, bottom to top.
const OF_SCENE: [Arrows; 22] = [
    ("corners", ""),
    ("folder", ""),
    ("texture_source", ""),
    ("mesh", "corners"),
    ("format", "folder texture_source"),
    ("options", "format"),
    ("camera", "corners format options"),
    ("surface", "folder format texture_source"),
    ("image_file", "surface texture_source"),
    ("environment", "format surface"),
    ("shapes", "corners format mesh surface"),
    ("lights", "camera format shapes"),
    ("components", "camera environment lights mesh shapes surface texture_source"),
    ("query", "components"),
    ("mtl", "components format surface"),
    ("scene_file", "camera components environment format lights options query shapes surface"),
    ("systems", "components corners image_file mesh query surface"),
    ("staging", "camera components corners mesh mtl options query scene_file systems"),
    (
        "gltf",
        "components corners folder format image_file mesh options scene_file staging surface systems",
    ),
    (
        "load",
        "camera components folder format gltf image_file mesh mtl options query scene_file shapes staging \
         surface systems",
    ),
    ("write", "components folder format load mesh query scene_file"),
    ("generate", "mesh write"),
];

/// The sources of the tracing core, and those of the crate of scenes.
const CORE: &str = "crates/core/src";
const SCENE: &str = "crates/scene/src";
const CRATES: [(&str, &[Arrows]); 2] = [(CORE, &OF_CORE), (SCENE, &OF_SCENE)];

/// The files with `unsafe` code: unchecked reads of the tree, the memory that threads append its
/// parts to, and the allocator of the command.
const UNSAFE: [&str; 3] =
    ["crates/core/src/accel/arena.rs", "crates/core/src/accel/arena/units.rs", "src/allocator.rs"];

/// The most lines that a file may have, its tests apart.
const MOST_LINES: usize = 400;

/// A source file, without tests.
struct Source {
    /// Relative to the repository.
    path: PathBuf,
    /// The module of its crate that it belongs to.
    module: String,
    /// How many `super::` lead from it to the root of its crate.
    depth: usize,
    text: String,
    /// The same without comments.
    code: String,
}

impl Source {
    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).expect("a source file");
        let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default().to_owned();
        let path = path.strip_prefix(repository("")).expect("it is in the repository").to_owned();
        let within = path.iter().skip_while(|part| *part != "src").skip(1).collect::<PathBuf>();
        let names: Vec<String> =
            within.with_extension("").iter().map(|n| n.to_string_lossy().into_owned()).collect();
        let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        let code = code.collect::<Vec<_>>().join("\n");
        Self { module: names[0].clone(), depth: names.len(), path, text, code }
    }

    /// The modules with `arrows` that it names: through `crate`, or through as many `super`s.
    fn imports(&self, arrows: &[Arrows]) -> BTreeSet<String> {
        let upward = "super::".repeat(self.depth);
        let mut found = after(&self.code, "crate::");
        found.extend(after(&self.code, &upward));
        found.remove(&self.module);
        // A macro's or a function's own `super::super` within a shallower file is no arrow.
        found.retain(|name| arrows.iter().any(|(module, _)| module == name) || name == "{");
        found
    }
}

/// The identifiers that follow `prefix`, or `{` where a list does.
fn after(code: &str, prefix: &str) -> BTreeSet<String> {
    let word = |rest: &str| -> String {
        if rest.starts_with('{') {
            return "{".to_owned();
        }
        rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
    };
    let starts = code.match_indices(prefix).filter(|(at, _)| {
        !code[..*at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':')
    });
    starts.map(|(at, _)| word(&code[at + prefix.len()..])).collect()
}

/// Every source file but those of tests, and the roots of crates.
fn sources() -> Vec<Source> {
    let mut files = Vec::new();
    collect(&repository("src"), &mut files);
    for folder in std::fs::read_dir(repository("crates")).expect("the crates") {
        collect(&folder.expect("a crate").path().join("src"), &mut files);
    }
    files.retain(|path| {
        let is = |name: &str| path.file_name().is_some_and(|file| file == name);
        let within = path.strip_prefix(repository("")).expect("it is in the repository");
        !(is("lib.rs") || is("tests.rs") || within.iter().any(|part| part == "tests"))
    });
    assert!(files.len() > 60, "{} files only", files.len());
    files.iter().map(|path| Source::read(path)).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
}

/// The sources of a crate.
fn sources_of(folder: &str) -> impl Iterator<Item = Source> {
    sources().into_iter().filter(move |source| source.path.starts_with(folder))
}

/// What each module imports, and from which file.
fn arrows_found(folder: &str, arrows: &[Arrows]) -> BTreeMap<(String, String), PathBuf> {
    let mut found = BTreeMap::new();
    for source in sources_of(folder) {
        for import in source.imports(arrows) {
            found.entry((source.module.clone(), import)).or_insert(source.path.clone());
        }
    }
    found
}

#[test]
fn modules_import_what_the_tables_allow_and_nothing_else() {
    let mut wrong = Vec::new();
    for (folder, arrows) in CRATES {
        let found = arrows_found(folder, arrows);
        for ((module, import), file) in &found {
            let allowed = arrows.iter().find(|(name, _)| name == module);
            if !allowed.is_some_and(|(_, allowed)| allowed.split(' ').any(|name| name == import)) {
                wrong.push(format!("{} imports {import}, which {module} may not", file.display()));
            }
        }
        for (module, allowed) in arrows {
            for import in allowed.split_whitespace() {
                if !found.contains_key(&((*module).to_owned(), import.to_owned())) {
                    wrong.push(format!("{module} may import {import} but does not: drop it here"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_arrows_point_downward() {
    for (_, arrows) in CRATES {
        let height = |name: &str| arrows.iter().position(|(module, _)| *module == name);
        for (module, imports) in arrows {
            for import in imports.split_whitespace() {
                assert!(height(import) < height(module), "{module} imports {import}");
            }
        }
    }
}

#[test]
fn every_module_is_in_a_table() {
    for (folder, arrows) in CRATES {
        let modules: BTreeSet<String> = sources_of(folder).map(|source| source.module).collect();
        let listed: BTreeSet<String> = arrows.iter().map(|(name, _)| (*name).to_owned()).collect();
        assert_eq!(modules, listed);
    }
}

#[test]
fn three_files_have_unsafe_code() {
    let words = |code: &str| {
        // The policies of a page have words of their own.
        code.replace("unsafe-inline", "")
            .split(|c: char| !(c.is_alphanumeric() || c == '_'))
            .any(|word| matches!(word, "unsafe" | "unsafe_code"))
    };
    let found: BTreeSet<PathBuf> =
        sources().into_iter().filter(|s| words(&s.code)).map(|s| s.path).collect();
    assert_eq!(found, UNSAFE.map(PathBuf::from).into());
}

/// Where numbers decide what is hit and what is seen.
const NUMERIC: &[&str] = &[CORE, SCENE];

/// The numbers written with digits in a line of code.
fn literals(line: &str) -> Vec<f64> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_');
    let joined = line.replace("e-", "e\u{2212}");
    let words = joined.split(|c: char| !(is_part(c) || c == '\u{2212}'));
    let numbers = words.filter(|word| word.starts_with(|c: char| c.is_ascii_digit()));
    let plain = |word: &str| {
        let word = word.replace('\u{2212}', "-").replace('_', "");
        word.trim_end_matches("f32").trim_end_matches("f64").parse().ok()
    };
    numbers.filter_map(plain).collect()
}

/// A tolerance has a name, and beside the name stands where it comes from.
#[test]
fn no_small_constant_is_unexplained() {
    assert_eq!(literals("let x = 1.5e-6_f32 * y1 + 0x10 as f32 - 2.0;"), [1.5e-6, 2.0]);
    let is_small = |x: &f64| (*x > 0.0 && *x < 0.01) || (*x > 1.0 && *x < 1.01);
    let mut found = 0;
    let is_numeric = |path: &Path| NUMERIC.iter().any(|folder| path.starts_with(folder));
    for source in sources().iter().filter(|source| is_numeric(&source.path)) {
        let lines: Vec<&str> = source.text.lines().map(str::trim_start).collect();
        for (number, line) in lines.iter().enumerate() {
            if line.starts_with("//") || !literals(line).iter().any(is_small) {
                continue;
            }
            found += 1;
            let is_named = line.contains("const ") && lines[number - 1].starts_with("//");
            assert!(is_named, "{}, line {}: {line}", source.path.display(), number + 1);
        }
    }
    assert!(found > 3, "it sees {found} only");
}

#[test]
fn no_file_is_longer_than_a_reader_can_bear() {
    for source in sources() {
        let (file, lines) = (source.path.display(), source.text.lines().count());
        assert!(lines <= MOST_LINES, "{file} has {lines} lines: divide it");
    }
}
