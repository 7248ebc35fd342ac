//! The output of `trace`.

use serde::Serialize;

use super::passes::Answers;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::tree::Visits;
use wavecrest_core::accel::{Hit, KernelChoice};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
use wavecrest_core::render::TracerKind;
use wavecrest_report::ray_file::RayFile;
use wavecrest_report::statistics::ClassUse;

/// Two t agree if they differ by less than this factor of t: those of the file may be off by what
/// single precision leaves at grazing angles.
const AGREEMENT: f32 = 1.0 / 16384.0;

/// The output.
#[derive(Serialize)]
pub(super) struct Report {
    pub(super) rays: usize,
    pub(super) any_hit: bool,
    pub(super) hits: usize,
    pub(super) mrays_s: f64,
    pub(super) seconds: f64,
    pub(super) repeats: u32,
    pub(super) threads: usize,
    pub(super) tracer: TracerKind,
    pub(super) simd: Level,
    pub(super) kernel: KernelChoice,
    pub(super) precision: Precision,
    pub(super) preset: Preset,
    pub(super) triangles: usize,
    pub(super) load_seconds: f64,
    pub(super) build_seconds: f64,
    /// The visits that the surface-area heuristic expects of a ray; 0 without a tree.
    pub(super) expected_visits: Visits,
    pub(super) nodes_per_ray: f64,
    pub(super) leaves_per_ray: f64,
    pub(super) triangles_per_ray: f64,
    pub(super) settled_per_ray: f64,
    pub(super) exact_per_ray: f64,
    pub(super) kernels: ClassUse,
    pub(super) compared: Compared,
}

/// The comparison of our answers with the file's.
#[derive(Debug, Default, Serialize)]
pub(super) struct Compared {
    /// Hits only in the file.
    lost: usize,
    /// Hits only in ours.
    extra: usize,
    /// Closest hits on another triangle at the same distance.
    other_triangle: usize,
    /// Closest hits at another distance.
    other_distance: usize,
    /// The largest relative difference of t among the rest.
    largest_relative_t: f32,
    /// Any-hit answers of "hit" only in the file.
    lost_any: usize,
    /// Any-hit answers of "hit" only in ours.
    extra_any: usize,
}

impl Compared {
    /// Compares `ours` with the answers of `file`.
    pub(super) fn new(file: &RayFile, ours: &Answers) -> Self {
        let mut compared = Self::default();
        for (theirs, ours) in file.closest.iter().zip(&ours.closest) {
            compared.add_closest(theirs, ours);
        }
        for (&theirs, &ours) in file.occluded.iter().zip(&ours.occluded) {
            compared.lost_any += usize::from(theirs && !ours);
            compared.extra_any += usize::from(ours && !theirs);
        }
        compared
    }

    fn add_closest(&mut self, theirs: &Hit, ours: &Hit) {
        match (theirs.is_miss(), ours.is_miss()) {
            (false, true) => self.lost += 1,
            (true, false) => self.extra += 1,
            (true, true) => {}
            (false, false) => {
                let relative = (theirs.t - ours.t).abs() / theirs.t.abs().max(f32::MIN_POSITIVE);
                // Written so that a NaN does not agree.
                let agrees = relative <= AGREEMENT;
                if !agrees {
                    self.other_distance += 1;
                    return;
                }
                self.largest_relative_t = self.largest_relative_t.max(relative);
                self.other_triangle += usize::from(theirs.primitive != ours.primitive);
            }
        }
    }

    fn text(&self) -> String {
        let Self { lost, extra, other_triangle, other_distance, lost_any, extra_any, .. } = self;
        format!(
            "against the file: {lost} lost, {extra} extra, {other_triangle} on another triangle, \
             {other_distance} at another distance, largest relative difference of t {:.2e}; \
             any-hit {lost_any} lost, {extra_any} extra\n",
            self.largest_relative_t
        )
    }
}

impl Report {
    /// In words.
    pub(super) fn text(&self) -> String {
        let kind = if self.any_hit { "any hit" } else { "closest hit" };
        let Self { mrays_s, rays, hits, seconds, repeats, threads, triangles, .. } = self;
        let Self { load_seconds, build_seconds, nodes_per_ray, leaves_per_ray, .. } = self;
        let Self { triangles_per_ray, settled_per_ray, exact_per_ray, compared, .. } = self;
        let (preset, precision, simd) =
            (self.preset.name(), self.precision.name(), self.simd.name());
        let Visits { nodes, leaves } = self.expected_visits;
        let ClassUse { packet, handed_over, stream, single, .. } = &self.kernels;
        let average = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.1}"));
        let [a_node, a_round] = [self.kernels.rays_a_node, self.kernels.rays_a_round].map(average);
        format!(
            "{mrays_s:.2} Mrays/s: {rays} rays ({kind}), {hits} hits, {seconds:.4} s, \
             median of {repeats} on {threads} threads\n\
             mesh: {triangles} triangles, loaded in {load_seconds:.3} s; \
             BVH {preset}, built in {build_seconds:.3} s, \
             estimate {nodes:.1} nodes and {leaves:.1} leaves per ray; {precision} precision\n\
             per ray: {nodes_per_ray:.2} nodes, {leaves_per_ray:.2} leaves, \
             {triangles_per_ray:.2} triangles, {settled_per_ray:.5} settled in double precision, \
             {exact_per_ray:.6} in exact arithmetic\n\
             {simd}: {packet} rays in packets ({handed_over} handed over), {stream} in streams, \
             {single} alone; average: {a_node} rays of a packet at a node, \
             {a_round} rays in flight per round\n{}",
            compared.text()
        )
    }
}
