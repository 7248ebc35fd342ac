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
    assert_eq!(lines.len(), 11, "{lines:#?}");
    assert!(lines[0].starts_with("26  rays that are not numbers"), "{}", lines[0]);
    assert!(lines[0].ends_with("they visit no node and hit nothing"), "{}", lines[0]);
    for (line, precision) in lines[1..4].iter().zip(["fast", "robust", "exact"]) {
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(words, [precision, "holds", "0", "of", "1000", "wrong"]);
    }
    assert!(lines[4].starts_with(" 5  directions"), "{}", lines[4]);
    assert!(lines[5].ends_with("1.00 x fast"), "{}", lines[5]);
    assert_eq!(lines[9..], ["robust 2 of 2 cases hold", "exact  2 of 2 cases hold"]);
}

#[test]
fn what_fast_arithmetic_fails_is_told_and_no_failure() {
    let arguments = ["selftest", "--case", "1", "--precision", "fast"];
    let output = run(folder().path(), &arguments);
    assert_eq!(output.status.code(), Some(0));
    let told = text(&output.stdout);
    assert!(told.contains("FAILS") && told.contains("fast   0 of 1 cases hold"), "{told}");
    assert!(
        told.contains("again: wavecrest selftest --case 1 --precision fast --seed 1"),
        "{told}"
    );
}

#[test]
fn a_mesh_of_the_users_own_is_tried() {
    let folder = folder();
    let mesh = folder.path().join("tetrahedron.obj");
    let lines =
        ["v 0 0 0", "v 1 0 0", "v 0 1 0", "v 0 0 1", "f 1 3 2", "f 1 2 4", "f 1 4 3", "f 2 3 4"];
    std::fs::write(&mesh, lines.join("\n")).expect("a file");
    let arguments = ["selftest", "--case", "26", "--json", "tetrahedron.obj"];
    let output = run(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0));
    let board: Value = serde_json::from_str(text(&output.stdout)).expect("JSON");
    let shape = &board["scene"]["shape"];
    assert_eq!((&shape["triangles"], &shape["borders"]), (&Value::from(4), &Value::from(0)));
    let [fast, robust, exact] = [0, 1, 2].map(|i| &board["scene"]["trials"][i]);
    assert!(fast["leaks"]["failed"].as_u64() > Some(0), "{fast}");
    for trial in [robust, exact] {
        assert!(trial["leaks"]["tried"].as_u64() > Some(100_000), "{trial}");
        let failed = [&trial["leaks"]["failed"], &trial["self_hits"]["failed"]];
        assert_eq!(failed, [&Value::from(0); 2]);
    }
}

#[test]
fn the_scoreboard_is_there_as_json() {
    let folder = folder();
    let output = run(folder.path(), &["selftest", "--case", "26", "--seed", "7", "--json"]);
    let board: Value = serde_json::from_str(text(&output.stdout)).expect("JSON");
    assert_eq!((&board["seed"], &board["full"]), (&Value::from(7), &Value::from(false)));
    let case = &board["cases"][0];
    assert_eq!(case["case"], 26);
    for (i, precision) in ["fast", "robust", "exact"].into_iter().enumerate() {
        let trial = &case["trials"][i];
        assert_eq!((&trial["precision"], &trial["holds"]), (&precision.into(), &true.into()));
        assert_eq!((&trial["tried"], &trial["failed"]), (&Value::from(1000), &Value::from(0)));
        assert_eq!(trial["first"], Value::Null);
    }
}

#[test]
fn a_case_that_there_is_not_is_an_error() {
    let message = "there is no such case, found 99; \
         name one of 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, \
         23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40";
    run_wrongly(folder().path(), &["selftest", "--case", "99"], message);
}
