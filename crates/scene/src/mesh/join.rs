//! Merges corners at equal positions into vertices.
//!
//! Corners are sorted on all threads by a hash of their position, those with the same hash by the
//! position itself: no input makes this slow. Vertices are numbered in the order of the file.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use rayon::prelude::*;

/// The distinct corners, in the order of their first use, and the triangles with their indices.
pub(super) fn join(triangles: Vec<[Vec3; 3]>) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corners = triangles.as_flattened();
    let first = first_of_each(corners);
    let mut positions = Vec::new();
    let mut numbers: Vec<u32> = Vec::with_capacity(corners.len());
    for (i, first) in first.into_iter().enumerate() {
        // Earlier vertices have their numbers.
        let number = numbers.get(first as usize).copied().unwrap_or(positions.len() as u32);
        if first as usize == i {
            positions.push(corners[i]);
        }
        numbers.push(number);
    }
    positions.shrink_to_fit();
    let joined = numbers.as_chunks().0.to_vec();
    (positions, joined)
}

/// For each of `corners`, the number of the first at its position.
pub fn first_of_each(corners: &[Vec3]) -> Vec<u32> {
    let number = |key: u64| key as u32;
    let place = |key: u64| bits(corners[number(key) as usize]);
    let mut keys: Vec<u64> = corners
        .par_iter()
        .enumerate()
        .map(|(i, p)| u64::from(hash(bits(*p))) << u32::BITS | i as u64)
        .collect();
    keys.par_sort_unstable();
    let first: Vec<AtomicU32> = corners.par_iter().map(|_| AtomicU32::new(0)).collect();
    keys.par_chunk_by_mut(|a, b| a >> u32::BITS == b >> u32::BITS).for_each(|of_hash| {
        of_hash.sort_unstable_by_key(|&key| (place(key), key));
        for same in of_hash.chunk_by(|a, b| place(*a) == place(*b)) {
            for &key in same {
                first[number(key) as usize].store(number(same[0]), Ordering::Relaxed);
            }
        }
    });
    first.into_iter().map(AtomicU32::into_inner).collect()
}

/// Zeros of both signs are the same position.
fn bits(p: Vec3) -> [u32; 3] {
    (p + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// Well mixed bits of a position: a multiplication carries them upward, a shift downward.
fn hash(bits: [u32; 3]) -> u32 {
    /// An odd number with half of its bits set: 2^64 over the golden ratio.
    const ODD: u64 = 0x9E37_79B9_7F4A_7C15;
    let mix = |hash: u64, bits: u32| {
        let product = (hash ^ u64::from(bits)).wrapping_mul(ODD);
        product ^ product >> 32
    };
    bits.into_iter().fold(0, mix) as u32
}
