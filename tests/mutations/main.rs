//! Faults in the sources, each of which a hard case must catch: a case that cannot fail proves nothing.
//!
//! A fault is planted in a copy of the sources: a wrong expression in place of the right one. All of them are in one
//! copy, each behind a switch, so that it is built once. The self-test must fail in the case of that number, or else the tests
//! of properties whose names begin with it.
//!
//! `cargo test --test mutations -- --ignored --nocapture` runs the list and prints what caught each.
//! `WAVECREST_FAULT=NAME` runs those alone whose name begins so.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a fault that cannot be planted ends the test, and the list is printed"
)]

mod faults;
mod plant;

use std::collections::BTreeSet;
use std::process::Output;
use std::time::Instant;

use faults::{FAULTS, Fault};
use plant::Planted;

/// The list follows the sources: each expression is still there, and only once, on however many lines.
#[test]
fn every_fault_has_its_place() {
    for fault in FAULTS {
        let places = fault.places(&fault.source());
        assert_eq!(places.len(), 1, "{}: `{}` in {}", fault.name, fault.right, fault.file);
    }
    let broken = Fault { right: "f(a, [b, c])", ..FAULTS[0] };
    let text = "g(f(\n    a,\n    [b, c],\n))";
    let found = broken.places(text);
    assert!(found.len() == 1 && found[0] == (2..text.len() - 1), "{found:?}");
    let names: BTreeSet<&str> = FAULTS.iter().map(|fault| fault.name).collect();
    assert_eq!(names.len(), FAULTS.len(), "names differ");
}

#[test]
#[ignore = "builds the core once more: minutes"]
fn every_fault_is_caught() {
    let asked = std::env::var("WAVECREST_FAULT").unwrap_or_default();
    let faults = || (1..).zip(FAULTS).filter(|(_, fault)| fault.name.starts_with(&asked));
    let planted = Planted::build();
    let caught = |number: usize, case: u32| {
        // The self-test ends with 2 if it has no such case.
        let fails = |output: Output| !matches!(output.status.code(), Some(0 | 2));
        let by_selftest = fails(planted.selftest(number, case)).then_some("self-test");
        by_selftest.or_else(|| fails(planted.properties(number, case)).then_some("properties"))
    };
    for case in faults().map(|(_, fault)| fault.case).collect::<BTreeSet<_>>() {
        assert_eq!(caught(0, case), None, "case {case} fails without a fault");
    }
    let mut missed = Vec::new();
    for (number, fault) in faults() {
        let start = Instant::now();
        let by = caught(number, fault.case);
        missed.extend(by.is_none().then_some(fault.name));
        let (seconds, by) = (start.elapsed().as_secs_f64(), by.unwrap_or("MISSED"));
        println!("{:56} case {:2}  {seconds:5.1} s  {by}", fault.name, fault.case);
    }
    assert!(missed.is_empty(), "nothing fails with {missed:?}");
}
