//! The command that tries hard cases.

use serde_json::Value;

use super::{run, run_wrongly, text};
use crate::support::folder;

#[test]
fn a_case_is_told_with_its_count_and_its_bound() {
    let folder = folder();
    let output = run(folder.path(), &["selftest", "--case", "26", "--case", "5"]);
    assert_eq!(text(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
    let lines: Vec<&str> = text(&output.stdout).lines().collect();
    assert_eq!(lines.len(), 2);
    assert!(lines[0].starts_with("26  holds         1000 asked"), "{}", lines[0]);
    assert!(lines[0].ends_with("they visit no node and hit nothing"), "{}", lines[0]);
    assert!(lines[1].starts_with(" 5  holds"), "{}", lines[1]);
}

#[test]
fn the_scoreboard_is_there_as_json() {
    let folder = folder();
    let output = run(folder.path(), &["selftest", "--case", "26", "--seed", "7", "--json"]);
    let board: Value = serde_json::from_str(text(&output.stdout)).expect("JSON");
    assert_eq!((&board["seed"], &board["full"]), (&Value::from(7), &Value::from(false)));
    let case = &board["cases"][0];
    assert_eq!(case["case"], 26);
    assert_eq!(case["holds"], true);
    assert_eq!((&case["tried"], &case["failed"]), (&Value::from(1000), &Value::from(0)));
    assert_eq!(case["first"], Value::Null);
}

#[test]
fn a_case_that_there_is_not_is_an_error() {
    let message = "there is no such case, found 99; \
         name one of 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, \
         23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36";
    run_wrongly(folder().path(), &["selftest", "--case", "99"], message);
}
