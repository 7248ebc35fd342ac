//! Texts that tests of any crate compare with: paragraphs of an input, one or more lines, and below it, indented, what
//! follows. A paragraph that begins with `#` is the heading of those after it: the rule that a failure names.
//!
//! `WAVECREST_BLESS=1` writes what follows again.

use std::fs;
use std::path::Path;

/// Compares what `follows` from each input with the text at `path` in the crate. Returns the inputs.
#[track_caller]
pub(crate) fn compare(path: &str, mut follows: impl FnMut(&str) -> String) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let approved = fs::read_to_string(&path).unwrap();
    let blessing = std::env::var_os("WAVECREST_BLESS").is_some_and(|value| value == "1");
    let (mut heading, mut all, mut inputs) = ("", Vec::new(), Vec::new());
    for paragraph in approved.trim_end().split("\n\n") {
        if paragraph.starts_with('#') {
            heading = paragraph;
            all.push(paragraph.to_owned());
            continue;
        }
        let lines = paragraph.lines().filter(|line| !line.starts_with("    "));
        let input = lines.collect::<Vec<_>>().join("\n");
        let below = follows(&input).lines().map(|line| format!("\n    {line}")).collect::<String>();
        let found = format!("{input}{below}");
        assert!(blessing || found == paragraph, "{heading}\n{found}\nand not\n{paragraph}");
        all.push(found);
        inputs.push(input);
    }
    if blessing {
        fs::write(path, all.join("\n\n") + "\n").unwrap();
    }
    inputs
}
