//! The seeds of tests that try inputs of many.

use std::ops::Range;

/// The seeds to try: `usual` ones, unless `WAVECREST_FUZZ` names others.
pub(crate) fn asked_for(usual: Range<u64>) -> Range<u64> {
    let Ok(asked) = std::env::var("WAVECREST_FUZZ") else { return usual };
    let number = |text: &str| text.parse::<u64>().expect("WAVECREST_FUZZ is a number or a range");
    match asked.split_once("..") {
        Some((start, end)) => number(start)..number(end),
        None => number(&asked)..number(&asked) + 1,
    }
}
