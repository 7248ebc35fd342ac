//! The tables of keys in SCENES.md follow from the declarations.
//!
//! The table below a line `<!-- keys: a light -->` has the keys of all lights. Below `<!-- keys: a shape: texture tint -->`
//! it has these keys of shapes, and tables that name none do without them. `WAVECREST_BLESS=1` writes the tables again.

use std::collections::{BTreeSet, HashSet};
use std::fs;

use wavecrest_scene::keys::{Absent, Key, Kind, Range, Takes, file};

const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/SCENES.md");

/// A kind of object, with the name of the kinds that it is one of, and its own.
type Named = ([&'static str; 2], &'static Kind);

/// All kinds of objects within a value.
fn kinds(takes: &'static Takes, found: &mut Vec<Named>) {
    let mut add = |name, kind: &'static Kind| {
        let own = kind.name.split(" (").next().unwrap();
        found.push(([name, own], kind));
        let keys = kind.declarations().map(|component| component.keys);
        keys.chain([kind.keys]).flatten().for_each(|key| kinds(&key.takes, found));
    };
    match takes {
        Takes::Object(kind) => add("", kind),
        Takes::Variants(all) => all.kinds.iter().for_each(|kind| add(all.name, kind)),
        Takes::AtLeast(_, item) | Takes::Exactly(_, item) => kinds(item, found),
        Takes::Either(first, second) => [first, second].iter().for_each(|one| kinds(one, found)),
        _ => {}
    }
}

/// A key of one or more kinds.
struct Row {
    name: &'static str,
    /// The values of `type` of these kinds.
    of: BTreeSet<&'static str>,
    /// Its names, values, default and meaning.
    cells: [String; 4],
}

/// The keys of the kinds with these names.
fn rows(kinds: &[Named], named: &str) -> Vec<Row> {
    let is_named = |names: &[&str]| named.split(", ").any(|one| names.contains(&one));
    let kinds = kinds.iter().filter(|(names, _)| is_named(names)).map(|(_, kind)| *kind);
    let kinds: Vec<&Kind> = kinds.collect();
    let mut rows: Vec<Row> = Vec::new();
    for kind in &kinds {
        let mut known = HashSet::new();
        let is_read = |key: &Key| !matches!(key.takes, Takes::Anything) && known.insert(key.name);
        for key in kind.all_keys().filter(is_read) {
            // A mesh needs points only without a file.
            let mut same = kinds.iter().filter(|other| other.word == kind.word);
            let default = match key.absent {
                Absent::Required | Absent::Open => {
                    let needs = |of: Key| of.absent == Absent::Required || is_ignored(&of);
                    let all = same.all(|kind| kind.key(key.name).is_some_and(needs));
                    if all { "required".to_owned() } else { String::new() }
                }
                Absent::Off => "`false`".to_owned(),
                Absent::Is(x) => x.to_string(),
                Absent::Are(three) => format!("{three:?}").replace(".0", ""),
                Absent::Says(word) => format!("`{word}`"),
            };
            let cells = [names(&key), value(&key.takes), default, key.about.to_owned()];
            match rows.iter_mut().find(|row| row.cells == cells) {
                Some(row) => _ = row.of.insert(kind.word),
                None => rows.push(Row { name: key.name, of: [kind.word].into(), cells }),
            }
        }
    }
    assert!(!rows.is_empty(), "no kind of object is {named:?}");
    rows
}

fn is_ignored(key: &Key) -> bool {
    matches!(key.takes, Takes::Anything)
}

fn code<T: ToString>(words: impl IntoIterator<Item = T>) -> String {
    let words = words.into_iter().map(|word| format!("`{}`", word.to_string()));
    words.collect::<Vec<_>>().join(", ")
}

fn names(key: &Key) -> String {
    let others =
        if key.synonyms.is_empty() { "" } else { &format!(" (or {})", code(key.synonyms)) };
    format!("{}{others}", code([key.name]))
}

/// The values of a key, briefly.
fn value(takes: &Takes) -> String {
    match takes {
        Takes::Anything => String::new(),
        Takes::Text => "text".to_owned(),
        Takes::Truth => code([true, false]),
        Takes::Number(range) => number(*range),
        Takes::Integer(0, u32::MAX) => "integer".to_owned(),
        Takes::Integer(low, high) => format!("integer {low} to {high}"),
        Takes::OneOf(numbers) => code(*numbers),
        Takes::Point | Takes::Direction(_) => "[x, y, z]".to_owned(),
        Takes::Color => "[r, g, b]".to_owned(),
        Takes::Choice(words) => code(words()),
        Takes::Object(_) | Takes::Variants(_) => "object".to_owned(),
        Takes::Either(first, second) => format!("{}, or {}", value(first), value(second)),
        Takes::Matrix => "4 times [a, b, c, d]".to_owned(),
        Takes::AtLeast(_, item) => format!("[{}, ...]", value(item)),
        Takes::Exactly(2, Takes::Number(_) | Takes::Integer(..)) => "[a, b]".to_owned(),
        Takes::Exactly(3, Takes::Number(_) | Takes::Integer(..)) => "[a, b, c]".to_owned(),
        Takes::Exactly(count, item) => format!("{count} times {}", value(item)),
    }
}

fn number(range: Range) -> String {
    let Range { low, high, open: is_open } = range;
    match range.words().ends_with("2^40") {
        _ if range == Range::COORDINATE => "number".to_owned(),
        true if is_open => format!("above {low}"),
        true => format!("{low} or more"),
        false => format!("{low} to {high}"),
    }
}

fn table(rows: &[&Row]) -> String {
    let types: BTreeSet<&str> = rows.iter().flat_map(|row| row.of.iter().copied()).collect();
    let has_types = rows.iter().any(|row| row.of != types);
    let line = |of: &str, cells: [&str; 4]| {
        let of = if has_types { &format!("| {of} ") } else { "" };
        format!("{of}| {} |\n", cells.join(" | ")).replace("|  |", "| |")
    };
    let head = line("type", ["key", "value", "default", "meaning"]);
    let rule = line("---", ["---"; 4]).replace(' ', "");
    let rows = rows.iter().map(|row| {
        let of = if row.of == types { "all".to_owned() } else { code(&row.of) };
        line(&of, row.cells.each_ref().map(String::as_str))
    });
    head + &rule + &rows.collect::<String>()
}

#[test]
fn the_tables_of_scenes_md_are_those_of_the_declarations() {
    const MARK: &str = "<!-- keys: ";
    let document = fs::read_to_string(DOCUMENT).unwrap();
    let mut all = Vec::new();
    kinds(file(), &mut all);
    let mut parts = document.split(MARK);
    let start = parts.next().unwrap();
    let parts: Vec<_> = parts
        .map(|part| {
            let (mark, below) = part.split_once(" -->\n").unwrap();
            let (name, keys) = mark.split_once(": ").unwrap_or((mark, ""));
            let keys: Vec<&str> = keys.split(' ').filter(|key| !key.is_empty()).collect();
            (mark, rows(&all, name), keys, below.find("\n\n").map_or("", |end| &below[end + 1..]))
        })
        .collect();
    let mut named: Vec<&Row> = Vec::new();
    for (_, rows, keys, _) in &parts {
        named.extend(rows.iter().filter(|row| keys.contains(&row.name)));
    }
    let mut shown = Vec::new();
    let mut written = start.to_owned();
    for (mark, rows, keys, rest) in &parts {
        let is_elsewhere = |row: &Row| named.iter().any(|other| other.cells == row.cells);
        let is_here = |row: &&Row| match keys[..] {
            [] => !is_elsewhere(row),
            _ => keys.contains(&row.name),
        };
        let rows: Vec<&Row> = rows.iter().filter(is_here).collect();
        written += &format!("{MARK}{mark} -->\n{}{rest}", table(&rows));
        shown.extend(rows);
    }
    for ([of, name], _) in &all {
        let name = if of.is_empty() { name } else { of };
        for row in rows(&all, name) {
            let is_shown = shown.iter().any(|other| other.cells == row.cells);
            assert!(is_shown, "no table has the key of {name}: {:?}", row.cells);
        }
    }
    if std::env::var_os("WAVECREST_BLESS").is_some_and(|value| value == "1") {
        fs::write(DOCUMENT, written).unwrap();
    } else {
        assert!(written == document, "tables have changed: WAVECREST_BLESS=1 writes them again");
    }
}
