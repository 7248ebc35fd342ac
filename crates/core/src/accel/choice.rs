//! The choice of a kernel.

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
