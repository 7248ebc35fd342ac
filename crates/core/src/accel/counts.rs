//! Counts of work while searching.

use std::ops::{AddAssign, Sub};

use bytemuck::{Pod, Zeroable};

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
    /// Hits on cut-outs, each with a look-up of alpha.
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
    pub(super) fn count_triangles(&mut self, count: u32, quads: u32, rays: u32) {
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
    /// For closest-hit rays: camera and mirror rays.
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
fn each<T: Pod>(mut counts: T, others: T, join: impl Fn(u64, u64) -> u64) -> T {
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

sums!(TestCounts, KernelCounts, Kernels);

impl Sub for TestCounts {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        each(self, other, |a, b| a - b)
    }
}
