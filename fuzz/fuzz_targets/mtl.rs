//! Tries `mtl` of `tests/fuzz/targets.rs`.

#![no_main]

#[path = "../../tests/fuzz/rays.rs"]
mod rays;
#[allow(dead_code, reason = "each fuzzer tries one target")]
#[path = "../../tests/fuzz/targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    targets::mtl(bytes);
});
