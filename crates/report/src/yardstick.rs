//! How quick the machine is at the moment: the time of some work that no version of the program changes.
//!
//! A processor in a rack is now and then a tenth slower for minutes, whoever shares it. Two sweeps, or two reports of `bench`, of one machine
//! are compared in this unit, so that it does not pass for a change of the program.

use std::hint::black_box;
use std::time::Instant;

/// Steps of each thread: about a millisecond.
const STEPS: u32 = 200_000;

/// Seconds that all threads of the pool together take for the same work. It is all in registers: what a render has in
/// the caches stays there.
pub fn yardstick() -> f64 {
    let start = Instant::now();
    rayon::broadcast(|_| {
        let (mut bits, mut value) = (black_box(1_u64), black_box(1.0_f64));
        for _ in 0..STEPS {
            // Knuth's multiplier (MMIX), and an iteration that rounding keeps busy.
            bits = bits
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            value = (value + (bits >> 40) as f64).sqrt();
        }
        black_box((bits, value));
    });
    start.elapsed().as_secs_f64()
}
