//! Exact counts of the work of a render: they show that a scene pays only for the effects it uses.

use std::ops::{AddAssign, Sub};

use bytemuck::{Pod, Zeroable};

/// Counts for one thread or for a whole render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Camera rays.
    pub primary_rays: u64,
    /// Rays that go on from surfaces: mirrored, refracted, or straight on.
    pub secondary_rays: u64,
    /// Shadow rays.
    pub shadow_rays: u64,
    /// Points sampled on the lens.
    pub lens_samples: u64,
    /// Points sampled on area lights.
    pub light_samples: u64,
    /// Hits on surfaces, and what is looked up there.
    pub look_ups: LookUps,
    /// Tests of boxes and primitives.
    pub tests: TestCounts,
    /// Rays by the kernel that traced them.
    pub kernels: Kernels,
    /// Samples that were not finite; they count as black.
    pub invalid: u64,
    /// The first of these in the order of pixels.
    pub first_invalid: Option<Sample>,
    /// Shadow rays to a light within the rounding error of the surface: its distance counts as that
    /// error.
    pub lights_at_surface: u64,
    /// Paths that ended at the largest number of rays.
    pub cut_short: u64,
}

/// A sample of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Sample {
    /// The pixel: its row times the image's width plus its column.
    pub pixel: u32,
    /// The camera ray within the pixel.
    pub sample: u32,
}

impl Counters {
    /// Counts samples that were not finite; `first` is the first of them.
    pub fn add_invalid(&mut self, count: u64, first: Option<Sample>) {
        self.invalid += count;
        self.first_invalid = [self.first_invalid, first].into_iter().flatten().min();
    }
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.primary_rays += other.primary_rays;
        self.secondary_rays += other.secondary_rays;
        self.shadow_rays += other.shadow_rays;
        self.lens_samples += other.lens_samples;
        self.light_samples += other.light_samples;
        self.look_ups += other.look_ups;
        self.tests += other.tests;
        self.kernels += other.kernels;
        self.add_invalid(other.invalid, other.first_invalid);
        self.lights_at_surface += other.lights_at_surface;
        self.cut_short += other.cut_short;
    }
}

/// Exact counts of hits on surfaces, and of look-ups in textures and mesh attributes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct LookUps {
    /// Hits on surfaces whose look is constant and that are opaque.
    pub plain: u64,
    /// Other hits on surfaces: on those with maps, and on transparent ones.
    pub mapped: u64,
    /// Look-ups of maps at these hits, each of one map at one hit.
    pub maps: u64,
    /// Hits whose colour was interpolated between vertices.
    pub colors: u64,
    /// Texels read.
    pub texels: u64,
    /// Footprints of rays: at each hit one for the coordinates of its trilinear textures, and one for
    /// each ray that goes on from a surface if there are such textures.
    pub footprints: u64,
}

/// Exact counts of the work while tracing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct TestCounts {
    /// Inner nodes visited, each testing the boxes of its children.
    pub nodes: u64,
    /// Leaves visited.
    pub leaves: u64,
    /// Triangles tested.
    pub triangles: u64,
    /// Halves of quads tested.
    pub quads: u64,
    /// Spheres tested.
    pub spheres: u64,
    /// Disks tested.
    pub disks: u64,
    /// Hits on cut-outs that would replace the ray's best, each with a look-up of alpha.
    pub cutouts: u64,
    /// Instances visited, counted for each ray.
    pub instances: u64,
    /// Triangles that single precision left open, settled in double precision.
    pub settled: u64,
    /// Triangles that double precision left open too, decided in exact arithmetic.
    pub exact: u64,
    /// Hits whose t was found when their ray was done.
    pub finished: u64,
}

impl TestCounts {
    /// Counts tests of `count` triangles, `quads` of them halves of quads, by `rays` rays.
    #[inline(always)]
    pub(crate) fn count_triangles(&mut self, count: u32, quads: u32, rays: u32) {
        self.triangles += u64::from((count - quads) * rays);
        self.quads += u64::from(quads * rays);
    }
}

/// Exact counts of the kernels' work for rays of one class. Every ray counts for its first kernel:
/// `packet`, `stream` and `single` sum up to all rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct KernelCounts {
    /// Rays taken by packets.
    pub packet: u64,
    /// Rays that packets handed over to the kernel in flight.
    pub handed_over: u64,
    /// Rays in flight from their start.
    pub stream: u64,
    /// Rays taken alone.
    pub single: u64,
    /// Nodes visited by packets.
    pub packet_nodes: u64,
    /// Rays of the packet at those nodes, summed over all visits.
    pub packet_rays: u64,
    /// Rounds of rays in flight.
    pub rounds: u64,
    /// Rays in flight, summed over all rounds.
    pub in_flight: u64,
}

impl KernelCounts {
    /// Rays of the class.
    pub fn rays(&self) -> u64 {
        self.packet + self.stream + self.single
    }

    /// Average number of rays of a packet that visit a node together; `None` without packets.
    pub fn rays_a_node(&self) -> Option<f64> {
        average(self.packet_rays, self.packet_nodes)
    }

    /// Average number of rays in flight in a round; `None` without any.
    pub fn rays_a_round(&self) -> Option<f64> {
        average(self.in_flight, self.rounds)
    }
}

fn average(sum: u64, count: u64) -> Option<f64> {
    (count > 0).then(|| sum as f64 / count as f64)
}

/// The work of the kernels, by query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Kernels {
    /// For closest-hit rays: all but shadow rays.
    pub closest: KernelCounts,
    /// For any-hit rays: shadow rays.
    pub shadow: KernelCounts,
}

impl Kernels {
    /// The sum over both classes.
    pub fn both(&self) -> KernelCounts {
        let mut both = self.closest;
        both += self.shadow;
        both
    }
}

/// Joins counts field by field: all of them are `u64`.
pub(crate) fn each<T: Pod>(mut counts: T, others: T, join: impl Fn(u64, u64) -> u64) -> T {
    let fields: &mut [u64] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut counts));
    let others: &[u64] = bytemuck::cast_slice(std::slice::from_ref(&others));
    fields.iter_mut().zip(others).for_each(|(count, &other)| *count = join(*count, other));
    counts
}

macro_rules! sums {
    ($($counts:ty),+) => {$(impl AddAssign for $counts {
        fn add_assign(&mut self, other: Self) {
            *self = each(*self, other, |a, b| a + b);
        }
    })+};
}

sums!(LookUps, TestCounts, KernelCounts, Kernels);

impl Sub for TestCounts {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        each(self, other, |a, b| a - b)
    }
}
