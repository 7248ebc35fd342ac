//! What is right in the hard cases, by number: their hits in rational numbers, and the means of
//! samplers. That every kernel finds these bits is what `wavecrest selftest` tests.
//!
//! `cargo test --test stability` tries few rays of each case,
//! `cargo test --release --test stability -- --ignored` a hundred times as many.

#![allow(
    clippy::expect_used,
    reason = "helpers of tests fail as tests do; clippy knows only the test functions themselves"
)]

#[path = "../properties/exact.rs"]
mod exact;

// The closest hit of a ray, in rational numbers.
mod reference;

// Whether the samplers have the means and the independence that sums rely on.
mod samplers;

use rayon::prelude::*;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::{CASES, Case, Count, Effort, SEED};

/// Every so many rays of a case are looked at.
const EVERY: usize = 32;

/// Cases of rays without a world of triangles and quads alone. Spheres and disks are in tests/properties, instances and
/// cut-outs in tests/integration.
const OF_OTHER_SHAPES: [u32; 5] = [13, 14, 15, 16, 44];

/// Asks the rays of a case; returns how many there are, and how many of them are among triangles and quads alone.
fn ask(case: &Case, count: Count) -> [usize; 2] {
    let inputs = case.inputs(&Effort { precision: Precision::Exact, seed: SEED, count });
    let asked = inputs.par_iter().map(|(accel, rays)| {
        let Some(triangles) = reference::triangles(accel.geometry()) else { return 0 };
        let mut traversal = accel.traversal();
        for ray in rays.iter().step_by(EVERY) {
            let right = reference::closest(ray, &triangles);
            let found = accel.closest(ray, &mut traversal);
            assert_eq!(found, right, "{}: {ray}", case.name);
        }
        rays.len()
    });
    [inputs.iter().map(|(_, rays)| rays.len()).sum(), asked.sum()]
}

fn hits_are_those_of_rational_arithmetic(count: Count) {
    let mut of_rays = 0;
    CASES.iter().for_each(|case| {
        let [rays, asked] = ask(case, count);
        let is_asked = rays > 0 && !OF_OTHER_SHAPES.contains(&case.number);
        assert_eq!(asked > 0, is_asked, "{}: {asked} of {rays} rays", case.name);
        of_rays += u32::from(rays > 0);
    });
    assert!(of_rays > 20, "{of_rays} cases only");
}

#[test]
fn hits_of_the_hard_cases_are_those_of_rational_arithmetic() {
    hits_are_those_of_rational_arithmetic(Count::Quick);
}

#[test]
#[ignore = "the full count: minutes for each case"]
fn all_hits_of_the_hard_cases_are_those_of_rational_arithmetic() {
    hits_are_those_of_rational_arithmetic(Count::Full);
}
