//! Merges corners at equal positions into vertices.
//!
//! All threads put the corners into one hash table, which begins with another number in each run: no input makes this slow.
//! Vertices are numbered in the order of the file.

use std::hash::{BuildHasher as _, RandomState};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use glam::Vec3;
use rayon::prelude::*;

use super::NO_VALUE;
use wavecrest_base::parallel;

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
    let seed = RandomState::new().hash_one(0);
    // A third stays empty, so that most searches end soon. A place has a number of 32 bits.
    let size = (corners.len() + corners.len() / 2 + 1).min(u32::MAX as usize);
    let table: Vec<AtomicU32> =
        (0..size).into_par_iter().map(|_| AtomicU32::new(NO_VALUE)).collect();
    let mut numbers = vec![0; corners.len()];
    // First the place of each: from that of its hash on, the first that is empty or has a corner of its position.
    parallel::each_mut(&mut numbers, |i, place| {
        let (i, own) = (i as u32, bits(corners[i]));
        let mut at = ((u64::from(hash(seed, own)) * size as u64) >> u32::BITS) as usize;
        loop {
            let mut found = table[at].load(Relaxed);
            if found == NO_VALUE {
                found =
                    table[at].compare_exchange(NO_VALUE, i, Relaxed, Relaxed).err().unwrap_or(i);
            }
            if bits(corners[found as usize]) == own {
                if i < found {
                    table[at].fetch_min(i, Relaxed);
                }
                break;
            }
            at = (at + 1) % size;
        }
        *place = at as u32;
    });
    parallel::each_mut(&mut numbers, |_, number| *number = table[*number as usize].load(Relaxed));
    numbers
}

/// Zeros of both signs are the same position.
fn bits(p: Vec3) -> [u32; 3] {
    (p + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// Well mixed bits of a position, and of a `seed`: a multiplication carries them upward, a shift downward.
fn hash(seed: u64, bits: [u32; 3]) -> u32 {
    /// An odd number with half of its bits set: 2^64 over the golden ratio.
    const ODD: u64 = 0x9E37_79B9_7F4A_7C15;
    let mix = |hash: u64, bits: u32| {
        let product = (hash ^ u64::from(bits)).wrapping_mul(ODD);
        product ^ product >> 32
    };
    bits.into_iter().fold(seed, mix) as u32
}
