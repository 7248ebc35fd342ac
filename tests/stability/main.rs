//! The hard cases, by number: each once with few inputs, and once with all that its bound speaks of.
//!
//! `cargo test --test stability` runs the first, `cargo test --release --test stability -- --ignored`
//! the second.

use wavecrest_core::kernels::precision::Precision;
use wavecrest_report::selftest::{CASES, Count, Effort, case};

/// The seed of every run; a failing input is told with its number.
const SEED: u64 = 1;

#[allow(clippy::expect_used, reason = "it fails as the tests do that call it")]
fn run(number: u32, count: Count) {
    let case = case(number).expect("the table below names cases that there are");
    let precision = Precision::Exact;
    let outcome = case.run(&Effort { precision, seed: SEED, count });
    let full = if count == Count::Full { " --full" } else { "" };
    assert!(
        outcome.holds(),
        "{}: {} of {} failed; the first: {}\nagain: wavecrest selftest --case {number} --precision {} \
         --seed {SEED}{full}",
        case.name,
        outcome.failed,
        outcome.tried,
        outcome.first.unwrap_or_default(),
        precision.name()
    );
}

/// What fast arithmetic is known to lose: were it to lose nothing, the cases would see nothing.
#[test]
fn fast_arithmetic_leaks_at_edges() {
    let case = case(1).expect("it is among those below");
    let (precision, count) = (Precision::Fast, Count::Quick);
    let effort = Effort { precision, seed: SEED, count };
    assert!(case.run(&effort).failed > 1000, "{}", case.name);
}

/// Two tests for each case.
macro_rules! cases {
    ($($number:literal $quick:ident $full:ident;)+) => {
        $(
            #[test]
            fn $quick() {
                run($number, Count::Quick);
            }

            #[test]
            #[ignore = "the full count: minutes"]
            fn $full() {
                run($number, Count::Full);
            }
        )+

        #[test]
        fn every_case_is_tested() {
            let numbers: Vec<u32> = CASES.iter().map(|case| case.number).collect();
            assert_eq!(numbers, [$($number),+]);
        }
    };
}

cases! {
    1 hc01_shared_edges hc01_shared_edges_full;
    2 hc02_vertices hc02_vertices_full;
    3 hc03_boxes hc03_boxes_full;
    4 hc04_along_axes hc04_along_axes_full;
    5 hc05_signed_zeros hc05_signed_zeros_full;
    6 hc06_tiny_components hc06_tiny_components_full;
    7 hc07_moved hc07_moved_full;
    8 hc08_scaled hc08_scaled_full;
    9 hc09_leaving hc09_leaving_full;
    10 hc10_contact hc10_contact_full;
    11 hc11_own_light hc11_own_light_full;
    12 hc12_before_a_light hc12_before_a_light_full;
    13 hc13_far_spheres hc13_far_spheres_full;
    14 hc14_huge_spheres hc14_huge_spheres_full;
    15 hc15_grazed_spheres hc15_grazed_spheres_full;
    16 hc16_inside_spheres hc16_inside_spheres_full;
    17 hc17_radii hc17_radii_full;
    18 hc18_without_area hc18_without_area_full;
    19 hc19_slivers hc19_slivers_full;
    20 hc20_in_the_plane hc20_in_the_plane_full;
    21 hc21_duplicates hc21_duplicates_full;
    22 hc22_one_centroid hc22_one_centroid_full;
    23 hc23_nested hc23_nested_full;
    24 hc24_next_to_nothing hc24_next_to_nothing_full;
    25 hc25_meshes hc25_meshes_full;
    26 hc26_invalid_rays hc26_invalid_rays_full;
    27 hc27_upright hc27_upright_full;
    28 hc28_angles hc28_angles_full;
    29 hc29_lenses hc29_lenses_full;
    30 hc30_look_ups hc30_look_ups_full;
    31 hc31_edge_on_lights hc31_edge_on_lights_full;
    32 hc32_lights_at_surfaces hc32_lights_at_surfaces_full;
    33 hc33_horizon hc33_horizon_full;
    34 hc34_crooked_quads hc34_crooked_quads_full;
    35 hc35_facing_mirrors hc35_facing_mirrors_full;
    36 hc36_highlights hc36_highlights_full;
    37 hc37_flat_floors hc37_flat_floors_full;
    38 hc38_copies hc38_copies_full;
    39 hc39_needles hc39_needles_full;
    40 hc40_before_the_origin hc40_before_the_origin_full;
    41 hc41_cones hc41_cones_full;
    42 hc42_listed_points hc42_listed_points_full;
    43 hc43_from_afar hc43_from_afar_full;
    44 hc44_instances hc44_instances_full;
    45 hc45_cut_outs hc45_cut_outs_full;
    46 hc46_vertex_colors hc46_vertex_colors_full;
    47 hc47_wide_quads hc47_wide_quads_full;
    48 hc48_integer_ends hc48_integer_ends_full;
    49 hc49_edges_of_slivers hc49_edges_of_slivers_full;
    50 hc50_turned_normals hc50_turned_normals_full;
    51 hc51_depth_images hc51_depth_images_full;
    52 hc52_footprints hc52_footprints_full;
    53 hc53_no_numbers hc53_no_numbers_full;
    54 hc54_cut_lenses hc54_cut_lenses_full;
    55 hc55_a_million_samples hc55_a_million_samples_full;
    56 hc56_samplers hc56_samplers_full;
    57 hc57_unbent_balls hc57_unbent_balls_full;
    58 hc58_panes hc58_panes_full;
    59 hc59_transparent_edges hc59_transparent_edges_full;
    60 hc60_white_light hc60_white_light_full;
    61 hc61_sky hc61_sky_full;
}
