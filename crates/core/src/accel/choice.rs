//! The choice of a kernel, and counts of the work of each.

use super::packet::TILE;

wavecrest_base::choices! {
    /// The kernel for batches of rays. The answers are the same.
    ///
    /// A single ray, as in the recursive tracer, is always traced alone; and without a tree there
    /// is nothing to choose but the reference, which decides these too. Fast precision has no pairs
    /// in exact arithmetic: there the reference is `single`.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum KernelChoice {
        /// Packets while rays are coherent, then streams.
        #[default]
        Auto = "auto",
        /// Packets, even of incoherent rays; rays that leave a packet continue in a stream.
        Packet = "packet",
        /// Streams of rays in flight.
        Stream = "stream",
        /// One ray at a time.
        Single = "single",
        /// One ray at a time, every pair in exact arithmetic, for tests and doubt.
        Reference = "reference",
    }
}

impl KernelChoice {
    /// The kernels for renders: all but the reference.
    pub const FOR_RENDERS: [Self; 4] = [Self::Auto, Self::Packet, Self::Stream, Self::Single];

    /// Whether a packet takes the next of `left` rays, given whether those before were coherent.
    #[inline(always)]
    pub(super) fn packs(self, left: usize, coherent: bool) -> bool {
        match self {
            // A partly filled tile shares less, but costs as much.
            Self::Auto => coherent && left >= TILE / 2,
            Self::Packet => left > 0,
            Self::Stream | Self::Single | Self::Reference => false,
        }
    }
}

/// Exact counts of the kernels' work for rays of one class. Every ray counts for its first kernel:
/// `packet`, `stream` and `single` sum up to all rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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

impl std::ops::AddAssign for KernelCounts {
    fn add_assign(&mut self, other: Self) {
        self.packet += other.packet;
        self.handed_over += other.handed_over;
        self.stream += other.stream;
        self.single += other.single;
        self.packet_nodes += other.packet_nodes;
        self.packet_rays += other.packet_rays;
        self.rounds += other.rounds;
        self.in_flight += other.in_flight;
    }
}

/// The work of the kernels, by query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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

impl std::ops::AddAssign for Kernels {
    fn add_assign(&mut self, other: Self) {
        self.closest += other.closest;
        self.shadow += other.shadow;
    }
}

#[cfg(test)]
mod tests;
