//! The command that tries hard cases.

use serde_json::Value;

use crate::support::{blessing, folder, repository, run, text};

/// Where the bits of each case are recorded.
const RECORDED: &str = "crates/report/src/selftest/recorded.txt";

/// `WAVECREST_BLESS=1 cargo test --test integration selftest` records the bits that are found.
#[test]
fn this_machine_finds_the_recorded_bits() {
    let output = run(folder().path(), &["selftest", "--precision", "exact", "--json", "-q"]);
    let board: Value = serde_json::from_str(text(&output.stdout)).expect("JSON");
    let cases = board["cases"].as_array().expect("cases").iter();
    let parts: Vec<&Value> =
        cases.flat_map(|case| case["exact"].as_array().expect("parts")).collect();
    let string = |part: &Value, key: &str| part[key].as_str().unwrap_or_default().to_owned();
    if blessing() {
        let lines =
            parts.iter().map(|part| string(part, "name") + ": " + &string(part, "bits") + "\n");
        std::fs::write(repository(RECORDED), lines.collect::<String>()).expect("a file");
        return;
    }
    let failed = parts.iter().filter(|part| part["failed"] != 0).map(|part| string(part, "first"));
    assert_eq!(failed.collect::<Vec<_>>(), [""; 0]);
    assert_eq!(output.status.code(), Some(0));
    let recorded = std::fs::read_to_string(repository(RECORDED)).expect("a file");
    assert_eq!(recorded.lines().count(), parts.len(), "a line for each part, and no more");
}
