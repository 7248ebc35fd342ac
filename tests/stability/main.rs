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
use wavecrest_report::selftest::{CASES, Count, Effort, SEED, case};

/// Every so many rays of a case are looked at.
const EVERY: usize = 32;

fn run(number: u32, count: Count) {
    let case = case(number).expect("the table below names cases that there are");
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
    let asked: usize = asked.sum();
    // Spheres and disks are in tests/properties, instances and cut-outs in tests/integration.
    assert_eq!(asked > 0, !OF_OTHER_SHAPES.contains(&number), "{}", case.name);
}

/// Cases without a world of triangles and quads alone.
const OF_OTHER_SHAPES: [u32; 5] = [13, 14, 15, 16, 44];

/// Two tests for each case.
macro_rules! cases {
    ($($number:literal $name:ident;)+) => {
        $(
            mod $name {
                use super::{Count, run};

                #[test]
                fn quick() {
                    run($number, Count::Quick);
                }

                #[test]
                #[ignore = "the full count: minutes"]
                fn full() {
                    run($number, Count::Full);
                }
            }
        )+

        #[test]
        fn every_case_of_rays_is_tested() {
            let effort = Effort { precision: Precision::Exact, seed: SEED, count: Count::Brief };
            let has_rays = CASES.iter().filter(|case| !case.inputs(&effort).is_empty());
            assert_eq!(has_rays.map(|case| case.number).collect::<Vec<_>>(), [$($number),+]);
        }
    };
}

cases! {
    1 hc01_shared_edges;
    2 hc02_vertices;
    3 hc03_boxes;
    4 hc04_along_axes;
    5 hc05_signed_zeros;
    6 hc06_tiny_components;
    9 hc09_leaving;
    10 hc10_contact;
    12 hc12_before_a_light;
    13 hc13_far_spheres;
    14 hc14_huge_spheres;
    15 hc15_grazed_spheres;
    16 hc16_inside_spheres;
    18 hc18_without_area;
    19 hc19_slivers;
    20 hc20_in_the_plane;
    21 hc21_duplicates;
    23 hc23_nested;
    26 hc26_invalid_rays;
    34 hc34_crooked_quads;
    39 hc39_needles;
    40 hc40_before_the_origin;
    44 hc44_instances;
    48 hc48_integer_ends;
    49 hc49_edges_of_slivers;
    51 hc51_depth_images;
}
