//! The current speed of the machine: the time of a fixed piece of work that is the same in all
//! versions.
//!
//! A shared processor may be a tenth slower for minutes. Two sweeps of one machine are compared in
//! this unit, so that such phases do not count as changes of the program.

use std::hint::black_box;
use std::time::Instant;

/// Steps for each thread: about a millisecond.
const STEPS: u32 = 200_000;

/// Seconds that all threads of the pool take for the same work. It uses only registers, so the
/// caches of a render are not disturbed.
pub fn yardstick() -> f64 {
    let start = Instant::now();
    rayon::broadcast(|_| {
        let (mut bits, mut value) = (black_box(1_u64), black_box(1.0_f64));
        for _ in 0..STEPS {
            // Knuth's multiplier (MMIX), and a floating-point iteration.
            bits = bits
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            value = (value + (bits >> 40) as f64).sqrt();
        }
        black_box((bits, value));
    });
    start.elapsed().as_secs_f64()
}
