//! Tries `accel` of `tests/fuzz/targets.rs`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    wavecrest_fuzz::targets::accel(bytes);
});
