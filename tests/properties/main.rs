//! What the kernels claim, tried with numbers of every size. A failure is made as small as it can be
//! and told. References are exact, or in double precision, and share no code with what is tried.
//! Searches, by every kernel with all instructions and in every kind of tree, are tried against brute
//! force.
//!
//! `PROPTEST_CASES=100000 cargo test --release --test properties` tries more, and
//! `PROPTEST_RNG_SEED=2` others.

#![allow(
    clippy::expect_used,
    reason = "helpers of tests fail as tests do; clippy knows only the test functions themselves"
)]

// Numbers, vectors and rays to try, and exact arithmetic.
mod exact;
mod inputs;

// The ray-triangle test and the exact orientation.
mod triangle;

// The half of a quad that a ray meets.
mod quad;

// The slab test loses nothing.
mod slab;

// Where rays meet spheres and disks.
mod disk;
mod sphere;

// Surfaces that nearly coincide, in the order of a ray.
mod surfaces;

// Moved origins leave the surface behind.
mod offsets;

// Random numbers, and the maps to shapes.
mod numbers;

// Texture look-ups.
mod texture;

// Light at extreme places, and reflection of it.
mod shading;

// Each step of a derivative against differences in double precision. Whole ways of rays, from all cameras and over
// several mirrors, are followed in `tests/integration/filtering.rs`.
mod differentials;

// Attempts to make some kernel, with some instructions, answer otherwise than brute force.
mod kernels;

// Cut-outs, by every kernel.
mod cutouts;

// What rays cross, and what of that shadow rays pass, against a test of every primitive.
mod crossings;

// Tiles of coherent rays against brute force.
mod packets;

// Every choice gives the same answers, and says truly who took which rays.
mod choice;

// The tree against brute force, and the hard cases of building.
mod chunks;

use proptest::test_runner::{Config, RngSeed};

/// Tries the same inputs in every run, unless the environment names others.
fn config() -> Config {
    let default = Config::default();
    let rng_seed = match default.rng_seed {
        RngSeed::Random => RngSeed::Fixed(1),
        fixed => fixed,
    };
    let asked = std::env::var_os("PROPTEST_CASES").is_some();
    let cases = if asked { default.cases } else { 2000 };
    // Of a million cases, more are rejected than by default may be.
    let rejects = u32::MAX;
    Config {
        rng_seed,
        cases,
        failure_persistence: None,
        max_local_rejects: rejects,
        max_global_rejects: rejects,
        ..default
    }
}
