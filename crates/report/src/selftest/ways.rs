//! Every kernel at every instruction level, and the hash of what they find.

use std::iter::Sum;
use std::ops::Range;

use xxhash_rust::xxh3::Xxh3;

use super::prelude::*;
use wavecrest_core::accel::{KernelChoice, Traversal};
use wavecrest_core::math::simd::Level;

/// Rays for each task: several packets.
pub(super) const RAYS_OF_A_TASK: usize = 1 << 8;

/// Checks `accel` with every kernel but the reference, at all instruction levels.
pub(super) fn with_every_kernel(accel: &mut Accel, check: impl Fn(&Accel) -> Outcome) -> Outcome {
    let mut outcome = Outcome::default();
    for level in Level::available() {
        let Some(token) = level.token() else { continue };
        accel.level = token;
        for kernel in KernelChoice::FOR_RENDERS {
            accel.kernel = kernel;
            let context = || format!("{} {}", level.name(), kernel.name());
            outcome.add(check(accel).with_context(context));
            if accel.tree().is_none() {
                // There is nothing left to vary: every kernel asks every primitive.
                return outcome;
            }
        }
    }
    outcome
}

/// The closest hits of rays, and whether each ray is blocked.
pub(super) fn hits(
    accel: &Accel,
    rays: &[Ray],
    traversal: &mut Traversal,
) -> (Vec<Hit>, Vec<bool>) {
    let (mut hits, mut blocked) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
    accel.closest_of(rays, &mut hits, traversal);
    accel.occluded_of(rays, &mut blocked, traversal);
    (hits, blocked)
}

/// The numbers below `count`, up to `size` of them at a time.
pub(super) fn blocks(
    count: usize,
    size: usize,
) -> impl IndexedParallelIterator<Item = Range<usize>> {
    let block = move |b: usize| b * size..((b + 1) * size).min(count);
    (0..count.div_ceil(size)).into_par_iter().map(block)
}

/// The sum of all outcomes; the first failure is that of the first failed test.
pub(super) fn in_order<T: Send + Sum>(outcomes: impl ParallelIterator<Item = T>) -> T {
    outcomes.collect::<Vec<_>>().into_iter().sum()
}

/// The hash of these words, in their order.
pub(super) fn hash(words: impl Iterator<Item = u32>) -> u64 {
    let mut hash = Xxh3::new();
    words.for_each(|word| hash.update(&word.to_le_bytes()));
    hash.digest()
}
